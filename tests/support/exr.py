"""Images as numbers. The reader is that of the format's authors, not the one the program uses."""

import unittest

import packages  # noqa: F401

try:
    import OpenEXR
except ImportError:
    OpenEXR = None


def read_exr(file):
    """Rows of pixels (R, G, B), floats. Skips the test where the Python package OpenEXR is missing."""
    if OpenEXR is None:
        raise unittest.SkipTest("the Python package OpenEXR is not installed")
    with OpenEXR.File(str(file)) as image:
        return [[tuple(pixel) for pixel in row] for row in image.channels()["RGB"].pixels.tolist()]
