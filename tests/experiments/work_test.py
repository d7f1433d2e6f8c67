#!/usr/bin/env python3
"""Several processes at one run: they share the work, take over from those that die, and leave what a single one leaves."""

import contextlib
import fcntl
import json
import os
import pathlib
import shutil
import signal
import sys
import tempfile
import threading
import time
import unittest

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "faults"))
import tiny

EXPERIMENT = dict(tiny.EXPERIMENT, replicates=6, reference=dict(tiny.EXPERIMENT["reference"], part={"spp": 8}))


@contextlib.contextmanager
def open_folder(folder):
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        yield descriptor
    finally:
        os.close(descriptor)


class Work(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="ulam-work-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name).resolve()

    def start(self, *arguments, variables=None):
        process = tiny.start(arguments, self.folder, variables)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def ulam(self, *arguments, expect=0):
        process = tiny.call(arguments, self.folder)
        self.assertEqual(process.returncode, expect, f"{arguments}\n{process.out}\n{process.err}")
        return process

    def work(self, *more):
        return ["work", "run", "--threads", 1, "--quiet", "--lease", 2, *more]

    def wait_for(self, condition):
        end = time.monotonic() + 60
        while not condition():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)

    def status(self):
        return json.loads(self.ulam("status", "run", "--json").out)

    def begin(self, experiment=EXPERIMENT):
        """A finished run of a single process, in `alone`, and the same one before anything is done, in `run`."""
        tiny.write_inputs(self.folder, experiment)
        self.ulam("run", "tiny.json", "-o", "alone", "--threads", 1, "--quiet")
        self.start_again()

    def start_again(self):
        shutil.rmtree(self.folder / "run", ignore_errors=True)
        shutil.rmtree(self.folder / "cache", ignore_errors=True)
        (self.folder / "run").mkdir()
        for name in ("experiment.json", "resolved.json"):
            shutil.copy(self.folder / "alone" / name, self.folder / "run" / name)

    def compare(self):
        """With a single process's run, after the summary is made."""
        self.ulam(*tiny.run_arguments("--resume"))
        alone, run = tiny.files(self.folder / "alone"), tiny.files(self.folder / "run")
        self.assertEqual(sorted(alone), sorted(run))
        for name, data in alone.items():
            if name.endswith(".exr"):
                self.assertEqual(run[name], data, name)
        summaries = [tiny.without_times(json.loads(files["summary.json"])) for files in (alone, run)]
        self.assertEqual(*summaries)

    def put_lease(self, place, number, age, seconds=2):
        place.mkdir(parents=True, exist_ok=True)
        lease = place / f"lease-{number}"
        lease.write_text(json.dumps({"host": "elsewhere", "process": 1, "since": "then", "seconds": seconds}))
        os.utime(lease, (time.time() - age,) * 2)
        return lease

    def test_workers_of_whom_one_is_killed(self):
        slow = dict(EXPERIMENT, budget={"spp": 2000}, replicates=3)
        self.begin(slow)
        for joined in (False, True):
            with self.subTest(joined=joined):
                self.start_again()
                first = self.start(*(tiny.run_arguments("--resume", "--lease", 2) if joined else self.work()))
                others = [self.start(*self.work()) for _ in range(2)]
                # Of the others: the first one makes the summary.
                leases = lambda: [lease for lease in self.folder.glob("run/**/lease-*")
                                  if f'"process":{others[0].pid},' in lease.read_text()]
                self.wait_for(lambda: self.quiet(leases))
                others[0].send_signal(signal.SIGKILL)
                self.assertEqual(others[0].wait(), -9)
                for process in (first, others[1]):
                    out, err = process.communicate(timeout=120)
                    self.assertEqual(process.returncode, 0, err)
                totals = self.status()["totals"]
                self.assertEqual((totals["done"], totals["replicates"]), (6, 6))
                self.compare()

    @staticmethod
    def quiet(find):
        try:
            return find()
        except OSError:  # released in the meantime
            return False

    def test_a_lease_of_another_host_is_waited_for_until_it_expires(self):
        self.begin()
        lease = self.put_lease(self.folder / "run/cells/wall-path/r002", 1, age=0)
        (reference,) = (self.folder / "alone/references").iterdir()
        part = self.put_lease(self.folder / "run/references" / reference.name / "parts/r001", 1, age=100)
        ended = threading.Event()
        holder = threading.Thread(target=lambda: [os.utime(lease) for _ in iter(lambda: ended.wait(0.1), True)])
        holder.start()
        self.addCleanup(holder.join)
        self.addCleanup(ended.set)
        worker = self.start(*self.work())
        self.wait_for(lambda: len(list(self.folder.glob("run/cells/*/r*/result.json"))) == 11)
        time.sleep(2.5)  # longer than a lease
        self.assertIsNone(worker.poll())
        status = self.status()
        self.assertEqual(status["totals"]["running"], 1)
        (running,) = next(cell for cell in status["cells"] if cell["cell"] == "wall-path")["running"]
        self.assertEqual((running["replicate"], running["host"], running["since"]), (2, "elsewhere", "then"))
        self.assertEqual(status["references"][0]["state"], "ready")
        self.assertFalse(part.exists())
        self.assertIn("running: wall-path, replicate 3 of 6: process 1 on elsewhere, since then", self.ulam("status", "run").out)
        # Nobody renews it any more.
        ended.set()
        _, err = worker.communicate(timeout=60)
        self.assertEqual(worker.returncode, 0, err)
        self.compare()

    def test_budgets_of_time_take_turns_on_a_machine(self):
        tiny.write_inputs(self.folder, dict(EXPERIMENT, budget={"time": 0.05}, replicates=2))
        (self.folder / "ulam-clock").mkdir()
        with open_folder(self.folder / "ulam-clock") as clock:
            fcntl.flock(clock, fcntl.LOCK_EX)
            worker = self.start(*tiny.run_arguments(), variables={"TMPDIR": str(self.folder)})
            self.wait_for(lambda: list(self.folder.glob("run/references/*/image.exr")))
            time.sleep(1)  # enough for all of them
            self.assertIsNone(worker.poll())
            self.assertEqual(list(self.folder.glob("run/cells/*/r*")), [])
        _, err = worker.communicate(timeout=60)
        self.assertEqual(worker.returncode, 0, err)
        self.assertEqual(err.count("waits: another process on this machine renders for a budget of time"), 1, err)
        self.assertEqual(len(list(self.folder.glob("run/cells/*/r*/result.json"))), 4)

    def test_failures_are_told_and_not_tried_by_everybody(self):
        tiny.write_inputs(self.folder)
        self.ulam("render", "scene.json", "--sampler", "path", "--spp", 16, "-o", "lit.exr", "--quiet")
        dark = {key: value for key, value in tiny.SCENE.items() if key != "lamp"}
        experiment = dict(EXPERIMENT, reference={"image": "lit.exr", "variance": "lit.exr"}, replicates=2)
        tiny.write_inputs(self.folder, experiment)
        (self.folder / "scene.json").write_text(json.dumps(dict(dark, lamp={"type": "point", "position": [0, 0, -2], "intensity": 1})))
        ended = self.ulam(*tiny.run_arguments(), expect=4)
        reason = ended.err.strip().splitlines()[-1].split(": ", 2)[2]
        status = self.status()
        self.assertEqual(status["totals"]["failed"], 1, status)
        for _ in range(2):
            self.assertIn("2 pieces of work failed", self.ulam(*self.work(), expect=1).err)
        (cell,) = [cell for cell in self.status()["cells"] if cell["failed"]]
        self.assertEqual([failed["message"] for failed in cell["failed"]], [reason, reason])
        self.assertIn(f"failed: wall-pssmlt, replicate 1 of 2: {reason}", self.ulam("status", "run").out)
        # With light it is another plan, which a worker does not make.
        tiny.write_inputs(self.folder, experiment)
        self.assertIn("/scene_hash is", self.ulam(*self.work(), expect=4).err)
        self.ulam(*tiny.run_arguments("--resume"))
        self.assertEqual(list(self.folder.glob("run/**/failed.json")), [])
        self.assertEqual(self.status()["totals"]["done"], 4)

    def test_what_kills_one_process_after_the_other_has_failed(self):
        self.begin()
        self.put_lease(self.folder / "run/cells/wall-path/r002", 5, age=100)
        self.assertEqual(self.status()["totals"]["expired"], 1)
        self.ulam(*self.work(), expect=1)
        status = self.status()
        self.assertEqual(status["totals"]["failed"], 1)
        self.assertIn("processes have ended", json.dumps(status))
        self.compare()

    def test_replicates_that_until_adds_are_shared_too(self):
        self.begin(dict(EXPERIMENT, replicates=4, samplers={"path": {"type": "path"}}, until={"relative_ci": 0.001, "max_replicates": 16},
                        reference={"sampler": "path", "budget": {"spp": 4000}, "part": {"spp": 500}}))
        run = self.start(*tiny.run_arguments("--resume", "--lease", 2))
        self.wait_for(lambda: (self.folder / "run/run.lock").exists())
        worker = self.start(*self.work())
        for process in (run, worker):
            _, err = process.communicate(timeout=120)
            self.assertEqual(process.returncode, 0, err)
        self.assertGreater(self.status()["totals"]["done"], 8)
        self.compare()

    def test_what_jobs_are_is_checked_first(self):
        tiny.write_inputs(self.folder)
        for jobs, message in (("pbs", "expected slurm or slurm:OPTIONS"), ("slurm:array=1", "array is set by ulam"),
                              ("slurm:task-minutes=0", "a number above 0 for task-minutes"), ("slurm:--hold", "expected KEY=VALUE")):
            self.assertIn(message, self.ulam(*tiny.run_arguments("--jobs", jobs), expect=2).err)
        self.assertFalse((self.folder / "run").exists())

    def test_another_plan_is_refused(self):
        self.begin()
        resolved = json.loads((self.folder / "run/resolved.json").read_text())
        for cell in resolved["cells"]:
            cell["budget"]["spp"] = 5
            cell["task_hash"] = "another"
        (self.folder / "run/resolved.json").write_text(json.dumps(resolved))
        self.assertIn("cell wall-path: /budget/spp is 4", self.ulam(*self.work(), expect=4).err)
        self.assertIn("no folder of a run", self.ulam("work", self.folder, expect=5).err)
        self.assertIn("no folder of a run", self.ulam("status", self.folder, expect=5).err)


if __name__ == "__main__":
    unittest.main()
