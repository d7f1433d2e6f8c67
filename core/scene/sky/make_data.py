#!/usr/bin/env python3
"""Makes hosek_wilkie_data.cpp from the data that Mitsuba 3's Python package ships: make_data.py OUT

Sky: the RGB data set of L. Hosek and A. Wilkie ("An analytic model for full spectral sky-dome radiance", 2012), as
Mitsuba has it. Sun: the radiance of their "Adding a solar-radiance function to the Hosek-Wilkie skylight model" (2013),
limb darkening included, integrated over the sun's disc at 11 wavelengths for Mitsuba, and made a colour here as Mitsuba
3.9 does in its RGB mode. LICENSE is that of Hosek's and Wilkie's data.
"""

import pathlib
import struct
import sys

import mitsuba
import numpy

# ∫ ȳ dλ of the CIE observer in nm: radiances become W / (m² sr nm), and an equal-energy spectrum of 1 has luminance 1.
CIE_Y = 106.7502593994140625
# What Mitsuba 3.9 multiplies the mean over the sun's 11 wavelengths by (SPEC_TO_RGB_SUN_CONV).
SUN_BANDWIDTH = 467.069280386
XYZ_TO_RGB = numpy.array([[3.240479, -1.537150, -0.498535], [-0.969256, 1.875991, 0.041556], [0.055648, -0.204043, 1.057311]])
TYPES = {10: "<f4", 11: "<f8"}


def tensors(path):
    """Mitsuba's tensor file: a header, then for each field its name, type, place and shape."""
    data = path.read_bytes()
    assert data[:12] == b"tensor_file\0"
    (count,), at, result = struct.unpack_from("<I", data, 14), 18, {}
    for _ in range(count):
        (length,) = struct.unpack_from("<H", data, at)
        name = data[at + 2 : at + 2 + length].decode()
        at += 2 + length
        dimensions, kind, offset = struct.unpack_from("<HBQ", data, at)
        shape = struct.unpack_from(f"<{dimensions}Q", data, at + 11)
        at += 11 + 8 * dimensions
        result[name] = numpy.frombuffer(data, TYPES[kind], int(numpy.prod(shape)), offset).reshape(shape)
    return result


def sun_colours(spectral):
    """[…, 11 wavelengths] to […, RGB]."""
    observer = numpy.array([numpy.array(mitsuba.cie1931_xyz(w)).ravel() for w in range(320, 721, 40)])
    return spectral.astype(float) @ (observer @ XYZ_TO_RGB.T) / 11 * SUN_BANDWIDTH / CIE_Y


def table(name, values):
    numbers = [f"{x}f" for x in values.astype(numpy.float32).ravel()]
    lines = [", ".join(numbers[i : i + 18]) for i in range(0, len(numbers), 18)]
    return f"const float {name}[{len(numbers)}] = {{\n" + ",\n".join(lines) + "};\n"


def main():
    mitsuba.set_variant("scalar_rgb")
    folder = pathlib.Path(mitsuba.__file__).parent / "data" / "sunsky"
    model, sampling = tensors(folder / "sunsky_datasets.bin"), tensors(folder / "sampling_data.bin")
    parts = [
        "// Made by make_data.py, which says from what; hosek_wilkie_data.h says what it is. LICENSE holds for it.\n",
        '#include "core/scene/sky/hosek_wilkie_data.h"\n',
        "// clang-format off\nnamespace ulam::sky_data {\n",
        table("kShape", model["sky_params_rgb"]),
        table("kRadiance", model["sky_rad_rgb"] / CIE_Y),
        table("kSunIrradiance", sun_colours(sampling["sun_irradiance"])),
        "}  // namespace ulam::sky_data\n",
    ]
    pathlib.Path(sys.argv[1]).write_text("\n".join(parts), encoding="utf8")


if __name__ == "__main__":
    main()
