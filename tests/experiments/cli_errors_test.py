#!/usr/bin/env python3
"""Mistakes and mishaps: each ends with the exit code of its kind and says what is wrong."""

import json
import os
import pathlib
import resource
import shlex
import signal
import subprocess
import time
import unittest

from cli_test import EXPERIMENT, SCENE, ULAM, CliTest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.path.abspath(ULAM)
TOO_LONG = 300 * "n"


class Files(CliTest):
    def refused(self, code, *arguments):
        message = self.ulam(*arguments, expect=code).stderr
        self.assertNotIn("internal error", message)
        return message

    def test_names_that_cannot_be_written_are_exit_6(self):
        self.write("tiny.json", EXPERIMENT)
        (self.folder / "ring.exr").symlink_to("ring.exr")
        render = ["render", "scene.json", "--sampler", "path", "--spp", 1, "--quiet", "-o"]
        self.assertIn("symbolic links", self.refused(6, *render, "ring.exr"))
        self.assertIn("too long", self.refused(6, *render, TOO_LONG + ".exr"))
        self.assertIn("too long", self.refused(6, *render, "out.exr", "--stats", TOO_LONG))
        self.assertFalse((self.folder / "out.exr").exists())
        self.assertIn("too long", self.refused(6, "run", "tiny.json", "--quiet", "-o", TOO_LONG))
        self.assertIn("too long", self.refused(6, "new", "mutation", TOO_LONG, "--folder", "."))
        self.assertEqual(list(self.folder.glob(".ulam-*")), [])

    def test_names_that_cannot_be_read_are_exit_5(self):
        for plugin in "", TOO_LONG:
            self.refused(5, "list", "mutations", "--plugin", plugin)
        for folder in "none", TOO_LONG:
            self.refused(5, "new", "mutation", "step", "--folder", folder)

    def test_image_and_numbers_are_two_files(self):
        (self.folder / "below").mkdir()
        (self.folder / "link").symlink_to("below")
        for output, stats in (("a.exr", "a.exr"), ("a.exr", "./a.exr"), ("a.exr", self.folder / "below/../a.exr"),
                              ("below/a.exr", "link/a.exr")):
            message = self.refused(2, "render", "scene.json", "--sampler", "path", "--spp", 1, "-o", output,
                                   "--stats", stats)
            self.assertIn("same file", message)
        self.render("--stats", "below/out.exr")

    def test_an_interrupted_render_without_an_image_keeps_the_old_one(self):
        (self.folder / "out.exr").write_text("old")
        away = json.dumps([{"type": "lookat", "origin": [0, 0, 4], "target": [0, 0, 9], "up": [0, 1, 0]}])
        process = subprocess.Popen([PROGRAM, "render", "scene.json", "--sampler", "path", "--time", "60", "-o", "out.exr",
                                    "--stats", "out.json", "--set", "scene.sensor.to_world=" + away],
                                   cwd=self.folder, stderr=subprocess.PIPE, text=True)
        time.sleep(3)
        process.send_signal(signal.SIGINT)
        _, message = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130, message)
        self.assertIn("no image is written", message)
        self.assertEqual((self.folder / "out.exr").read_text(), "old")
        self.assertFalse((self.folder / "out.json").exists())


