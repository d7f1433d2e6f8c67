#!/usr/bin/env python3
"""Every place where the program meets the file system, with every fault: no crash, exit code 6 and the file's name, no torn
file, old bytes kept, nothing left over, and a run that goes on ends as if nothing had happened.

A fault is put before the C library (faults.cpp). Quick: a sample of the places, by a fixed seed; full: all of them.
"""

import collections
import itertools
import json
import os
import pathlib
import random
import shutil
import sys
import tempfile
import time
import unittest

import tiny

FAULTS = os.path.abspath(os.environ.get("ULAM_FAULTS", "build/release/tests/libulam_faults.so"))
REFUSALS = ["ENOSPC", "EIO", "EROFS", "EACCES"]
FAULTS_OF = {
    "open": REFUSALS + ["EINTR", "KILL"],
    "open-read": ["EIO", "EACCES"],
    "open-folder": ["EIO", "EACCES"],
    "write": ["ENOSPC", "EIO", "EINTR", "SHORT", "KILL"],
    "fsync": ["ENOSPC", "EIO", "EINTR", "KILL"],
    "fsync-folder": ["EIO", "EINTR"],
    "close": ["ENOSPC", "EIO", "EINTR"],
    "rename": REFUSALS + ["KILL"],
    "mkdir": REFUSALS + ["KILL"],
    "ftruncate": ["EIO", "EACCES"],
    "unlink": ["EIO", "EROFS", "KILL"],
    "flock": ["ENOLCK", "EINTR"],
}
SURVIVED = ("EINTR", "SHORT", "ENOLCK")

Place = collections.namedtuple("Place", "operation number file")


class Case:
    """A command, what is there before, and what is to be there afterwards. Each run has a folder of its own."""

    def __init__(self, name, arguments, prepare=None, again=None):
        self.name, self.arguments, self.prepare = name, arguments, prepare
        self.again = again or arguments  # the command that goes on

    def fresh(self):
        temporary = tempfile.TemporaryDirectory(prefix="ulam-faults-")
        folder = pathlib.Path(temporary.name).resolve()
        if self.prepare:
            shutil.copytree(self.prepare, folder, dirs_exist_ok=True)
        else:
            tiny.write_inputs(folder)
        return temporary, folder


def variables(folder, fault="", log=""):
    # The inputs are made by the test, not by the program.
    return {"LD_PRELOAD": FAULTS, "ULAM_FAULT_BELOW": str(folder) + "/", "ULAM_FAULT": fault, "ULAM_FAULT_LOG": str(log)}


def places_of(case):
    """Every call of an undisturbed run, with the file that it is about: of a temporary one, what it becomes."""
    temporary, folder = case.fresh()
    with temporary, tempfile.NamedTemporaryFile("r") as log:
        done = tiny.call(case.arguments, folder, variables(folder, log=log.name))
        assert done.returncode == 0, done.err
        lines = [[word, *map(os.path.normpath, names)] for word, *names in (line.split(" ") for line in log.read().splitlines())]
    counts, found = collections.Counter(), []
    for i, (operation, *names) in enumerate(lines):
        counts[operation] += 1
        file = names[-1]
        if ".ulam-" in file:
            file = next((later[2] for later in lines[i:] if later[0] == "rename" and later[1] == names[-1]), file)
        found.append(Place(operation, counts[operation], file[len(str(folder)) + 1:]))
    return found


def is_convenience(place):
    """What a run can do without: it says so, or it is only slower the next time, or it is at the end of a lock."""
    return (place.file + "/").startswith("cache/") or place.file.endswith("checkpoint") or \
        place.operation == "close" and place.file.endswith(".lock")


def in_turns(trials):
    """In random order, and kinds of places one after the other, so that the first trials are a fair sample."""
    random.Random(5).shuffle(trials)
    kinds = collections.defaultdict(list)
    for case, place, *rest in trials:
        kinds[case.name, place.operation].append((case, place, *rest))
    return [trial for turn in itertools.zip_longest(*kinds.values()) for trial in turn if trial]


