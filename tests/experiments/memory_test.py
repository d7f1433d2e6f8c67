#!/usr/bin/env python3
"""Memory: what a render is said to need against what it takes, and refusals before it is taken."""

import array
import json
import os
import pathlib
import shutil
import struct
import subprocess
import tempfile
import unittest

ULAM = os.path.abspath(os.environ.get("ULAM", "build/release/ulam"))
FULL = os.environ.get("ULAM_TEST_LEVEL") == "full"
MEGABYTE = 1 << 20

# Little work, and much to hold: films, chains, bootstrap samples, a mesh.
LARGE_FILM = ["--set", "scene.film.width=1536", "--set", "scene.film.height=1536"]
MANY_CHAINS = ["--set", "scene.film.width=64", "--set", "scene.film.height=64", "--mutations", "100000",
               "--set", "sampler.chains=20000", "--set", "sampler.bootstrap=20000"]
JOBS = {
    "films of path": ["cornell_box", "--sampler", "path", "--spp", "0.2", *LARGE_FILM],
    "films of bdpt": ["cornell_box", "--sampler", "bdpt", "--spp", "0.05", *LARGE_FILM],
    "chains of mlt": ["cornell_box", "--sampler", "mlt", *MANY_CHAINS],
    "a mesh": ["terrain", "--sampler", "path", "--spp", "1", "--set", "scene.cells=500", "--set", "scene.film.width=32",
               "--set", "scene.film.height=32"],
}
if FULL:
    JOBS |= {
        "films of light": ["cornell_box", "--sampler", "light", "--spp", "0.2", *LARGE_FILM],
        "films of mlt": ["cornell_box", "--sampler", "mlt", "--spp", "0.2", *LARGE_FILM],
        "films of pssmlt": ["cornell_box", "--sampler", "pssmlt", "--spp", "0.1", *LARGE_FILM],
        "films of portal": ["grid_of_holes", "--sampler", "portal", "--spp", "0.2", *LARGE_FILM],
        "chains of pssmlt": ["cornell_box", "--sampler", "pssmlt", *MANY_CHAINS],
        "bootstrap": ["cornell_box", "--sampler", "mlt", "--mutations", "10000", "--set", "sampler.bootstrap=8000000",
                      "--set", "scene.film.width=32", "--set", "scene.film.height=32"],
        "images of techniques": ["cornell_box", "--sampler", "bdpt", "--spp", "0.1", "--set", "sampler.technique_images=true",
                                 "--set", "scene.film.width=512", "--set", "scene.film.height=512"],
        "images of acceptance": ["cornell_box", "--sampler", "mlt", "--spp", "0.2", "--set", "sampler.acceptance_images=true",
                                 *LARGE_FILM],
        "many threads": ["cornell_box", "--sampler", "path", "--spp", "0.5", "--threads", "8", *LARGE_FILM],
    }