class Resources(CliTest):
    def test_results_that_cannot_be_printed_are_exit_6(self):
        self.write("tiny.json", EXPERIMENT)
        commands = [["schema", "scene"], ["schema", "experiment"], ["list", "samplers"], ["--help"], ["--version"],
                    ["scene", "scene.json", "--info", "--json"], ["run", "tiny.json", "--dry-run"],
                    ["run", "tiny.json", "--dry-run", "--json"], ["run", "tiny.json", "--quiet", "--json"]]
        for command in commands:
            for redirection in ">/dev/full", ">&-":
                with self.subTest(command=command, redirection=redirection):
                    done = subprocess.run(f"{shlex.join([PROGRAM, *command])} {redirection}", shell=True, cwd=self.folder,
                                          env=self.environment, stderr=subprocess.PIPE, text=True, timeout=300)
                    self.assertEqual(done.returncode, 6, done.stderr)
                    self.assertIn("ulam: cannot write to the standard output", done.stderr)

    def test_messages_that_cannot_be_printed_leave_the_exit_code(self):
        done = subprocess.run(f"{shlex.quote(PROGRAM)} rendr 2>/dev/full", shell=True, cwd=self.folder, timeout=60)
        self.assertEqual(done.returncode, 2)

    def test_too_little_memory_is_exit_4(self):
        def little():
            resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))

        start = [PROGRAM, "--version"]
        if subprocess.run(start, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=little).returncode != 0:
            self.skipTest("sanitizers need more")
        done = subprocess.run([PROGRAM, "render", "scene.json", "--sampler", "path", "--spp", "1", "--threads", "1",
                               "--quiet", "-o", "out.exr", "--set", "scene.film.width=8192",
                               "--set", "scene.film.height=8192"],
                              cwd=self.folder, stderr=subprocess.PIPE, text=True, timeout=60, preexec_fn=little)
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertIn("ulam: out of memory: ", done.stderr)


class Arguments(CliTest):
    def test_seeds_do_not_wrap(self):
        for seed in "-1", "99999999999999999999", "1.5", "many", "":
            with self.subTest(seed=seed):
                self.assertIn("--seed", self.render("--seed", seed, expect=2).stderr)
                self.assertIn("--seed", self.ulam("verify", "--seed", seed, expect=2).stderr)
        self.render("--seed", 2**64 - 1, "--stats", "out.json")
        self.assertEqual(json.loads((self.folder / "out.json").read_text())["seed"], 2**64 - 1)

    def test_unknown_options_name_the_nearest(self):
        for arguments, unknown, nearest in (
                (["render", "scene.json", "--smapler", "path", "--spp", 1, "-o", "x.exr"], "--smapler", "--sampler"),
                (["render", "scene.json", "--sampler", "path", "--sp=1", "-o", "x.exr"], "--sp", "--spp"),
                (["run", "none.json", "--dryrun"], "--dryrun", "--dry-run"),
                (["list", "samplers", "--jsn"], "--jsn", "--json"),
                (["new", "mutation", "step", "--foldr", "."], "--foldr", "--folder"),
                (["--versoin"], "--versoin", "--version")):
            with self.subTest(arguments=arguments):
                message = self.ulam(*arguments, expect=2).stderr
                self.assertIn(f'unknown option "{unknown}"', message)
                self.assertIn(f'did you mean "{nearest}"?', message)
        self.assertIn('unknown option "--foo" of ulam; see ulam --help', self.ulam("--foo", expect=2).stderr)
        self.assertIn('"mutation"', self.ulam("new", "mutatoin", "step", expect=2).stderr)

    def test_film_errors_name_their_argument(self):
        self.assertIn("--set scene.film.width=0", self.render("--set", "scene.film.width=0", expect=4).stderr)
        self.assertIn("--set scene.film.rfilter.type=bx",
                      self.render("--set", "scene.film.rfilter.type=bx", expect=4).stderr)
        self.write("zero.json", dict(SCENE, sensor=dict(SCENE["sensor"], film={"type": "hdrfilm", "width": 0})))
        self.assertIn("zero.json:1:", self.ulam("render", "zero.json", "--sampler", "path", "--spp", 1, "-o", "x.exr",
                                                "--set", "scene.film.height=8", expect=4).stderr)


class New(CliTest):
    def test_mutations_of_any_name_compile(self):
        names = ["mutation", "sample", "random", "proposal", "space", "path", "scene", "kernel", "step_context", "registry",
                 "primary_vector", "json", "reject", "class", "x1"]
        for name in names:
            self.ulam("new", "mutation", name, "--folder", ".")
        (self.folder / "all.cpp").write_text("".join(f'#include "{name}.cpp"\n' for name in names))
        flags = subprocess.run(["pkg-config", "--cflags", "Imath"], stdout=subprocess.PIPE, text=True, check=True).stdout
        subprocess.run(["g++", "-std=c++20", "-march=native", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-I", ROOT,
                        *flags.split(), "all.cpp"], cwd=self.folder, check=True, timeout=300)


if __name__ == "__main__":
    unittest.main()
