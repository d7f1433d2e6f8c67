#!/usr/bin/env python3
"""`ulam verify` as people call it: some subjects in the quick suite, every one at both levels in the full one."""

import json
import os
import subprocess
import time
import unittest

ULAM = os.path.abspath(os.environ.get("ULAM", "build/release/ulam"))
FULL = os.environ.get("ULAM_TEST_LEVEL") == "full"
KINDS = ("kernel", "target", "mutation", "sampler")
SECONDS = {"quick": 20, "full": 1200}  # of a mutation on two cores
ENERGY = {"quick": 0.005, "full": 0.001}


class Audit(unittest.TestCase):
    def audit(self, *arguments):
        done = subprocess.run([ULAM, "verify", "--json", *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertIn(done.returncode, (0, 3), done.stderr)
        report = json.loads(done.stdout)
        self.assertEqual([(s["kind"], s["name"], f["level"], f["check"], f["details"]) for s in report["subjects"]
                          for f in s["findings"] if f["outcome"] in ("rejected", "not covered")], [])
        self.assertEqual(done.returncode, 0)
        return report

    def test_some_subjects(self):
        report = self.audit("--kernel", "metropolis_hastings", "--mutation", "lens_subpath", "--sampler", "path")
        self.assertEqual([s["kind"] for s in report["subjects"]], ["kernel", "mutation", "sampler"])
        self.assertEqual({f["level"] for f in report["subjects"][1]["findings"]}, {"", "L0", "L1", "L2", "L4", "L5", "L6", "L7"})

    @unittest.skipUnless(FULL, "every subject: ULAM_TEST_LEVEL=full")
    def test_every_subject(self):
        for level in ("quick", "full"):
            with self.subTest(level):
                begin = time.monotonic()
                report = self.audit("--level", level)
                self.assertEqual({s["kind"] for s in report["subjects"]}, set(KINDS))
                for subject in report["subjects"]:
                    seconds = sum(f["seconds"] for f in subject["findings"])
                    print(f"{level}: {subject['kind']} {subject['name']}: {seconds:.0f} s", flush=True)
                    for f in subject["findings"]:
                        for place, numbers in f["numbers"].items():
                            if isinstance(numbers, dict) and "energy_half_width" in numbers:
                                self.assertLessEqual(numbers["energy_half_width"], ENERGY[level], (subject["name"], place))
                print(f"{level}: {time.monotonic() - begin:.0f} s", flush=True)


if __name__ == "__main__":
    unittest.main()
