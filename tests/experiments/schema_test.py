#!/usr/bin/env python3
"""`ulam schema experiment` says of a file what `ulam run` says: hundreds of experiments, each with one value changed, are
given to both."""

import copy
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.append(str(ROOT / "tests/support"))
import packages  # noqa: E402, F401

try:
    import jsonschema
except ImportError:
    print("the schema is not checked: the Python package jsonschema is not installed")
    sys.exit(0)

ULAM = os.path.abspath(os.environ.get("ULAM", "build/release/ulam"))
FULL = os.environ.get("ULAM_TEST_LEVEL") == "full"
QUICK_CASES = 300

# Little time: planning tries each cell.
BASE = {
    "scene": {"type": "sphere_light_center"},
    "film": {"width": 16, "height": 16},
    "samplers": {"mlt": {"type": "mlt"}, "other": {"type": "pssmlt"}},
    "baseline": "other",
    "budget": {"time": 0.03},
    "reference": {"sampler": "mlt", "budget": {"time": 0.5}},
}
VALUES = [0, 1, -1, 2, 0.5, 1e9, 1e30, "x", "", True, None, [], {}, [1], [0, 1, 2], {"type": "x"}, ["relmse"], ["psnr"], ["psnr", "relmse"], ["relmse", "psnr"]]
# What a schema cannot know: names that stand elsewhere in the file, which files there are, what a sweep's values are for.
BEYOND_SCHEMAS = ("unknown sampler of this experiment", "has no chains", "cannot read", "does not exist", "unknown scene",
                  "the crop reaches beyond", "at least the", "intervals need", "needs a scene with features", "no parameter of a sampler", "two candidates", "other limits than its budget", "expected at most 10000; give larger ones", " at sweep ", " at tune.sweep ", " twice ", "no point of the sweep", "(/reference/sampler); Known")


def changed(document, path, value):
    copied = copy.deepcopy(document)
    place = copied
    for step in path[:-1]:
        place = place.setdefault(step, {})
    place[path[-1]] = value
    return copied


def candidates(schema):
    values = list(VALUES)
    for bound in ("minimum", "exclusiveMinimum", "maximum", "exclusiveMaximum"):
        if bound in schema:
            limit = int(schema[bound]) if float(schema[bound]).is_integer() else schema[bound]
            values += [limit, limit - 1, limit + 1]
    return values + schema.get("enum", []) + ([schema["default"]] if "default" in schema else []) + schema.get("examples", [])


def experiments(schema):
    """Pairs of what was changed, and the document."""
    definitions = schema["definitions"]
    places = [((name,), s) for name, s in schema["properties"].items()]
    for name, s in definitions["budget"]["properties"].items():
        places += [(("budget", name), s), (("reference", "budget", name), s), (("reference", "part", name), s)]
    places += [(("tune", name), s) for name, s in schema["properties"]["tune"]["properties"].items()]
    places += [(("until", name), s) for name, s in schema["properties"]["until"]["properties"].items()]
    film = schema["properties"]["film"]["properties"]
    places += [(("film", name), s) for name, s in film.items()]
    for filter in film["rfilter"]["anyOf"]:
        kind = filter["properties"]["type"]
        for name in [kind["const"]] if "const" in kind else kind["enum"]:
            places.append((("film", "rfilter"), {"enum": [{"type": name}]}))
        places += [(("film", "rfilter"), {"enum": [{"type": kind["const"], name: value} for value in candidates(s)]})
                   for name, s in filter["properties"].items() if name != "type"]
    for form in definitions["reference"]["anyOf"][1:]:
        places += [(("reference", name), s) for name, s in form["properties"].items()]
    cases = [("nothing", BASE)]
    cases += [(".".join(path), changed(BASE, path, value)) for path, s in places for value in candidates(s)]
    for sampler in definitions["sampler"]["anyOf"]:
        name = sampler["properties"]["type"]["const"]
        document = changed(BASE, ("samplers", "mlt"), {"type": name})
        cases.append((name, document))
        for key, s in sampler["properties"].items():
            if key != "type":
                cases += [(f"{name}.{key}", changed(document, ("samplers", "mlt", key), value)) for value in candidates(s)]
            if key == "mutations":
                for mutation in ("lens", "large_step", "kelemen_step", "mine"):
                    for entry in ({}, {"weight": 2}, {"weight": -1}, {"type": "large_step"}, {"type": "lens"}, {"wight": 1}):
                        cases.append((f"{name}.{mutation}", changed(document, ("samplers", "mlt", key), {mutation: entry})))
    for key in BASE:
        cases.append((f"without {key}", {name: value for name, value in BASE.items() if name != key}))
    for path in (("filmm",), ("film", "widht"), ("film", "pixel_format"), ("film", "rfilter", "type"), ("budget", "tim"), ("samplers", "mlt", "chain"), ("samplers", "a b"), ("reference", "sample"), ("scenes", "a")):
        cases += [(".".join(path), changed(BASE, path, value)) for value in (1, {"type": "path"}, {"type": "cornell_box"})]
    ranges = [[2, 3], [], 3, "2"]
    for scale in ("linear", "log", "lin"):
        for ends in ([2, 4], [4, 2], [0, 4], [2], [2, 3, 4], ["2", 4]):
            for number in ("steps", "draws", "step"):
                ranges += [{scale: ends, number: n} for n in (3, 1, 0, 1000, 1001, 1.5)]
    cases += [("sweep.max_depth", changed(BASE, ("sweep", "max_depth"), values)) for values in ranges]
    cases += [("sweep.zip", changed(BASE, ("sweep", "zip", "max_depth"), values)) for values in ranges[:12]]
    sweeping = changed(BASE, ("sweep", "max_depth"), [2, 3])
    for comparison in ("<", "<=", ">", ">=", "==", "!=", "in", "=>", 1):
        for value in (3, [2, 3], [], {"path": "budget.time"}, {"pth": 1}, None):
            condition = ["max_depth", comparison, value]
            cases += [("where", changed(sweeping, ("sweep", "where"), where)) for where in ([condition], [condition[:2]], condition)]
    once = {json.dumps(document): (what, document) for what, document in cases}
    return list(once.values())


