#!/usr/bin/env python3
"""Several processes and one place to write: one run at a time in a folder, and of renders with one name one wins whole."""

import fcntl
import json
import os
import pathlib
import socket
import tempfile
import time
import unittest

import tiny


class Locks(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="ulam-lock-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name).resolve()
        tiny.write_inputs(self.folder)

    def start(self, *arguments, variables=None):
        process = tiny.start(arguments, self.folder, variables)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def wait_for(self, condition):
        end = time.monotonic() + 60
        while not condition():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.02)

    def test_one_run_in_a_folder(self):
        first = self.start(*tiny.run_arguments("--set", "reference.part.spp=1000000"))
        self.wait_for(lambda: (self.folder / "run/provenance.json").exists())
        for more in ([], ["--resume"]):
            second = tiny.call(tiny.run_arguments(*more), self.folder)
            self.assertEqual(second.returncode, 6, second.err)
            self.assertIn(f"run is in use by process {first.pid} on {socket.gethostname()}", second.err)
        # Another folder is free, and so is this one when its process is gone, in whatever way.
        other = tiny.call(["run", "tiny.json", "-o", "other", "--quiet", "--threads", 1], self.folder)
        self.assertEqual(other.returncode, 0, other.err)
        first.kill()
        first.communicate()
        again = tiny.call(tiny.run_arguments("--resume"), self.folder)
        self.assertEqual(again.returncode, 0, again.err)

    def test_runs_without_a_folder_take_different_ones(self):
        runs = [self.start("run", "tiny.json", "--quiet", "--threads", 1) for _ in range(3)]
        for run in runs:
            out, err = run.communicate(timeout=300)
            self.assertEqual(run.returncode, 0, err)
        for n in (1, 2, 3):
            self.assertTrue((self.folder / f"runs/tiny-{n}/summary.json").exists())

    def render(self, seed, *more, spp=4):
        return ["render", "scene.json", "--sampler", "path", "--spp", spp, "-o", "out.exr", "--stats", "out.json", "--threads", 1,
                "--quiet", "--seed", seed, *more]

    def test_one_render_keeps_its_state_in_a_file(self):
        long = self.render(1, "--checkpoint", 0.01, spp=10**9)
        first = self.start(*long)
        self.wait_for(lambda: (self.folder / "out.exr.checkpoint").exists())
        for more in ([], ["--resume"]):
            second = tiny.call(self.render(2, *more), self.folder)
            self.assertEqual(second.returncode, 6, second.err)
            self.assertIn(f"out.exr is in use by process {first.pid} on {socket.gethostname()}", second.err)
        self.assertTrue((self.folder / "out.exr.checkpoint").exists())
        # One that keeps no state has nothing to share, and the name is free when the process is gone, in whatever way.
        free = tiny.call(self.render(2, "--checkpoint", 0), self.folder)
        self.assertEqual(free.returncode, 0, free.err)
        first.kill()
        first.communicate()
        self.assertTrue((self.folder / "out.exr.lock").exists())
        again = tiny.call(self.render(2), self.folder)
        self.assertEqual(again.returncode, 0, again.err)
        self.assertFalse((self.folder / "out.exr.lock").exists())

    def test_of_renders_that_start_together_those_refused_say_so(self):
        for _ in range(3):
            renders = [self.start(*self.render(seed, spp=2000)) for seed in range(4)]
            codes = []
            for render in renders:
                _, err = render.communicate(timeout=60)
                codes.append(render.returncode)
                if render.returncode:
                    self.assertIn("out.exr is in use by ", err)
            self.assertIn(0, codes)
            self.assertLessEqual(set(codes), {0, 6})
            self.assertFalse((self.folder / "out.exr.lock").exists())

    def test_a_name_too_long_for_a_lock_does_without(self):
        name = 247 * "n" + ".exr"
        done = tiny.call(["render", "scene.json", "--sampler", "path", "--spp", 4, "-o", name, "--threads", 1], self.folder)
        self.assertEqual(done.returncode, 0, done.err)
        self.assertIn("cannot be locked", done.err)
        self.assertTrue((self.folder / name).exists())

    def test_a_render_waits_until_another_has_written_its_files(self):
        folder = os.open(self.folder, os.O_RDONLY | os.O_DIRECTORY)
        self.addCleanup(os.close, folder)
        fcntl.flock(folder, fcntl.LOCK_EX)
        render = self.start(*self.render(1))
        time.sleep(1)
        self.assertIsNone(render.poll())
        self.assertFalse((self.folder / "out.exr").exists())
        fcntl.flock(folder, fcntl.LOCK_UN)
        render.communicate(timeout=60)
        self.assertEqual(render.returncode, 0)
        self.assertTrue((self.folder / "out.exr").exists())

    def test_of_renders_with_one_name_one_wins_whole(self):
        images = {}
        for seed in (1, 2, 3):
            tiny.call(self.render(seed), self.folder)
            images[seed] = (self.folder / "out.exr").read_bytes()
        self.assertEqual(len(set(images.values())), 3)
        for _ in range(3):
            for render in [self.start(*self.render(seed, "--checkpoint", 0)) for seed in images]:
                render.communicate(timeout=60)
                self.assertEqual(render.returncode, 0)
            winner = json.loads((self.folder / "out.json").read_text())["seed"]
            self.assertEqual((self.folder / "out.exr").read_bytes(), images[winner])


if __name__ == "__main__":
    unittest.main()
