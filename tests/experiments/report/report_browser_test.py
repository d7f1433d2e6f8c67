#!/usr/bin/env python3
"""Drives a report in a real browser, by chromium and chromedriver alone: report_browser_test.py [REPORT_HTML].

Without an argument the report is that of the made-up run of report_test.cpp, whose program lies beside $ULAM.
"""

import copy
import functools
import itertools
import json
import math
import pathlib
import re
import sys
import tempfile
import xml.etree.ElementTree as xml

from browser import DOWN, ENTER, LEFT, RIGHT, UP, check, check_plot, complaints, data_of, report, run_tests, with_data

VIEWER = "#viewer-scene-0"
STAGE, EXPOSURE = f"{VIEWER} .stage", f"{VIEWER} .exposure"


def loads_without_errors(browser):
    for name in (
        "verdict",
        "cells",
        "convergence",
        "spectrum",
        "images",
        "mutations",
        "holes",
        "caught",
        "ledger",
        "provenance",
    ):
        check(browser.run("return document.getElementById(arguments[0]) !== null", name), f"no section {name}")
    said = complaints(browser)
    check(not said, f"the console says {said}")


def asks_for_nothing(browser):
    events = [json.loads(entry["message"])["message"] for entry in browser.log("performance")]
    asked = [e["params"]["request"]["url"] for e in events if e["method"] == "Network.requestWillBeSent"]
    others = [url for url in asked if not url.startswith("data:") and not url.endswith("/report.html")]
    check(asked, "the browser logged no request, not even the page itself")
    check(not others, f"requests: {others}")


def draws_every_chart(browser):
    """Every axis has at least two labels that do not overlap, within the figure, and every line its points."""
    charts = browser.run(
        """return [...document.querySelectorAll('#convergence .chart > svg, #spectrum .chart > svg')].map((root) => {
        const boxes = (selector) => [...root.querySelectorAll(selector)].map((node) => node.getBoundingClientRect());
        const outer = root.getBoundingClientRect(), x = boxes('.x-tick'), y = boxes('.y-tick');
        const overlaps = x.slice(1).filter((box, i) => box.left < x[i].right).length;
        const outside = boxes('text').filter((box) => box.left < outer.left - 1 || box.right > outer.right + 1 || box.bottom > outer.bottom + 1);
        return { x: x.length, y: y.length, overlaps, outside: outside.length, lines: root.querySelectorAll('.series path[stroke]').length };
    })"""
    )
    check(len(charts) >= 5, f"{len(charts)} charts")
    for chart in charts:
        check(chart["x"] >= 2 and chart["y"] >= 2 and chart["lines"] >= 1, f"axes without labels or no lines: {chart}")
        check(chart["overlaps"] == 0 and chart["outside"] == 0, f"labels overlap or are cut: {chart}")


def plots_the_errors_of_the_summary(browser, page):
    """Against each cost, with intervals; a sampler without mutations has no line against those."""
    summary = json.loads((page.parent / "summary.json").read_text(encoding="utf-8"))
    drawn = 0
    for scene in ("hidden", "emitter"):
        legend = browser.run(
            """return [...document.querySelectorAll('#convergence .group')].find((group) =>
                group.querySelector('h3').textContent === arguments[0]).querySelector('.legend')""",
            scene,
        )
        for cost in ("seconds", "rays", "mutations"):
            expected = {
                cell["sampler"]: [(p[cost], p["error"], *p["ci95"]) for p in cell["convergence"]]
                for cell in summary["cells"]
                if cell["scene"] == scene and cell["convergence"][0][cost] > 0
            }
            check_plot(browser, legend, f"relMSE against {cost}, {scene}", expected)
            drawn += len(expected)
    check(drawn == 2 * (3 + 3 + 2), f"{drawn} lines")


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


def shows_maps_over_runs(browser):
    """Spread over runs and p-values: maps instead of the pictures, of cells only, and said in words for a pixel."""
    reference = f"{VIEWER} .tile-image"
    browser.press("2")
    before, plain = browser.pixels(reference), browser.pixels(STAGE)
    seen = {plain}
    for key, words in (("d", "relative standard deviation"), ("p", "too dark · too bright")):
        browser.press(key)
        seen.add(browser.pixels(STAGE))
        legend = browser.run("return document.querySelector(`${arguments[0]} .error-legend`).textContent", VIEWER)
        check(words in legend, f"after key {key} the legend says '{legend}'")
    check(len(seen) == 3, "keys d and p show the same")
    check(browser.pixels(reference) == before, "the reference has a map of its own")
    notes = browser.run(
        "return [...document.querySelectorAll(`${arguments[0]} .tile-note`)].map((n) => n.textContent)", VIEWER
    )
    check(any(re.match(r"\d+ of \d+ (pixels|blocks of \d+ × \d+) differ", note) for note in notes), f"notes: {notes}")
    browser.drag(STAGE, 5, 5, grip=(30, 300))
    readout = browser.run("return document.querySelector(`${arguments[0]} .readout`).textContent", VIEWER)
    check("spread over runs" in readout, f"the readout says '{readout}'")
    browser.press("p")
    check(browser.pixels(STAGE) == plain, "key p does not toggle back")


