#!/usr/bin/env python3
"""The program with planted bugs is the program where none is chosen, and the audit finds the bugs: the ten classics in
the quick suite, all of them in the full one."""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import audit_bugs
import plant

FULL = os.environ.get("ULAM_TEST_LEVEL") == "full"
MOST_ESCAPES = 0.05

SCENE = {
    "type": "scene",
    "sensor": {"type": "perspective", "fov": 60, "film": {"type": "hdrfilm", "width": 16, "height": 16},
               "to_world": [{"type": "lookat", "origin": [0, 0, 4], "target": [0, 0, 0], "up": [0, 1, 0]}]},
    "wall": {"type": "rectangle", "to_world": [{"type": "scale", "value": 3}]},
    "ball": {"type": "sphere", "radius": 0.5, "center": [0, 0, 1], "bsdf": {"type": "dielectric"}},
    "lamp": {"type": "rectangle", "emitter": {"type": "area", "radiance": 4},
             "to_world": [{"type": "rotate", "axis": [1, 0, 0], "angle": 180},
                          {"type": "translate", "value": [2.5, 0, 2]}]},
}
MUTATIONS = ["bidirectional", "lens", "caustic", "multi_chain", "lens_subpath", "kelemen_step", "large_step"]


class PlantedTest(unittest.TestCase):
    def test_the_program_is_the_ordinary_one_where_no_bug_is_chosen(self):
        ordinary = os.environ.get("ULAM", "build/release/ulam")
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder) / "scene.json"
            scene.write_text(json.dumps(SCENE))
            for sampler in [{"type": "mlt", "chains": 10, "mutations": {m: {} for m in MUTATIONS}},
                            {"type": "pssmlt", "chains": 10}, {"type": "path"}, {"type": "light"}, {"type": "bdpt"}]:
                config = pathlib.Path(folder) / "sampler.json"
                config.write_text(json.dumps(sampler))
                work = ["--mutations", "5000"] if "chains" in sampler else ["--spp", "4"]
                images = []
                for program in (ordinary, audit_bugs.PROGRAM):
                    image = pathlib.Path(folder) / "image.exr"
                    stats = pathlib.Path(folder) / "stats.json"
                    subprocess.run([program, "render", scene, "--sampler", config, *work, "--threads", "1",
                                    "-o", image, "--stats", stats], check=True, capture_output=True,
                                   env={k: v for k, v in os.environ.items() if k != "ULAM_PLANTED"})
                    images.append(json.loads(stats.read_text())["image_sha256"])
                self.assertEqual(images[0], images[1], sampler)

    def test_the_audit_finds_the_classics(self):
        classics = [bug for bug in audit_bugs.bugs() if bug.get("classic")]
        self.assertEqual(len(classics), 10)
        for bug in classics:
            with self.subTest(bug["name"]):
                found, seconds, _ = audit_bugs.audit(bug["id"], bug["subject"])
                print(audit_bugs.row(bug, "quick", found, seconds), end="", file=sys.stderr)
                self.assertTrue(found)

    def test_a_failure_of_the_audit_is_replayed_by_its_token(self):
        for bug_id, subject, check in ((3, "mutation lens", "balance"), (9, "mutation lens", "structure"),
                                        (50, "mutation kelemen_step", "jacobian")):
            report = audit_bugs.audit(bug_id, subject)[2]
            found = [f for s in report["subjects"] for f in s["findings"] if f["check"] == check]
            message, token = found[0]["details"][0].split("; ulam replay-path ")
            for planted in (bug_id, 0):
                code, out, _ = audit_bugs.run(planted, "replay-path", token, "--json")
                self.assertEqual(code, 0)
                told = json.loads(out)
                self.assertEqual(told["check"], check)
                (step,) = told["steps"]
                self.assertIn("log_target", step["proposal"])
                self.assertEqual(told["failures"] != [], planted != 0)
                if check == "jacobian":  # judges many trials, of which the token has one
                    continue
                # The state's class is in the message, a letter for each vertex: the token's trial starts at that state.
                self.assertEqual(len(step["current"]["path"]["vertices"]), len(re.search(r"\(state (\w+)\)", message)[1]))
                if planted:
                    self.assertTrue(message.endswith(told["failures"][0]), (message, told["failures"]))

    @unittest.skipUnless(FULL, "all bugs: ULAM_TEST_LEVEL=full")
    def test_the_audit_finds_nearly_all_bugs_and_nothing_where_there_is_none(self):
        bugs = audit_bugs.bugs()
        for subject in dict.fromkeys(bug["subject"] for bug in bugs):
            with self.subTest(subject):
                self.assertEqual(audit_bugs.audit(0, subject)[0], "")
        escaped = [bug["name"] for bug in bugs
                   if not any(audit_bugs.audit(bug["id"], bug["subject"], level)[0] for level in ("quick", "full"))]
        self.assertGreaterEqual(len(bugs), 36)
        self.assertLessEqual(len(escaped), MOST_ESCAPES * len(bugs), escaped)


