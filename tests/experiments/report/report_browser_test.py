#!/usr/bin/env python3
"""Drives a report in a real browser, by chromium and chromedriver alone: report_browser_test.py [REPORT_HTML].

Without an argument the report is that of the made-up run of report_test.cpp, whose program lies beside $ULAM.
"""

import functools
import http.client
import json
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
            sys.exit("report_browser_test: chromium and chromedriver are needed")
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
        """Waits until two frames are drawn: charts are made in one, observers answer in the next."""
        self.call(
            "POST",
            "/execute/async",
            {
                "script": "const done = arguments[0];"
                "requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 30)))",
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


VIEWER = "#viewer-scene-0"
STAGE, EXPOSURE = f"{VIEWER} .stage", f"{VIEWER} .exposure"


def loads_without_errors(browser):
    for name in ("verdict", "cells", "convergence", "images", "mutations", "holes", "caught", "ledger", "provenance"):
        check(browser.run("return document.getElementById(arguments[0]) !== null", name), f"no section {name}")
    complaints = [entry["message"] for entry in browser.log("browser")]
    check(not complaints, f"the console says {complaints}")


def asks_for_nothing(browser):
    events = [json.loads(entry["message"])["message"] for entry in browser.log("performance")]
    asked = [e["params"]["request"]["url"] for e in events if e["method"] == "Network.requestWillBeSent"]
    others = [url for url in asked if not url.startswith("data:") and not url.endswith("/report.html")]
    check(asked, "the browser logged no request, not even the page itself")
    check(not others, f"requests: {others}")


def draws_every_chart(browser):
    blank = browser.run("""return [...document.querySelectorAll('.chart canvas')].filter((canvas) => {
        const empty = document.createElement('canvas');
        Object.assign(empty, { width: canvas.width, height: canvas.height });
        return canvas.width < 50 || canvas.toDataURL() === empty.toDataURL();
    }).length""")
    charts = browser.run("return document.querySelectorAll('.chart canvas').length")
    check(charts >= 3 and blank == 0, f"{blank} of {charts} charts are blank")


def flips_by_keys(browser):
    entries = browser.run("return document.querySelectorAll(`${arguments[0]} .tile-label`).length", VIEWER)
    seen = set()
    for key in range(1, min(9, entries) + 1):
        browser.press(str(key))
        title = browser.run("return document.querySelector(`${arguments[0]} .stage-title`).textContent", VIEWER)
        check(title.startswith(f"{key} "), f"after key {key} the stage shows '{title}'")
        seen.add(browser.pixels(STAGE))
    check(len(seen) == min(9, entries), f"{len(seen)} different pictures for {entries} keys")


def exposure_changes_all(browser):
    tile = f"{VIEWER} .tile-image"
    before = browser.pixels(STAGE), browser.pixels(tile)
    browser.focus(EXPOSURE)
    browser.press(*[RIGHT] * 6)
    after = browser.pixels(STAGE), browser.pixels(tile)
    check(before[0] != after[0], "the exposure slider leaves the stage as it was")
    check(before[1] != after[1], "the exposure slider leaves the tiles as they were")
    browser.press(*[LEFT] * 6)
    check(browser.pixels(STAGE) == before[0], "the exposure slider does not come back")


def toggles_false_colour(browser):
    browser.press("2")
    plain = browser.pixels(STAGE)
    browser.press("e")
    coloured = browser.pixels(STAGE)
    browser.press("e")
    check(plain != coloured, "key e leaves the picture as it was")
    check(plain == browser.pixels(STAGE), "key e does not toggle back")
    browser.click(f"{VIEWER} .error-toggle")
    check(browser.pixels(STAGE) == coloured, "the box shows another picture than the key")
    browser.press("e")


def shows_the_worst_run(browser):
    tiles = f"{VIEWER} .tile:nth-child(2) .tile-note"
    browser.press("w")
    check(
        "worst run" in browser.run("return document.querySelector(arguments[0]).textContent", tiles),
        "key w shows no worst run",
    )
    browser.press("w")
    check(
        "median run" in browser.run("return document.querySelector(arguments[0]).textContent", tiles),
        "key w does not toggle back",
    )


def zooms_and_pans_together(browser):
    tile = f"{VIEWER} .tile-image"
    states = [(browser.pixels(STAGE), browser.pixels(tile))]
    browser.press("+", "+")
    states.append((browser.pixels(STAGE), browser.pixels(tile)))
    browser.drag(tile, 40, 25)
    states.append((browser.pixels(STAGE), browser.pixels(tile)))
    browser.focus(STAGE)
    browser.press(UP)
    states.append((browser.pixels(STAGE), browser.pixels(tile)))
    for i, canvas in enumerate(("stage", "tile")):
        for action, before, after in zip(("keys +", "a drag", "the arrow keys"), states, states[1:]):
            check(before[i] != after[i], f"the {canvas} does not follow {action}")
    browser.press("0")
    check(browser.pixels(STAGE) == states[0][0], "key 0 does not reset the view")


def moves_crops(browser):
    crop = f"{VIEWER} .crop-0"
    stage, before = browser.pixels(STAGE), browser.pixels(crop)
    browser.focus(f"{VIEWER} .inset-0")
    browser.press(LEFT, LEFT, UP, UP, UP)
    check(browser.pixels(crop) != before, "the crop does not follow the arrow keys")
    check(browser.pixels(STAGE) == stage, "moving a crop moves the picture")
    moved = browser.pixels(crop)
    browser.drag(f"{VIEWER} .inset-0", -30, -20, grip=(5, 5))
    check(browser.pixels(crop) != moved, "the crop cannot be dragged")


def sorts_the_table(browser):
    columns = browser.run("return document.querySelectorAll('#cell-table thead th').length")
    index = browser.run(
        "return [...document.querySelectorAll('#cell-table thead th')].findIndex((th) => th.classList.contains('wide'))"
    )
    check(0 <= index < columns, "no column of the primary metric")
    values = (
        "return [...document.querySelectorAll('#cell-table tbody tr')].map((tr) => tr.children[arguments[0]].sortValue)"
    )
    button = f"#cell-table thead th:nth-child({index + 1}) button"
    browser.focus(button)
    browser.press(ENTER)
    check(browser.run(values, index) == sorted(browser.run(values, index)), "the first press does not sort upwards")
    browser.click(button)
    check(
        browser.run(values, index) == sorted(browser.run(values, index), reverse=True),
        "the second does not sort downwards",
    )
    order = browser.run(
        "return [...document.querySelectorAll('#cell-table th[aria-sort]')].map((th) => th.getAttribute('aria-sort'))"
    )
    check(order == ["descending"], f"aria-sort says {order}")


def draws_hole_maps(browser):
    grids = browser.run(
        "return JSON.parse(document.getElementById('data').textContent).summary.cells.map((c) => c.feature_grid)"
    )
    maps = browser.run(
        "return [...document.querySelectorAll('#holes .hole-card')].map((card) => "
        "card.querySelector('.hole-map').querySelectorAll('[data-hole]').length)"
    )
    check(maps == [rows * columns for rows, columns in grids], f"{maps} squares for grids of {grids}")
    browser.focus("#holes .hole-map")
    browser.press(RIGHT, DOWN)
    text = browser.run("return document.getElementById('tooltip').textContent")
    check("row 2, column 2" in text and "its true share" in text, f"the arrow keys read '{text}'")
    browser.run("document.activeElement.blur()")
    check(browser.run("return document.getElementById('tooltip').hidden"), "the tooltip stays")


def chooses_the_caught_sampler(browser):
    text = "return document.querySelector('#caught .sentence').textContent"
    before = browser.run(text)
    browser.focus("#caught select")
    browser.press(DOWN)
    check(browser.run(text) != before, "choosing another sampler changes nothing")


def warns_in_red(browser):
    colour = browser.run("return getComputedStyle(document.getElementById('warnings')).color")
    red, green, blue = map(int, re.findall(r"\d+", colour)[:3])
    check(red > 1.5 * max(green, blue), f"warnings are {colour}")


def fits_a_laptop(browser):
    for width in (1280, 1024):
        browser.call("POST", "/window/rect", {"width": width, "height": 800})
        browser.settle()
        wide = browser.run("return document.documentElement.scrollWidth - innerWidth")
        check(wide <= 0, f"{wide} pixels too wide for {width}")
    browser.call("POST", "/window/rect", {"width": 1280, "height": 900})


def follows_the_colour_scheme(browser):
    seen = []
    for scheme in ("light", "dark"):
        browser.media(scheme)
        seen.append(browser.run("return getComputedStyle(document.body).backgroundColor"))
        draws_every_chart(browser)
    check(seen[0] != seen[1], "light and dark have the same background")
    browser.media("light")


def names_every_control(browser):
    nameless = browser.run(
        """return [...document.querySelectorAll('button, select, input, [tabindex], [role=img]')].filter((node) =>
        !node.getAttribute('aria-label') && !node.textContent.trim() && !node.labels?.length).map((node) => node.outerHTML.slice(0, 80))"""
    )
    check(not nameless, f"without a name: {nameless}")


def survives_missing_data(browser, page):
    """Every field of a cell is optional: the page without it must still draw itself."""
    text = page.read_text(encoding="utf-8")
    found = re.search(r'(<script type="application/json" id="data">)(.*?)(</script>)', text, re.DOTALL)
    names = sorted({name for cell in json.loads(found[2])["summary"]["cells"] for name in cell} - {"cell"})

    def without(*removed):
        data = json.loads(found[2])
        for cell in data["summary"]["cells"]:
            for name in removed:
                cell.pop(name, None)
        return data

    variants = {name: without(name) for name in names}
    variants["everything"] = without(*names)
    variants["comparisons"] = without()
    variants["comparisons"]["summary"].update(comparisons=[], verdicts=[], warnings=[])
    variants["cells"] = {"summary": {}, "results": {}, "pictures": {}, "images": [], "shrink": 1}
    variants["pictures"] = {**without(), "pictures": {}}
    variants["numbers"] = json.loads(re.sub(r"(?<=[:\[,])-?\d+\.\d+(e-?\d+)?", "null", found[2]))
    with tempfile.TemporaryDirectory() as folder:
        for name, data in variants.items():
            path = pathlib.Path(folder) / "report.html"
            path.write_text(
                text[: found.start(2)] + json.dumps(data).replace("<", "\\u003c") + text[found.end(2) :],
                encoding="utf-8",
            )
            browser.open(path)
            complaints = [entry["message"] for entry in browser.log("browser")]
            check(not complaints, f"without {name} the console says {complaints}")
            check(
                browser.run("return document.querySelectorAll('section').length") >= 3,
                f"without {name} the page is empty",
            )


def make_report(folder):
    """The report of the made-up run of report_test.cpp."""
    program = pathlib.Path(os.environ.get("ULAM", "build/release/ulam")).parent / "tests" / "test_experiments_report"
    if not program.exists():
        sys.exit(f"report_browser_test: no {program}; build the tests, or name a report.html")
    command = [program, "a report holds its run and asks for nothing"]
    subprocess.run(command, env={**os.environ, "ULAM_REPORT_DIR": folder}, check=True, stdout=subprocess.DEVNULL)
    return pathlib.Path(folder) / "report.html"


def test_page(page):
    tests = [
        loads_without_errors,
        asks_for_nothing,
        draws_every_chart,
        flips_by_keys,
        exposure_changes_all,
        toggles_false_colour,
        shows_the_worst_run,
        zooms_and_pans_together,
        moves_crops,
        sorts_the_table,
        draws_hole_maps,
        chooses_the_caught_sampler,
        warns_in_red,
        fits_a_laptop,
        follows_the_colour_scheme,
        names_every_control,
    ]
    passed = failed = 0
    browser = Browser()
    try:
        browser.open(page)
        browser.media("light")
        for test in [*tests, functools.partial(survives_missing_data, page=page)]:
            try:
                test(browser)
                passed += 1
            except (AssertionError, RuntimeError) as error:
                failed += 1
                print(f"FAILED {getattr(test, 'func', test).__name__}: {error}")
        complaints = [entry["message"] for entry in browser.log("browser")]
        if complaints:
            failed += 1
            print(f"FAILED: while it was used the console said {complaints}")
    finally:
        browser.close()
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


def main():
    if len(sys.argv) > 2:
        sys.exit(__doc__)
    if len(sys.argv) == 2:
        return test_page(pathlib.Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as folder:
        return test_page(make_report(folder))


if __name__ == "__main__":
    sys.exit(main())
