#!/usr/bin/env python3
"""The viewer in a real browser, on pictures of known values: viewer_browser_test.py [REPORT_HTML].

Of the report only the program is used. In all pictures red tells the column, green the row and blue is the same all over;
they differ by a factor.
"""

import base64
import contextlib
import functools
import math
import pathlib
import re
import struct
import sys
import tempfile

from browser import DOWN, ENTER, RIGHT, check, complaints, report, run_tests, with_data

WIDTH, HEIGHT, BLUE = 16, 12, 0.5
FIRST, SECOND = "#viewer-scene-0", "#viewer-scene-1"
STAGE = f"{FIRST} .stage"
REFERENCE, BRIGHT = 1, 3  # keys
FACTORS = {
    "reference": 1,
    "dim": {"median": 0.75, "worst": 0.5, "mean": 0.875},
    "bright": {"median": 1.5, "worst": 2, "mean": 1.25},
}


def rgb9e5(rgb):
    exponent = max(0, math.floor(math.log2(max(rgb))) + 1 + 15)
    return sum(round(value / 2 ** (exponent - 24)) << (9 * c) for c, value in enumerate(rgb)) | exponent << 27


def made_up_run():
    """Two samplers on two scenes with three runs each, and the elements of their pictures."""
    images, elements = [], []

    def add(data, **fields):
        images.append(fields)
        text = base64.b64encode(data).decode()
        elements.append(f'<script type="text/plain" id="image-{len(images) - 1}">{text}</script>')
        return len(images) - 1

    def picture(factor):
        pixels = [
            rgb9e5([factor * value for value in ((x + 1) / WIDTH, (y + 1) / HEIGHT, BLUE)])
            for y in range(HEIGHT)
            for x in range(WIDTH)
        ]
        return add(struct.pack(f"<{len(pixels)}I", *pixels), width=WIDTH, height=HEIGHT)

    def blocks(byte):
        return add(bytes([byte] * (WIDTH * HEIGHT // 4)), width=WIDTH // 2, height=HEIGHT // 2, block=2, span=[1, 1])

    cells, pictures = [], {}
    for scene in ("first", "second"):
        reference = picture(FACTORS["reference"])
        for sampler in ("dim", "bright"):
            name = f"{scene}-{sampler}"
            errors = [0.25, 0.5, 0.125]
            cells.append(
                {
                    "cell": name,
                    "scene": scene,
                    "sampler": sampler,
                    "replicates": 3,
                    "metrics": {"relmse": {"mean": 0.3, "ci95": [0.2, 0.4], "values": errors}},
                    "worst_replicate": 1,
                    "median_replicate": 0,
                    "reference_image": f"references/{scene}/image.exr",
                    "feature_grid": [1, 2],
                    "features": {
                        "hole_0_0": {"share": 0.4, "truth": 0.5, "per_replicate": [0.45, 0.2, 0.55]},
                        "hole_0_1": {"share": 0.6, "truth": 0.5, "per_replicate": [0.55, 0.8, 0.45]},
                    },
                }
            )
            pictures[name] = {
                "reference": reference,
                **{kind: picture(factor) for kind, factor in FACTORS[sampler].items()},
                "median_replicate": 0,
                "worst_replicate": 1,
                **{kind: blocks(byte) for kind, byte in (("deviation", 180), ("tests", 220), ("rhat", 100), ("acceptance", 90))},
            }
    summary = {"name": "made up", "primary_metric": "relmse", "cells": cells, "comparisons": []}
    data = {"summary": summary, "results": {}, "pictures": pictures, "images": images, "shrink": 1, "exact": True}
    return data, "".join(elements)


@contextlib.contextmanager
def other_page(browser, page, change):
    """The made-up run with its data changed; then the page as before."""
    data, elements = made_up_run()
    change(data)
    before = browser.run("return location.href")
    with tempfile.TemporaryDirectory() as folder:
        browser.open(with_data(page, data, pathlib.Path(folder) / "report.html", elements))
        yield
        said = complaints(browser)
        check(not said, f"the console says {said}")
    browser.call("POST", "/url", {"url": before})
    browser.settle()


def colours(browser, selector, places=((0.5, 0.5),)):
    """Linear RGB that the canvases of a selector display at places, in parts of their width and height."""
    found = browser.run(
        """return [...document.querySelectorAll(arguments[0])].map((canvas) => {
            const copy = Object.assign(document.createElement('canvas'), { width: canvas.width, height: canvas.height });
            const context = copy.getContext('2d', { willReadFrequently: true });
            context.drawImage(canvas, 0, 0);
            return arguments[1].map(([u, v]) =>
                [...context.getImageData(u * canvas.width, v * canvas.height, 1, 1).data].slice(0, 3));
        })""",
        selector,
        places,
    )

    def linear(byte):
        return byte / 255 / 12.92 if byte <= 10 else ((byte / 255 + 0.055) / 1.055) ** 2.4

    return [[[linear(byte) for byte in colour] for colour in canvas] for canvas in found]


def blue(browser, selector=STAGE):
    return colours(browser, selector)[0][0][2]


def pixel_of(colour):
    """Which pixel of any of the pictures has this colour."""
    red, green, blue = colour
    return round(WIDTH * BLUE * red / blue) - 1, round(HEIGHT * BLUE * green / blue) - 1


def view(browser, scene=0):
    return browser.run("return window.reportView.get().viewers[arguments[0]]", scene)


def text(browser, selector):
    return browser.run("return document.querySelector(arguments[0]).textContent", selector)


def point(browser, selector, u, v):
    """Moves the pointer to a place of an element, in parts of its width and height."""
    width, height = browser.run(
        """const node = document.querySelector(arguments[0]);
        node.scrollIntoView({ block: 'center', behavior: 'instant' });
        return [node.clientWidth, node.clientHeight]""",
        selector,
    )
    element = browser.call("POST", "/element", {"using": "css selector", "value": selector})
    x, y = round((u - 0.5) * width), round((v - 0.5) * height)
    move = {"type": "pointerMove", "origin": element, "x": x, "y": y}
    browser.call("POST", "/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": [move]}]})
    browser.settle()


