"""The files of a run. Whatever is wrong with one is a RunError that names it."""

import difflib
import json
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

import ijson
import numpy as np
import OpenEXR

SCHEMA_VERSION = 1
"""The newest `schema_version` that this package understands."""


class RunError(Exception):
    """A run, or a file of one, is not what it should be."""


def did_you_mean(name: str, known: Collection[str]) -> str:
    """`; did you mean "lens"?`, or nothing if no name is near."""
    near = difflib.get_close_matches(name, known, n=1)
    return f'; did you mean "{near[0]}"?' if near else ""


def choices(name: str, known: Collection[str]) -> str:
    """The nearest name and all names, to end a message with."""
    return f"{did_you_mean(name, known) or '.'} Known: {', '.join(known)}"


def check_version(file: Path, version: Any) -> None:
    if not isinstance(version, int):
        raise RunError(f'{file}: expected a whole number as "schema_version", found {version!r}')
    if version > SCHEMA_VERSION:
        raise RunError(
            f"{file}: its schema_version {version} is newer than {SCHEMA_VERSION}, the newest this package knows: "
            "install the package of the program that made it"
        )


def read_json(file: Path) -> dict[str, Any]:
    """A JSON object, its `schema_version` checked where it has one."""
    try:
        found = json.loads(file.read_bytes())
    except OSError as error:
        raise RunError(f"{file}: {error.strerror}") from error
    except json.JSONDecodeError as error:
        raise RunError(f"{file}:{error.lineno}:{error.colno}: damaged JSON: {error.msg}") from error
    except UnicodeDecodeError as error:
        raise RunError(f"{file}: damaged JSON: {error}") from error
    if not isinstance(found, dict):
        raise RunError(f"{file}: expected a JSON object, found {type(found).__name__}")
    if "schema_version" in found:
        check_version(file, found["schema_version"])
    return found


def stream_json(file: Path, place: str) -> Iterator[Any]:
    """The values at a place of a large JSON file, one after another: "cells.item" yields each element of "cells". The
    file is read as far as the caller goes."""
    try:
        with file.open("rb") as stream:
            yield from ijson.items(stream, place, use_float=True)
    except OSError as error:
        raise RunError(f"{file}: {error.strerror}") from error
    except ijson.JSONError as error:
        read_json(file)  # says the line, too
        raise RunError(f"{file}: damaged JSON: {error}") from error


def read_exr(file: Path) -> np.ndarray:
    """Linear RGB, float32, shape (height, width, 3), first row at the top."""
    if not file.is_file():
        raise RunError(f"{file}: No such file")
    try:
        with OpenEXR.File(str(file)) as image:
            channels = image.channels()
            if "RGB" not in channels:
                raise RunError(f"{file}: expected the channels R, G and B, found {', '.join(channels)}")
            return np.array(channels["RGB"].pixels, dtype=np.float32)
    except (RuntimeError, OSError, ValueError) as error:
        raise RunError(f"{file}: damaged image: {error}") from error


def read_npy(file: Path, shape: tuple[int, ...]) -> np.ndarray:
    """A read-only view of the file, which is read where the array is."""
    try:
        array = np.load(file, mmap_mode="r", allow_pickle=False)
    except OSError as error:
        raise RunError(f"{file}: {error.strerror or error}") from error
    except (ValueError, EOFError) as error:
        raise RunError(f"{file}: damaged array: {error}") from error
    if array.shape != shape:
        raise RunError(f"{file}: expected an array of shape {shape}, found {array.shape}")
    return array