def shows_maps_of_chains(browser):
    """R-hat and acceptance, of samplers with chains only."""
    notes = "return [...document.querySelectorAll(`${arguments[0]} .tile-note`)].map((n) => n.textContent)"
    browser.press("3")
    plain = browser.pixels(STAGE)
    seen = {plain}
    for key, words in (("m", "R̂ of the pixels of a block"), ("a", "proposals accepted")):
        browser.press(key)
        seen.add(browser.pixels(STAGE))
        legend = browser.run("return document.querySelector(`${arguments[0]} .error-legend`).textContent", VIEWER)
        check(words in legend, f"after key {key} the legend says '{legend}'")
    check(len(seen) == 3, "keys m and a show the same")
    browser.press("m")
    apart = [note for note in browser.run(notes, VIEWER) if re.match(r"R̂ above 1\.2 in [\d.]+\s?% of it", note)]
    check(len(apart) == 2, f"two samplers have chains, but {apart}")
    browser.drag(STAGE, 5, 5, grip=(30, 300))
    readout = browser.run("return document.querySelector(`${arguments[0]} .readout`).textContent", VIEWER)
    check("R̂" in readout and "acceptance" in readout, f"the readout says '{readout}'")
    browser.press("2")
    coloured = browser.pixels(STAGE)
    browser.press("m")
    check(browser.pixels(STAGE) == coloured, "a sampler without chains has a map of them")


def splits_the_stage(browser):
    """Left of the divider the chosen picture, right of it the shown one; moved by arrow keys and by dragging."""
    halves = """const canvas = document.querySelector(arguments[0]), width = Math.floor(0.4 * canvas.width);
        return [0, canvas.width - width].map((x) => {
            const part = Object.assign(document.createElement('canvas'), { width, height: canvas.height });
            part.getContext('2d').drawImage(canvas, -x, 0);
            return part.toDataURL();
        })"""
    browser.press("1")
    reference = browser.run(halves, STAGE)
    browser.press("2")
    shown = browser.run(halves, STAGE)
    browser.press("s")
    check(browser.run(halves, STAGE) == [reference[0], shown[1]], "the halves are not those of the two pictures")
    divider = f"{VIEWER} .split-divider"
    browser.focus(divider)
    browser.press(*[RIGHT] * 15)
    check(
        browser.run("return document.querySelector(arguments[0]).ariaValueNow", divider) == "80",
        "the arrow keys do not move it",
    )
    check(browser.run(halves, STAGE)[1] != shown[1], "the picture does not follow the divider")
    browser.drag(divider, -200, 0)
    now = float(browser.run("return document.querySelector(arguments[0]).ariaValueNow", divider))
    check(now < 60, f"after dragging it stands at {now} %")
    browser.focus(f"{VIEWER} .split-left")
    browser.press(DOWN, DOWN)
    check(browser.run(halves, STAGE)[0] != reference[0], "choosing the left picture changes nothing")
    browser.press(UP, UP)
    browser.run("document.activeElement.blur()")
    browser.press("s")
    check(browser.run(halves, STAGE) == shown, "key s does not toggle back")


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
    """Towards the middle, whichever corner the crop begins in."""
    crop, frame = f"{VIEWER} .crop-0", f"{VIEWER} .inset-0"
    left, top = browser.run(
        """const frame = document.querySelector(arguments[0]), box = frame.parentElement;
        return [frame.offsetLeft < box.clientWidth / 3, frame.offsetTop < box.clientHeight / 3]""",
        frame,
    )
    stage, before = browser.pixels(STAGE), browser.pixels(crop)
    browser.focus(frame)
    browser.press(*[RIGHT if left else LEFT] * 2, *[DOWN if top else UP] * 3)
    check(browser.pixels(crop) != before, "the crop does not follow the arrow keys")
    check(browser.pixels(STAGE) == stage, "moving a crop moves the picture")
    moved = browser.pixels(crop)
    browser.drag(frame, 30 if left else -30, 20 if top else -20, grip=(5, 5))
    check(browser.pixels(crop) != moved, "the crop cannot be dragged")