class Faults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="ulam-faults-")
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.base = pathlib.Path(cls.temporary.name).resolve()
        finished = cls.base / "finished"
        finished.mkdir()
        tiny.write_inputs(finished)
        done = tiny.call(tiny.run_arguments(), finished)
        assert done.returncode == 0, done.err
        cls.run_done = tiny.Undisturbed(finished)
        # Older files of the same names, to be replaced.
        older = cls.base / "older"
        older.mkdir()
        tiny.write_inputs(older)
        cls.render = ["render", "scene.json", "--sampler", "path", "--spp", 4, "-o", "out.exr", "--stats", "out.json",
                      "--threads", 1, "--quiet"]
        cls.export = ["scene", "scene.json", "--export", "mitsuba3", "out"]
        for arguments in (cls.render + ["--seed", 9], cls.export):
            done = tiny.call(arguments, older)
            assert done.returncode == 0, done.err
        cls.finished, cls.older = finished, older

    def cases(self):
        return [
            Case("run", tiny.run_arguments(), again=tiny.run_arguments("--resume")),
            Case("resume", tiny.run_arguments("--resume"), self.finished),
            Case("render", self.render, self.older),
            Case("export", self.export, self.older),
            Case("report", ["report", "run"], self.finished),
        ]

    def check(self, case, place, fault, sticky, clean):
        temporary, folder = case.fresh()
        with temporary:
            before = tiny.files(folder)
            text = f"{place.operation}:{place.number}:{fault}{':sticky' if sticky else ''}"
            done = tiny.call(case.arguments, folder, variables(folder, text))
            where = f"{case.name}, {text}, {place.file}\nexit {done.returncode}: {done.err}"
            now = tiny.files(folder)

            if fault == "KILL":
                self.assertEqual(done.returncode, -9, where)
            else:
                self.assertFalse(tiny.crashed(done), where)
                reads = place.operation == "open-read"
                self.assertIn(done.returncode, (0, 4, 5, 6) if reads else (0, 6), where)
                if done.returncode != 0:
                    # A sticky fault may be survived in one place and not in a later one.
                    named = {other.file for other in case.places} if sticky else {place.file}
                    self.assertTrue(any(name.split("/")[-1] in done.err for name in named), where)
                if fault in SURVIVED:
                    self.assertEqual(done.returncode, 0, where)
                elif place.operation in ("open", "write", "fsync", "close", "rename", "mkdir") and not is_convenience(place):
                    self.assertEqual(done.returncode, 6, where)

            # Nothing is torn: every file is the old one or the new one.
            for name, data in now.items():
                if ".ulam-" in name or name.endswith(".lock"):
                    continue
                self.assertTrue(tiny.is_whole(name, data), f"{name} is torn: {where}")
                if name.endswith(".exr") and name in clean:
                    self.assertIn(data, (clean[name], before.get(name)), f"{name} is torn: {where}")
            for name in before:
                if not (case.name == "export" and fault == "KILL"):
                    self.assertTrue(name in now or tiny.is_temporary(name), f"{name} is gone: {where}")
            if fault != "KILL" and place.operation not in ("unlink", "open-folder"):
                self.assertEqual([n for n in now if ".ulam-" in n], [], where)

            # Going on ends as if nothing had happened.
            again = tiny.call(case.again, folder)
            self.assertEqual(again.returncode, 0, f"{where}\nthen {again.err}")
            end = tiny.files(folder)
            self.assertEqual([n for n in end if tiny.is_temporary(n)], [], where)
            if case.name in ("run", "resume", "report"):
                self.assertEqual(self.run_done.differences(folder), [], where)
            else:
                for name, data in clean.items():
                    if name.endswith(".exr") or case.name == "export":
                        self.assertEqual(end.get(name), data, f"{name}: {where}")

    def trials(self):
        """Every place of every case with every fault."""
        for case in self.cases():
            places = case.places = places_of(case)
            temporary, folder = case.fresh()
            with temporary:
                self.assertEqual(tiny.call(case.arguments, folder).returncode, 0)
                clean = tiny.files(folder)
            # A library that caught nothing would make every trial pass.
            operations = {place.operation for place in places}
            self.assertLessEqual({"open", "write", "fsync", "close", "rename"}, operations, case.name)
            for place in places:
                for fault in FAULTS_OF[place.operation]:
                    yield case, place, fault, False, clean
                    if fault in REFUSALS:
                        yield case, place, fault, True, clean

    def test_every_place_with_every_fault(self):
        trials = list(self.trials())
        seconds = float(os.environ.get("ULAM_FAULT_SECONDS", "inf" if tiny.FULL else "14"))
        trials = in_turns(trials)
        start, done = time.process_time() + sum(os.times()[2:4]), 0
        tally = collections.Counter()
        for case, place, fault, sticky, clean in trials:
            with self.subTest(case=case.name, place=place, fault=fault, sticky=sticky):
                self.check(case, place, fault, sticky, clean)
            tally[case.name] += 1
            if done % 100 == 99:
                print(done + 1, "of", len(trials), file=sys.stderr)
            done += 1
            if time.process_time() + sum(os.times()[2:4]) - start > seconds:
                break
        print(f"{done} of {len(trials)} trials: {dict(tally)}")
        self.assertGreater(done, 10)


if __name__ == "__main__":
    unittest.main()
