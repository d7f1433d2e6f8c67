"""A tiny experiment, the program, and what is to be true of its files after a fault."""

import json
import os
import pathlib
import signal
import subprocess

ULAM = os.path.abspath(os.environ.get("ULAM", "build/release/ulam"))
FULL = os.environ.get("ULAM_TEST_LEVEL") == "full"

SCENE = {
    "type": "scene",
    "sensor": {"type": "perspective", "fov": 60, "film": {"type": "hdrfilm", "width": 8, "height": 8},
               "to_world": [{"type": "lookat", "origin": [0, 0, 4], "target": [0, 0, 0], "up": [0, 1, 0]}]},
    "wall": {"type": "rectangle", "to_world": [{"type": "scale", "value": 3}]},
    "lamp": {"type": "rectangle", "emitter": {"type": "area", "radiance": 4},
             "to_world": [{"type": "rotate", "axis": [1, 0, 0], "angle": 180},
                          {"type": "translate", "value": [2.5, 0, 2]}]},
}

EXPERIMENT = {
    "name": "tiny",
    "scenes": {"wall": "scene.json"},
    "max_depth": 3,
    "samplers": {"path": {"type": "path"}, "pssmlt": {"type": "pssmlt", "chains": 4, "bootstrap": 500}},
    "baseline": "path",
    "budget": {"spp": 4},
    "replicates": 2,
    "snapshots": 1,
    "metrics": ["relmse"],
    "reference": {"sampler": "path", "budget": {"spp": 64}, "part": {"spp": 16}},
}


def write_inputs(folder, experiment=None):
    (folder / "scene.json").write_text(json.dumps(SCENE) + "\n")
    (folder / "tiny.json").write_text(json.dumps(experiment or EXPERIMENT) + "\n")


def start(arguments, folder, variables=None):
    """The program in a folder, whose cache lies in it too; no threads but one."""
    environment = dict(os.environ, XDG_CACHE_HOME=str(folder / "cache"), **(variables or {}))
    return subprocess.Popen([ULAM, *map(str, arguments)], cwd=folder, env=environment, text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def call(arguments, folder, variables=None):
    process = start(arguments, folder, variables)
    try:
        process.out, process.err = process.communicate(timeout=300)
    finally:
        process.kill()
    return process


def run_arguments(*more):
    return ["run", "tiny.json", "-o", "run", "--threads", 1, "--quiet", *more]


def files(folder):
    """The bytes of every file below a folder, by relative name."""
    return {str(file.relative_to(folder)): file.read_bytes()
            for file in sorted(pathlib.Path(folder).rglob("*")) if file.is_file()}


def is_whole(name, data):
    """Not torn, as far as the format tells."""
    try:
        if name.endswith(".json"):
            return data.endswith(b"\n") and json.loads(data) is not None
        if name.endswith(".html"):
            return data.rstrip().endswith(b"</html>")
    except ValueError:
        return False
    return True


TIMES = ("seconds", "speedup", "slope", "efficiency", "per_second")  # the slope is of errors over time


def without_times(value):
    """A summary without what differs from run to run: numbers made of times, and the words and folders made of them."""
    if isinstance(value, dict):
        return {key: without_times(item) for key, item in value.items()
                if not any(time in key for time in TIMES) and key not in ("verdicts", "warnings", "created", "provenance")}
    if isinstance(value, list):
        return [without_times(item) for item in value]
    return value


def is_temporary(name):
    return ".ulam-" in name or "/parts/" in name or "/lease-" in name or name.endswith("checkpoint")


class Undisturbed:
    """What a run leaves when nothing goes wrong, and the comparison with a disturbed one."""

    def __init__(self, folder):
        # The cache is a convenience, and may have been filled or not.
        self.files = {name: data for name, data in files(folder).items() if not name.startswith("cache/")}
        self.images = {name: data for name, data in self.files.items() if name.endswith(".exr")}
        self.summary = without_times(json.loads(self.files["run/summary.json"]))

    def torn(self, folder):
        """Files that are neither whole nor temporary. Images are the same bytes in every run of the same work; those of
        parts of references, which are not there at the end, are judged when the reference is."""
        return [name for name, data in files(folder).items()
                if ".ulam-" not in name and not (self.images.get(name, data) == data and is_whole(name, data))]

    def differences(self, folder):
        """What is not as in the undisturbed run, when everything is done."""
        now = {name: data for name, data in files(folder).items() if not name.startswith("cache/")}
        found = [f"{name} is missing" for name in self.files if name not in now]
        found += [f"{name} is too much" for name in now if name not in self.files or is_temporary(name)]
        found += [f"{name} differs" for name, data in self.images.items() if now.get(name, data) != data]
        if "run/summary.json" in now and without_times(json.loads(now["run/summary.json"])) != self.summary:
            found.append("the summary differs")
        for name, data in self.files.items():
            if name.endswith("result.json") and name in now:
                before, after = json.loads(data), json.loads(now[name])
                found += [f"{key} of {name} differs" for key in before
                          if key.endswith("sha256") and before[key] != after.get(key)]
        return found


def crashed(process):
    """Ended by a signal, or by something that looks like one."""
    return process.returncode < 0 or any(word in process.err for word in ("Sanitizer", "terminate called", "internal error"))
