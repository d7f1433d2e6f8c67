#!/usr/bin/env python3
"""The program as scripts use it: exit codes, what goes to stdout and stderr, and what is written."""

import json
import os
import pathlib
import platform
import signal
import socket
import struct
import subprocess
import tempfile
import time
import unittest
import xml.etree.ElementTree

ULAM = os.environ.get("ULAM", "build/release/ulam")

SCENE = {
    "type": "scene",
    "sensor": {"type": "perspective", "fov": 60, "film": {"type": "hdrfilm", "width": 16, "height": 16},
               "to_world": [{"type": "lookat", "origin": [0, 0, 4], "target": [0, 0, 0], "up": [0, 1, 0]}]},
    "wall": {"type": "rectangle", "to_world": [{"type": "scale", "value": 3}]},
    "lamp": {"type": "rectangle", "emitter": {"type": "area", "radiance": 4},
             "to_world": [{"type": "rotate", "axis": [1, 0, 0], "angle": 180},
                          {"type": "translate", "value": [2.5, 0, 2]}]},
}

EXPERIMENT = {
    "scenes": {"wall": "scene.json"},
    "max_depth": 3,
    "samplers": {"path": {"type": "path"}, "bdpt": {"type": "bdpt"}},
    "baseline": "path",
    "budget": {"spp": 4},
    "replicates": 3,
    "snapshots": 1,
    "metrics": ["relmse"],
    "reference": {"sampler": "bdpt", "budget": {"spp": 128}, "part": {"spp": 32}},
}


class CliTest(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.folder = pathlib.Path(self.temporary.name)
        self.environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))
        self.write("scene.json", SCENE)

    def write(self, name, content):
        (self.folder / name).write_text(json.dumps(content), encoding="utf8")

    def write_pfm(self, name, value):
        """A grey picture of 16 x 16."""
        (self.folder / name).write_bytes(b"Pf\n16 16\n-1.0\n" + struct.pack("<f", value) * 256)

    def ulam(self, *arguments, expect=0):
        done = subprocess.run([os.path.abspath(ULAM), *map(str, arguments)], capture_output=True, text=True,
                              cwd=self.folder, env=self.environment, timeout=300)
        self.assertEqual(done.returncode, expect, f"{arguments}\n{done.stdout}\n{done.stderr}")
        if expect not in (0, 1):
            self.assertEqual(done.stdout, "", "results only on stdout")
            self.assertNotEqual(done.stderr, "")
        return done

    def render(self, *arguments, expect=0):
        return self.ulam("render", "scene.json", "--sampler", "path", "--spp", 2, "-o", "out.exr", "--quiet", *arguments,
                         expect=expect)


class References(CliTest):
    def test_they_are_listed_checked_and_removed(self):
        self.assertIn("0 references", self.ulam("reference", "list").stdout)
        self.write("tiny.json", EXPERIMENT)
        self.ulam("run", "tiny.json", "-o", "run", "--quiet")
        entry, = json.loads(self.ulam("reference", "list", "--json").stdout)
        made = self.folder / "run/references" / entry["key"]
        self.assertEqual({**entry, "damage": ""}, entry)
        self.assertEqual((entry["scene"], entry["width"], entry["replicates"], entry["part"]), ("wall", 16, 4, {"spp": 32}))
        self.assertEqual(entry["bytes"], sum(f.stat().st_size for f in made.iterdir()))
        self.assertIn('4 parts of {"spp":32.0}', self.ulam("reference", "list").stdout)
        self.assertIn("1 references", self.ulam("reference", "list").stdout)

        # A larger budget needs the rest, a smaller one nothing.
        for spp, missing in (256, 4), (128, 0), (16, 0):
            reference, = json.loads(self.ulam("run", "tiny.json", "--dry-run", "--json",
                                              "--set", f"reference.budget.spp={spp}").stdout)["references"].values()
            self.assertEqual(reference["missing_parts"], missing)
            self.assertEqual(reference["estimated_seconds"] > 0, missing > 0)
        self.ulam("run", "tiny.json", "-o", "better", "--quiet", "--set", "reference.budget.spp=256")
        better, = json.loads(self.ulam("reference", "list", "--json").stdout)
        self.assertEqual((better["key"], better["replicates"]), (entry["key"], 8))

        cached = self.folder / "cache/ulam/references" / entry["key"]
        image = (cached / "image.exr").read_bytes()
        (cached / "image.exr").write_bytes((cached / "variance.exr").read_bytes())
        self.assertIn("damaged", self.ulam("reference", "list").stdout)
        (cached / "image.exr").write_bytes(image)

        self.assertIn(entry["key"], self.ulam("reference", "remove", entry["key"][:-1], expect=4).stderr)
        self.ulam("reference", "remove", expect=2)
        self.ulam("reference", "remove", "--older-than", 1)
        self.assertTrue(cached.exists())
        self.ulam("reference", "remove", entry["key"])
        self.assertFalse(cached.exists())
        self.assertTrue((made / "image.exr").exists())


