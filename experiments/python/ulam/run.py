"""A run on disk."""

import os
from collections.abc import Callable, Iterable, Iterator
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from . import chains, display, tables
from .cell import Cell, Reference
from .files import RunError, check_version, did_you_mean, read_json, stream_json

if TYPE_CHECKING:
    import arviz

NEEDED = ("resolved.json", "cells")


def load_run(folder: str | os.PathLike[str]) -> "Run":
    """Opens what `ulam run` left in a folder. Only asks whether the files are there: a run of 100 000 cells opens as
    fast as one of four. Raises RunError, as does everything that reads later."""
    path = Path(folder)
    if not path.is_dir():
        what = "is a file, not the folder of a run" if path.exists() else "no such folder"
        near = did_you_mean(path.name, [p.name for p in path.parent.iterdir()]) if path.parent.is_dir() else ""
        raise RunError(f"{path}: {what}{near}")
    missing = [name for name in NEEDED if not (path / name).exists()]
    if missing:
        are = "is" if len(missing) == 1 else "are"
        raise RunError(f"{path}: it is no run: {' and '.join(missing)} {are} missing")
    return Run(path)


class Run:
    """Frames are tidy: one row an observation, columns and index levels called as the fields of summary.json and
    result.json. Each is made when it is first asked for, by one pass over the file."""

    def __init__(self, folder: Path):
        self.folder = folder

    # ---- files

    @property
    def summary_file(self) -> Path:
        file = self.folder / "summary.json"
        if not file.exists():
            raise RunError(f"{file}: missing: the run has not come to its end (ulam run … --resume goes on)")
        return file

    @cached_property
    def experiment(self) -> dict[str, Any]:
        """experiment.json: what was asked."""
        return read_json(self.folder / "experiment.json")

    @cached_property
    def provenance(self) -> dict[str, Any]:
        """provenance.json: program, machine, time."""
        return read_json(self.folder / "provenance.json")

    def _stream(self, place: str) -> Iterator[Any]:
        """Values of summary.json, read as far as the caller goes."""
        file = self.summary_file
        check_version(file, next(stream_json(file, "schema_version"), None))
        return stream_json(file, place)

    def _field(self, name: str) -> Any:
        for value in self._stream(name):
            return value
        raise RunError(f'{self.summary_file}: "{name}" is missing')

    def summaries(self) -> Iterator[dict[str, Any]]:
        """The entries of the cells in summary.json, one after another."""
        return self._stream("cells.item")

    @cached_property
    def name(self) -> str:
        return self._field("name")

    @cached_property
    def primary_metric(self) -> str:
        """The metric that carries verdicts."""
        return self._field("primary_metric")

    @cached_property
    def metric_definitions(self) -> dict[str, Any]:
        """Of each metric `definition`, `constants`, `debiased`, `higher_is_better`."""
        return self._field("metrics")

    @cached_property
    def verdicts(self) -> list[str]:
        """A sentence for each comparison."""
        return self._field("verdicts")

    @cached_property
    def warnings(self) -> list[str]:
        """What makes the numbers less than they seem, in sentences."""
        return self._field("warnings")

    # ---- frames

    def _frame(
        self, rows: Callable[[tables.Object], Iterable[tables.Row]], index: list[str], columns: str = ""
    ) -> pd.DataFrame:
        return tables.frame((row for cell in self.summaries() for row in rows(cell)), index, columns.split())

    @cached_property
    def cells(self) -> pd.DataFrame:
        """A row a cell: scene, sampler, `sweep.PATH` for each path of the sweep, and means over replicates: `seconds`,
        `rays`, `mutations`, …; `variance` and `bias_squared` in squared radiance; `slope.value` of error against time."""
        return self._frame(lambda cell: [tables.cell_row(cell)], ["cell"], "scene sampler")

    @cached_property
    def parameters(self) -> pd.DataFrame:
        """A row a cell and parameter of its sampler ("mutations.lens.weight"): `value`."""
        return self._frame(tables.parameter_rows, ["cell", "parameter"], "value")

    @cached_property
    def metrics(self) -> pd.DataFrame:
        """A row a cell and metric: `mean`, `ci95_low`, `ci95_high`, `trimmed_mean`, `worst_replicate`."""
        return self._frame(tables.metric_rows, ["cell", "metric"], "mean ci95_low ci95_high trimmed_mean")

    @cached_property
    def convergence(self) -> pd.DataFrame:
        """A row a cell and `fraction` of the budget: costs, and `error` in the primary metric with its interval."""
        return self._frame(
            tables.convergence_rows, ["cell", "fraction"], "seconds rays mutations samples error ci95_low ci95_high"
        )

    @cached_property
    def error_spectrum(self) -> pd.DataFrame:
        """A row a cell and bin of frequencies: `density` of the error's power with its 5 and 95 % quantiles `low` and
        `high` over replicates, `counts` the frequencies of the bin."""
        return self._frame(tables.spectrum_rows, ["cell", "cycles_per_pixel"], "counts density low high")

    @cached_property
    def features(self) -> pd.DataFrame:
        """A row a cell and feature of its scene: `share` of the image's energy, `truth`, and
        `jumps_per_million` mutations that brought a chain to it from another feature."""
        return self._frame(
            tables.feature_rows,
            ["cell", "feature"],
            "share share_ci95_low share_ci95_high truth judged p_adjusted jumps_per_million",
        )

    @cached_property
    def mutation_statistics(self) -> pd.DataFrame:
        """A row a cell and mutation, sums over replicates: `proposed`, `accepted`, `zero`, `rejected.REASON`, `seconds`;
        `esjd_pixels` is the mean squared jump of a proposal, in pixels squared."""
        counts = self._frame(tables.mutation_rows, ["cell", "mutation"], "proposed accepted zero seconds esjd_pixels")
        reasons = counts.filter(like="rejected.").columns
        counts[reasons] = counts[reasons].fillna(0).astype("int64")
        return counts

    @cached_property
    def comparisons(self) -> pd.DataFrame:
        """A row a comparison, as in summary.json: `ratio`, `ci95_low`, …, `p_adjusted`, `verdict`."""
        columns = "cell baseline_cell scene sampler baseline metric ratio ci95_low ci95_high speedup speedup_ci95_low "
        columns += "speedup_ci95_high p p_adjusted verdict"
        return tables.frame(map(tables.flat, self._stream("comparisons.item")), [], columns.split())

    @cached_property
    def replicates(self) -> pd.DataFrame:
        """A row a cell and replicate: seed, times, counts, `normalization`, …, and every metric by its name. Reads a file
        a replicate; `cell(name).replicates` reads those of one cell."""
        return self._frame(
            lambda cell: Cell(self, cell["cell"]).replicate_rows(cell), ["cell", "replicate"], "seed wall_seconds"
        )

    @cached_property
    def mixing(self) -> pd.DataFrame:
        """A row a cell, replicate and scalar of its chains: `split_rhat`, `nested_rhat`, `ess` (effective sample size),
        `ess_per_second`, `integrated_autocorrelation_mutations` (of a chain) with `integrated_autocorrelation_bound` ("upper",
        "lower" or null), `draws_per_chain`, `mutations_per_draw`; none for samplers without chains. Reads a file a replicate."""
        return self._frame(
            lambda cell: Cell(self, cell["cell"]).mixing_rows(),
            ["cell", "replicate", "scalar"],
            "split_rhat nested_rhat ess ess_per_second integrated_autocorrelation_mutations integrated_autocorrelation_bound",
        )

    # ---- cells

    def cell(self, name: str) -> Cell:
        return Cell(self, name)

    @cached_property
    def references(self) -> dict[str, Reference]:
        """By key, the name of the folder; `cell(name).reference` is that of a cell."""
        return {path.name: Reference(path) for path in sorted((self.folder / "references").iterdir())}

    def inference_data(self, cell: str | Cell, replicate: int | None = None) -> "arviz.InferenceData":
        """Scalars of the chains for ArviZ: dimensions chain and draw, variables as in `Replicate.traces`. Without a number
        the chains of all replicates, told apart by the coordinate `replicate`; where budgets of time left traces of
        several lengths, the draws beyond the shortest are left out. Needs the extra `arviz`."""
        cell = cell if isinstance(cell, Cell) else self.cell(cell)
        return chains.inference_data(cell.name, cell.finished() if replicate is None else [cell.replicate(replicate)])

    def __repr__(self) -> str:
        return f"Run({str(self.folder)!r})"

    def _repr_html_(self) -> str:
        return display.run_html(self)