def saves_every_figure(browser):
    """Each is well-formed SVG of its own, 90 or 180 mm wide or as it needs, with text."""
    files = browser.call(
        "POST",
        "/execute/async",
        {
            "script": """const done = arguments[0], real = URL.createObjectURL, blobs = [];
                URL.createObjectURL = (blob) => { blobs.push(blob.text()); return '#' };
                const buttons = [...document.querySelectorAll('.save')].filter((b) => b.textContent === 'SVG');
                buttons.forEach((b) => b.click());
                URL.createObjectURL = real;
                Promise.all(blobs).then((texts) => done(texts.map((text, i) => [buttons[i].ariaLabel, text])))""",
            "args": [],
        },
    )
    kinds = (
        "ratios of all",
        "relMSE against rays",
        "pictures, ",
        "what became of",
        "occupancy, ",
        "run ",
        "techniques, ",
        "ranks of ",
    )
    for kind in kinds:
        check(
            any(name.startswith(kind) for name, _ in files), f"no figure '{kind}' among {[name for name, _ in files]}"
        )
    for name, text in files:
        root = xml.fromstring(text)
        width = float(root.get("width").removesuffix("mm"))
        check(30 < width <= 181, f"{name}: {width} mm wide")
        check(root.findall(".//{http://www.w3.org/2000/svg}text"), f"{name}: no text")


def tells_how_it_was_tuned(browser):
    """The best candidates first, with what they had in each round."""
    rows = browser.run(
        """return [...document.querySelectorAll('#tuning-table tbody tr')].map((tr) =>
            [tr.classList.contains('winner'), [...tr.children].map((cell) => cell.textContent)])"""
    )
    check([winner for winner, _ in rows] == [True, False, False, False], f"the winner is not first: {rows}")
    check([cells[1] for _, cells in rows] == ['"max"'] * 4, f"parameters: {rows}")
    check([cells[3] == "–" for _, cells in rows] == [False, False, True, True], f"rounds: {rows}")
    head = browser.run("return document.querySelector('#tuning-table thead').textContent")
    check("chains" in head and "1 s" in head and "2 s" in head, f"the head says '{head}'")


def sorts_every_table(browser):
    """By each column with values, the first by the keyboard and by a click: upwards, then downwards; what is missing stays
    last."""
    names = browser.run("return [...document.querySelectorAll('main table')].map((table) => table.getAttribute('aria-label'))")
    check(len(names) == len(set(names)) and None not in names, f"the tables are {names}")
    kinds = {name.split(" on ")[0] for name in names}
    check({"cells", "tuning", "mutations", "provenance", "mixing of pssmlt"} <= kinds, f"the tables are {names}")
    head = """const table = [...document.querySelectorAll('main table')].find((t) => t.getAttribute('aria-label') === arguments[0]);
        const headers = [...table.tHead.rows[0].cells];"""
    for name in names:
        titles = browser.run(head + "return headers.map((th) => [th.textContent, th.querySelector('button') !== null])", name)
        check(all(sortable or not title for title, sortable in titles), f"{name} has columns {titles}")
        sortable = [i for i, (_, sortable) in enumerate(titles) if sortable]
        for index in sortable:
            button = f"table[aria-label='{name}'] thead th:nth-child({index + 1}) button"
            column = f"{name}, {titles[index][0]}"
            if index == sortable[0]:
                browser.focus(button)
                browser.press(ENTER)
                upwards = browser.run(ORDER, name, index)
                browser.click(button)
                downwards = browser.run(ORDER, name, index)
            else:
                upwards, downwards = browser.run(
                    f"""return [1, 2].map(() => {{
                        document.querySelector(arguments[2]).click();
                        {ORDER}
                    }})""",
                    name,
                    index,
                    button,
                )
            for order, (said, values) in (("ascending", upwards), ("descending", downwards)):
                check(said == [order if i == index else None for i in range(len(titles))], f"{column}: aria-sort {said}")
                known = [value for value in values if value is not None]
                check(None not in values[: len(known)], f"{column}: what is missing is not last in {values}")
                check(known == sorted(known, key=natural, reverse=order == "descending"), f"{column}: {order} is {values}")
            check(sorted(map(str, upwards[1])) == sorted(map(str, downwards[1])), f"{column}: sorting changes the rows")


