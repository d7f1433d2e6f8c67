#!/usr/bin/env python3
"""Runs of a given time: how well they keep it, and what the engine takes besides. It needs an idle machine: full level only."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

ULAM = os.path.abspath(os.environ.get("ULAM", "build/release/ulam"))
SECONDS, REPLICATES = 4, 8
EXPERIMENT = {
    "scenes": {"box": {"type": "cornell_box"}},
    "film": {"width": 128, "height": 128},
    "max_depth": 6,
    "samplers": {"path": {"type": "path"}, "bdpt": {"type": "bdpt"}, "mlt": {"type": "mlt"}, "pssmlt": {"type": "pssmlt"}},
    "baseline": "bdpt",
    "budget": {"time": SECONDS},
    "replicates": REPLICATES,
    "metrics": ["relmse"],
    "reference": {"sampler": "bdpt", "budget": {"spp": 16}, "part": {"spp": 4}},
}


class BudgetTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory(prefix="ulam-budget-")
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        (cls.folder / "experiment.json").write_text(json.dumps(EXPERIMENT))
        cls.run_seconds = cls.run_experiment()
        # Everything is there: only the plan, the summary and the report are made once more.
        cls.again_seconds = cls.run_experiment("--resume")
        cls.results = [json.loads(file.read_text()) for file in sorted((cls.folder / "run").glob("cells/*/r*/result.json"))]

    @classmethod
    def run_experiment(cls, *options):
        start = time.monotonic()
        subprocess.run([ULAM, "run", "experiment.json", "-o", "run", "--quiet", "--keep-going", *options], cwd=cls.folder, check=True,
                       env=dict(os.environ, XDG_CACHE_HOME=str(cls.folder / "cache")))
        return time.monotonic() - start

    def test_budgets_are_kept(self):
        """Within max(0.1 %, 20 ms) in 99 % of the runs."""
        over = [result["wall_seconds"] - SECONDS for result in self.results]
        self.assertEqual(len(over), REPLICATES * len(EXPERIMENT["samplers"]))
        late = [seconds for seconds in over if abs(seconds) > max(0.001 * SECONDS, 0.02)]
        print(f"largest deviation {1000 * max(map(abs, over)):.1f} ms", file=sys.stderr)
        self.assertLessEqual(len(late), 0.01 * len(over), late)

    def test_overhead_is_small(self):
        """Beside renders and reference, at most 1 % of their time."""
        rendered = sum(result["wall_seconds"] for result in self.results)
        reference = sum(json.loads(file.read_text())["wall_seconds"]
                        for file in (self.folder / "run").glob("references/*/result.json"))
        besides = self.run_seconds - self.again_seconds - rendered - reference
        print(f"{1000 * besides / len(self.results):.1f} ms a run, {100 * besides / rendered:.2f} %", file=sys.stderr)
        self.assertLess(besides, 0.01 * rendered)


if __name__ == "__main__":
    if os.environ.get("ULAM_TEST_LEVEL") != "full":
        sys.exit(print("budgets are timed at the full level only"))
    unittest.main(verbosity=2)
