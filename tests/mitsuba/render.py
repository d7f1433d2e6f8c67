#!/usr/bin/env python3
"""Independent runs of Mitsuba 3's path tracer: render.py SCENE.xml OUT max_depth=D runs=N error=E

OUT gets the images one after another, as 32-bit floats (run, row, column, R G B). Each run has as many samples per
pixel as it takes for the mean of all images to have the relative standard error E. Images of a pilot, or of runs that it
sized too small, are not used.
"""

import itertools
import os
import sys

import mitsuba
import numpy

PILOT_SAMPLES = 4
RESERVE = 1.15  # the standard error may be larger than asked for by this factor
LARGEST_BATCH = 64  # samples per pixel: a call's memory grows with them
# The seed of a pixel is that of the call plus the pixel's number, so calls need seeds that are as far apart as the film
# has pixels. No seed gives the same image each time.
SEED_STRIDE = 1 << 16


class Renderer:
    def __init__(self, scene, max_depth):
        self.scene = mitsuba.load_file(scene)
        self.integrator = mitsuba.load_dict({"type": "path", "max_depth": max_depth, "rr_depth": 1_000_000})
        self.calls = 0

    def batch(self, samples):
        seed = self.calls * SEED_STRIDE
        self.calls += 1
        return numpy.array(mitsuba.render(self.scene, integrator=self.integrator, spp=samples, seed=seed), numpy.float32)

    def run(self, samples):
        """Batches of equal size: their mean is the image."""
        batches = -(-samples // LARGEST_BATCH)
        return numpy.mean([self.batch(-(-samples // batches)) for _ in range(batches)], axis=0, dtype=numpy.float64)


def main():
    scene, out = sys.argv[1:3]
    options = dict(argument.split("=") for argument in sys.argv[3:])
    runs, error = int(options["runs"]), float(options["error"])
    mitsuba.set_variant("scalar_rgb")
    renderer = Renderer(scene, int(options["max_depth"]))
    samples = PILOT_SAMPLES
    for attempt in itertools.count():
        images = numpy.array([renderer.run(samples) for _ in range(runs)], numpy.float32)
        energy = images.mean(axis=(1, 2, 3), dtype=numpy.float64)
        found = energy.std(ddof=1) / energy.mean() / runs**0.5
        # Where few samples carry most of the light a pilot may see none of them.
        if attempt > 0 and found <= RESERVE * error:
            break
        samples = max(PILOT_SAMPLES, round(samples * (found / error) ** 2))
    with open(out + ".tmp", "wb") as file:
        file.write(images.tobytes())
    os.replace(out + ".tmp", out)
    print(f"{scene}: {runs} runs of {samples} samples per pixel")


if __name__ == "__main__":
    main()