class PlantTest(unittest.TestCase):
    """The generator, on a small house of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.source = pathlib.Path(folder.name)
        self.write("core/a.h", '#pragma once\ninline int one() { return 1; }\n')
        self.write("core/b.h", '#include "core/a.h"\n')
        self.write("core/b.cpp", '#include "core/b.h"\nint two() { int n = 1; n += 1; return n; }\n')
        self.write("core/c.cpp", "int three() { return 3; }\n")

    def write(self, name, text):
        plant.write(self.source / name, text)

    def altered(self, *entries):
        return plant.altered(self.source, list(entries))

    def test_expressions_and_statements_become_choices(self):
        texts = self.altered({"id": 1, "file": "core/b.cpp", "old": "n += 1;", "new": "n += 2;"},
                             {"id": 2, "file": "core/b.cpp", "old": "n += 1;", "new": ";"},
                             {"id": 3, "file": "core/b.cpp", "old": "1", "within": "int n = 1", "new": "4"})
        self.assertIn("int n = (::ulam::plantedId == 3 ? (4) : (1)); "
                      "if (::ulam::plantedId == 1) { n += 2; } else if (::ulam::plantedId == 2) { ; } else { n += 1; } return n;",
                      texts["core/b.cpp"])

    def test_what_sees_an_altered_header_is_compiled_anew(self):
        texts = self.altered({"id": 1, "file": "core/a.h", "old": "return 1", "new": "return 2"})
        self.assertEqual(plant.affected(self.source, texts), ["core/b.cpp"])
        texts = self.altered({"id": 1, "file": "core/c.cpp", "old": "3", "new": "4"})
        self.assertEqual(plant.affected(self.source, texts), ["core/c.cpp"])

    def test_a_list_that_does_not_fit_the_code_is_refused(self):
        for entry, message in [({"old": "five", "new": "6"}, "occurs 0 times"), ({"old": "n", "new": "6"}, "times instead of once"),
                               ({"file": "core/d.cpp", "old": "n", "new": "6"}, "no such file")]:
            with self.assertRaisesRegex(plant.Breach, message):
                self.altered({"id": 1, "file": "core/b.cpp", **entry})
        with self.assertRaisesRegex(plant.Breach, "overlap"):
            self.altered({"id": 1, "file": "core/b.cpp", "old": "n += 1", "new": "6"},
                         {"id": 2, "file": "core/b.cpp", "old": "n += 1;", "new": "6"})
        one = self.source / "one.toml"
        one.write_text('[[bug]]\nid = 1\n')
        with self.assertRaisesRegex(plant.Breach, "used twice"):
            plant.entries_of([one, one])

    def test_what_did_not_change_is_not_written(self):
        path = self.source / "core/c.cpp"
        before = path.stat().st_mtime_ns
        plant.write(path, path.read_text())
        self.assertEqual(path.stat().st_mtime_ns, before)


if __name__ == "__main__":
    unittest.main()
