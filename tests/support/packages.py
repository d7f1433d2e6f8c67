"""Imported first: goes on with the interpreter that has the packages of requirements.txt, where tests/run has made it."""

import os
import pathlib
import sys

PYTHON = pathlib.Path(__file__).resolve().parent.parent.parent / "build/python/bin/python"

if PYTHON.exists() and pathlib.Path(sys.prefix) != PYTHON.parent.parent:
    os.execv(PYTHON, [str(PYTHON), *sys.argv])
