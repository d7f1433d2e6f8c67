#!/usr/bin/env python3
"""A storm of SIGKILL at random moments of an experiment that is taken up again after each: no file is ever torn, what is
finished stays as it is, and the end is that of an undisturbed run.

Quick: 20 kills; full: 1000; ULAM_KILLS asks for another number, ULAM_KILL_SEED for other moments. These come from a fixed
seed, but where in its work they find the program depends on the machine.
"""

import os
import pathlib
import random
import subprocess
import sys
import tempfile
import time
import unittest

import tiny

EXPERIMENT = dict(tiny.EXPERIMENT, sweep={"max_depth": [2, 3]}, replicates=6)
KILLS = int(os.environ.get("ULAM_KILLS", 1000 if tiny.FULL else 20))


def finished(folder):
    """Bytes and time of change of every file of a finished replicate, part of a reference, or reference."""
    found = {}
    for result in folder.glob("run/**/result.json"):
        for file in result.parent.rglob("*"):
            name = str(file.relative_to(folder))
            if file.is_file() and not any(part in name for part in (".ulam-", "/lease-", "/checkpoint")):
                found[name] = (file.read_bytes(), file.stat().st_mtime_ns)
    return found


class Storm(unittest.TestCase):
    def folder(self):
        temporary = tempfile.TemporaryDirectory(prefix="ulam-kill-")
        self.addCleanup(temporary.cleanup)
        path = pathlib.Path(temporary.name).resolve()
        tiny.write_inputs(path, EXPERIMENT)
        return path

    def test_storm(self):
        calm = self.folder()
        start = time.monotonic()
        done = tiny.call(tiny.run_arguments(), calm)
        self.assertEqual(done.returncode, 0, done.err)
        seconds = time.monotonic() - start
        undisturbed = tiny.Undisturbed(calm)

        moments = random.Random(int(os.environ.get("ULAM_KILL_SEED", 11)))
        kills = runs = kept = left_over = 0
        folder, before = self.folder(), {}
        # Long enough for something new, not for everything: how long that is changes with what else the machine does.
        span = 0.4 * seconds
        while kills < KILLS:
            process = tiny.start(tiny.run_arguments("--resume"), folder)
            try:
                process.communicate(timeout=moments.uniform(0, span))
            except subprocess.TimeoutExpired:
                process.kill()
                process.communicate()
            # Between the last look and the kill it may have ended by itself.
            self.assertIn(process.returncode, (0, -9))
            kills += process.returncode == -9
            self.assertEqual(undisturbed.torn(folder), [])
            left_over += any(".ulam-" in name for name in tiny.files(folder))
            now = finished(folder)
            for name, state in before.items():
                whole = name.split("/parts/")[0] + "/result.json"
                if "/parts/" in name and whole in now:
                    continue  # parts go when the whole is there
                self.assertEqual(now.get(name), state, f"{name} was finished {kills} kills ago or less, and has changed")
            kept += len(before)
            new = len(now) - len(before)
            span *= 0.8 if process.returncode == 0 or new > 10 else 1.1 if new == 0 else 1
            if kills % 50 == 0:
                print(f"{kills} kills, {runs} runs to the end", file=sys.stderr)
            before = now
            if process.returncode == 0:
                self.assertEqual(undisturbed.differences(folder), [])
                folder, before = self.folder(), {}
                runs += 1
        done = tiny.call(tiny.run_arguments("--resume"), folder)
        self.assertEqual(done.returncode, 0, done.err)
        self.assertEqual(undisturbed.differences(folder), [])
        print(f"{kills} kills in {runs + 1} runs to the end; finished files found unchanged {kept} times; "
              f"temporary files were left {left_over} times and are gone in the end")
        self.assertGreater(kept, KILLS, "most kills come when something is finished")


if __name__ == "__main__":
    unittest.main()
