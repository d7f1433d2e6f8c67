#!/usr/bin/env python3
"""The Python package, installed from experiments/python, on a small run: frames say what the summary says, images are those
that were written, docs/python.md runs as it stands, and what is wrong with a run is named."""

import base64
import csv
import hashlib
import html
import importlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import tracemalloc
import unittest
import warnings
from unittest import mock

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.append(str(ROOT / "tests/support"))
import packages  # noqa: E402, F401

try:
    import drjit
    import hatchling  # noqa: F401  builds the package
    import ijson  # noqa: F401
    import mitsuba
    import numpy as np
    import OpenEXR  # noqa: F401
    import pandas as pd
    import pyarrow  # noqa: F401
except ImportError as error:
    print(f"the Python package is not tested: {error}")
    sys.exit(0)

ULAM = os.path.abspath(os.environ.get("ULAM", "build/release/ulam"))
FULL = os.environ.get("ULAM_TEST_LEVEL") == "full"
DOC = (ROOT / "docs/python.md").read_text(encoding="utf8")
MLT = "box-mlt,chains=50"
METRICS = ["relmse", "mse", "mae", "mape", "smape", "ssim"]
mitsuba.set_variant("scalar_rgb")
drjit.set_thread_count(2)  # on a machine of one core Mitsuba waits for ever for a thread that reads the image


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", DOC, re.M | re.S)


def tables(text):
    """Frames that the documentation lists."""
    return re.findall(r"^\| `run\.(\w+)` \|", text, re.M)


def setUpModule():
    """Installs the package into a folder, imports it from there and makes the run of the documentation."""
    global ulam, run, folder, summary
    temporary = tempfile.TemporaryDirectory()
    unittest.addModuleCleanup(temporary.cleanup)
    work = pathlib.Path(temporary.name)
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "--quiet"]
    alone = ["--no-index", "--no-deps", "--no-build-isolation", "--no-compile", "--target", work / "installed"]
    subprocess.run([*pip, *alone, ROOT / "experiments/python"], check=True)
    sys.path.insert(0, str(work / "installed"))
    ulam = importlib.import_module("ulam")

    experiment, = blocks("json")
    (work / "box.json").write_text(experiment)
    environment = dict(os.environ, XDG_CACHE_HOME=str(work / "cache"))
    command = [ULAM, "run", "box.json", "-o", "runs/box", "--quiet", "--set", f"metrics={json.dumps(METRICS)}",
               "--set", 'scenes.holes={"type": "grid_of_holes", "holes": 2}']
    subprocess.run(command, cwd=work, env=environment, check=True, stdout=subprocess.DEVNULL)
    os.chdir(work)
    folder = work / "runs/box"
    run = ulam.load_run(folder)
    summary = json.loads((folder / "summary.json").read_text())


def copy_of_run(test):
    temporary = tempfile.TemporaryDirectory()
    test.addCleanup(temporary.cleanup)
    return pathlib.Path(shutil.copytree(folder, f"{temporary.name}/box"))


def plain(value):
    """As JSON has it: null for NaN."""
    return None if isinstance(value, float) and np.isnan(value) else value


