#!/usr/bin/env python3
"""Runs as jobs, with commands in place of Slurm's that say what each test wants: what is submitted when, what "until" adds, and
what status makes of the answers. Slurm itself is in slurm_test.py."""

import json
import pathlib
import shutil
import sys
import tempfile
import unittest

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "faults"))
import tiny

# Undecided between equal samplers, decided where one is worse: looks at 5, 10 and 15 replicates.
EXPERIMENT = dict(tiny.EXPERIMENT, replicates=5, snapshots=0, until={"relative_ci": 0.001, "max_replicates": 15},
                  samplers={"path": {"type": "path"}, "again": {"type": "path"}, "light": {"type": "light"}},
                  reference={"sampler": "path", "budget": {"spp": 4096}, "part": {"spp": 1024}})

COMMANDS = {
    "sbatch": 'echo >> numbers; wc -l < numbers',
    "squeue": 'cat squeue.txt',
    "scontrol": 'echo "MaxArraySize            = 1001"',
    "sacct": 'echo "$@" > sacct-arguments.txt; cat sacct.txt',
}


class Jobs(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="ulam-jobs-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name).resolve()
        (self.folder / "bin").mkdir()
        for name, lines in COMMANDS.items():
            self.command(name, lines)
        self.queue()

    def command(self, name, lines):
        file = self.folder / "bin" / name
        file.write_text(f"#!/bin/sh\nPATH=/usr/bin:/bin\ncd {self.folder}\n{lines}\n")
        file.chmod(0o755)

    def queue(self, *lines, ended=()):
        (self.folder / "squeue.txt").write_text("".join(line + "\n" for line in lines))
        (self.folder / "sacct.txt").write_text("".join(line + "\n" for line in ended))

    def ulam(self, *arguments, expect=0):
        process = tiny.call(arguments, self.folder, {"PATH": f"{self.folder}/bin"})
        self.assertEqual(process.returncode, expect, f"{arguments}\n{process.out}\n{process.err}")
        return process

    def submit(self, *more):
        """Replicates by kind of array, and what was said."""
        process = self.ulam(*tiny.run_arguments("--jobs", "slurm", "--json", *more))
        return {array["kind"]: array["replicates"] for array in json.loads(process.out)}, process.err

    def work(self, expect=0):
        return self.ulam("work", "run", "--threads", 1, "--quiet", expect=expect)

    def replicates(self, run="run"):
        resolved = json.loads((self.folder / run / "resolved.json").read_text())
        return {cell["sampler"]: cell["replicates"] for cell in resolved["cells"]}

    def status(self):
        return json.loads(self.ulam("status", "run", "--json").out)["slurm"]

    def test_until_adds_what_a_run_without_jobs_adds(self):
        tiny.write_inputs(self.folder, EXPERIMENT)
        self.ulam("run", "tiny.json", "-o", "alone", "--threads", 1, "--quiet")
        self.assertEqual(self.replicates("alone"), {"path": 15, "again": 15, "light": 5})
        shutil.rmtree(self.folder / "cache")

        submitted, said = self.submit()
        self.assertEqual(submitted, {"references": 4, "cells": 15})
        self.assertIn('"until" looks at the errors when these replicates are there', said)
        for job, reached in ((2, 5), (3, 10)):
            # While a task has replicates to make nothing is looked at, and what there is stays; nor does it fall back to
            # the first look where a task whose replicates are there is run once more.
            self.queue(*(f"{n}_0|RUNNING|None" for n in range(1, job + 1)))
            submitted, said = self.submit("--resume")
            self.assertEqual(submitted, {})
            self.assertEqual(self.replicates(), {"path": reached, "again": reached, "light": 5})
            # One that has ended is in no queue, though squeue still knows it.
            self.work()
            self.queue(f"{job}_0|COMPLETED|None")
            submitted, said = self.submit("--resume")
            self.assertEqual(submitted, {"cells": 10})
            self.assertIn("not decided yet: 10 replicates more", said)
            self.assertEqual(self.replicates(), {"path": reached + 5, "again": reached + 5, "light": 5})
        self.work()
        submitted, said = self.submit("--resume")
        self.assertEqual(submitted, {})
        self.assertIn('"until" asks for no more replicates', said)

        self.ulam(*tiny.run_arguments("--resume"))
        self.assertEqual(self.replicates(), self.replicates("alone"))
        summaries = [json.loads((self.folder / run / "summary.json").read_text()) for run in ("alone", "run")]
        self.assertEqual(*map(tiny.without_times, summaries))

    def test_until_waits_for_what_failed_or_is_told_not_to(self):
        tiny.write_inputs(self.folder, EXPERIMENT)
        self.submit()
        self.work()
        failed = self.folder / "run/cells/wall-again/r002"
        shutil.rmtree(failed)
        failed.mkdir()
        record = json.dumps({"message": "broken", "host": "n1", "time": "then"})
        for more, expected in (((), 1), (("--keep-going",), 11)):
            (failed / "failed.json").write_text(record)
            submitted, said = self.submit("--resume", *more)
            self.assertEqual(submitted, {"cells": expected})
            self.assertEqual("not decided yet" in said, expected > 1)

    def test_parts_that_nobody_combined(self):
        tiny.write_inputs(self.folder, EXPERIMENT)
        self.submit()
        (reference,) = (self.folder / "run/references").iterdir()
        name = json.loads((self.folder / "run/jobs/001/tasks.json").read_text())["tasks"][0][0][0]
        # The last part first and the others later: so nobody ever sees all of them.
        for parts in ([3], [0, 1, 2]):
            (self.folder / "share.json").write_text(json.dumps({"tasks": [[[name, part] for part in parts]]}))
            self.ulam("work", "run", "--threads", 1, "--quiet", "--task", "share.json:0")
            (reference / "parts").rename(self.folder / f"parts-{len(parts)}")
        (self.folder / "parts-1/r003").rename(self.folder / "parts-3/r003")
        (self.folder / "parts-3").rename(reference / "parts")
        submitted, _ = self.submit("--resume")
        self.assertEqual(submitted["references"], 1)
        self.ulam("work", "run", "--threads", 1, "--quiet", "--task", "run/jobs/003/tasks.json:0")
        self.assertTrue((reference / "image.exr").exists())
        self.assertFalse((reference / "parts").exists())

    def test_status_tells_what_became_of_each_task(self):
        tiny.write_inputs(self.folder, EXPERIMENT)
        self.ulam(*tiny.run_arguments("--jobs", "slurm:task-minutes=1e-9"))
        self.queue("1_0|COMPLETED|None", "1_1|FAILED|NonZeroExitCode", "1_2|RUNNING|None", "1_3|RUNNING|None",
                   *(f"2_{n}|PENDING|Dependency" for n in (0, 1, 2, 4)), "77_0|PENDING|Priority",
                   ended=("2_3|CANCELLED by 0|0:0", "2_5|FAILED|1:0", "2_6|TIMEOUT|0:0", "1_1|COMPLETED|0:0"))
        references, cells = self.status()["arrays"]
        self.assertEqual((references["job"], references["kind"], references["tasks"], references["folder"]), ("1", "references", 4, "jobs/001"))
        states = lambda array: {(group["state"], group["reason"]): group["tasks"] for group in array["states"]}
        self.assertEqual(states(references), {("COMPLETED", ""): [0], ("FAILED", "NonZeroExitCode"): [1], ("RUNNING", ""): [2, 3]})
        self.assertEqual(states(cells), {("PENDING", "Dependency"): [0, 1, 2, 4], ("CANCELLED", ""): [3], ("FAILED", "exit code 1:0"): [5],
                                         ("TIMEOUT", ""): [6], ("ENDED", ""): list(range(7, 15))})
        self.assertIn("--jobs=2\n", (self.folder / "sacct-arguments.txt").read_text())
        text = self.ulam("status", "run").out
        for line in ("job 2: cells, 15 tasks, logs in jobs/002", "PENDING (Dependency): 2_[0-2,4]", "FAILED (NonZeroExitCode): 1_[1]"):
            self.assertIn(line + "\n", text)

    def test_status_without_answers(self):
        tiny.write_inputs(self.folder, EXPERIMENT)
        self.submit()
        self.command("squeue", "echo 'no controller' >&2; exit 1")
        self.queue(ended=("1_0|COMPLETED|0:0",))
        status = self.status()
        self.assertEqual([[group["state"] for group in array["states"]] for array in status["arrays"]], [["COMPLETED"], ["UNKNOWN"]])
        self.assertEqual(status["trouble"], ["squeue does not tell what becomes of the jobs: no controller"])
        (self.folder / "bin/sacct").unlink()
        process = self.ulam("status", "run")
        self.assertIn("15 replicates: 15 missing\n", process.out)
        self.assertIn("UNKNOWN: 2_[0]\n", process.out)
        self.assertTrue(process.out.endswith("squeue does not tell what becomes of the jobs: no controller\n"
                                             "sacct is no command here: are Slurm's commands installed?\n"), process.out)
        shutil.rmtree(self.folder / "run/jobs")  # a run without jobs: nobody is asked
        self.assertTrue(self.ulam("status", "run").out.endswith("15 missing\n"))
        self.assertNotIn("slurm", json.loads(self.ulam("status", "run", "--json").out))


if __name__ == "__main__":
    unittest.main()