class Usage(CliTest):
    def test_the_page_of_the_vocabulary_is_the_programs(self):
        page = pathlib.Path("docs/vocabulary.md").read_text()
        printed = subprocess.run([ULAM, "list", "vocabulary"], capture_output=True, text=True, check=True).stdout
        self.assertEqual(page.split("\n", 6)[6], printed, "make it again: see the head of docs/vocabulary.md")

    def test_a_time_limited_render_can_be_repeated_as_work(self):
        for sampler in ("bdpt", "pssmlt", "mlt"):
            with self.subTest(sampler=sampler):
                self.ulam("render", "scene.json", "--sampler", sampler, "--time", 0.3, "-o", "a.exr", "--stats", "a.json")
                first = json.loads((self.folder / "a.json").read_text())
                (budget, amount), = first["repeat"]["budget"].items()
                self.ulam("render", "scene.json", "--sampler", json.dumps(first["repeat"]["sampler"]), f"--{budget}", amount,
                          "-o", "b.exr", "--stats", "b.json")
                self.assertEqual(json.loads((self.folder / "b.json").read_text())["image_sha256"], first["image_sha256"])

    def test_help_goes_to_stdout(self):
        self.assertIn("render", self.ulam("--help").stdout)
        self.assertIn("--resume", self.ulam("run", "--help").stdout)
        self.assertRegex(self.ulam("--version").stdout, r"^\d+\.\d+\.\d+")

    def test_usage_errors_are_exit_2(self):
        self.ulam(expect=2)
        self.assertIn('"render"', self.ulam("rendr", expect=2).stderr)
        self.ulam("render", "scene.json", expect=2)
        self.ulam("render", "scene.json", "--sampler", "path", "-o", "x.exr", expect=2)
        self.render("--spp", "many", expect=2)
        self.render("--time", "nan", expect=2)
        self.render("--mutations", "-3", expect=2)
        self.render("--threads", "0", expect=2)
        self.render("--set", "samplermax_depth", expect=2)
        self.render("--set", "camera.fov=3", expect=2)
        self.ulam("list", "smaplers", expect=2)
        self.assertIn("--tev", self.ulam("run", "tiny.json", "--jobs", "slurm", "--tev", "localhost:14158", expect=2).stderr)
        self.ulam("render", "scene.json", "--sampler", "path", "--spp", 1, "-o", "out.png", expect=2)
        self.ulam("scene", "scene.json", expect=2)
        self.ulam("scene", "scene.json", "--info", "--export", "mitsuba3", "out", expect=2)
        self.ulam("scene", "scene.json", "--export", "mitsuba3", expect=2)
        self.ulam("scene", "scene.json", "--export", "pbrt", "out", expect=2)


