#!/usr/bin/env python3
"""A mutation from outside the tree: built as docs/plugins.md says, listed, rendered with."""

import json
import os
import pathlib
import shlex
import subprocess
import tempfile
import unittest

ULAM = os.path.abspath(os.environ.get("ULAM", "build/release/ulam"))
ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLE = pathlib.Path(__file__).resolve().parent / "uniform_step.cpp"


def compile_command():
    """The command of the page, so that the page is tested."""
    for line in (ROOT / "docs" / "plugins.md").read_text(encoding="utf8").splitlines():
        if line.strip().startswith("g++"):
            return line.strip().replace("-I ULAM", f"-I {shlex.quote(str(ROOT))}")
    raise AssertionError("docs/plugins.md has no g++ command")


class PluginTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = pathlib.Path(cls.temporary.name)
        (cls.folder / EXAMPLE.name).write_bytes(EXAMPLE.read_bytes())
        subprocess.run(compile_command(), shell=True, check=True, cwd=cls.folder, timeout=300)

    def ulam(self, *arguments, expect=0):
        done = subprocess.run([ULAM, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder, timeout=300)
        self.assertEqual(done.returncode, expect, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def render(self, output, mutations, *arguments, expect=0):
        sampler = json.dumps({"type": "pssmlt", "chains": 20, "bootstrap": 5000, "max_depth": 3, "mutations": mutations})
        return self.ulam("render", '{"type": "furnace", "max_depth": 3}', "--sampler", sampler, "--mutations", 40000, "--quiet",
                         "--set", "scene.film.width=8", "--set", "scene.film.height=8", "-o", output, "--stats", output + ".json",
                         *arguments, expect=expect)

    def test_it_is_listed_with_its_parameters(self):
        plugin = ["--plugin", "./libuniform_step.so"]
        listed = json.loads(self.ulam("list", "mutations", "--json", *plugin).stdout)
        names = [item["name"] for item in (listed if isinstance(listed, list) else listed["mutations"])]
        self.assertIn("uniform_step", names)
        self.assertIn("kelemen_step", names)
        one = self.ulam("list", "mutations", "uniform_step", *plugin).stdout
        self.assertIn("size", one)
        self.assertIn("longest step of a number", one)
        self.assertNotIn("uniform_step", self.ulam("list", "mutations").stdout)

    def test_it_renders(self):
        mix = {"large_step": {"weight": 0.3}, "uniform_step": {"weight": 0.7, "size": 0.05}}
        self.render("a.exr", mix, "--plugin", "./libuniform_step.so", "--threads", 1)
        self.render("b.exr", mix, "--plugin", "libuniform_step.so", "--threads", 2)
        self.assertEqual((self.folder / "a.exr").read_bytes(), (self.folder / "b.exr").read_bytes())
        result = json.loads((self.folder / "a.exr.json").read_text(encoding="utf8"))
        steps = result["mutation_statistics"]["uniform_step"]
        # The furnace: each sample's value varies little, so most small steps are accepted.
        self.assertGreater(steps["proposed"], 25000)
        self.assertGreater(steps["accepted"], 0.5 * steps["proposed"])
        self.assertEqual(result["parameters"]["mutations"]["uniform_step"]["size"], 0.05)
        self.assertAlmostEqual(result["normalization"], 1, delta=0.1)

    @unittest.skipUnless(os.environ.get("ULAM_TEST_LEVEL") == "full", "takes half a minute")
    def test_it_is_audited(self):
        done = self.ulam("verify", "--mutation", "uniform_step", "--plugin", "./libuniform_step.so", "--json", "--page", "audit.html")
        findings = {f["check"]: f for f in json.loads(done.stdout)["subjects"][0]["findings"]}
        self.assertEqual({f["outcome"] for f in findings.values()} - {"passed", "reported", "not audited"}, set())
        self.assertEqual(findings["mixed invariance"]["outcome"], "passed")
        self.assertIn("uniform_step", (self.folder / "audit.html").read_text(encoding="utf8"))

    def test_without_it_the_name_is_unknown(self):
        done = self.render("c.exr", {"uniform_step": {}}, expect=4)
        self.assertIn('"uniform_step"', done.stderr)

    def test_bad_parameters_and_bad_files_are_refused(self):
        done = self.render("d.exr", {"uniform_step": {"size": 7}}, "--plugin", "./libuniform_step.so", expect=4)
        self.assertIn("size", done.stderr)
        self.assertIn("missing.so", self.ulam("list", "mutations", "--plugin", "missing.so", expect=5).stderr)
        (self.folder / "text.so").write_text("not a library", encoding="utf8")
        self.assertIn("text.so", self.ulam("list", "mutations", "--plugin", "text.so", expect=4).stderr)


if __name__ == "__main__":
    unittest.main()
