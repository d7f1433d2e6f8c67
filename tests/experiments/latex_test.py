#!/usr/bin/env python3
"""LaTeX sets summary.tex, with names that LaTeX would take for commands, and the figures come out as they are in summary.json."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ULAM = os.path.abspath(os.environ.get("ULAM", "build/release/ulam"))
if not shutil.which("pdflatex"):
    print("LaTeX is not there: summary.tex is not set (package texlive-latex-recommended)")
    sys.exit(0)

EXPERIMENT = {
    "name": "odd_names",
    "scenes": {"box_1": {"type": "cornell_box"}},
    "film": {"width": 16, "height": 16, "rfilter": {"type": "box"}},
    "samplers": {"bdpt_a": {"type": "bdpt"}, "mlt+b": {"type": "mlt", "chains": 10}},
    "baseline": "bdpt_a",
    "budget": {"spp": 2},  # so few that p is 0.03 and errors are above 0.001
    "replicates": 4,
    "snapshots": 0,
    "metrics": ["relmse"],
    "reference": {"sampler": "bdpt", "budget": {"spp": 256}},
    "sweep": {"samplers.mlt+b.chains": [10, 20]},
}
DOCUMENT = r"""\documentclass{article}
\usepackage[T1]{fontenc}
\usepackage{booktabs}
\begin{document}
\input{summary.tex}
\end{document}
"""


class Latex(unittest.TestCase):
    def test_the_table_is_set(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "e.json").write_text(json.dumps(EXPERIMENT))
            environment = {**os.environ, "XDG_CACHE_HOME": name}
            subprocess.run([ULAM, "run", "e.json", "-o", "run", "--quiet"], cwd=folder, env=environment, check=True, capture_output=True)
            (folder / "run/table.tex").write_text(DOCUMENT)
            done = subprocess.run(["pdflatex", "-halt-on-error", "-interaction=nonstopmode", "table.tex"], cwd=folder / "run",
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout[-2000:])
            self.assertGreater((folder / "run/table.pdf").stat().st_size, 1000)
            self.assertNotIn("Missing character", done.stdout + (folder / "run/table.log").read_text(errors="replace"))

            table = (folder / "run/summary.tex").read_text()
            cells = json.loads((folder / "run/summary.json").read_text())["cells"]
            self.assertEqual(len(cells), 3)
            rows = [line for line in table.splitlines() if line.startswith(r"box\_1 & ")]
            self.assertEqual(len(rows), 3)
            for cell, row in zip(cells, rows):
                self.assertIn(f" {cell['metrics']['relmse']['mean']:.4g} ", row)
                self.assertIn(cell["sampler"].replace("_", r"\_"), row)


if __name__ == "__main__":
    unittest.main()