class Render(CliTest):
    def test_writes_image_and_numbers(self):
        done = self.render("--stats", "out.json", "--seed", 7, "--set", "sampler.max_depth=3",
                           "--set", "scene.film.width=8")
        self.assertEqual(done.stdout, "")
        stats = json.loads((self.folder / "out.json").read_text())
        self.assertEqual(stats["parameters"]["max_depth"], 3)
        self.assertEqual((stats["width"], stats["height"], stats["seed"]), (8, 16, 7))
        self.assertEqual(stats["samples"], 2 * 8 * 16)

    def test_same_seed_same_bytes_with_any_number_of_threads(self):
        images = set()
        for threads in 1, 2, 3:
            self.render("--threads", threads)
            images.add((self.folder / "out.exr").read_bytes())
        self.assertEqual(len(images), 1)
        self.render("--seed", 2)
        self.assertNotIn((self.folder / "out.exr").read_bytes(), images)

    def test_scenes_and_samplers_come_in_three_forms(self):
        self.write("sampler.json", {"type": "bdpt", "max_depth": 2})
        self.ulam("render", json.dumps(SCENE), "--sampler", "sampler.json", "--spp", 1, "-o", "a.exr")
        self.ulam("render", "grid_of_holes", "--set", "scene.film.width=16", "--set", "scene.film.height=16",
                  "--set", "scene.back=emitter", "--sampler", '{"type": "path"}', "--spp", 16, "-o", "b.exr")

    def test_bad_configurations_are_exit_4_and_name_the_nearest(self):
        self.assertIn('"max_depth"', self.render("--set", "sampler.max_dept=3", expect=4).stderr)
        self.assertIn('"radiance"', self.render("--set", "scene.lamp.emitter.radianc=3", expect=4).stderr)
        self.assertIn('"path"', self.ulam("render", "scene.json", "--sampler", "pth", "--spp", 1, "-o", "x.exr",
                                          expect=4).stderr)
        self.assertIn('"grid_of_holes"', self.ulam("render", "grid_of_hole", "--sampler", "path", "--spp", 1, "-o",
                                                   "x.exr", expect=4).stderr)
        (self.folder / "broken.json").write_text('{"type": "scene",\n  "a": }')
        self.assertIn("broken.json:2:8", self.ulam("render", "broken.json", "--sampler", "path", "--spp", 1, "-o",
                                                   "x.exr", expect=4).stderr)
        self.render("--mutations", 100, expect=4)

    def test_a_black_image_is_no_result(self):
        done = self.render("--set", "scene.sensor.to_world=[{\"type\": \"lookat\", \"origin\": [0,0,4], "
                           "\"target\": [0,0,9], \"up\": [0,1,0]}]", expect=4)
        self.assertIn("no path carried light", done.stderr)
        self.assertFalse((self.folder / "out.exr").exists())

    def test_missing_inputs_are_exit_5(self):
        self.ulam("render", "none.json", "--sampler", "path", "--spp", 1, "-o", "x.exr", expect=5)
        self.render("--plugin", "none.so", expect=5)

    def test_what_cannot_be_written_is_exit_6_before_any_work(self):
        (self.folder / "file").write_text("")
        start = time.monotonic()
        self.ulam("render", "scene.json", "--sampler", "path", "--time", 60, "-o", "file/out.exr", expect=6)
        self.render("--stats", "none/out.json", expect=6)
        self.assertLess(time.monotonic() - start, 20)

    def test_a_file_that_is_no_plugin_says_why(self):
        (self.folder / "no.so").write_text("text")
        self.assertIn("no.so", self.render("--plugin", "no.so", expect=4).stderr)

    def test_a_signal_ends_a_render_with_an_image(self):
        process = subprocess.Popen([os.path.abspath(ULAM), "render", "scene.json", "--sampler", "path", "--time", "60",
                                    "-o", "out.exr"], cwd=self.folder, stderr=subprocess.PIPE)
        time.sleep(3)
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=30)
        self.assertEqual(process.returncode, 143)
        self.assertTrue((self.folder / "out.exr").exists())


