#!/usr/bin/env python3
"""Figures of a sweep in a real browser, and what is saved of them: figures_browser_test.py [REPORT_HTML].

Of the report only the program is used; the sweep is made up here.
"""

import base64
import functools
import math
import pathlib
import re
import sys
import tempfile
import time
import xml.etree.ElementTree as xml
import zlib

from browser import DOWN, ELEMENT, RIGHT, UP, check, check_plot, complaints, number_of, report, run_tests, with_data

HOLES, CHAINS = "scenes.hidden.holes", "samplers.mlt.chains"
SVG = "{http://www.w3.org/2000/svg}"


def made_up_sweep():
    """bdpt on four scenes, mlt on each of them with three numbers of chains; the winner changes on the way."""
    cells, comparisons = [], []

    def cell(sampler, sweep, error):
        cells.append(
            {
                "cell": "-".join(["hidden", sampler, *(f"{path.split('.')[-1]}={v}" for path, v in sweep.items())]),
                "scene": "hidden",
                "sampler": sampler,
                "sweep": sweep,
                "metrics": {"relmse": {"mean": error, "ci95": [0.8 * error, 1.25 * error]}},
                "reference_image": f"references/{sweep[HOLES]}/image.exr",
            }
        )
        return cells[-1]["cell"]

    for holes in (2, 4, 8, 16):
        plain = 0.02 * holes**1.3
        baseline = cell("bdpt", {HOLES: holes}, plain)
        for chains in (100, 1000, 10000):
            error = 0.03 * holes**0.8 * (1 + abs(math.log10(chains / 1000)))
            ratio = error / plain
            undecided = 0.8 < ratio < 1.25
            comparisons.append(
                {
                    "scene": "hidden",
                    "sampler": "mlt",
                    "baseline": "bdpt",
                    "cell": cell("mlt", {HOLES: holes, CHAINS: chains}, error),
                    "baseline_cell": baseline,
                    "metric": "relmse",
                    "ratio": ratio,
                    "ci95": [0.8 * ratio, 1.25 * ratio],
                    "p_adjusted": 0.4 if undecided else 0.01,
                    "verdict": "undecided" if undecided else "better" if ratio < 1 else "worse",
                }
            )
    experiment = {"sweep": {HOLES: [2, 4, 8, 16], CHAINS: {"log": [100, 10000], "steps": 3}}}
    summary = {"name": "made up", "primary_metric": "relmse", "cells": cells, "comparisons": comparisons}
    empty = {"results": {}, "pictures": {}, "images": [], "shrink": 1}
    return {"summary": summary, "experiment": experiment, **empty}


WEIGHT = "samplers.mlt.mutations.lens.weight"


def made_up_cells(points):
    """mlt alone, at points of a sweep."""
    cells = [
        {
            "cell": f"hidden-mlt-{i}",
            "scene": "hidden",
            "sampler": "mlt",
            "sweep": point,
            "metrics": {"relmse": {"mean": 0.01 * (i + 1)}},
        }
        for i, point in enumerate(points)
    ]
    summary = {"name": "made up", "primary_metric": "relmse", "cells": cells}
    return {"summary": summary, "results": {}, "pictures": {}, "images": [], "shrink": 1}


def texts(browser, selector):
    return browser.run("return [...document.querySelectorAll(arguments[0])].map((node) => node.textContent)", selector)


def loads_without_errors(browser):
    said = complaints(browser)
    check(not said, f"the console says {said}")


def draws_error_against_difficulty(browser):
    """A plot for each number of chains, with both samplers' lines, bands and the four values on a log axis."""
    titles = texts(browser, "#sweep .difficulty svg > text[font-weight]")
    check(titles == [f"mlt.chains = {n}" for n in (100, 1000, 10000)], f"small multiples: {titles}")
    plot = browser.run("""const root = document.querySelector('#sweep .chart svg');
        const ticks = [...root.querySelectorAll('.x-tick')];
        return { lines: root.querySelectorAll('.series').length, bands: root.querySelectorAll('.band').length,
                 ticks: ticks.map((t) => t.textContent), at: ticks.map((t) => Number(t.getAttribute('x'))) }""")
    check(plot["lines"] == 2 and plot["bands"] == 2, f"lines and bands: {plot}")
    check(plot["ticks"] == ["2", "4", "8", "16"], f"ticks {plot['ticks']}")
    steps = [b - a for a, b in zip(plot["at"], plot["at"][1:])]
    check(max(steps) - min(steps) < 0.5, f"values of equal ratios stand at {plot['at']}")


