"""Scalars along the Markov chains of a cell, for ArviZ."""

import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from .files import RunError, read_npy

if TYPE_CHECKING:
    import arviz

    from .cell import Replicate

WHOLE_NUMBERS = ("path_length", "feature")


def read_traces(replicate: "Replicate") -> dict[str, np.ndarray]:
    """Each scalar, shape (chains, draws): `raster_x` and `raster_y` in pixels from the upper left corner, `log_target`,
    `path_length` in edges (0 where states are whole samples), `feature` the number of the last feature crossed before
    the camera, -1 for none. Chains are evenly spaced among all, draws in the run."""
    folder = replicate.folder
    traces = replicate.result.get("traces")
    if traces is None:
        why = "the run was too short" if replicate.result["chains"] else "its sampler has no chains"
        if "traces" not in replicate.result:
            why = "an older program made it"
        raise RunError(f"{folder / 'result.json'}: no chain scalars: {why}")
    shape = (traces["chains"], traces["draws"], len(traces["scalars"]))
    values = read_npy(folder / traces["file"], shape)
    return {
        name: values[..., i].astype(np.int32 if name in WHOLE_NUMBERS else np.float32)
        for i, name in enumerate(traces["scalars"])
    }


def inference_data(cell: str, replicates: Sequence["Replicate"]) -> "arviz.InferenceData":
    try:
        import arviz
    except ImportError as error:
        raise ImportError(
            'inference_data needs ArviZ: install the extra "arviz", as in pip install "./experiments/python[arviz]"'
        ) from error
    if not hasattr(arviz, "InferenceData"):
        raise ImportError(f'inference_data needs ArviZ below 1, found {arviz.__version__}: install the extra "arviz"')
    parts = [replicate.traces for replicate in replicates]
    result = replicates[0].result
    draws = min(replicate.result["traces"]["draws"] for replicate in replicates)
    numbers = [number for r in replicates for number in [r.number] * r.result["traces"]["chains"]]
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "More chains")  # many short ones are what Ulam runs
        data = arviz.from_dict(
            posterior={name: np.concatenate([part[name][:, :draws] for part in parts]) for name in parts[0]},
            posterior_attrs={
                "inference_library": "ulam",
                "inference_library_version": result["program_version"],
                "cell": cell,
                "scene": result["scene"],
                "sampler": result["sampler"],
                "features": list(result["feature_energy"]),
            },
        )
    data.posterior = data.posterior.assign_coords(replicate=("chain", numbers))
    return data