class Frames(unittest.TestCase):
    def assert_fields(self, row, fields, but=()):
        """Each number, word and interval among the fields stands in the row under its name."""
        for name, value in fields.items():
            if name in but:
                continue
            if name.endswith("ci95"):
                self.assertEqual([plain(row[f"{name}_low"]), plain(row[f"{name}_high"])], value or [None, None], name)
            elif not isinstance(value, (dict, list)):
                self.assertEqual(plain(row[name]), value, name)

    def test_installed_package_is_what_is_tested(self):
        self.assertEqual(pathlib.Path(ulam.__file__).parent.parent.name, "installed")

    def test_cells_and_their_tables_are_those_of_the_summary(self):
        self.assertEqual(list(run.cells.index), [cell["cell"] for cell in summary["cells"]])
        for cell in summary["cells"]:
            name = cell["cell"]
            self.assert_fields(run.cells.loc[name], cell, but=("cell", "slope"))
            self.assertEqual(run.cells.loc[name, "slope.value"], cell["slope"]["value"])
            for path, value in cell["sweep"].items():
                self.assertEqual(run.cells.loc[name, f"sweep.{path}"], value)
            for metric, fields in cell["metrics"].items():
                self.assert_fields(run.metrics.loc[(name, metric)], fields)
            for point in cell["convergence"]:
                self.assert_fields(run.convergence.loc[(name, point["fraction"])], point, but=("fraction",))
            spectrum = cell["error_spectrum"]
            self.assertEqual(run.cells.loc[name, "error_spectrum.brightness"], spectrum["brightness"])
            for column in "density", "low", "high", "counts":
                written = dict(zip(spectrum["cycles_per_pixel"], spectrum[column], strict=True))
                self.assertEqual(run.error_spectrum.loc[name][column].to_dict(), written)
            for mutation, fields in cell["mutation_statistics"].items():
                row = run.mutation_statistics.loc[(name, mutation)]
                self.assert_fields(row, fields)
                for reason in [c for c in run.mutation_statistics if c.startswith("rejected.")]:
                    self.assertEqual(row[reason], fields["rejected"].get(reason.removeprefix("rejected."), 0))
            for feature, fields in cell["features"].items():
                self.assert_fields(run.features.loc[(name, feature)], fields)
        lengths = {field: sum(len(cell[field]) for cell in summary["cells"])
                   for field in ("metrics", "convergence", "mutation_statistics", "features")}
        self.assertEqual({field: len(getattr(run, field)) for field in lengths}, lengths)
        self.assertGreater(min(lengths.values()), 0)
        self.assertEqual(run.parameters.loc[(MLT, "chains"), "value"], 50)

    def test_types_are_those_a_column_can_be_counted_with(self):
        self.assertEqual(run.cells["replicates"].dtype, np.int64)
        self.assertEqual(run.metrics["mean"].dtype, np.float64)
        self.assertTrue((run.mutation_statistics.filter(like="rejected.").dtypes == np.int64).all())
        self.assertEqual(run.comparisons["speedup"].dtype, np.float64)
        self.assertEqual(run.features["jumps_per_million"].dtype, np.float64)

    def test_frames_come_back_from_parquet(self):
        frames = [name for name in tables(DOC) if name != "parameters"]
        self.assertEqual(len(frames), 9)
        file = folder / "frame.parquet"
        for name in frames:
            with self.subTest(name):
                frame = getattr(run, name)
                frame.to_parquet(file)
                pd.testing.assert_frame_equal(pd.read_parquet(file), frame)
        text = run.parameters.astype({"value": str})
        text.to_parquet(file)
        self.assertEqual(pd.read_parquet(file).loc[(MLT, "chains"), "value"], "50")

    def test_comparisons(self):
        self.assertEqual(len(run.comparisons), len(summary["comparisons"]))
        for (_, row), fields in zip(run.comparisons.iterrows(), summary["comparisons"], strict=True):
            self.assert_fields(row, fields)
        self.assertEqual(run.verdicts, summary["verdicts"])
        self.assertEqual(run.warnings, summary["warnings"])

    def test_the_csv_has_the_same_numbers(self):
        frame = run.metrics.join(run.cells.drop(columns="worst_replicate")).reset_index()
        with open(folder / "summary.csv", encoding="utf8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), len(frame))
        for written, (_, row) in zip(rows, frame.iterrows(), strict=True):
            for name, text in written.items():
                value = plain(row[name])
                self.assertEqual(float(text) if text and not isinstance(value, str) else text or None, value, name)

    def test_replicates_are_the_results(self):
        self.assertEqual(len(run.replicates), sum(cell["replicates"] for cell in summary["cells"]))
        for (cell, replicate), row in run.replicates.iterrows():
            result = json.loads((folder / "cells" / cell / f"r{replicate:03}" / "result.json").read_text())
            self.assert_fields(row, result, but=("replicate", "mixing", "traces"))
            mixing = result["mixing"] or {}
            for scalar in {"raster_x", "raster_y", "log_target", "path_length", "feature"} & set(mixing):
                row = run.mixing.loc[(cell, replicate, scalar)]
                self.assert_fields(row, mixing[scalar])
                self.assert_fields(row, mixing)
                draws = result["chains"] * mixing["draws_per_chain"]
                mutations = row["integrated_autocorrelation_mutations"]
                np.testing.assert_allclose(row["ess"] * mutations, draws * mixing["mutations_per_draw"], rtol=1e-12)
        self.assertGreater(len(run.mixing), 0)
        means = run.replicates.groupby("cell")["relmse"].mean()
        for cell in summary["cells"]:
            np.testing.assert_allclose(means[cell["cell"]], cell["metrics"]["relmse"]["mean"], rtol=1e-12)
        pd.testing.assert_frame_equal(run.cell(MLT).replicates, run.replicates.loc[MLT], check_dtype=False)

    def test_errors_are_nobodys_where_replicates_have_come_or_gone(self):
        copy = copy_of_run(self)
        shutil.rmtree(copy / "cells" / MLT / "r001")
        cell = ulam.load_run(copy).cell(MLT)
        self.assertEqual(list(cell.replicates.index), [0, 2, 3])
        self.assertTrue(cell.replicates["relmse"].isna().all())

    def test_a_run_without_features_or_mutations_has_empty_frames_with_columns(self):
        copy = copy_of_run(self)
        cells = [cell | {"features": {}, "mutation_statistics": {}} for cell in summary["cells"]]
        (copy / "summary.json").write_text(json.dumps(summary | {"cells": cells}))
        empty = ulam.load_run(copy)
        self.assertEqual((len(empty.features), empty.features.index.names), (0, ["cell", "feature"]))
        self.assertEqual(len(empty.features["share"]) + len(empty.mutation_statistics["proposed"]), 0)


class Images(unittest.TestCase):
    def assert_hash(self, image, recorded):
        self.assertEqual(image.dtype, np.float32)
        height, width, _ = image.shape
        self.assertEqual(hashlib.sha256(f"{width} {height} ".encode() + image.tobytes()).hexdigest(), recorded)

    def test_images_are_what_was_written(self):
        for name in run.cells.index:
            cell = run.cell(name)
            for number in cell.replicate_numbers:
                self.assert_hash(cell.replicate(number).image, cell.replicate(number).result["image_sha256"])
            self.assert_hash(cell.reference.image, cell.reference.result["image_sha256"])
            self.assert_hash(cell.reference.variance, cell.reference.result["variance_sha256"])
        self.assertIn(cell.reference.folder.name, run.references)

    def test_another_reader_sees_the_same(self):
        replicate = run.cell(MLT).replicate(2)
        for image, file in (replicate.image, "image.exr"), (replicate.snapshot(0), "snapshots/s00.exr"):
            np.testing.assert_array_equal(image, np.array(mitsuba.Bitmap(str(replicate.folder / file))))
        self.assertFalse(np.array_equal(replicate.image, replicate.snapshot(0)))

    def test_error_maps_have_the_metrics_of_the_summary(self):
        cell = run.cell(MLT)
        for metric in METRICS[:5]:
            expected = cell.summary["metrics"][metric]
            self.assertEqual(cell.error_map(metric).shape, (16, 16))
            np.testing.assert_allclose(cell.error_map(metric).mean(), expected["mean"], rtol=1e-12)
            np.testing.assert_allclose(cell.error_map(metric, 3).mean(), expected["values"][3], rtol=1e-12)
        with self.assertRaisesRegex(ulam.RunError, '"relmsee" is no metric of this run; did you mean "relmse"?'):
            cell.error_map("relmsee")
        with self.assertRaisesRegex(ulam.RunError, '"ssim" has no map here.* Known: mse, mae'):
            cell.error_map("ssim")


class Chains(unittest.TestCase):
    def test_inference_data_are_the_scalars_of_the_file(self):
        result = run.cell(MLT).replicate(1).result
        values = np.load(folder / "cells" / MLT / "r001" / result["traces"]["file"])
        data = run.inference_data(MLT, replicate=1)
        self.assertEqual(list(data.posterior.data_vars), result["traces"]["scalars"])
        for i, name in enumerate(result["traces"]["scalars"]):
            self.assertEqual(data.posterior[name].dims, ("chain", "draw"))
            np.testing.assert_array_equal(data.posterior[name], values[..., i])
        self.assertEqual(data.posterior.attrs["sampler"], "mlt")
        self.assertTrue((data.posterior["path_length"] >= 1).all())
        self.assertTrue((data.posterior["raster_x"] < 16).all())

    def test_arviz_finds_the_r_hat_of_the_result(self):
        import arviz

        rhat = arviz.rhat(run.inference_data(MLT, 0))
        for scalar in "raster_x", "raster_y", "log_target", "path_length":
            expected = run.mixing.loc[(MLT, 0, scalar), "split_rhat"]
            np.testing.assert_allclose(float(rhat[scalar]), expected, rtol=1e-4, err_msg=scalar)

    def test_all_replicates_are_told_apart(self):
        data = run.inference_data(run.cell(MLT)).posterior
        one = run.inference_data(MLT, 2).posterior
        chains = run.cell(MLT).replicate(0).result["traces"]["chains"]
        self.assertEqual(list(data["replicate"].values), [0] * chains + [1] * chains + [2] * chains + [3] * chains)
        of_two = data["log_target"].values[data["replicate"].values == 2]
        np.testing.assert_array_equal(of_two, one["log_target"].values[:, :of_two.shape[1]])

    def test_what_is_missing_is_said(self):
        with self.assertRaisesRegex(ulam.RunError, "its sampler has no chains"):
            run.inference_data("box-bdpt")
        with mock.patch.dict(sys.modules, arviz=None), self.assertRaisesRegex(ImportError, r"\[arviz\]"):
            run.inference_data(MLT)
        copy = copy_of_run(self)
        file = copy / "cells" / MLT / "r000/chains.npy"
        file.write_bytes(file.read_bytes()[:-8])
        with self.assertRaisesRegex(ulam.RunError, "r000/chains.npy: damaged array"):
            ulam.load_run(copy).inference_data(MLT, 0)


class Errors(unittest.TestCase):
    def assert_says(self, pattern, action):
        with self.assertRaisesRegex(ulam.RunError, pattern):
            action()

    def test_folders_that_are_no_runs(self):
        self.assert_says(r"runs/bxo: no such folder; did you mean \"box\"\?", lambda: ulam.load_run("runs/bxo"))
        self.assert_says("box.json: is a file", lambda: ulam.load_run("box.json"))
        self.assert_says("runs: it is no run: resolved.json and cells are missing", lambda: ulam.load_run("runs"))

    def test_a_run_that_has_not_ended(self):
        copy = copy_of_run(self)
        (copy / "summary.json").unlink()
        unfinished = ulam.load_run(copy)
        self.assertEqual(unfinished.cell(MLT).images.shape, (4, 16, 16, 3))
        self.assert_says("summary.json: missing: the run has not come to its end", lambda: unfinished.cells)
        for result in (copy / "cells" / MLT).glob("*/result.json"):
            result.unlink()
        self.assert_says(f"{MLT}: no replicate has finished", lambda: unfinished.cell(MLT).images)
        self.assert_says(f"{MLT}: no replicate has finished", lambda: unfinished.inference_data(MLT))

    def test_damage_is_found_where_it_is_read_and_named(self):
        copy = copy_of_run(self)
        file = copy / "summary.json"
        text = file.read_text()
        file.write_text(text[: text.index('"cells"') + 2000])
        damaged = ulam.load_run(copy)
        self.assertEqual(damaged.verdicts, summary["verdicts"], "they stand before the damage")
        self.assert_says(r"summary.json:\d+:\d+: damaged JSON", lambda: damaged.cells)
        result = copy / "cells" / MLT / "r000/result.json"
        result.write_text('{"schema_version": 1,\n  "seed": }')
        self.assert_says("r000/result.json:2:11: damaged JSON", lambda: damaged.cell(MLT).replicate(0).result)
        image = copy / "cells" / MLT / "r000/image.exr"
        image.write_bytes(image.read_bytes()[:200])
        self.assert_says("r000/image.exr: damaged image", lambda: damaged.cell(MLT).replicate(0).image)
        image.unlink()
        self.assert_says("r000/image.exr: No such file", lambda: damaged.cell(MLT).replicate(0).image)

    def test_newer_files_are_refused(self):
        copy = copy_of_run(self)
        for name in "summary.json", "provenance.json":
            fields = json.loads((copy / name).read_text())
            (copy / name).write_text(json.dumps(fields | {"schema_version": 2}))
        newer = ulam.load_run(copy)
        self.assert_says("summary.json: its schema_version 2 is newer than 1", lambda: newer.cells)
        self.assert_says("provenance.json: its schema_version 2 is newer than 1", lambda: newer.provenance)

    def test_unknown_names(self):
        self.assert_says(r'no cell "box-mlt,chains=5"; did you mean "box-mlt,chains=50"\?', lambda: run.cell(MLT[:-1]))
        self.assert_says("replicate 4 has not finished; finished: .0, 1, 2, 3.", lambda: run.cell(MLT).replicate(4))


class Display(unittest.TestCase):
    def test_a_run_shows_its_report_in_a_frame(self):
        shown = run._repr_html_()
        page = re.fullmatch(r'<iframe sandbox="allow-scripts[^"]*" srcdoc="([^"]*)"[^>]*></iframe>', shown)[1]
        # Its buttons save files and print; the notebook stays out of its reach.
        sandbox = re.search(r'sandbox="([^"]*)"', shown)[1].split()
        self.assertEqual(set(sandbox), {"allow-scripts", "allow-downloads", "allow-modals"})
        self.assertEqual(html.unescape(page), (folder / "report.html").read_text(encoding="utf8"))
        copy = copy_of_run(self)
        (copy / "report.html").unlink()
        self.assertIn("ulam report", ulam.load_run(copy)._repr_html_())

    def test_a_cell_shows_numbers_and_pictures(self):
        shown = run.cell(MLT)._repr_html_()
        judged = run.comparisons.set_index("cell").loc[MLT]
        self.assertIn(f"{judged['ratio']:.4g}", shown)
        self.assertIn(judged["verdict"], shown)
        pictures = re.findall(r"data:image/png;base64,([^\"]+)", shown)
        self.assertEqual(len(pictures), 2)
        reference = pathlib.Path("reference.png")
        reference.write_bytes(base64.b64decode(pictures[1]))
        decoded = np.array(mitsuba.Bitmap(str(reference)))
        expected = mitsuba.Bitmap(run.cell(MLT).reference.image).convert(
            mitsuba.Bitmap.PixelFormat.RGB, mitsuba.Struct.Type.UInt8, srgb_gamma=True)
        self.assertLessEqual(np.abs(decoded.astype(int) - np.array(expected).astype(int)).max(), 1)


class Documentation(unittest.TestCase):
    def test_examples_run_as_they_stand(self):
        names = {}
        examples = blocks("python")
        self.assertGreaterEqual(len(examples), 4)
        with open(os.devnull, "w") as nowhere, mock.patch("sys.stdout", nowhere), warnings.catch_warnings():
            warnings.simplefilter("ignore", FutureWarning)  # ArviZ announces its next version
            for number, example in enumerate(examples):
                exec(compile(example, f"docs/python.md, example {number + 1}", "exec"), names)
        self.assertEqual(names["z"].shape, (16, 16, 3))
        self.assertEqual(names["errors"].shape[1], len(run.cells))


class ManyCells(unittest.TestCase):
    CELLS = 100_000 if FULL else 2_000

    def test_memory_is_that_of_the_columns(self):
        copy = copy_of_run(self)
        cell = json.dumps(summary["cells"][-1])
        head = {key: value for key, value in summary.items() if key != "cells"}
        with (copy / "summary.json").open("w") as file:
            file.write(json.dumps(head)[:-1] + ', "cells": [')
            for number in range(self.CELLS):
                file.write((", " if number else "") + cell.replace(MLT, f"cell-{number}"))
            file.write("]}")
        size = (copy / "summary.json").stat().st_size
        tracemalloc.start()
        self.addCleanup(tracemalloc.stop)
        many = ulam.load_run(copy)
        self.assertLess(tracemalloc.get_traced_memory()[1], 1e6)
        self.assertEqual(len(many.cells), self.CELLS)
        print(f"{size / 1e6:.0f} MB of summary, {tracemalloc.get_traced_memory()[1] / 1e6:.0f} MB of memory at most")
        self.assertLess(tracemalloc.get_traced_memory()[1], size)


if __name__ == "__main__":
    unittest.main()