def scroll(browser, selector, delta, u=0.5, v=0.5):
    width, height = browser.run("const n = document.querySelector(arguments[0]); return [n.clientWidth, n.clientHeight]", selector)
    origin = browser.call("POST", "/element", {"using": "css selector", "value": selector})
    x, y = round((u - 0.5) * width), round((v - 0.5) * height)
    wheel = {"type": "scroll", "origin": origin, "x": x, "y": y, "deltaX": 0, "deltaY": delta}
    browser.call("POST", "/actions", {"actions": [{"type": "wheel", "id": "wheel", "actions": [wheel]}]})
    browser.settle()


def starts_anew(test):
    """Ends a test with the first viewer as it was found."""

    @functools.wraps(test)
    def wrapped(browser):
        browser.focus(STAGE)
        browser.press("0", "1")
        test(browser)
        browser.focus(STAGE)
        browser.press("0", "1")

    return wrapped


@starts_anew
def exposes_in_stops(browser):
    """Two presses are a stop: twice the light, for the pictures of all tiles."""
    browser.press(*"[" * 6)
    low, tiles = blue(browser), colours(browser, f"{FIRST} .tile-image")
    exposure = view(browser)["exposure"]
    check(abs(low / (BLUE * 2**exposure) - 1) < 0.03, f"{low} is shown of {BLUE} at {exposure} stops")
    browser.press("]", "]")
    check(view(browser)["exposure"] == exposure + 1, f"two presses make {view(browser)['exposure'] - exposure} stops")
    check(abs(blue(browser) / low - 2) < 0.06, f"a stop more makes {blue(browser) / low} times the light")
    for before, after in zip(tiles, colours(browser, f"{FIRST} .tile-image"), strict=True):
        check(abs(after[0][2] / before[0][2] - 2) < 0.1, f"in a tile it makes {after[0][2] / before[0][2]}")
    browser.press("[", "[", "[", "[")
    check(abs(blue(browser) / low - 0.5) < 0.03, f"a stop less makes {blue(browser) / low} times the light")


