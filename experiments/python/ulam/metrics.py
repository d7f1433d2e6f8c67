"""Error maps: the metrics that are means over pixels, as core/image/metrics.cpp defines them."""

from collections.abc import Callable, Mapping

import numpy as np

from .files import RunError, choices

# Of image x, reference r, its variance v and the metric's epsilon.
CHANNEL_ERRORS: Mapping[str, Callable] = {
    "mse": lambda x, r, v, epsilon: (x - r) ** 2 - v,
    "mae": lambda x, r, v, epsilon: abs(x - r),
    "relmse": lambda x, r, v, epsilon: ((x - r) ** 2 - v) / (r**2 + epsilon),
    "mape": lambda x, r, v, epsilon: abs(x - r) / (abs(r) + epsilon),
    "smape": lambda x, r, v, epsilon: abs(x - r) / (abs(x) + abs(r) + epsilon),
}


def error_map(
    metric: str, constants: Mapping[str, float], image: np.ndarray, reference: np.ndarray, variance: np.ndarray
) -> np.ndarray:
    """Shape (height, width), float64; its mean is the metric. `constants` are those that summary.json records. Images
    have shape (height, width, 3)."""
    if metric not in CHANNEL_ERRORS:
        raise RunError(f'"{metric}" has no map here{choices(metric, CHANNEL_ERRORS)}')
    x, r, v = (np.asarray(channel, dtype=np.float64) for channel in (image, reference, variance))
    return CHANNEL_ERRORS[metric](x, r, v, constants.get("epsilon")).mean(axis=2)