def reads_points_by_keys(browser):
    text = "return document.getElementById('tooltip').textContent"
    browser.focus("#sweep .chart svg")
    browser.press(RIGHT)
    check(browser.run(text).startswith("bdpt") and "holes = 4" in browser.run(text), browser.run(text))
    browser.press(DOWN)
    check(browser.run(text).startswith("mlt") and "holes = 4" in browser.run(text), browser.run(text))
    browser.run("document.activeElement.blur()")
    check(browser.run("return document.getElementById('tooltip').hidden"), "the tooltip stays")


def chooses_the_swept_value(browser):
    browser.focus("#sweep select")
    browser.press(DOWN)
    titles = texts(browser, "#sweep .difficulty svg > text[font-weight]")
    check("holes = 2" in titles, f"after another choice the plots are {titles}")
    dashed = browser.run(
        "return document.querySelectorAll('#sweep .difficulty .chart:first-child .series path[stroke-dasharray]').length"
    )
    check(dashed == 1, f"{dashed} dashed lines; bdpt has no chains and is the same everywhere")
    browser.press(UP)


def plots_the_errors_of_the_sweep(browser):
    """Of each number of chains both samplers' errors with their intervals."""
    cells = made_up_sweep()["summary"]["cells"]
    legend = browser.run("return document.querySelector('#sweep .legend')")
    for chains in (100, 1000, 10000):
        expected = {"bdpt": [], "mlt": []}
        for cell in cells:
            if cell["sweep"].get(CHAINS, chains) == chains:
                error = cell["metrics"]["relmse"]
                expected[cell["sampler"]].append((cell["sweep"][HOLES], error["mean"], *error["ci95"]))
        check_plot(browser, legend, f"relMSE against holes, hidden, mlt.chains = {chains}", expected)


def maps_hold_the_values_of_the_sweep(browser):
    """Each square stands at the values of its cell, has its figure in it, and its colour where that is on the scale."""
    maps = browser.run(
        """return [...document.querySelectorAll('#sweep .maps svg[aria-label]')].map((root) => {
            const number = (node, name) => Number(node.getAttribute(name));
            const ticks = (axis) => [...root.querySelectorAll(`.${axis}-tick`)].map((t) => [number(t, axis), t.textContent]);
            const bar = [...root.querySelectorAll('g > rect[height="9"]')], labels = [...bar[0].parentElement.querySelectorAll('text')];
            return { name: root.ariaLabel, x: ticks('x'), y: ticks('y'), bar: bar.map((r) => r.getAttribute('fill')),
                     labels: labels.slice(0, 3).map((t) => t.textContent),
                     squares: [...root.querySelectorAll('[data-cell]')].map((g) => {
                         const box = g.querySelector('rect'), middle = (at, size) => number(box, at) + number(box, size) / 2;
                         return [g.dataset.cell, middle('x', 'width'), middle('y', 'height'), box.getAttribute('fill'),
                                 g.querySelector('text').textContent];
                     }) };
        })"""
    )
    summary = made_up_sweep()["summary"]
    cells = {cell["cell"]: cell for cell in summary["cells"]}
    values = {
        "relMSE": {name: cell["metrics"]["relmse"]["mean"] for name, cell in cells.items()},
        "ratio to bdpt": {comparison["cell"]: comparison["ratio"] for comparison in summary["comparisons"]},
    }
    check([m["name"].split(" over ")[0] for m in maps] == list(values), f"the maps are {[m['name'] for m in maps]}")
    for found, expected in zip(maps, values.values(), strict=True):
        high = number_of(found["labels"][2])
        low = 1 / high if found["labels"][0].startswith("1∕") else number_of(found["labels"][0])
        bar = [[int(c) for c in re.findall(r"\d+", colour)] for colour in found["bar"]]
        check(len(found["squares"]) == 12 and len(bar) == 64, f"{len(found['squares'])} squares, {len(bar)} colours")
        for name, x, y, colour, figure in found["squares"]:
            value = expected[name]
            check(abs(number_of(figure) / value - 1) < 0.051, f"{name}: {figure} stands for {value}")
            for ticks, at, path in ((found["x"], x, CHAINS), (found["y"], y, HOLES)):
                nearest = min(ticks, key=lambda tick: abs(tick[0] - at))[1]
                check(number_of(nearest) == cells[name]["sweep"][path], f"{name} stands at {nearest}")
            rgb = [int(c) for c in re.findall(r"\d+", colour)]
            place = min(range(64), key=lambda i: math.dist(bar[i], rgb)) / 63
            shown = low * (high / low) ** place
            check(abs(shown / min(high, max(low, value)) - 1) < 0.08, f"{name}: the colour is that of {shown}, not {value}")