class Describe(CliTest):
    def test_lists_are_json(self):
        for kind in ("samplers", "mutations", "kernels", "targets", "bsdfs", "shapes", "emitters", "sensors", "textures", "metrics",
                     "generators"):
            items = json.loads(self.ulam("list", kind, "--json").stdout)
            self.assertTrue(items, kind)
            for item in items:
                self.assertTrue(item["name"] and item["summary"], item)
                one = json.loads(self.ulam("list", kind, item["name"], "--json").stdout)
                self.assertEqual(one, [item])
                break
        self.assertIn('"bdpt"', self.ulam("list", "samplers", "bdtp", expect=4).stderr)
        self.assertIn("max_depth", self.ulam("list", "samplers", "path").stdout)

    def test_schemas_are_draft_7(self):
        for kind in "experiment", "scene":
            schema = json.loads(self.ulam("schema", kind).stdout)
            self.assertEqual(schema["$schema"], "http://json-schema.org/draft-07/schema#")
            text = json.dumps(schema)
            for reference in set(part.split('"')[0] for part in text.split('"#/definitions/')[1:]):
                self.assertIn(reference, schema["definitions"])

    def test_scene_information(self):
        info = json.loads(self.ulam("scene", "scene.json", "--info", "--json").stdout)
        self.assertEqual((info["width"], info["emitters"], len(info["hash"])), (16, 1, 64))
        self.assertIn("16 x 16", self.ulam("scene", "scene.json", "--info").stdout)

    def test_files_may_lie_in_the_folders_of_resource_path(self):
        for name in ("scenes", "meshes"):
            (self.folder / name).mkdir()
        (self.folder / "meshes/m.obj").write_text("v 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\n")
        absolute = str(self.folder / "meshes/m.obj")
        for name, filename in (("relative", "m.obj"), ("absolute", absolute), ("up", "../meshes/m.obj")):
            self.write(f"scenes/{name}.json", dict(SCENE, mesh={"type": "obj", "filename": filename}))
            refused = self.ulam("scene", f"scenes/{name}.json", "--info", expect=5 if name == "relative" else 4).stderr
            self.assertEqual("--resource-path" in refused, name != "relative")
            allowed = ("--resource-path", "scenes", "--resource-path", "meshes")
            self.ulam("scene", f"scenes/{name}.json", "--info", *allowed)
            self.ulam("render", f"scenes/{name}.json", "--sampler", "path", "--spp", 1, "-o", "x.exr", *allowed)
            self.write("scenes/experiment.json", dict(EXPERIMENT, scenes={"wall": f"{name}.json"}))
            self.ulam("run", "scenes/experiment.json", "--dry-run", *allowed)
        self.ulam("scene", "scene.json", "--info", "--resource-path", "none", expect=5)

    def test_a_scene_is_exported(self):
        self.write("scene.json", dict(SCENE, integrator={"type": "path"}))
        for _ in range(2):
            done = self.ulam("scene", "scene.json", "--export", "mitsuba3", "out")
            self.assertEqual(done.stdout, "out/scene.xml\n")
            self.assertEqual(done.stderr, 'left out: "path" at /integrator\n')
        shapes = xml.etree.ElementTree.parse(self.folder / "out/scene.xml").getroot().findall("shape")
        self.assertEqual([shape.get("id") for shape in shapes], ["wall", "lamp"])
        self.write("out/mine", {})
        self.assertIn("out holds mine", self.ulam("scene", "scene.json", "--export", "mitsuba3", "out", expect=6).stderr)
        self.ulam("scene", "scene.json", "--export", "mitsuba3", "scene.json/out", expect=6)
        self.assertEqual(self.ulam("scene", "scene.json", "--export", "pbrt4", "pbrt").stdout, "pbrt/scene.pbrt\n")
        read = json.loads(self.ulam("scene", "pbrt/scene.pbrt", "--info", "--json").stdout)
        self.assertEqual((read["shapes"], read["emitters"]), (2, 1))
        self.ulam("scene", "pbrt/scene.pbrt", "-D", "a=1", "--info", expect=2)

    def test_compare(self):
        self.render()
        same = json.loads(self.ulam("compare", "out.exr", "out.exr", "--json").stdout)["metrics"]
        self.assertEqual(same["relmse"]["value"], 0)
        self.assertIsNone(same["psnr"]["value"])
        self.assertIn("flip", self.ulam("compare", "out.exr", "out.exr").stdout)
        self.ulam("compare", "out.exr", "none.exr", expect=5)

    def test_compare_refuses_what_is_no_variance(self):
        self.render()
        self.write_pfm("good.pfm", 0.001)
        self.ulam("compare", "out.exr", "out.exr", "--variance", "good.pfm")
        for value in -0.001, float("nan"), float("inf"):
            self.write_pfm("bad.pfm", value)
            done = self.ulam("compare", "out.exr", "out.exr", "--variance", "bad.pfm", expect=4)
            self.assertIn("bad.pfm", done.stderr)


