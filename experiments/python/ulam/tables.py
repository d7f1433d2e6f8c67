"""From the objects of summary.json and result.json to the rows of tidy frames. Columns are called as the fields are; an
interval `ci95: [low, high]` is two columns, `ci95_low` and `ci95_high`, as in summary.csv."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import islice
from typing import Any

import pandas as pd

Row = dict[str, Any]
Object = Mapping[str, Any]

CHUNK = 10_000  # rows: objects take ten times the memory of columns, so few rows are objects at a time


def frame(rows: Iterable[Row], index: list[str], columns: Iterable[str] = ()) -> pd.DataFrame:
    """Rows as a frame, indexed by the columns named. `columns` are there even if no row has them."""
    rows, chunks = iter(rows), []
    while chunk := list(islice(rows, CHUNK)):
        part = pd.DataFrame.from_records(chunk)
        for name in part.columns[part.isna().all()]:
            part[name] = part[name].astype(float)  # null is a number that is not known
        chunks.append(part)
    whole = pd.concat(chunks, ignore_index=True) if chunks else pd.DataFrame()
    missing = [name for name in [*index, *columns] if name not in whole]
    whole = whole.assign(**dict.fromkeys(missing, pd.Series(dtype=float)))
    return whole.set_index(index) if index else whole


def flat(fields: Object, prefix: str = "") -> Row:
    """The numbers, words and intervals among the fields."""
    row = {}
    for key, value in fields.items():
        if key.endswith("ci95"):
            row[f"{prefix}{key}_low"], row[f"{prefix}{key}_high"] = value or (None, None)
        elif not isinstance(value, (dict, list)):
            row[prefix + key] = value
    return row


def cell_row(cell: Object) -> Row:
    row = flat({key: value for key, value in cell.items() if key != "slope"})
    row |= {f"sweep.{path}": value for path, value in cell["sweep"].items()}
    row |= flat(cell.get("error_spectrum") or {}, "error_spectrum.")
    return row | flat(cell.get("slope") or {"value": None, "ci95": None}, "slope.")


def metric_rows(cell: Object) -> Iterator[Row]:
    for name, metric in cell["metrics"].items():
        yield {"cell": cell["cell"], "metric": name} | flat(metric)


def convergence_rows(cell: Object) -> Iterator[Row]:
    for point in cell["convergence"]:
        yield {"cell": cell["cell"]} | flat(point)


def spectrum_rows(cell: Object) -> Iterator[Row]:
    spectrum = {name: values for name, values in cell.get("error_spectrum", {}).items() if isinstance(values, list)}
    for bin_values in zip(*spectrum.values(), strict=True):
        yield {"cell": cell["cell"]} | dict(zip(spectrum, bin_values, strict=True))


def feature_rows(cell: Object) -> Iterator[Row]:
    for name, feature in cell["features"].items():
        yield {"cell": cell["cell"], "feature": name} | flat(feature)


def mutation_rows(cell: Object) -> Iterator[Row]:
    for name, statistics in cell["mutation_statistics"].items():
        yield {"cell": cell["cell"], "mutation": name} | flat(statistics) | flat(statistics["rejected"], "rejected.")


def parameter_rows(cell: Object) -> Iterator[Row]:
    for path, value in leaves(cell["parameters"]):
        yield {"cell": cell["cell"], "parameter": path, "value": value}


def result_row(result: Object) -> Row:
    return flat({key: value for key, value in result.items() if key not in ("mixing", "traces")})


def mixing_rows(result: Object) -> Iterator[Row]:
    found = result.get("mixing") or {}
    for name, scalar in found.items():
        if isinstance(scalar, dict):
            yield {"replicate": result["replicate"], "scalar": name} | flat(scalar) | flat(found)


def leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """What is no object, with its path: ("mutations.lens.weight", 1)."""
    if isinstance(value, dict) and value:
        for key, inner in value.items():
            yield from leaves(inner, f"{path}.{key}" if path else key)
    else:
        yield path, value
