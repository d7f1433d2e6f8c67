#!/usr/bin/env python3
"""Panels of chains and techniques in a real browser: chains_browser_test.py [REPORT_HTML].

Of the made-up run mlt's chains stay in a hole each, pssmlt's go everywhere; bdpt has images of five techniques.
"""

import sys

from browser import DOWN, ENTER, LEFT, RIGHT, check, complaints, report, run_tests

CHAINS, PYRAMID = "#chains > .group:nth-of-type(1)", "#techniques > .group:nth-of-type(1)"
TOOLTIP = "return document.getElementById('tooltip').textContent"


def loads_without_errors(browser):
    for name in ("chains", "techniques"):
        check(browser.run("return document.getElementById(arguments[0]) !== null", name), f"no section {name}")
    said = complaints(browser)
    check(not said, f"the console says {said}")


def choose(browser, selector, index):
    browser.run(
        """const select = document.querySelector(arguments[0]);
        select.selectedIndex = arguments[1];
        select.dispatchEvent(new Event('change'))""",
        selector,
        index,
    )
    browser.settle()


def ranks_show_caught_chains(browser):
    """The 16 rows of mlt's ranks of the feature have one full class each; those of pssmlt are even."""
    full = """const fills = [...document.querySelectorAll(`${arguments[0]} .charts figure:nth-child(2) rect[shape-rendering]`)].map((r) => r.getAttribute('fill'));
        const columns = fills.length / 16, extremes = fills.filter((f) => f === arguments[1]).length;
        return [fills.length, columns, extremes]"""
    empty = browser.run("return getComputedStyle(document.documentElement).getPropertyValue('--diverging-low').trim()")
    rgb = f"rgb({' '.join(str(int(empty[i : i + 2], 16)) for i in (1, 3, 5))})"
    shares = []
    for sampler in (1, 0):  # mlt, then pssmlt
        choose(browser, f"{CHAINS} h3 select", sampler)
        choose(browser, f"{CHAINS} .scalar", 4)
        squares, columns, empties = browser.run(full, CHAINS, rgb)
        check(squares == 16 * columns and columns == 16, f"{squares} squares in {columns} columns")
        shares.append(empties / squares)
    check(shares[0] > 0.9 and shares[1] < 0.5, f"empty classes of ranks: mlt {shares[0]:.2f}, pssmlt {shares[1]:.2f}")


def autocorrelation_tells_them_apart(browser):
    """Around the mean of all chains ρ of mlt's place stays up; around a chain's own mean it falls at once."""
    choose(browser, f"{CHAINS} h3 select", 1)
    browser.focus(f"{CHAINS} .charts figure:nth-child(3) svg")
    values = []
    for key in (RIGHT, DOWN):
        browser.press(key)
        text = browser.run(TOOLTIP)
        check("lag 1: ρ = " in text, f"the arrow keys read '{text}'")
        values.append(
            float(text.split("ρ = ")[1].split("around")[0].replace("−", "-").replace("\u2009×\u200910⁻⁴", "e-4"))
        )
    check(abs(values[0]) < 0.2 and values[1] > 0.9, f"ρ at lag 1: own mean {values[0]}, common mean {values[1]}")
    browser.run("document.activeElement.blur()")


def reads_ranks_by_keys(browser):
    browser.focus(f"{CHAINS} .charts figure:nth-child(2) svg")
    browser.press(RIGHT, DOWN)
    text = browser.run(TOOLTIP)
    check(text.startswith("chain 2") and "if chains agree" in text, f"the arrow keys read '{text}'")
    browser.run("document.activeElement.blur()")


def draws_traces(browser):
    lines = browser.run(
        "return document.querySelectorAll(`${arguments[0]} .charts figure:nth-child(1) .series`).length", CHAINS
    )
    check(lines == 6, f"{lines} traces")
    table = browser.run("return document.querySelector(`${arguments[0]} table`).textContent", CHAINS)
    for said in "R-hat", "4.20", "integrated autocorrelation mutations", "≥ 4321":
        check(said in table, f"the table of mixing says '{table}', not '{said}'")
    check("bound" not in table, f"the table of mixing has a column of signs: '{table}'")


