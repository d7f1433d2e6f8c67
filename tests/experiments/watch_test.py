#!/usr/bin/env python3
"""ulam watch: a page in a real browser follows a small experiment from before its folder is there to its end."""

import contextlib
import http.client
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "report"))
from browser import Browser  # noqa: E402

ULAM = os.path.abspath(os.environ.get("ULAM", "build/release/ulam"))
EXPERIMENT = {
    "name": "small_one",
    "scenes": {"box": {"type": "cornell_box"}},
    "film": {"width": 48, "height": 32},
    "max_depth": 4,
    "samplers": {"path": {"type": "path"}, "mlt": {"type": "mlt", "chains": 50, "bootstrap": 5000}},
    "baseline": "path",
    "budget": {"time": 0.3},
    "replicates": 1000,  # until the test has seen enough
    "snapshots": 1,
    "metrics": ["relmse"],
    "reference": {"sampler": "path", "budget": {"spp": 256}, "part": {"spp": 64}},
}
# In the page: what the report in its frame shows, and how.
REPORT = """const frame = document.querySelector("iframe:not(.coming)");
    if (!frame) return null;
    const page = frame.contentDocument, data = JSON.parse(page.getElementById("data").textContent);
    const { viewers, orders, scroll } = frame.contentWindow.reportView.get();
    return { summary: data.summary, verdicts: page.querySelectorAll("#verdict").length, scroll, orders, view: viewers[0] }"""


class WatchTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        (self.folder / "small.json").write_text(json.dumps(EXPERIMENT))

    def start(self, *arguments):
        environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))
        process = subprocess.Popen([ULAM, *map(str, arguments)], cwd=self.folder, env=environment, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def watch(self, *arguments):
        watcher = self.start("watch", "run", "--port", 0, *arguments)
        address = watcher.stdout.readline().strip()
        self.assertRegex(address, r"^http://127\.0\.0\.1:\d+/$")
        self.port = int(re.search(r":(\d+)/", address)[1])
        return watcher, address

    def ask(self, path, host="localhost"):
        with contextlib.closing(http.client.HTTPConnection("127.0.0.1", self.port, timeout=10)) as connection:
            connection.request("GET", path, headers={"Host": f"{host}:{self.port}"})
            answer = connection.getresponse()
            return answer.status, answer.read().decode()

    def state(self):
        return json.loads(self.ask("/state")[1])

    def until(self, condition, what):
        """The condition's value, as soon as it is one."""
        for _ in range(600):
            if value := condition():
                return value
            time.sleep(0.1)
        self.fail(f"{what} did not come; the state is {self.state()}")

    def files(self):
        return {str(path): path.stat().st_mtime_ns for path in (self.folder / "run").rglob("*")}

    def end(self, watcher):
        watcher.send_signal(signal.SIGINT)
        _, err = watcher.communicate(timeout=20)
        self.assertEqual(watcher.returncode, 130, err)

    def test_the_page_follows_a_run_to_its_end(self):
        watcher, address = self.watch()
        self.until(lambda: "waiting for a run in run" in self.state().get("message", ""), "the waiting")
        self.assertEqual(self.ask("/report")[0], 404)
        self.assertFalse((self.folder / "run").exists())
        browser = Browser()
        self.addCleanup(browser.close)
        browser.call("POST", "/url", {"url": address})
        text = lambda id: browser.run("return document.getElementById(arguments[0]).textContent", id)
        self.until(lambda: "waiting for a run in run" in text("message"), "the message in the page")

        run = self.start("run", "small.json", "-o", "run", "--threads", 1)
        part = self.until(lambda: (now := browser.run(REPORT)) and len(now["summary"]["cells"]) == 2 and now, "a report")
        self.assertIsNone(run.poll(), "the run ended before the page showed any of it")
        self.assertEqual(part["verdicts"], 1)
        self.assertRegex(text("counts"), r"^\d+ of 2000 replicates done, 1 in work")
        self.assertEqual(text("name"), "small one")
        # What the reader looks at stays.
        browser.run("""const report = document.querySelector("iframe").contentWindow;
            report.scrollTo(0, 300);
            const view = report.reportView.get(), [first, second] = view.viewers[0].insets;
            Object.assign(view.viewers[0], { zoom: 2, exposure: 1.5, shown: "mean mlt", insets: [{ ...first, u: 0.4 }, second] });
            report.reportView.set({ ...view, orders: [{ table: "cells", column: "sampler", direction: "descending" }] })""")
        later = self.until(lambda: (now := browser.run(REPORT)) and now["summary"] != part["summary"] and now, "the next report")
        self.assertEqual((later["scroll"], later["view"]["zoom"], later["view"]["exposure"], later["view"]["shown"]),
                         (300, 2, 1.5, "mean mlt"))
        self.assertEqual(later["view"]["insets"][0]["u"], 0.4)
        self.assertEqual(later["orders"], [{"table": "cells", "column": "sampler", "direction": "descending"}])

        self.until(lambda: self.state()["totals"]["done"] >= 4, "the second replicate")
        run.send_signal(signal.SIGINT)
        run.communicate(timeout=60)
        run = self.start("run", "small.json", "-o", "run", "--resume", "--set", "replicates=2")
        _, err = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 0, err)
        summary = json.loads((self.folder / "run/summary.json").read_text())
        self.until(lambda: (now := browser.run(REPORT)) and now["summary"] == summary, "the report of all")
        self.assertEqual(text("message"), "finished")
        self.assertEqual(text("counts"), "4 of 4 replicates done")
        self.assertEqual([entry["message"] for entry in browser.log("browser")], [])
        self.end(watcher)
        self.until(lambda: text("message") == "ulam watch has ended", "the end")

        # A run that is over, which nobody changes.
        before = self.files()
        watcher, _ = self.watch()
        self.until(lambda: self.state()["version"] == 1, "the report")
        self.assertEqual(self.ask("/report"), (200, (self.folder / "run/report.html").read_text()))
        self.assertEqual(self.files(), before)
        self.assertEqual(self.state()["message"], "finished")
        # Pages of others, whose names were made to point here, learn nothing.
        for path in ("/", "/state", "/report"):
            self.assertEqual(self.ask(path, host="elsewhere.example")[0], 403)
        other = self.start("watch", "run", "--port", self.port)
        _, err = other.communicate(timeout=20)
        self.assertEqual(other.returncode, 2)
        self.assertIn(f"port {self.port} is taken", err)
        self.end(watcher)


if __name__ == "__main__":
    unittest.main()
