#!/usr/bin/env python3
"""Other vector instructions in the ray tracer: independent samples make the same image but for rounding, chains the same
in the mean."""

import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import unittest

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "support"))
from exr import read_exr

ULAM = os.path.abspath(os.environ.get("ULAM", "build/release/ulam"))
HERE = pathlib.Path(__file__).resolve().parent
SIZE = 32
# Embree's names; what this processor lacks is left out.
NEEDED_FLAG = {"sse2": "sse2", "avx2": "avx2", "avx512": "avx512vl"}


def processor_flags():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("flags"):
            return line.split()
    return []


class Simd(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        cls.preload = cls.folder / "isa.so"
        subprocess.run([os.environ.get("CC", "cc"), "-shared", "-fPIC", "-o", cls.preload, HERE / "isa.c", "-ldl"], check=True)
        flags = processor_flags()
        cls.instructions = [isa for isa, flag in NEEDED_FLAG.items() if flag in flags]
        if len(cls.instructions) < 2:
            raise unittest.SkipTest("the processor has one vector width")

    def render(self, isa, scene, sampler, *arguments):
        output = self.folder / "image.exr"
        environment = dict(os.environ, ULAM_TEST_ISA=isa, LD_PRELOAD=str(self.preload))
        subprocess.run([ULAM, "render", scene, "--sampler", sampler, "--threads", "1", "--quiet", "-o", output,
                        "--set", f"scene.film.width={SIZE}", "--set", f"scene.film.height={SIZE}", *map(str, arguments)],
                       check=True, env=environment)
        return [value for row in read_exr(output) for pixel in row for value in pixel]

    def test_independent_samples_differ_by_rounding_but_in_a_few_pixels(self):
        first, *others = self.instructions
        differ = False
        for scene in "cornell_box", "torus_in_glass":
            for sampler in "path", "bdpt":
                image = self.render(first, scene, sampler, "--spp", 16)
                self.assertEqual(len(image), 3 * SIZE * SIZE)
                scale = statistics.fmean(image)
                self.assertGreater(scale, 0)
                for isa in others:
                    other = self.render(isa, scene, sampler, "--spp", 16)
                    differ = differ or other != image
                    far = sum(abs(a - b) > 1e-3 * (abs(a) + scale) for a, b in zip(image, other))
                    # A ray along an edge takes another side; from there on the path is another.
                    self.assertLessEqual(far, 0.02 * len(image), (scene, sampler, first, isa))
        self.assertTrue(differ, "other instructions were not used")

    def test_chains_agree_in_the_mean(self):
        replicates, tiles = 8, 4
        means = {}
        for k, isa in enumerate((self.instructions[0], self.instructions[-1])):
            for sampler in "mlt", "pssmlt":
                for seed in range(replicates):
                    image = self.render(isa, "cornell_box", sampler, "--mutations", 20000, "--seed", 1 + seed + 100 * k)
                    part = len(image) // tiles
                    means.setdefault((sampler, isa), []).append(
                        [statistics.fmean(image[i * part:(i + 1) * part]) for i in range(tiles)])
        for sampler in "mlt", "pssmlt":
            a, b = (means[sampler, isa] for isa in (self.instructions[0], self.instructions[-1]))
            for tile in range(tiles):
                x, y = [run[tile] for run in a], [run[tile] for run in b]
                error = math.sqrt((statistics.variance(x) + statistics.variance(y)) / replicates)
                t = (statistics.fmean(x) - statistics.fmean(y)) / error
                # 8 replicates a side: at least 7 degrees of freedom, where p is about 1e-5.
                self.assertLess(abs(t), 10.5, (sampler, tile, t))


if __name__ == "__main__":
    unittest.main()
