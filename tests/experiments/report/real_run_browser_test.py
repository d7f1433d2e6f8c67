#!/usr/bin/env python3
"""Reports of real runs in a real browser: of a scene that has a gap, and of eight samplers on eight scenes.

At the full level the films of the latter have 1280 × 720 pixels.
"""

import functools
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

from browser import ENTER, check, complaints, number_of, run_tests

ULAM = os.path.abspath(os.environ.get("ULAM", "build/release/ulam"))
FULL = os.environ.get("ULAM_TEST_LEVEL") == "full"
MIX = {"bidirectional": {"weight": 0.5}, "lens": {}, "caustic": {"fewest_specular": 0}, "multi_chain": {}}
DOOR = {
    "name": "gap",
    "scene": {"type": "door_ajar"},
    "film": {"width": 48, "height": 27},
    "samplers": {"bdpt": {"type": "bdpt"}, "mlt": {"type": "mlt", "chains": 100, "bootstrap": 20000, "mutations": MIX}},
    "baseline": "bdpt",
    "budget": {"spp": 16},
    "replicates": 4,
    "metrics": ["relmse"],
    "reference": {"sampler": "bdpt", "budget": {"spp": 64}, "part": {"spp": 16}},
}
NOISY = {
    "name": "large",
    "scene": {"type": "cornell_box", "variant": "glossy"},
    "film": {"width": 1280, "height": 720} if FULL else {"width": 320, "height": 180},
    "max_depth": 4,
    "samplers": {
        "path": {"type": "path"},
        "bdpt": {"type": "bdpt"},
        "pssmlt": {"type": "pssmlt", "bootstrap": 20000, "acceptance_images": True},
        "mlt": {"type": "mlt", "bootstrap": 20000, "acceptance_images": True, "mutations": MIX},
    },
    "baseline": "bdpt",
    "budget": {"spp": 1},
    "replicates": 2,
    "snapshots": 2,
    "metrics": ["relmse"],
    "reference": {"sampler": "path", "budget": {"spp": 4}, "part": {"spp": 1}},
}


def run(folder, experiment):
    """The folder of a run of the program."""
    file = folder / "experiment.json"
    file.write_text(json.dumps(experiment), encoding="utf-8")
    environment = {**os.environ, "XDG_CACHE_HOME": str(folder / "cache")}
    command = [ULAM, "run", file, "-o", folder / "run", "--quiet"]
    subprocess.run(command, env=environment, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return folder / "run"


def read(file):
    return json.loads(file.read_text(encoding="utf-8"))


def draws_gaps(browser, folder):
    """A place that is on no map: a row of a table for each sampler, with the numbers of the summary."""
    table = "table[aria-label='features of scene']"
    rows = f"return [...document.querySelectorAll(\"#holes {table} tbody tr\")].map((row) => [...row.cells].map((c) => c.textContent))"
    found = browser.run(rows)
    cells = {cell["sampler"]: cell["features"]["gap"] for cell in read(folder / "summary.json")["cells"]}
    check([row[:2] for row in found] == [[sampler, "gap"] for sampler in cells], f"the rows are {found}")
    for sampler, _, share, truth, p, spread, jumps in found:
        gap = cells[sampler]
        said = share.split("\u202f%")[0] + "\u202f%"
        for text, value in ((said, gap["share"]), (truth, gap["truth"]), (p, gap["p_adjusted"]), (spread, gap["relative_sd"])):
            check(abs(number_of(text) - value) <= 0.051 * value, f"{sampler}: {text} stands for {value}")
        jumped = gap.get("jumps_per_million")
        check(jumps == "–" if jumped is None else abs(number_of(jumps) - jumped) <= 0.01 * jumped, f"{sampler}: {jumps} jumps for {jumped}")
        check(0 < gap["share"] <= 1, f"{sampler}: a share of {gap['share']}")
    check(browser.run("return document.querySelectorAll('#holes .hole-map, #holes .colour-bar').length") == 0, "a door has a map of holes")
    lead = browser.run("return document.querySelector('#holes .lead').textContent")
    check("hatched" not in lead and "door" not in lead and "trapping" in lead, f"it is explained so: {lead}")
    browser.focus(f"{table} th:nth-child(3) button")
    browser.press(ENTER, ENTER)
    order = sorted(cells, key=lambda sampler: -cells[sampler]["share"])
    check([row[0] for row in browser.run(rows)] == order, f"downwards by share, the rows are {browser.run(rows)}, not {order}")


def large_run(source, folder):
    """Eight samplers on eight scenes: the cells and the reference of a run as often as it takes, by links."""
    summary, cells = read(source / "summary.json"), []
    for scene in range(8):
        for sampler in range(8):
            cell = summary["cells"][sampler % len(summary["cells"])]
            name, reference = f"scene{scene}-sampler{sampler}", pathlib.Path(cell["reference_image"])
            shutil.copytree(source / "cells" / cell["cell"], folder / "cells" / name, copy_function=os.link)
            copy = pathlib.Path("references", str(scene), reference.name)
            if sampler == 0:
                shutil.copytree(source / reference.parent, folder / copy.parent, copy_function=os.link)
            cells.append(
                {**cell, "cell": name, "scene": f"scene{scene}", "sampler": f"sampler{sampler}", "reference_image": str(copy)}
            )
    summary = {**summary, "cells": cells, "comparisons": [], "verdicts": [], "warnings": []}
    (folder / "summary.json").write_text(json.dumps(summary), encoding="utf-8")


def opens_a_large_run(browser):
    """At most 25 MB, which are used; two seconds of the processor until it can be used, and everything is made in the end."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        source = run(folder, NOISY)
        large_run(source, folder / "large")
        subprocess.run([ULAM, "report", folder / "large"], check=True, stdout=subprocess.DEVNULL)
        page = folder / "large" / "report.html"
        size = page.stat().st_size
        check(15e6 < size <= 25e6, f"the page has {size} bytes")
        time_domain = {"timeDomain": "threadTicks"}  # not the clock's: other programs run beside the test
        browser.call("POST", "/goog/cdp/execute", {"cmd": "Performance.enable", "params": time_domain})
        browser.call("POST", "/url", {"url": page.as_uri()})
        found = browser.call("POST", "/goog/cdp/execute", {"cmd": "Performance.getMetrics", "params": {}})["metrics"]
        seconds = next(metric["value"] for metric in found if metric["name"] == "TaskDuration")
        check(0.05 < seconds < 2, f"{seconds:.2f} s of the processor until it can be used")
        browser.settle()
        film = browser.run("const data = JSON.parse(document.getElementById('data').textContent); return [data.shrink, data.images[0].width]")
        print(f"{size / 1e6:.1f} MB, {seconds:.2f} s, pictures {film[1]} pixels wide, shrunk by {film[0]}")
    viewers = browser.run("return document.querySelectorAll('.viewer').length")
    check(viewers == 8, f"{viewers} viewers")
    said = complaints(browser)
    check(not said, f"the console says {said}")


def main():
    with tempfile.TemporaryDirectory() as folder:
        door = run(pathlib.Path(folder), DOOR)
        tests = [functools.partial(draws_gaps, folder=door), opens_a_large_run]
        return run_tests(tests, lambda browser: browser.open(door / "report.html"))


if __name__ == "__main__":
    sys.exit(main())