@starts_anew
def shows_the_same_place_in_all(browser):
    """Whatever moves the view, the stage and all tiles show the same pixels."""
    places = [(u, v) for u in (0.22, 0.52, 0.81) for v in (0.22, 0.52, 0.81)]
    browser.press(*"[" * 4)

    def expect(action):
        state = view(browser)
        expected = [
            (
                math.floor(WIDTH * (state["u"] + (u - 0.5) / state["zoom"])),
                math.floor(HEIGHT * (state["v"] + (v - 0.5) / state["zoom"])),
            )
            for u, v in places
        ]
        shown = [[pixel_of(colour) for colour in canvas] for canvas in colours(browser, f"{STAGE}, {FIRST} .tile-image", places)]
        check(len(shown) == 6, f"{len(shown)} canvases")
        for pixels in shown:
            check(pixels == expected, f"after {action} a canvas shows {pixels}, not {expected}")
        return state

    whole = expect("the start")
    browser.press("+", "+")
    near = expect("keys +")
    check(near["zoom"] == 1.5**2, f"zoom {near['zoom']}")
    browser.drag(f"{FIRST} .tile-image", 20, 12)
    dragged = expect("a drag to the right and down")
    check(dragged["u"] < near["u"] and dragged["v"] < near["v"], f"the drag moved the view to {dragged}")
    browser.focus(STAGE)
    browser.press(RIGHT, DOWN)
    moved = expect("the arrow keys")
    check(moved["u"] > dragged["u"] and moved["v"] > dragged["v"], f"the arrow keys moved the view to {moved}")
    browser.press("-")
    check(expect("key -")["zoom"] == 1.5, "key - does not undo a key +")
    browser.click(f"{FIRST} .controls button")
    reset = view(browser)
    check([reset[name] for name in ("zoom", "u", "v")] == [1, 0.5, 0.5], f"the button resets to {reset}")
    check(reset["exposure"] == whole["exposure"] + 2, "the button leaves the exposure")
    browser.press(*"[" * 4)
    expect("the button")


@starts_anew
def zooms_by_the_wheel(browser):
    """About the pointer, on a canvas that has the focus alone: elsewhere the page scrolls."""
    browser.run("document.activeElement.blur(); document.querySelector(arguments[0]).scrollIntoView({ block: 'center' })", STAGE)
    before = browser.run("return scrollY")
    scroll(browser, STAGE, -100)
    check(view(browser)["zoom"] == 1, "the wheel zooms a stage without the focus")
    check(browser.run("return scrollY") < before, "the page does not scroll")
    browser.focus(STAGE)
    browser.run("document.querySelector(arguments[0]).scrollIntoView({ block: 'center' })", STAGE)
    browser.press(*"[" * 4)
    place = [(0.3, 0.7)]
    pixel = pixel_of(colours(browser, STAGE, place)[0][0])
    scroll(browser, STAGE, -200, *place[0])
    check(1.3 < view(browser)["zoom"] < 1.7, f"zoom {view(browser)['zoom']}")
    check(pixel_of(colours(browser, STAGE, place)[0][0]) == pixel, "the pixel under the pointer moves")
    scroll(browser, STAGE, 400, *place[0])
    check(view(browser)["zoom"] == 1, f"back to zoom {view(browser)['zoom']}")


@starts_anew
def flips_to_a_clicked_tile(browser):
    browser.press(*"[" * 4)
    for index, factor in ((2, 0.75), (3, 1.5)):
        browser.click(f"{FIRST} .tile:nth-child({index}) .tile-image")
        check(abs(blue(browser) / blue(browser, f"{FIRST} .tile-image") - factor) < 0.05, f"tile {index} is not shown")
        check(text(browser, f"{FIRST} .stage-title").startswith(f"{index} "), f"the title of tile {index} is not shown")


@starts_anew
def shows_the_worst_run(browser):
    browser.press(*"[" * 4, str(BRIGHT))
    reference = blue(browser, f"{FIRST} .tile-image")
    for key, run, error in (("w", "worst", "0.500"), ("w", "median", "0.250")):
        browser.press(key)
        factor = blue(browser) / reference
        check(abs(factor - FACTORS["bright"][run]) < 0.05, f"{factor} times the reference is shown as the {run} run")
        title = text(browser, f"{FIRST} .stage-title")
        check(f"{run} run, relMSE {error}" in title, f"the {run} run is called '{title}'")