def plays_by_keyboard(browser):
    """Nothing moves by itself; Enter plays and pauses; the slider shows a draw; slower where motion is unwanted."""
    film, play, slider = f"{CHAINS} .chain-film", f"{CHAINS} .play", f"{CHAINS} .draw"
    draw = f"return Number(document.querySelector('{slider}').value)"
    wait = "const done = arguments[1]; setTimeout(done, arguments[0])"

    def pause(milliseconds):
        browser.call("POST", "/execute/async", {"script": wait, "args": [milliseconds]})

    pause(300)
    check(browser.run(draw) == 0, "the chains move before anyone asked")
    before = browser.pixels(film)
    browser.focus(play)
    browser.press(ENTER)
    pause(600)
    browser.press(ENTER)
    stopped = browser.run(draw)
    check(stopped >= 3 and browser.pixels(film) != before, f"after 0.6 s it stands at draw {stopped}")
    pause(300)
    check(browser.run(draw) == stopped, "it goes on after a pause")
    browser.focus(slider)
    shown = browser.pixels(film)
    browser.press(RIGHT)
    check(browser.run(draw) == stopped + 1 and browser.pixels(film) != shown, "the slider shows no other draw")
    features = [{"name": "prefers-reduced-motion", "value": "reduce"}]
    browser.call("POST", "/goog/cdp/execute", {"cmd": "Emulation.setEmulatedMedia", "params": {"features": features}})
    browser.focus(play)
    browser.press(ENTER)
    pause(900)
    browser.press(ENTER)
    moved = browser.run(draw) - stopped - 1
    check(0 < moved <= 3, f"with reduced motion it moved by {moved} draws in 0.9 s")
    browser.media("light")


def draws_the_pyramid(browser):
    """Rows of length 2 and 3 with s from left to right; shares of the light add up to 100 %."""
    rows = browser.run(
        """return [...document.querySelectorAll(`${arguments[0]} .pyramid-row`)].slice(0, 2).map((row) =>
        [row.querySelector('span').textContent, [...row.querySelectorAll('figcaption')].map((c) => c.textContent)])""",
        PYRAMID,
    )
    names = [(length, [text.split(" ·")[0] for text in texts]) for length, texts in rows]
    check(names == [("length 2", ["0, 3", "1, 2", "2, 1"]), ("length 3", ["1, 3", "2, 2"])], f"the pyramid: {names}")
    total = sum(float(text.split("·")[1].replace("%", "")) for _, texts in rows for text in texts)
    check(abs(total - 100) < 0.5, f"the shares add up to {total} %")


def switches_weights(browser):
    picture = f"{PYRAMID} canvas"
    browser.focus(f"{PYRAMID} .pyramid-fit")
    browser.press(" ")  # one exposure for all, so that weights show
    weighted = browser.pixels(picture)
    browser.focus(f"{PYRAMID} .pyramid-weighted")
    browser.press(RIGHT)
    unweighted = browser.pixels(picture)
    check(weighted != unweighted, "weighted and unweighted look the same")
    browser.press(LEFT)
    check(browser.pixels(picture) == weighted, "the switch does not come back")
    browser.focus(f"{PYRAMID} .controls input[type=range]")
    browser.press(*[RIGHT] * 3)
    check(browser.pixels(picture) != weighted, "the exposure changes nothing")
    browser.press(*[LEFT] * 3)


def main():
    tests = [
        loads_without_errors,
        ranks_show_caught_chains,
        autocorrelation_tells_them_apart,
        reads_ranks_by_keys,
        draws_traces,
        plays_by_keyboard,
        draws_the_pyramid,
        switches_weights,
    ]
    with report(sys.argv) as page:
        return run_tests(tests, lambda browser: browser.open(page))


if __name__ == "__main__":
    sys.exit(main())
