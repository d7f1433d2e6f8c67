#!/usr/bin/env python3
"""Runs of a given time: how well they keep it, and what everything else takes.

A run keeps its budget where it deviates by at most max(0.1 %, 20 ms). That at least 99 % do is said with 95 % confidence: of n runs
at most as many were late as n runs of which 1 % are late have with a probability of at most 5 %. Of 300 runs (quick) none may be, of
1200 (full) six. At the full level besides: everything that is no render, from the start of the program to the report, takes at most
1 % of the time of the renders where they take 10 s each. Where other processes took more than a tenth of a processor, what fails is
skipped: it says nothing about this program.
"""

import json
import math
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time
import unittest

ULAM = os.path.abspath(os.environ.get("ULAM", "build/release/ulam"))
FULL = os.environ.get("ULAM_TEST_LEVEL") == "full"
# By the width of the film, which is square: seconds a run.
BUDGETS = {64: 0.1, 128: 0.15, 256: 0.2}
LATE_SHARE, ERROR = 0.01, 0.05
COMMON = {
    "scenes": {"box": {"type": "cornell_box"}},
    "max_depth": 6,
    "samplers": {name: {"type": name} for name in ("path", "bdpt", "mlt", "pssmlt")},
    "baseline": "bdpt",
    "metrics": ["relmse"],
}
SHORT = COMMON | {
    "snapshots": 1,
    "replicates": 100 if FULL else 25,
    "reference": {"sampler": "bdpt", "budget": {"spp": 4}, "part": {"spp": 1}},
    "sweep": {
        "zip": {
            "film": [{"width": width, "height": width} for width in BUDGETS],
            "budget": [{"time": seconds} for seconds in BUDGETS.values()],
        }
    },
}
LONG = COMMON | {
    "film": {"width": 128, "height": 128},
    "budget": {"time": 10},
    "replicates": 8,
    "reference": {"sampler": "bdpt", "budget": {"spp": 16}, "part": {"spp": 4}},
}


def most_late(runs):
    """The largest number k with P(K ≤ k) ≤ 5 % of a binomial K of so many runs; -1 where there is none."""
    probability, k = 0.0, -1
    while True:
        next_one = k + 1
        probability += math.comb(runs, next_one) * LATE_SHARE**next_one * (1 - LATE_SHARE) ** (runs - next_one)
        if probability > ERROR:
            return k
        k = next_one


def machine_seconds():
    """That the processors have been busy since the machine started: all but idle and waiting for files."""
    times = [int(ticks) for ticks in pathlib.Path("/proc/stat").read_text().split("\n")[0].split()[1:9]]
    return (sum(times) - times[3] - times[4]) / os.sysconf("SC_CLK_TCK")


def own_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Experiment:
    """An experiment that was run: its results, the seconds it took by the clock, and the processors that others took from it."""

    def __init__(self, test, description):
        temporary = tempfile.TemporaryDirectory(prefix="ulam-budget-")
        test.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        (self.folder / "experiment.json").write_text(json.dumps(description))
        start, busy, own = time.monotonic(), machine_seconds(), own_seconds()
        subprocess.run([ULAM, "run", "experiment.json", "-o", "run", "--quiet", "--keep-going"], cwd=self.folder, check=True,
                       stdout=subprocess.DEVNULL, env=dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache")))
        self.seconds = time.monotonic() - start
        self.others = (machine_seconds() - busy - own_seconds() + own) / self.seconds

    def results(self, pattern):
        return [json.loads(file.read_text()) for file in sorted((self.folder / "run").glob(pattern))]


class BudgetTest(unittest.TestCase):
    def judge(self, experiment, kept, said):
        print(said, file=sys.stderr)
        if not kept and experiment.others > 0.1:
            self.skipTest(f"other processes took {experiment.others:.2f} processors: {said}")
        self.assertTrue(kept, said)

    def test_budgets_are_kept(self):
        experiment = Experiment(self, SHORT)
        results = experiment.results("cells/*/r*/result.json")
        self.assertEqual(len(results), SHORT["replicates"] * len(SHORT["samplers"]) * len(BUDGETS))
        deviations = [(abs(r["wall_seconds"] - BUDGETS[r["width"]]), BUDGETS[r["width"]], r["sampler"]) for r in results]
        late = sum(seconds > max(0.001 * budget, 0.02) for seconds, budget, _ in deviations)
        seconds, budget, sampler = max(deviations)
        said = f"{late} of {len(results)} runs were late, the worst {1000 * seconds:.1f} ms, of {sampler} in {budget} s"
        self.judge(experiment, late <= most_late(len(results)), said)

    @unittest.skipUnless(FULL, "overhead is timed at the full level only")
    def test_overhead_is_small(self):
        """Planning, files, summary and report included: at most 1 % of the time of the renders."""
        experiment = Experiment(self, LONG)
        rendered = [result["wall_seconds"] for result in experiment.results("cells/*/r*/result.json")]
        self.assertEqual(len(rendered), LONG["replicates"] * len(LONG["samplers"]))
        reference = sum(result["wall_seconds"] for result in experiment.results("references/*/result.json"))
        besides = experiment.seconds - sum(rendered) - reference
        said = f"{besides:.2f} s besides {sum(rendered):.0f} s of renders, {100 * besides / sum(rendered):.2f} %"
        self.judge(experiment, besides <= 0.01 * sum(rendered), said)


if __name__ == "__main__":
    unittest.main(verbosity=2)