# Of a table of this name: aria-sort of its headings, and a column's values.
ORDER = """const table = [...document.querySelectorAll('main table')].find((t) => t.getAttribute('aria-label') === arguments[0]);
    return [[...table.tHead.rows[0].cells].map((th) => th.getAttribute('aria-sort')),
            [...table.tBodies[0].rows].map((row) => row.cells[arguments[1]].sortValue ?? null)]"""


def natural(value):
    """Numbers by size, texts with numbers in them by those."""
    if not isinstance(value, str):
        return (0, value)
    return (1, [(0, int(part), "") if part.isdigit() else (1, 0, part.casefold()) for part in re.split(r"(\d+)", value) if part])


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


# Linear RGB as seen without the cones for red or for green: Machado, Oliveira & Fernandes 2009, severity 1.
COLOUR_VISION = {
    "normal": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "protanopia": (
        (0.152286, 1.052583, -0.204868),
        (0.114503, 0.786281, 0.099216),
        (-0.003882, -0.048116, 1.051998),
    ),
    "deuteranopia": (
        (0.367322, 0.860646, -0.227968),
        (0.280085, 0.672501, 0.047413),
        (-0.011820, 0.042940, 0.968881),
    ),
}
SMALLEST_DIFFERENCE = 0.1  # in OKLab, where black and white are 1 apart


def linear_rgb(colour):
    codes = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    return [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in codes]


def times(matrix, vector):
    return [sum(m * v for m, v in zip(row, vector, strict=True)) for row in matrix]


def oklab(rgb):
    to_cones = (
        (0.4122214708, 0.5363325363, 0.0514459929),
        (0.2119034982, 0.6806995451, 0.1073969566),
        (0.0883024619, 0.2817188376, 0.6299787005),
    )
    from_cones = (
        (0.2104542553, 0.793617785, -0.0040720468),
        (1.9779984951, -2.428592205, 0.4505937099),
        (0.0259040371, 0.7827717662, -0.808675766),
    )
    return times(from_cones, [cone ** (1 / 3) for cone in times(to_cones, [min(1, max(0, c)) for c in rgb])])


def tells_eight_samplers_apart(browser, page):
    """By colour, whatever cones the eye has, against the page; and by the shape of the mark."""
    script = page.read_text(encoding="utf-8").split("const kSamplerColours = ")[1].split(";")[0]
    for scheme, paper in (("light", "#fdfcf9"), ("dark", "#131517")):
        colours = re.findall(r"#[0-9a-f]{6}", re.search(scheme + r": \[([^]]*)\]", script)[1])
        check(len(colours) == 8, f"{len(colours)} colours on a {scheme} page")
        for vision, matrix in COLOUR_VISION.items():
            for a, b in itertools.combinations(colours, 2):
                apart = math.dist(*(oklab(times(matrix, linear_rgb(colour))) for colour in (a, b)))
                check(apart >= SMALLEST_DIFFERENCE, f"{a} and {b} are {apart:.3f} apart in {vision} vision")
        for colour in colours:
            low, high = sorted(sum(w * c for w, c in zip((0.2126, 0.7152, 0.0722), linear_rgb(x), strict=True)) for x in (colour, paper))
            check((high + 0.05) / (low + 0.05) >= 3, f"{colour} on {paper}")
    marks = browser.run(
        """const shape = (mark) => mark.tagName + (mark.getAttribute('d') ?? '').replace(/[\\d.\\s-]/g, '') + mark.getAttribute('fill');
        return ['#cell-table .mark > *', '.viewer .mark > *', '#convergence .point-mark > :nth-child(2)'].map((selector) =>
            [...new Set([...document.querySelectorAll(selector)].map(shape))].sort())"""
    )
    check(len(marks[0]) == 3, f"the marks of three samplers are {marks[0]}")
    check(marks[0] == marks[1] == marks[2], f"marks differ between table, tiles and plots: {marks}")