def draws_maps(browser):
    """Errors and ratios over both values: 12 squares each, and rings exactly where a verdict is undecided."""
    maps = browser.run(
        """return [...document.querySelectorAll('#sweep figure')].filter((f) => f.querySelector('[data-cell]'))
        .map((f) => ({ cells: [...f.querySelectorAll('[data-cell]')].map((g) => g.dataset.cell),
                       rings: [...f.querySelectorAll('[data-cell]:has(.undecided)')].map((g) => g.dataset.cell),
                       fills: [...f.querySelectorAll('[data-cell] rect')].map((r) => r.getAttribute('fill')) }))"""
    )
    check([len(m["cells"]) for m in maps] == [12, 12], f"{[len(m['cells']) for m in maps]} squares")
    check(len(set(maps[0]["fills"])) >= 8, "the map of errors has too few colours")
    expected = {c["cell"] for c in made_up_sweep()["summary"]["comparisons"] if c["verdict"] == "undecided"}
    check(not maps[0]["rings"] and set(maps[1]["rings"]) == expected, f"rings at {maps[1]['rings']}, not {expected}")
    browser.run("document.querySelector('#sweep svg:has(.undecided)').focus()")
    browser.press(RIGHT, DOWN)
    text = browser.run("return document.getElementById('tooltip').textContent")
    check("holes = 8, mlt.chains = 1000" in text and "better" in text, f"the arrow keys read '{text}'")
    browser.run("document.activeElement.blur()")


def click(browser, figure, kind):
    element = browser.run(
        "return [...document.querySelectorAll('.save')].find((b) => b.getAttribute('aria-label') === `${arguments[0]}: save as ${arguments[1]}`)",
        figure,
        kind,
    )
    check(element, f"no button to save '{figure}' as {kind}")
    browser.call("POST", f"/element/{element[ELEMENT]}/click", {})


PLOT = "relMSE against holes, hidden, mlt.chains = 100"
MAP = "ratio to bdpt over mlt.chains and holes, hidden, mlt"


def saves_svg(browser):
    """In both colour schemes the same light file, with text as text and nothing but attributes."""
    saved = []
    with tempfile.TemporaryDirectory() as folder:
        behaviour = {"behavior": "allow", "downloadPath": folder}
        browser.call("POST", "/goog/cdp/execute", {"cmd": "Browser.setDownloadBehavior", "params": behaviour})
        for scheme in ("dark", "light"):
            browser.media(scheme)
            for figure in (PLOT, MAP):
                click(browser, figure, "SVG")
                name = f"made-up-{figure}".lower().replace(", ", "-").replace(" ", "-")
                file = pathlib.Path(folder) / f"{name}.svg"
                for _ in range(100):
                    if file.exists():
                        break
                    time.sleep(0.05)
                check(file.exists(), f"no {file.name}, but {[p.name for p in pathlib.Path(folder).iterdir()]}")
                saved.append(file.read_text(encoding="utf-8"))
                file.unlink()
    check(saved[:2] == saved[2:], "what is saved depends on the page's colours")
    for text in saved[:2]:
        root = xml.fromstring(text)
        check(root.tag == f"{SVG}svg" and root.get("width") == "90.00mm", f"{root.tag} {root.get('width')} wide")
        check(len(root.findall(f".//{SVG}text")) > 8, "text is not text")
        check(
            "class=" not in re.sub(r'class="(series|band|[xy]-tick|undecided)"', "", text) and "var(" not in text,
            "it needs a style sheet",
        )
    words = [node.text for node in xml.fromstring(saved[0]).iter(f"{SVG}text")]
    check({"bdpt", "mlt", "holes", "relMSE"} <= set(words), f"the file's words are {words}")


def prints_pdf(browser):
    """One page of the figure's size, with fonts; then the page is as it was."""
    browser.run("window.print = () => {}")
    click(browser, PLOT, "PDF")
    printed = browser.call(
        "POST",
        "/goog/cdp/execute",
        {"cmd": "Page.printToPDF", "params": {"preferCSSPageSize": True, "printBackground": True}},
    )
    pdf = base64.b64decode(printed["data"])
    pages = len(re.findall(rb"/Type\s*/Page\b", pdf))
    box = [float(v) for v in re.search(rb"/MediaBox\s*\[([^\]]*)\]", pdf)[1].split()]
    check(pages == 1, f"{pages} pages")
    check(abs(box[2] - 90 / 25.4 * 72) < 1.5, f"{box[2]} points wide")
    check(b"/Font" in pdf, "no fonts: text is not text")
    drawn = b"".join(
        zlib.decompress(stream)
        for stream in re.findall(rb"FlateDecode[^>]*>>\s*stream\r?\n(.*?)\r?\nendstream", pdf, re.DOTALL)
    )
    check(drawn.count(b"BT") >= 8, f"{drawn.count(b'BT')} texts on the page")
    browser.run("window.dispatchEvent(new Event('afterprint'))")
    check(browser.run("return document.getElementById('paper') === null"), "the printed figure stays")
    check(browser.run("return !document.documentElement.className"), "the page stays as for printing")


