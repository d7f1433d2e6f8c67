#!/usr/bin/env python3
"""Long renders: killed and resumed, repeated by their results, always to the same bytes."""

import json
import os
import pathlib
import random
import signal
import subprocess
import tempfile
import time
import unittest

FAULTS = os.path.abspath(os.environ.get("ULAM_FAULTS", "build/release/tests/libulam_faults.so"))
ULAM = os.path.abspath(os.environ.get("ULAM", "build/release/ulam"))
FULL = os.environ.get("ULAM_TEST_LEVEL") == "full"

SAMPLERS = {
    "path": ["--spp", "60"],
    "light": ["--spp", "60"],
    "bdpt": ["--spp", "20"],
    "pssmlt": ["--spp", "12"],
    "mlt": ["--spp", "50"],
}
FILM = ["--set", "scene.film.width=64", "--set", "scene.film.height=64"]

EXPERIMENT = {
    "scenes": {"box": {"type": "cornell_box"}, "file": "scene.json"},
    "film": {"width": 32, "height": 32},
    "max_depth": 4,
    "samplers": {"bdpt": {"type": "bdpt"}, "mlt": {"type": "mlt", "chains": 50}},
    "baseline": "bdpt",
    "budget": {"time": 0.1},
    "replicates": 2,
    "snapshots": 0,
    "metrics": ["relmse"],
    "reference": {"sampler": "bdpt", "budget": {"spp": 16}, "part": {"spp": 4}},
}
SCENE = {
    "type": "scene",
    "sensor": {"type": "perspective", "fov": 60,
               "to_world": [{"type": "lookat", "origin": [0, 0, 4], "target": [0, 0, 0], "up": [0, 1, 0]}]},
    "wall": {"type": "rectangle", "to_world": [{"type": "scale", "value": 3}]},
    "lamp": {"type": "point", "position": [0, 0, 2], "intensity": 4},
}


class ResumeTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))

    def start(self, *arguments, variables=None):
        return subprocess.Popen([ULAM, *map(str, arguments)], cwd=self.folder, env=dict(self.environment, **(variables or {})),
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def ulam(self, *arguments, expect=0, variables=None):
        process = self.start(*arguments, variables=variables)
        out, err = process.communicate(timeout=600)
        self.assertEqual(process.returncode, expect, f"{arguments}\n{out}\n{err}")
        return err

    def render(self, sampler, output, *more, expect=0):
        return self.ulam("render", "cornell_box", "--sampler", sampler, *SAMPLERS[sampler], *FILM, "-o", output, *more,
                         expect=expect)

    def image(self, name):
        return (self.folder / name).read_bytes()

    def test_killed_renders_resume_to_the_same_bytes(self):
        moments = random.Random(7)
        for sampler in SAMPLERS:
            started = time.monotonic()
            self.render(sampler, "whole.exr")
            whole = time.monotonic() - started
            for turn in range(10 if FULL else 1):
                with self.subTest(sampler=sampler, turn=turn):
                    kills = 0
                    while True:
                        process = self.start("render", "cornell_box", "--sampler", sampler, *SAMPLERS[sampler], *FILM, "-o",
                                             "killed.exr", "--checkpoint", "0.02", "--resume", "--threads",
                                             1 + kills % 3)
                        # The mean session does a third of the work.
                        if kills < 6:
                            try:
                                process.wait(moments.uniform(0.1, 0.7) * whole)
                            except subprocess.TimeoutExpired:
                                process.send_signal(signal.SIGKILL)
                        out, err = process.communicate(timeout=600)
                        if process.returncode == 0:
                            break
                        self.assertEqual(process.returncode, -signal.SIGKILL, err)
                        kills += 1
                    self.assertEqual(self.image("killed.exr"), self.image("whole.exr"))
                    self.assertFalse((self.folder / "killed.exr.checkpoint").exists())
                    (self.folder / "killed.exr").unlink()

    def test_a_signal_leaves_image_and_checkpoint(self):
        arguments = ["render", "cornell_box", "--sampler", "mlt", "--spp", "400", *FILM, "-o", "a.exr", "--stats", "a.json"]
        self.ulam(*arguments)
        whole, stats = self.image("a.exr"), json.loads((self.folder / "a.json").read_text())
        for number, code in ((signal.SIGTERM, 143), (signal.SIGINT, 130)):
            wait = 0.6 * stats["wall_seconds"]
            for _ in range(10):
                process = self.start(*arguments, "--resume")
                time.sleep(wait)
                process.send_signal(number)
                _, err = process.communicate(timeout=60)
                # Machines change their pace: the signal is meant to come after seeding and before the end. One that comes
                # while the program is still being loaded kills it.
                if process.returncode == 0:
                    wait *= 0.8
                elif process.returncode == -number:
                    wait *= 1.2
                elif "nothing was found until then" in err:
                    (self.folder / "a.exr.checkpoint").unlink()
                    wait *= 1.2
                else:
                    break
            self.assertEqual(process.returncode, code, err)
            self.assertIn("--resume goes on", err)
            self.assertTrue((self.folder / "a.exr.checkpoint").exists())
            part = json.loads((self.folder / "a.json").read_text())
            self.assertTrue(part["interrupted"])
            self.assertLess(part["mutations"], stats["mutations"])
            # What was interrupted can be repeated, too.
            self.ulam("render", "--replay", "a.json", "-o", "part.exr")
            self.assertEqual(self.image("part.exr"), self.image("a.exr"))
            # Another run does not take it for its own.
            err = self.ulam("render", "cornell_box", "--sampler", "mlt", "--spp", "401", *FILM, "-o", "a.exr", "--resume",
                            expect=4)
            self.assertIn("/budget/spp is 401", err)
            self.ulam(*arguments, "--resume")
            self.assertEqual(self.image("a.exr"), whole)
            resumed = json.loads((self.folder / "a.json").read_text())
            self.assertEqual(resumed["sessions"], 2)
            self.assertEqual(resumed["image_sha256"], stats["image_sha256"])

    def test_runs_limited_by_time_are_repeated_by_their_results(self):
        for sampler in SAMPLERS:
            with self.subTest(sampler=sampler):
                self.ulam("render", "cornell_box", "--sampler", sampler, "--time", "0.4", *FILM, "-o", "timed.exr",
                          "--stats", "timed.json", "--seed", "3")
                self.ulam("render", "--replay", "timed.json", "-o", "again.exr", "--threads", "1")
                self.assertEqual(self.image("again.exr"), self.image("timed.exr"))

    def test_replicates_of_an_experiment_are_repeated_by_their_results(self):
        (self.folder / "scene.json").write_text(json.dumps(SCENE))
        (self.folder / "experiment.json").write_text(json.dumps(EXPERIMENT))
        self.ulam("run", "experiment.json", "-o", "out")
        results = sorted((self.folder / "out").glob("cells/*/r*/result.json"))
        self.assertEqual(len(results), 8)
        for result in results:
            self.ulam("render", "--replay", result, "-o", "again.exr")
            self.assertEqual(self.image("again.exr"), (result.parent / "image.exr").read_bytes())
        # A scene that has changed is not taken for the same.
        (self.folder / "scene.json").write_text(json.dumps(dict(SCENE, lamp=dict(SCENE["lamp"], intensity=5))))
        of_file = next(r for r in results if "file" in str(r))
        self.assertIn("a file has changed", self.ulam("render", "--replay", of_file, "-o", "again.exr", expect=4))

    def test_a_long_replicate_goes_on_where_it_was_stopped(self):
        experiment = dict(EXPERIMENT, scenes={"box": {"type": "cornell_box"}}, budget={"spp": 6000}, replicates=1,
                          samplers={"mlt": {"type": "mlt"}}, baseline="mlt")
        (self.folder / "long.json").write_text(json.dumps(experiment))
        self.ulam("run", "long.json", "-o", "whole")
        (result,) = (self.folder / "whole").glob("cells/*/r000/result.json")
        seconds = json.loads(result.read_text())["wall_seconds"]
        process = self.start("run", "long.json", "-o", "stopped")
        place = self.folder / "stopped" / result.parent.relative_to(self.folder / "whole")
        while not place.exists() and process.poll() is None:
            time.sleep(0.01)
        time.sleep(seconds / 2)
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 143, err)
        self.assertEqual([f.name for f in place.iterdir()], ["checkpoint"])
        with tempfile.NamedTemporaryFile("r") as log:
            self.ulam("run", "long.json", "-o", "stopped", "--resume",
                      variables={"LD_PRELOAD": FAULTS, "ULAM_FAULT_BELOW": str(self.folder.resolve()) + "/", "ULAM_FAULT_LOG": log.name})
            calls = log.read().splitlines()
        # A state may be most of the memory: it is read once.
        self.assertEqual(calls.count(f"open-read {(place / 'checkpoint').resolve()}"), 1, calls)
        again = json.loads((place / "result.json").read_text())
        self.assertEqual(again["sessions"], 2)
        self.assertEqual((place / "image.exr").read_bytes(), (result.parent / "image.exr").read_bytes())
        self.assertFalse((place / "checkpoint").exists())

    def test_repetitions_and_threads_make_the_same_bytes(self):
        for sampler in SAMPLERS:
            self.render(sampler, "first.exr", "--threads", "1")
            for turn in range(100 if FULL else 2):
                threads = (2, 8, 3, 1)[turn % 4]
                self.render(sampler, "again.exr", "--threads", threads)
                self.assertEqual(self.image("again.exr"), self.image("first.exr"), (sampler, threads))


if __name__ == "__main__":
    unittest.main()