@starts_anew
def chooses_what_is_shown(browser):
    """Each radio button shows what its key shows, and is the one that is set."""
    browser.press(str(BRIGHT))
    seen = set()
    for name, key in (("error", "e"), ("deviation", "d"), ("tests", "p"), ("rhat", "m"), ("acceptance", "a"), ("tones", "a")):
        browser.click(f"{FIRST} .{name}-toggle")
        by_button = browser.pixels(STAGE)
        browser.press("0", key)
        if name == "tones":
            browser.press(key)  # back from its map
        check(browser.pixels(STAGE) == by_button, f"the button of {name} shows another picture than key {key}")
        chosen = browser.run("return [...document.querySelectorAll(`${arguments[0]} .shows input`)].find((i) => i.checked).className", FIRST)
        check(chosen == f"{name}-toggle", f"after key {key} {chosen} is set")
        seen.add(by_button)
    check(len(seen) == 6, f"{len(seen)} different pictures of 6")


@starts_anew
def reads_the_picture_under_the_pointer(browser):
    """On either side of the divider the one displayed there, in tiles their own, and says which."""
    readout = f"{FIRST} .readout"

    def read(selector, u, v):
        point(browser, selector, u, v)
        found = re.match(r"(.*) · pixel (\d+), (\d+): ([\d.]+), ([\d.]+), ([\d.]+)", text(browser, readout))
        check(found, f"the readout says '{text(browser, readout)}'")
        return found[1], (int(found[2]), int(found[3])), float(found[6]) / BLUE

    browser.press(str(BRIGHT), "s")
    check(read(STAGE, 0.22, 0.3) == ("reference", (3, 3), 1), f"left: {text(browser, readout)}")
    check(read(STAGE, 0.72, 0.3) == ("bright, median run, relMSE 0.250", (11, 3), 1.5), f"right: {text(browser, readout)}")
    check(read(f"{FIRST} .tile:nth-child(2) .tile-image", 0.72, 0.3)[2] == 0.75, f"a tile: {text(browser, readout)}")
    browser.press("s")
    check(read(STAGE, 0.22, 0.3)[0].startswith("bright"), f"without the divider: {text(browser, readout)}")


def gives_keys_to_the_focused_viewer(browser):
    """Though the other one is nearer the middle of the window."""
    browser.run(
        """document.querySelector(`${arguments[1]} .stage`).focus({ preventScroll: true });
        document.querySelector(arguments[0]).scrollIntoView({ block: 'center', behavior: 'instant' })""",
        FIRST,
        SECOND,
    )
    browser.press(str(BRIGHT))
    shown = [view(browser, scene)["shown"] for scene in (0, 1)]
    check(shown == ["reference reference", "replicate bright"], f"the viewers show {shown}")
    browser.press(str(REFERENCE))
    browser.run("document.activeElement.blur()")
    browser.press(str(BRIGHT))
    check(view(browser, 0)["shown"] == "replicate bright", "without a focus the nearest viewer has no keys")
    browser.press(str(REFERENCE))


@starts_anew
def keeps_choices_in_other_colours(browser):
    """View, crops, order of the table, choices and place of the page."""
    browser.press("+", "+", "]", str(BRIGHT), "e")
    browser.focus(f"{FIRST} .inset-0")
    browser.press(RIGHT, DOWN)
    browser.focus("#cell-table th:nth-child(2) button")
    browser.press(ENTER, ENTER)
    browser.focus("#caught select")
    browser.press(DOWN)
    browser.run("document.activeElement.blur(); scrollTo({ top: 333, behavior: 'instant' })")
    found = """return { ...window.reportView.get(), caught: document.querySelector('#caught .sentence').textContent,
        rows: [...document.querySelectorAll('#cell-table tbody tr')].map((row) => row.textContent),
        frame: document.querySelector('.inset-0').style.left }"""
    before = browser.run(found)
    check(
        before["orders"] == [{"table": "cells", "column": "sampler", "direction": "descending"}],
        f"the orders are {before['orders']}",
    )
    check(before["viewers"][0]["zoom"] > 2 and before["scroll"] == 333, f"the view is {before}")
    browser.media("dark")
    after = browser.run(found)
    browser.media("light")
    check(after == before, f"in dark colours the view is {after}, not {before}")
    for _ in range(2):
        browser.media("dark")
        browser.media("light")
    check(browser.run(found) == before, "after more changes it is another")
    browser.run("document.querySelector('#caught select').selectedIndex = 0")


