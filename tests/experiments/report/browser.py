"""A page in a real browser, by chromium and chromedriver alone, and the report of the made-up run of report_test.cpp."""

import contextlib
import http.client
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ELEMENT = "element-6066-11e4-a52e-4f735466cecf"  # the name WebDriver gives to references
ENTER, TAB, LEFT, UP, RIGHT, DOWN = "\ue007", "\ue004", "\ue012", "\ue013", "\ue014", "\ue015"


class Browser:
    """A WebDriver session (W3C) with chromedriver."""

    def __init__(self):
        driver = shutil.which("chromedriver")
        browser = shutil.which("chromium") or shutil.which("google-chrome")
        if not driver or not browser:
            sys.exit("tests in a browser need chromium and chromedriver")
        self.process = subprocess.Popen(
            [driver, "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        for line in self.process.stdout:
            if found := re.search(r"started successfully on port (\d+)", line):
                self.port = int(found[1])
                break
        options = {
            "binary": browser,
            "args": [
                "--headless=new",
                "--no-sandbox",
                "--disable-gpu",
                "--disable-dev-shm-usage",
                "--window-size=1280,900",
            ],
        }
        self.session = ""
        self.session = (
            "/session/"
            + self.call(
                "POST",
                "/session",
                {
                    "capabilities": {
                        "alwaysMatch": {
                            "goog:chromeOptions": options,
                            "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"},
                        }
                    }
                },
            )["sessionId"]
        )

    def call(self, method, path, body=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=120)
        connection.request(method, self.session + path, None if body is None else json.dumps(body))
        value = json.loads(connection.getresponse().read())["value"]
        if isinstance(value, dict) and "error" in value:
            raise RuntimeError(f"{value['error']}: {value['message']}")
        return value

    def open(self, path):
        self.call("POST", "/url", {"url": path.as_uri()})
        self.settle()

    def settle(self):
        """Waits until all is made and two frames are drawn: observers answer in the second, and may have it made anew."""
        self.call(
            "POST",
            "/execute/async",
            {
                "script": """const done = arguments[0], isBusy = () => document.querySelector('[aria-busy]') !== null;
                    const frames = () => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(end, 30)));
                    const end = () => isBusy() ? wait() : done();
                    const wait = () => isBusy() ? setTimeout(wait, 10) : frames();
                    wait()""",
                "args": [],
            },
        )

    def run(self, script, *arguments):
        return self.call("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def press(self, *keys):
        actions = [{"type": kind, "value": key} for key in keys for kind in ("keyDown", "keyUp")]
        self.call("POST", "/actions", {"actions": [{"type": "key", "id": "keyboard", "actions": actions}]})
        self.settle()

    def focus(self, selector):
        self.run("document.querySelector(arguments[0]).focus()", selector)

    def click(self, selector):
        element = self.call("POST", "/element", {"using": "css selector", "value": selector})[ELEMENT]
        self.call("POST", f"/element/{element}/click", {})
        self.settle()

    def drag(self, selector, dx, dy, grip=None):
        """Drags from the middle of an element, or from `grip`, pixels from its upper left corner."""
        x, y = self.run(
            """const node = document.querySelector(arguments[0]), grip = arguments[1];
            node.scrollIntoView({ block: "center", behavior: "instant" });
            const box = node.getBoundingClientRect();
            return grip ? [grip[0] - box.width / 2, grip[1] - box.height / 2].map(Math.round) : [0, 0]""",
            selector,
            grip,
        )
        element = self.call("POST", "/element", {"using": "css selector", "value": selector})
        self.call(
            "POST",
            "/actions",
            {
                "actions": [
                    {
                        "type": "pointer",
                        "id": "mouse",
                        "actions": [
                            {"type": "pointerMove", "origin": element, "x": x, "y": y},
                            {"type": "pointerDown", "button": 0},
                            {"type": "pointerMove", "origin": "pointer", "x": dx, "y": dy},
                            {"type": "pointerUp", "button": 0},
                        ],
                    }
                ]
            },
        )
        self.settle()

    def media(self, scheme):
        self.call(
            "POST",
            "/goog/cdp/execute",
            {
                "cmd": "Emulation.setEmulatedMedia",
                "params": {"features": [{"name": "prefers-color-scheme", "value": scheme}]},
            },
        )
        self.settle()

    def pixels(self, selector):
        """The pixels of the first such canvas, as a string to compare."""
        return self.run("return document.querySelector(arguments[0]).toDataURL()", selector)

    def log(self, kind):
        return self.call("POST", "/se/log", {"type": kind})

    def close(self):
        try:
            self.call("DELETE", "")
        finally:
            self.process.terminate()
            self.process.wait()


def check(condition, message):
    if not condition:
        raise AssertionError(message)


def make_report(folder):
    """The report of the made-up run of report_test.cpp."""
    program = pathlib.Path(os.environ.get("ULAM", "build/release/ulam")).parent / "tests" / "test_experiments_report"
    if not program.exists():
        sys.exit(f"no {program}; build the tests, or name a report.html")
    command = [program, "a report holds its run and asks for nothing"]
    subprocess.run(command, env={**os.environ, "ULAM_REPORT_DIR": folder}, check=True, stdout=subprocess.DEVNULL)
    return pathlib.Path(folder) / "report.html"


DATA = re.compile(r'(<script type="application/json" id="data">)(.*?)(</script>)', re.DOTALL)


def data_of(page):
    return json.loads(DATA.search(page.read_text(encoding="utf-8"))[2])


def with_data(page, data, path, elements=""):
    """The page with other data, and elements of pictures that go with them, as a new file."""
    text = page.read_text(encoding="utf-8")
    found = DATA.search(text)
    safe = json.dumps(data).replace("<", "\\u003c")
    path.write_text(text[: found.start(2)] + safe + found[3] + elements + text[found.end() :], encoding="utf-8")
    return path


MULTIPLES = {"%": 0.01, "k": 1e3, "M": 1e6, "G": 1e9}


def number_of(text):
    """The number that the page writes so: 0.0120, 2.40 M, 3.4 × 10⁻⁵, −1 %."""
    text = text.replace("−", "-").replace("\u2009×\u200910", "e").translate(str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-"))
    digits, _, unit = text.partition("\u202f")
    return float(digits) * MULTIPLES.get(unit, 1)


def read_plot(browser, name):
    """What a plot with logarithmic axes holds, by its ticks: {colour: [(x, y, lower, upper), …]}, bounds being those of the
    band."""
    drawn = browser.run(
        """const root = document.querySelector(`svg[aria-label="${arguments[0]}"]`);
        const ticks = (axis) => [...root.querySelectorAll(`.${axis}-tick`)].map((t) =>
            [Number(t.getAttribute(axis)) - (axis === 'y' ? 4 : 0), t.textContent]);  // labels are centred on their ticks
        const places = (path) => path && path.getAttribute('d').match(/[\\d.]+/g).map(Number);
        return { x: ticks('x'), y: ticks('y'), series: [...root.querySelectorAll('.series')].map((g) => {
            const line = g.querySelector(':scope > path[fill=none]');
            return [line.getAttribute('stroke'), places(line), places(g.querySelector('.band'))];
        }) }""",
        name,
    )

    def scale(ticks):
        (a, low), (b, high) = [(at, math.log(number_of(text))) for at, text in (ticks[0], ticks[-1])]
        return lambda at: math.exp(low + (high - low) * (at - a) / (b - a))

    x, y = scale(drawn["x"]), scale(drawn["y"])
    found = {}
    for colour, line, band in drawn["series"]:
        points = len(line) // 2
        check(len(band) == 2 * len(line), f"{name}: the band has {len(band)} numbers, the line {len(line)}")
        upper, lower = band[1 : 2 * points : 2], band[2 * points + 1 :: 2][::-1]
        found[colour] = [(x(u), y(v), y(lo), y(hi)) for u, v, lo, hi in zip(line[::2], line[1::2], lower, upper, strict=True)]
    return found


def check_plot(browser, legend, name, expected):
    """A plot has the lines of `expected`, {name in the legend: [(x, y, lower, upper), …]}, but for what drawing rounds."""
    colours = browser.run(
        """return [...arguments[0].querySelectorAll('li:has(b)')].map((item) =>
            [item.querySelector('b').textContent, item.querySelector('line').getAttribute('stroke')])""",
        legend,
    )
    found = read_plot(browser, name)
    labels = {colour: label for label, colour in colours}
    check({labels[colour] for colour in found} == set(expected), f"{name} has lines of {[labels[c] for c in found]}")
    for colour, points in found.items():
        wanted = expected[labels[colour]]
        check(len(points) == len(wanted), f"{name}: {labels[colour]} has {len(points)} points, not {len(wanted)}")
        for point, numbers in zip(points, wanted, strict=True):
            near = all(abs(a / b - 1) < 0.01 for a, b in zip(point, numbers, strict=True))
            check(near, f"{name}: {labels[colour]} is drawn at {point}, not {numbers}")


def complaints(browser):
    return [entry["message"] for entry in browser.log("browser")]


def run_tests(tests, open_page):
    """Runs each test on the page that `open_page` opens first; 0 if all passed, as an exit code."""
    passed = failed = 0
    browser = Browser()
    try:
        open_page(browser)
        browser.media("light")
        for test in tests:
            try:
                test(browser)
                passed += 1
            except (AssertionError, RuntimeError) as error:
                failed += 1
                print(f"FAILED {getattr(test, 'func', test).__name__}: {error}")
        if said := complaints(browser):
            failed += 1
            print(f"FAILED: while it was used the console said {said}")
    finally:
        browser.close()
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


@contextlib.contextmanager
def report(arguments):
    """The page a test is given, or else that of the made-up run."""
    if len(arguments) == 2:
        yield pathlib.Path(arguments[1]).resolve()
        return
    with tempfile.TemporaryDirectory() as folder:
        yield make_report(folder)