def chooses_the_pair_of_a_map(browser, page):
    """Of three values two at a time, with a map for each value of the third; values of a zip make no map."""
    grid = [{HOLES: h, CHAINS: c, WEIGHT: w} for h in (2, 4) for c in (10, 100) for w in (0.5, 1)]
    zipped = [{HOLES: h, CHAINS: c} for h, c in ((2, 10), (4, 100), (8, 50))]
    titles = "return [...document.querySelectorAll('#sweep .maps svg > text[font-weight]')].map((t) => t.textContent)"
    with tempfile.TemporaryDirectory() as folder:
        browser.open(with_data(page, made_up_cells(grid), pathlib.Path(folder) / "grid.html"))
        pairs = browser.run("return [...document.querySelectorAll('#sweep label:last-of-type option')].length")
        check(pairs == 3, f"{pairs} pairs of three values")
        before = browser.run(titles)
        lens = "mlt.mutations.lens.weight"
        check(before == [f"mlt, {lens} = {w}" for w in ("0.5", "1")], f"the maps are {before}")
        browser.focus("#sweep label:last-of-type select")
        browser.press(DOWN)
        check(browser.run(titles) == [f"mlt, mlt.chains = {c}" for c in (10, 100)], f"then {browser.run(titles)}")
        browser.open(with_data(page, made_up_cells(zipped), pathlib.Path(folder) / "zip.html"))
        check(browser.run(titles) == [], "values that vary together have a map")
        lines = browser.run("return document.querySelectorAll('#sweep .difficulty .series').length")
        check(lines == 1, f"{lines} lines for a zip of one sampler")
    said = complaints(browser)
    check(not said, f"the console says {said}")


def shows_cells_without_a_place(browser, page):
    """Errors that a logarithmic scale has no place for: named in words, and squares of their own in maps."""
    data = made_up_sweep()
    bad = {"hidden-mlt-holes=4-chains=1000": -1e-4, "hidden-mlt-holes=8-chains=100": None}
    for cell in data["summary"]["cells"]:
        if cell["cell"] in bad:
            cell["metrics"]["relmse"] = {"mean": bad[cell["cell"]], "ci95": None}
    for comparison in data["summary"]["comparisons"]:
        if comparison["cell"] in bad:
            comparison.update(ratio=None, ci95=None, verdict="undecided")
    squares = """return [...document.querySelectorAll('#sweep .maps figure')].map((figure) =>
        [figure.querySelectorAll('[data-cell]').length,
         [...figure.querySelectorAll('[data-cell]:has(.no-place)')].map((g) => g.dataset.cell)])"""
    with tempfile.TemporaryDirectory() as folder:
        browser.open(with_data(page, data, pathlib.Path(folder) / "report.html"))
        for count, without in browser.run(squares):
            check(count == 12 and set(without) == set(bad), f"{count} squares, without a place {without}")
        legend = "; ".join(texts(browser, "#sweep .legend li"))
        for said in (
            "not drawn, error ≤ 0: reference too poor: hidden-mlt-holes=4-chains=1000",
            "not drawn, error not known: hidden-mlt-holes=8-chains=100",
        ):
            check(said in legend, f"the legend says '{legend}'")
        browser.run("document.querySelector('#sweep .maps svg').focus()")
        browser.press(RIGHT, DOWN, DOWN)
        read = browser.run("return document.getElementById('tooltip').textContent")
        check("holes = 4, mlt.chains = 1000" in read and "error ≤ 0: reference too poor" in read, f"keys read '{read}'")
        for cell in data["summary"]["cells"]:
            cell["metrics"]["relmse"]["mean"] = -1e-4
        browser.open(with_data(page, data, pathlib.Path(folder) / "report.html"))
        found = browser.run(squares)
        check(found and len(found[0][1]) == 12, f"with no error at all the maps are {found}")
    said = complaints(browser)
    check(not said, f"the console says {said}")


def main():
    tests = [
        loads_without_errors,
        draws_error_against_difficulty,
        reads_points_by_keys,
        plots_the_errors_of_the_sweep,
        maps_hold_the_values_of_the_sweep,
        chooses_the_swept_value,
        draws_maps,
        saves_svg,
        prints_pdf,
    ]
    with report(sys.argv) as page, tempfile.TemporaryDirectory() as folder:
        sweep = with_data(page, made_up_sweep(), pathlib.Path(folder) / "sweep.html")
        tests += [functools.partial(test, page=page) for test in (chooses_the_pair_of_a_map, shows_cells_without_a_place)]
        return run_tests(tests, lambda browser: browser.open(sweep))


if __name__ == "__main__":
    sys.exit(main())
