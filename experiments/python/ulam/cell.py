"""A cell of a run, its replicates and its reference. Nothing is read before it is asked for."""

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from . import display, tables
from .chains import read_traces
from .files import RunError, choices, did_you_mean, read_exr, read_json
from .metrics import error_map

if TYPE_CHECKING:
    from .run import Run


class Rendered:
    """A folder with an image and what is known of it."""

    def __init__(self, folder: Path):
        self.folder = folder

    @cached_property
    def result(self) -> dict[str, Any]:
        """result.json; of a reference its kind, budget, and whether its halves agree."""
        return read_json(self.folder / "result.json")

    @cached_property
    def image(self) -> np.ndarray:
        """Linear RGB, float32, shape (height, width, 3)."""
        return read_exr(self.folder / "image.exr")


class Replicate(Rendered):
    """One complete run of a sampler, with seeds of its own."""

    def __init__(self, folder: Path, number: int):
        super().__init__(folder)
        self.number = number

    def snapshot(self, number: int) -> np.ndarray:
        """The image at a part of the budget, as `image`; `result["snapshots"][number]` says which part."""
        return read_exr(self.folder / self.result["snapshots"][number]["image"])

    @property
    def extra_images(self) -> list[str]:
        """Names of what else the sampler writes."""
        return sorted(file.stem for file in (self.folder / "extra").glob("*.exr"))

    def extra(self, name: str) -> np.ndarray:
        """An image of `extra_images`, as `image`."""
        return read_exr(self.folder / "extra" / f"{name}.exr")

    @cached_property
    def traces(self) -> dict[str, np.ndarray]:
        """Scalars of the chains, each of shape (chains, draws)."""
        return read_traces(self)

    def __repr__(self) -> str:
        return f"Replicate({str(self.folder)!r})"


class Reference(Rendered):
    """What images are compared with."""

    @cached_property
    def variance(self) -> np.ndarray:
        """Variance of `image`, the mean of the reference's parts, per pixel and channel; zero where it is exact."""
        return read_exr(self.folder / "variance.exr")

    def __repr__(self) -> str:
        return f"Reference({str(self.folder)!r})"


class Cell:
    """A point of scenes × samplers × sweep."""

    def __init__(self, run: "Run", name: str):
        self.run = run
        self.name = name
        self.folder = run.folder / "cells" / name
        if not name or not self.folder.is_dir():
            known = [path.name for path in (run.folder / "cells").iterdir()]
            raise RunError(f'{run.folder}: it has no cell "{name}"{did_you_mean(name, known)}')

    @cached_property
    def summary(self) -> dict[str, Any]:
        """The cell's entry in summary.json."""
        for cell in self.run.summaries():
            if cell["cell"] == self.name:
                return cell
        raise RunError(f'{self.run.summary_file}: nothing of cell "{self.name}": no replicate had finished')

    @cached_property
    def replicate_numbers(self) -> list[int]:
        """Of the finished replicates: those with a result.json."""
        return sorted(int(file.parent.name[1:]) for file in self.folder.glob("r[0-9]*/result.json"))

    def replicate(self, number: int) -> Replicate:
        if number not in self.replicate_numbers:
            raise RunError(f"{self.folder}: replicate {number} has not finished; finished: {self.replicate_numbers}")
        return Replicate(self.folder / f"r{number:03}", number)

    def finished(self) -> list[Replicate]:
        """All finished replicates, at least one."""
        if not self.replicate_numbers:
            raise RunError(f"{self.folder}: no replicate has finished")
        return [self.replicate(number) for number in self.replicate_numbers]

    @cached_property
    def replicates(self) -> pd.DataFrame:
        """The rows of `Run.replicates` that belong to this cell, indexed by replicate."""
        return tables.frame(self.replicate_rows(self.summary), ["replicate"]).drop(columns="cell")

    def replicate_rows(self, summary: tables.Object) -> list[tables.Row]:
        rows = [{"cell": self.name} | tables.result_row(replicate.result) for replicate in self.finished()]
        for name, metric in summary["metrics"].items():
            # The summary has a number for each replicate it found: with others since, it is not that of these rows.
            values = metric["values"] if len(metric["values"]) == len(rows) else [None] * len(rows)
            for row, value in zip(rows, values, strict=True):
                row[name] = value
        return rows

    def mixing_rows(self) -> list[tables.Row]:
        rows = (row for replicate in self.finished() for row in tables.mixing_rows(replicate.result))
        return [{"cell": self.name} | row for row in rows]

    @property
    def images(self) -> np.ndarray:
        """Of all finished replicates: float32, shape (replicates, height, width, 3)."""
        return np.stack([replicate.image for replicate in self.finished()])

    @cached_property
    def reference(self) -> Reference:
        return Reference((self.run.folder / self.summary["reference_image"]).parent)

    def error_map(self, metric: str | None = None, replicate: int | None = None) -> np.ndarray:
        """Error per pixel, float64, shape (height, width), in the primary metric or the one named, which must be a mean
        over pixels. Of one replicate, or the mean of all maps; its mean is the metric of the summary."""
        metric, definitions = metric or self.run.primary_metric, self.run.metric_definitions
        if metric not in definitions:
            raise RunError(f'"{metric}" is no metric of this run{choices(metric, definitions)}')
        constants = definitions[metric]["constants"]
        replicates = self.finished() if replicate is None else [self.replicate(replicate)]
        reference, variance = self.reference.image, self.reference.variance
        maps = [error_map(metric, constants, r.image, reference, variance) for r in replicates]
        return np.mean(maps, axis=0)

    def __repr__(self) -> str:
        return f"Cell({self.name!r})"

    def _repr_html_(self) -> str:
        return display.cell_html(self)
