"""Runs of Ulam as pandas frames and numpy images: `ulam.load_run(folder)`. See docs/python.md."""

from .cell import Cell, Reference, Replicate
from .files import RunError
from .run import Run, load_run

__all__ = ["Cell", "Reference", "Replicate", "Run", "RunError", "load_run"]