def described(schema, name=""):
    """Every key that the schema knows, with what it says of it."""
    if isinstance(schema, dict):
        for key, value in schema.get("properties", {}).items():
            yield f"{name}/{key}", value
        for key, value in schema.items():
            if key not in ("default", "examples"):
                yield from described(value, f"{name}/{key}")
    elif isinstance(schema, list):
        for i, value in enumerate(schema):
            yield from described(value, f"{name}/{i}")


class Schema(unittest.TestCase):
    def test_every_key_has_a_meaning_and_an_example_that_holds(self):
        schema = json.loads(subprocess.check_output([ULAM, "schema", "experiment"]))
        keys = 0
        for name, said in described(schema):
            if "const" in said or name.endswith("/type") or name.endswith("/value"):
                continue  # the one value it has, or the part of a colour
            with self.subTest(name):
                keys += 1
                self.assertIn("description", said)
                self.assertTrue(said.get("examples"))
                for example in said["examples"]:
                    jsonschema.Draft7Validator({**said, "definitions": schema["definitions"]}).validate(example)
        self.assertGreater(keys, 500)

    def test_the_schema_and_the_program_agree(self):
        schema = json.loads(subprocess.check_output([ULAM, "schema", "experiment"]))
        jsonschema.Draft7Validator.check_schema(schema)
        validator = jsonschema.Draft7Validator(schema)
        cases = experiments(schema)
        if not FULL:
            cases = random.Random(1).sample(cases, QUICK_CASES)
        with tempfile.TemporaryDirectory() as folder:
            def run(case):
                number, (what, document) = case
                file = pathlib.Path(folder) / f"{number}.json"
                file.write_text(json.dumps(document))
                done = subprocess.run([ULAM, "run", file, "--dry-run", "--quiet", "--json"], capture_output=True, text=True)
                file.unlink()
                error = next(validator.iter_errors(document), None)
                return what, document, done.returncode, done.stderr, error and error.message

            with ThreadPoolExecutor(2) as pool:
                results = list(pool.map(run, enumerate(cases)))
        accepted = refused = 0
        for what, document, code, message, error in results:
            with self.subTest(what):
                self.assertIn(code, (0, 4, 5), message)
                if any(text in message for text in BEYOND_SCHEMAS):
                    self.assertNotEqual(code, 0)
                    continue
                self.assertEqual(code == 0, error is None, f"{json.dumps(document)}\nprogram: {message or 'accepted'}\nschema: {error or 'accepted'}")
                accepted, refused = accepted + (code == 0), refused + (code != 0)
        print(f"{accepted} experiments accepted by both, {refused} refused by both")
        self.assertGreaterEqual(accepted + refused, 200)
        self.assertGreater(min(accepted, refused), 30)


if __name__ == "__main__":
    unittest.main()