class Run(CliTest):
    def setUp(self):
        super().setUp()
        self.write("tiny.json", EXPERIMENT)

    def test_leaves_a_run_and_ends_with_verdict_and_report(self):
        done = self.ulam("run", "tiny.json")
        lines = done.stdout.splitlines()
        self.assertEqual(len(lines), 2)
        self.assertRegex(lines[0], r"^wall: bdpt has [\d.e-]+ times the relMSE of path .*undecided$")
        report = pathlib.Path(lines[1])
        self.assertEqual(report, (self.folder / "runs/tiny-1/report.html").resolve())
        for name in ("experiment.json", "resolved.json", "provenance.json", "summary.json", "summary.csv", "comparisons.csv", "summary.md",
                     "summary.tex", "report.html", "cells/wall-path/r002/image.exr", "cells/wall-path/r002/result.json"):
            self.assertTrue((report.parent / name).exists(), name)
        self.assertIn("too few replicates for a verdict", done.stderr)
        provenance = json.loads((report.parent / "provenance.json").read_text())
        self.assertIn("run", provenance["arguments"])
        if pathlib.Path("/etc/os-release").exists():
            self.assertEqual(provenance["machine"]["distribution"], platform.freedesktop_os_release()["PRETTY_NAME"])

        # A second run is another folder, and its reference comes from the cache.
        again = self.ulam("run", "tiny.json", "--json", "--quiet")
        summary = json.loads(again.stdout)
        self.assertEqual(summary["cells"][0]["reference_image"].split("/")[0], "references")
        self.assertTrue((self.folder / "runs/tiny-2/report.html").exists())
        self.assertEqual(len(list((self.folder / "cache/ulam/references").iterdir())), 1)

        self.ulam("report", "runs/tiny-2")
        self.ulam("report", "runs/none", expect=5)

    def test_resume(self):
        self.ulam("run", "tiny.json", "-o", "out")
        self.ulam("run", "tiny.json", "-o", "out", expect=2)
        (self.folder / "out/cells/wall-bdpt/r001/result.json").unlink()
        self.assertIn("5 replicates were there already, 1 are new",
                      self.ulam("run", "tiny.json", "-o", "out", "--resume").stderr)

    def test_resume_does_damaged_files_again(self):
        self.ulam("run", "tiny.json", "-o", "out")
        result = self.folder / "out/cells/wall-bdpt/r001/result.json"
        result.write_text(json.dumps(dict(json.loads(result.read_text()), task_hash=3)))
        (self.folder / "out/cells/wall-path/r000/image.exr").write_text("damaged")
        for reference in self.folder.glob("**/references/*/variance.exr"):
            reference.write_text("damaged")
        left = self.folder / f"out/cells/wall-path/.ulam-{socket.gethostname()}-99999999-0.tmp"
        left.write_text("half")
        done = self.ulam("run", "tiny.json", "-o", "out", "--resume")
        self.assertIn("4 replicates were there already, 2 are new", done.stderr)
        self.assertIn("wall-path, replicate 1 of 3 is damaged and done again", done.stderr)
        self.assertFalse(left.exists())
        self.assertIn("6 replicates were there already, 0 are new",
                      self.ulam("run", "tiny.json", "-o", "out", "--resume").stderr)

    def test_a_reference_with_a_negative_variance_is_exit_4(self):
        self.render()
        self.write_pfm("bad.pfm", -0.001)
        self.write("file.json", dict(EXPERIMENT, reference={"image": "out.exr", "variance": "bad.pfm"}))
        self.assertIn("bad.pfm", self.ulam("run", "file.json", expect=4).stderr)

    def test_a_scene_without_reference_does_not_stop_the_others(self):
        self.render()
        self.write_pfm("bad.pfm", -0.001)
        self.write("two.json", dict(EXPERIMENT, scenes={"wall": "scene.json", "other": "scene.json"},
                                    reference={"wall": EXPERIMENT["reference"],
                                               "other": {"image": "out.exr", "variance": "bad.pfm"}}))
        self.ulam("run", "two.json", "-o", "out", expect=4)
        done = self.ulam("run", "two.json", "-o", "out", "--resume", "--keep-going", expect=1)
        self.assertIn("6 of 12 replicates failed", done.stderr)
        self.assertIn("the reference of other failed", done.stderr)
        self.assertIn("wall: bdpt has", done.stdout)

    def test_sweeps_of_the_whole_run_are_refused(self):
        self.write("sweep.json", dict(EXPERIMENT, sweep={"metrics": [["mse"], ["relmse"]]}))
        self.assertIn('"metrics"', self.ulam("run", "sweep.json", "--dry-run", expect=4).stderr)

    def test_dry_run_writes_nothing(self):
        done = self.ulam("run", "tiny.json", "--dry-run", "--set", "replicates=4")
        self.assertIn("2 cells, 1 comparisons", done.stdout)
        plan = json.loads(self.ulam("run", "tiny.json", "--dry-run", "--json").stdout)
        self.assertEqual(len(plan["cells"][0]["random_keys"]), 3)
        self.assertGreater(plan["estimated_seconds"], 0)
        self.assertTrue(plan["warnings"])
        self.assertFalse((self.folder / "runs").exists())

    def test_set_names_its_origin(self):
        self.assertIn("--set replicates=many", self.ulam("run", "tiny.json", "--set", "replicates=many", expect=4).stderr)

    def test_bad_inputs(self):
        self.ulam("run", "none.json", expect=5)
        self.write("typo.json", dict(EXPERIMENT, replicats=3))
        self.assertIn('"replicates"', self.ulam("run", "typo.json", expect=4).stderr)
        (self.folder / "nan.json").write_text('{"budget": {"time": NaN}}')
        self.ulam("run", "nan.json", expect=4)
        (self.folder / "file").write_text("")
        self.ulam("run", "tiny.json", "-o", "file/run", expect=6)

    def test_a_signal_keeps_what_is_finished(self):
        self.write("slow.json", dict(EXPERIMENT, budget={"time": 2}, replicates=20))
        process = subprocess.Popen([os.path.abspath(ULAM), "run", "slow.json", "-o", "out"], cwd=self.folder,
                                   env=self.environment, stderr=subprocess.PIPE)
        for _ in range(600):
            if list(self.folder.glob("out/cells/*/*/result.json")):
                break
            time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        _, message = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        self.assertIn(b"--resume", message)
        self.assertTrue(list(self.folder.glob("out/cells/*/*/result.json")))


if __name__ == "__main__":
    unittest.main()