def names_the_test(browser, page):
    """The words for p and intervals are those of what was done."""
    text = "return document.querySelector(arguments[0]).textContent"
    meaning = "return [...document.querySelectorAll('#cell-table th button')].find((b) => b.textContent === 'p').title"
    check("permutation test of complete runs, after Holm" in browser.run(meaning), browser.run(meaning))
    check("95 % interval" in browser.run(text, "#verdict .note"), browser.run(text, "#verdict .note"))
    data = data_of(page)
    for comparison in data["summary"]["comparisons"]:
        comparison.update(paired=True, looks=3)
    with tempfile.TemporaryDirectory() as folder:
        browser.open(with_data(page, data, pathlib.Path(folder) / "report.html"))
    for said in (browser.run(meaning), browser.run(text, "#verdict .note")):
        check("sign-flip test of pairs with common random numbers" in said and "times 3 looks" in said, said)
    for said in (browser.run(text, f"#{name} {part}") for name, part in (("verdict", ".note"), ("cells", ".lead"))):
        check("98.3\u202f% interval (95 % over all 3 looks)" in said, said)


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
    whole = data_of(page)
    one_scene = [cell for cell in whole["summary"]["cells"] if cell["scene"] == "hidden"]
    whole["summary"]["cells"] = one_scene  # enough, and half the work
    names = sorted({name for cell in one_scene for name in cell} - {"cell"})

    def without(*removed):
        data = copy.deepcopy(whole)
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
    variants["numbers"] = json.loads(
        re.sub(r"(?<=[:\[,])-?\d+\.\d+(e-?\d+)?", "null", json.dumps(whole, separators=(",", ":")))
    )
    with tempfile.TemporaryDirectory() as folder:
        for name, data in variants.items():
            browser.open(with_data(page, data, pathlib.Path(folder) / "report.html"))
            said = complaints(browser)
            check(not said, f"without {name} the console says {said}")
            check(
                browser.run("return document.querySelectorAll('section').length") >= 3,
                f"without {name} the page is empty",
            )


def jpeg(browser, width, height, code):
    """Base64 of a JPEG; `code` is JavaScript for the code of channel c of any pixel."""
    return browser.run(
        f"""const canvas = Object.assign(document.createElement('canvas'), {{ width: {width}, height: {height} }});
        const pixels = new ImageData({width}, {height});
        pixels.data.forEach((_, i) => {{ const c = i % 4; pixels.data[i] = c === 3 ? 255 : {code}; }});
        canvas.getContext('2d').putImageData(pixels, 0, 0);
        return canvas.toDataURL('image/jpeg', 0.9).split(',')[1]"""
    )


def reads_jpegs(browser, page):
    """Codes become values: toe · sinh(step · code)."""
    data, text = data_of(page), jpeg(browser, 128, 128, "[100, 150, 200][c]")
    ids = data["pictures"]["hidden-bdpt"]
    data["images"].append({"width": 128, "height": 128, "toe": 0.01, "step": 0.03})
    ids["median"] = len(data["images"]) - 1
    data["exact"] = False
    element = f'<script type="text/plain" id="image-{ids["median"]}">{text}</script>'
    with tempfile.TemporaryDirectory() as folder:
        browser.open(with_data(page, data, pathlib.Path(folder) / "report.html", element))
    browser.press("2")
    browser.drag(STAGE, 5, 5)
    readout = browser.run("return document.querySelector(`${arguments[0]} .readout`).textContent", VIEWER)
    values = [float(value) for value in re.search(r"pixel \d+, \d+: ([\d., ]+)", readout)[1].rstrip(" ,").split(", ")]
    expected = [0.01 * math.sinh(0.03 * code) for code in (100, 150, 200)]
    check(all(abs(x / y - 1) < 0.04 for x, y in zip(values, expected, strict=True)), f"{readout}, not {expected}")
    lead = browser.run("return document.querySelector('#images .lead').textContent")
    check("JPEG" in lead, f"the images' lead says '{lead}'")
    said = complaints(browser)
    check(not said, f"the console says {said}")


def test_page(page):
    tests = [
        loads_without_errors,
        asks_for_nothing,
        draws_every_chart,
        flips_by_keys,
        exposure_changes_all,
        toggles_false_colour,
        shows_maps_over_runs,
        shows_maps_of_chains,
        splits_the_stage,
        shows_the_worst_run,
        zooms_and_pans_together,
        moves_crops,
        saves_every_figure,
        tells_how_it_was_tuned,
        sorts_every_table,
        draws_hole_maps,
        chooses_the_caught_sampler,
        warns_in_red,
        fits_a_laptop,
        follows_the_colour_scheme,
        names_every_control,
    ]
    others = (plots_the_errors_of_the_summary, tells_eight_samplers_apart, names_the_test, survives_missing_data, reads_jpegs)
    on_other_pages = [functools.partial(test, page=page) for test in others]
    return run_tests([*tests, *on_other_pages], lambda browser: browser.open(page))


if __name__ == "__main__":
    with report(sys.argv) as shown:
        sys.exit(test_page(shown))