def names_runs_by_their_folders(browser, page):
    """Where the first replicate is lost, arrays begin with the second."""

    def lose_first(data):
        for cell in data["summary"]["cells"]:
            cell["replicate_numbers"] = [1, 2, 3]
            cell["worst_replicate"] = data["pictures"][cell["cell"]]["worst_replicate"] = 2
            cell["median_replicate"] = data["pictures"][cell["cell"]]["median_replicate"] = 1
            data["results"][cell["cell"]] = {"replicate": 1, "image_sha256": "a" * 64}

    with other_page(browser, page, lose_first):
        browser.press(str(BRIGHT))
        title = text(browser, f"{FIRST} .stage-title")
        check("median run, relMSE 0.250" in title, f"the median run is called '{title}'")
        browser.press("w")
        title = text(browser, f"{FIRST} .stage-title")
        check("worst run, relMSE 0.500" in title, f"the worst run is called '{title}'")
        caught = text(browser, "#caught .sentence")
        check(re.match(r"In run 2 of .* got 1\.60 × its true share", caught), f"of the caught run it says '{caught}'")
        runs = browser.run("return [...document.querySelectorAll('#caught .mini-maps figure')].map((f) => f.textContent)")
        check([run[:2] for run in runs[:3]] == ["1:", "2:", "3:"], f"the runs are {runs}")
        worst = text(browser, "#caught .mini-maps .worst")
        check(worst.startswith("2: 60"), f"the worst of them is '{worst}'")
        check("first-dim/r001" in text(browser, "#provenance"), "the digest is of another replicate")


def says_what_is_shrunk(browser, page):
    """Pixels are those of the film, and means read less noisy than pixels."""
    legend = f"{FIRST} .error-legend"
    browser.press("e")
    check("means" not in text(browser, legend), f"unshrunk, the legend says '{text(browser, legend)}'")
    browser.press("d")
    check("means over 2 × 2 pixels" in text(browser, legend), f"of blocks of 2 the legend says '{text(browser, legend)}'")
    browser.press("d")

    def shrink(data):
        data["shrink"], data["exact"] = 3, False

    with other_page(browser, page, shrink):
        point(browser, STAGE, 0.72, 0.3)
        readout = text(browser, f"{FIRST} .readout")
        check("3 × 3 pixels from 33, 9: " in readout, f"the readout says '{readout}'")
        browser.press("e")
        said = text(browser, legend)
        check("means over 3 × 3 pixels" in said and "noise reads smaller" in said, f"the legend says '{said}'")
        check("means over 3 × 3 pixels" in text(browser, "#images .lead"), text(browser, "#images .lead"))


def main():
    tests = [
        exposes_in_stops,
        shows_the_same_place_in_all,
        zooms_by_the_wheel,
        flips_to_a_clicked_tile,
        shows_the_worst_run,
        chooses_what_is_shown,
        reads_the_picture_under_the_pointer,
        gives_keys_to_the_focused_viewer,
        keeps_choices_in_other_colours,
    ]
    with report(sys.argv) as page, tempfile.TemporaryDirectory() as folder:
        data, elements = made_up_run()
        made_up = with_data(page, data, pathlib.Path(folder) / "made_up.html", elements)
        tests += [functools.partial(test, page=page) for test in (names_runs_by_their_folders, says_what_is_shrunk)]
        return run_tests(tests, lambda browser: browser.open(made_up))


if __name__ == "__main__":
    sys.exit(main())