class Memory(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="ulam-memory-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def ulam(self, *arguments):
        """Exit code, peak of resident bytes, and what it says."""
        with open(self.folder / "out", "w+") as out, open(self.folder / "err", "w+") as err:
            process = subprocess.Popen([ULAM, *arguments], cwd=self.folder, stdout=out, stderr=err)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            texts = [(file.seek(0), file.read())[1] for file in (out, err)]
        return process.returncode, usage.ru_maxrss * 1024, *texts

    def render(self, *arguments):
        return self.ulam("render", "-o", "out.exr", "--stats", "out.json", "--quiet", *arguments)

    def test_estimates_against_peaks(self):
        for name, arguments in JOBS.items():
            with self.subTest(name):
                threads = [] if "--threads" in arguments else ["--threads", "2"]
                code, peak, _, err = self.render(*arguments, *threads)
                self.assertEqual(code, 0, err)
                result = json.loads((self.folder / "out.json").read_text())
                self.assertAlmostEqual(result["peak_rss_bytes"], peak, delta=16 * MEGABYTE)
                self.assertLess(peak, 1.1 * result["estimated_memory_bytes"] + 10 * MEGABYTE)
                self.assertLess(result["estimated_memory_bytes"], 1.4 * peak + 10 * MEGABYTE)

    def large_mesh(self):
        """A grid of about a million triangles, from a file."""
        n = 700
        vertices = array.array("f", (c for i in range(n + 1) for j in range(n + 1) for c in (i / n, (i * j % 7) * 1e-4, j / n)))
        faces = b"".join(struct.pack("<B3iB3i", 3, a, a + 1, a + n + 1, 3, a + 1, a + n + 2, a + n + 1)
                         for i in range(n) for a in range(i * (n + 1), i * (n + 1) + n))
        header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {(n + 1) ** 2}\nproperty float x\nproperty float y\n"
                  f"property float z\nelement face {2 * n * n}\nproperty list uchar int vertex_indices\nend_header\n")
        folder = self.folder.parent / (self.folder.name + "-scene")
        folder.mkdir()
        self.addCleanup(shutil.rmtree, folder)
        (folder / "grid.ply").write_bytes(header.encode() + vertices.tobytes() + faces)
        (folder / "grid.json").write_text(json.dumps({
            "type": "scene", "mesh": {"type": "ply", "filename": "grid.ply"}, "sky": {"type": "constant"},
            "sensor": {"type": "perspective", "fov": 60, "film": {"type": "hdrfilm", "width": 32, "height": 32},
                       "to_world": [{"type": "lookat", "origin": [0.5, 2, 2], "target": [0.5, 0, 0.5], "up": [0, 1, 0]}]}}))
        return str(folder / "grid.json")

    def refused(self, limit, *arguments):
        code, peak, _, err = self.render(*arguments, "--max-memory", limit)
        self.assertEqual(code, 4, err)
        self.assertEqual({file.name for file in self.folder.iterdir()}, {"out", "err"}, "nothing else is left")
        return peak, err

    def test_a_render_that_needs_more_is_refused_before_it_takes_it(self):
        peak, err = self.refused("600M", *JOBS["films of path"], "--threads", "8")
        self.assertLess(peak, 300 * MEGABYTE)
        for part in ("the render needs about", "--max-memory allows 600 MB", "the films of 8 threads", "a smaller film or fewer threads"):
            self.assertIn(part, err)

    def test_a_scene_that_needs_more_is_refused_before_its_tree_is_built(self):
        scene = self.large_mesh()
        code, whole, out, err = self.ulam("scene", scene, "--info")
        self.assertEqual(code, 0, err)
        self.assertIn("for the tree for tracing rays while it is built", out)
        peak, err = self.refused("170M", scene, "--sampler", "path", "--spp", "1")
        self.assertIn("the scene needs about", err)
        self.assertIn("the tree for tracing rays while it is built", err)
        self.assertLess(peak, 170 * MEGABYTE)
        self.assertLess(170 * MEGABYTE, whole)

    def test_experiments_have_the_limit_too(self):
        (self.folder / "large.json").write_text(json.dumps({
            "scenes": {"box": {"type": "cornell_box"}}, "film": {"width": 4096, "height": 4096}, "max_depth": 3,
            "samplers": {"path": {"type": "path"}}, "baseline": "path", "budget": {"spp": 0.1}, "replicates": 2,
            "metrics": ["relmse"], "reference": {"sampler": "path", "budget": {"spp": 0.1}, "part": {"spp": 0.025}}}))
        code, peak, _, err = self.ulam("run", "large.json", "-o", "run", "--quiet", "--max-memory", "300M", "--threads", "2")
        self.assertEqual(code, 4, err)
        self.assertIn("--max-memory allows 300 MB", err)
        self.assertLess(peak, 300 * MEGABYTE)

    def test_sizes_are_understood_or_refused(self):
        code, _, _, err = self.render("cornell_box", "--sampler", "path", "--spp", "1", "--max-memory", "much")
        self.assertEqual(code, 2, err)
        self.assertIn("--max-memory", err)
        code, _, _, err = self.render("cornell_box", "--sampler", "path", "--spp", "1", "--max-memory", "4GB")
        self.assertEqual(code, 0, err)


if __name__ == "__main__":
    unittest.main()
