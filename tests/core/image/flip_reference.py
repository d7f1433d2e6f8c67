#!/usr/bin/env python3
"""Compares the golden values of flip_test.cpp with NVIDIA's FLIP.

Needs `pip install flip-evaluator numpy`. Prints a line per pair of images and exits with 1 if a value is off by more
than 1e-5. `--print` prints the table for the test instead.
"""

import re
import sys
from pathlib import Path

import flip_evaluator
import numpy as np

WIDTH, HEIGHT = 64, 48
NAMES = ["noise", "scaled", "shifted", "fireflies", "mostly_black", "high_range", "white_and_black"]


def base(x, y):
    return np.stack(
        [
            0.5 + 0.5 * np.sin(0.15 * x + 0.07 * y),
            0.3 + 0.3 * np.cos(0.005 * x * y),
            8 * np.exp(-0.004 * ((x - 30) ** 2 + (y - 20) ** 2)),
        ],
        axis=-1,
    )


def scatter(x, y, channel):
    value = np.sin(12.9898 * x + 78.233 * y + 37.719 * channel) * 43758.5453
    return value - np.floor(value)


def make_pair(name):
    """The same pairs as in flip_test.cpp: reference and image."""
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH].astype(float)
    r = base(x, y)
    noise = np.stack([scatter(x, y, c) for c in range(3)], axis=-1)
    if name == "noise":
        return r, r * -np.log(1 - noise)
    if name == "scaled":
        return r, 1.3 * r
    if name == "shifted":
        return r, base(x + 2, y)
    if name == "fireflies":
        return r, np.where(noise[..., :1] < 0.004, r + 300, r)
    if name == "mostly_black":
        r = np.where((x < 24)[..., None], r, 0)
        return r, r + 0.02 * noise
    if name == "high_range":
        r = np.exp(3 * r)
        return r, r * (0.5 + noise)
    if name == "white_and_black":
        return np.full_like(r, 5), np.zeros_like(r)
    raise ValueError(name)


def evaluate(name):
    """Mean error (in double, the package's own mean is a float sum), first and last exposure, their number."""
    reference, image = (a.astype(np.float32) for a in make_pair(name))
    error_map, _, used = flip_evaluator.evaluate(reference, image, "HDR", applyMagma=False, computeMeanError=False)
    return error_map.mean(dtype=float), used["startExposure"], used["stopExposure"], used["numExposures"]


def golden_values():
    text = Path(__file__).with_name("flip_test.cpp").read_text()
    rows = re.findall(r'\{"(\w+)", ([-\d.]+), ([-\d.]+), ([-\d.]+), (\d+)\}', text)
    return {row[0]: tuple(float(v) for v in row[1:]) for row in rows}


def main():
    if "--print" in sys.argv[1:]:
        for name in NAMES:
            print('    {"%s", %.6f, %.6f, %.6f, %d},' % (name, *evaluate(name)))
        return 0
    golden = golden_values()
    agree = set(golden) == set(NAMES)
    for name in NAMES:
        theirs, ours = evaluate(name), golden.get(name)
        same = ours is not None and all(abs(a - b) <= 1e-5 for a, b in zip(theirs, ours))
        agree = agree and same
        print(f"{'agrees' if same else 'DIFFERS':8} {name:16} {theirs} {ours}")
    return 0 if agree else 1


if __name__ == "__main__":
    sys.exit(main())
