#!/usr/bin/env python3
"""Independent runs of Mitsuba 3's path tracer: render.py SCENE.xml OUT max_depth=D runs=N error=E

OUT gets the images one after another, as 32-bit floats (run, row, column, R G B). Each run has as many samples per
pixel as it takes for the mean of all images to have the relative standard error E.
"""

import os
import sys

import mitsuba
import numpy

PILOT_SAMPLES = 4
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
    pilot = numpy.array([renderer.run(PILOT_SAMPLES).mean() for _ in range(runs)])
    found = pilot.std(ddof=1) / pilot.mean() / runs**0.5
    samples = max(PILOT_SAMPLES, round(PILOT_SAMPLES * (found / error) ** 2))
    images = numpy.array([renderer.run(samples) for _ in range(runs)], numpy.float32)
    with open(out + ".tmp", "wb") as file:
        file.write(images.tobytes())
    os.replace(out + ".tmp", out)
    print(f"{scene}: {runs} runs of {samples} samples per pixel")


if __name__ == "__main__":
    main()
