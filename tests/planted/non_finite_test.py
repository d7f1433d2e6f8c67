#!/usr/bin/env python3
"""Values that are not finite, made in many places: each is refused, counted by its cause, never reaches the image, and can be
seen again by its token."""

import json
import os
import pathlib
import struct
import subprocess
import tempfile
import tomllib
import unittest

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = pathlib.Path(os.environ.get("ULAM", HERE.parent.parent / "build/release/ulam")).resolve().parent / "ulam_planted"
FULL = os.environ.get("ULAM_TEST_LEVEL") == "full"
KEPT = 16

SCENE = {
    "type": "scene",
    "sensor": {"type": "perspective", "fov": 60, "film": {"type": "hdrfilm", "width": 16, "height": 16},
               "to_world": [{"type": "lookat", "origin": [0, 0, 4], "target": [0, 0, 0], "up": [0, 1, 0]}]},
    "wall": {"type": "rectangle", "to_world": [{"type": "scale", "value": 3}],
             "bsdf": {"type": "diffuse", "reflectance": {"type": "bitmap", "filename": "wall.pfm"}}},
    "ball": {"type": "sphere", "radius": 0.7, "center": [0, 0, 1], "bsdf": {"type": "roughplastic", "alpha": 0.3}},
    "lamp": {"type": "rectangle", "emitter": {"type": "area", "radiance": [4, 5, 3]},
             "to_world": [{"type": "rotate", "axis": [1, 0, 0], "angle": 180},
                          {"type": "translate", "value": [0, 0, 5]}]},
    "sky": {"type": "sunsky"},
}
SAMPLERS = {
    "path": ({"type": "path", "max_depth": 5, "rr_depth": 2}, ["--spp", "16"]),
    "light": ({"type": "light", "max_depth": 5}, ["--spp", "16"]),
    "bdpt": ({"type": "bdpt", "max_depth": 5}, ["--spp", "8"]),
    "pssmlt": ({"type": "pssmlt", "max_depth": 5, "chains": 20, "bootstrap": 2000}, ["--mutations", "4000"]),
    "mlt": ({"type": "mlt", "max_depth": 5, "chains": 20, "bootstrap": 2000}, ["--mutations", "20000"]),
}


def places():
    with open(HERE / "non_finite.toml", "rb") as file:
        return tomllib.load(file)["bug"]


class NonFiniteTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        (self.folder / "scene.json").write_text(json.dumps(SCENE))
        texels = [0.2 + 0.1 * (i % 5) for i in range(48)]
        (self.folder / "wall.pfm").write_bytes(b"PF\n4 4\n-1.0\n" + struct.pack("<48f", *texels))

    def program(self, place, *arguments):
        done = subprocess.run([PROGRAM, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True, timeout=300,
                              env={**os.environ, "ULAM_PLANTED": str(place)})
        self.assertEqual(done.returncode, 0, f"{place} {arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def render(self, place, sampler, threads=2):
        config, work = SAMPLERS[sampler]
        done = self.program(place, "render", "scene.json", "--sampler", json.dumps(config), *work, "--threads", threads, "-o",
                            "image.exr", "--stats", "stats.json")
        return done, json.loads((self.folder / "stats.json").read_text())

    def test_an_ordinary_render_meets_none(self):
        for sampler in SAMPLERS:
            _, stats = self.render(0, sampler)
            self.assertEqual(stats["non_finite"], {}, sampler)
            self.assertEqual(stats["non_finite_first"], [])

    def test_each_is_refused_counted_and_seen_again(self):
        self.assertGreaterEqual(len(places()), 20)
        for place in places():
            with self.subTest(place["name"]):
                # An image with such a value would not be written (and the run not end well).
                done, stats = self.render(place["id"], place["sampler"])
                self.assertGreater(stats["non_finite"].get(place["cause"], 0), 0, stats["non_finite"])
                self.assertIn("not finite", done.stderr)
                self.assertIn("ulam replay-path path1-", done.stderr)
                first = stats["non_finite_first"]
                self.assertEqual(len(first), min(KEPT, sum(stats["non_finite"].values())))
                for event in first if FULL else first[:1]:
                    told = json.loads(self.program(place["id"], "replay-path", event["token"], "--json").stdout)
                    self.assertEqual(told["cause"], event["cause"])
                    if place["cause"] == "target":  # which is no part of the sample that seeds
                        self.assertTrue(told.get("contributions") or told.get("refused"), told)
                    else:
                        self.assertIn(f'"refused": "{place["cause"].split()[0]}"', json.dumps(told))
                self.assertIn("cause: ", self.program(place["id"], "replay-path", first[0]["token"]).stdout)

    def test_the_same_are_kept_with_any_number_of_threads(self):
        for place, sampler in ((201, "bdpt"), (203, "mlt")):
            _, one = self.render(place, sampler, 1)
            _, many = self.render(place, sampler, 3)
            self.assertEqual(one["non_finite"], many["non_finite"])
            self.assertEqual(one["non_finite_first"], many["non_finite_first"])


if __name__ == "__main__":
    unittest.main()
