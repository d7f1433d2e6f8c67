#!/usr/bin/env python3
"""The house's order: who includes whom, that the registry and the files say the same, and that a type's name means one
type. Ends with exit code 1 and a line for each breach."""

import json
import os
import pathlib
import re
import subprocess
import sys

root = pathlib.Path(__file__).resolve().parent.parent

CORE = ["core/base", "core/config", "core/image", "core/scene", "core/path", "core/mcmc", "core/render"]
MAY_INCLUDE = {
    "core/base": [],
    "core/config": ["core/base"],
    "core/image": ["core/base"],
    "core/scene": CORE[:3],
    "core/path": CORE[:4],
    "core/mcmc": CORE[:5],
    "core/render": CORE[:6],
    "samplers": CORE,
    "mutations": CORE[:6],
    "experiments": CORE,
}
# Libraries that one place alone knows.
ONLY_IN = {"OpenImageIO/": "core/image/", "embree": "core/scene/", "pugixml": "core/scene/", "httplib": "experiments/cli/"}

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.M)
REGISTRATION = re.compile(r'^ULAM_REGISTER(?:_[A-Z]+)?\(\s*(?:::ulam::)?\w+\s*,(?:[^"]*,)?\s*"([^"]+)"', re.M)

NAMESPACE = re.compile(r"namespace\s*([\w:]*)\s*\{(?!.*\})")
TYPE = re.compile(r"(?:struct|class|union|enum(?: class)?)\s+(\w+)\b(?!::)[^;]*\{")


def layer_of(path):
    return next((layer for layer in MAY_INCLUDE if path.startswith(layer + "/")), None)


def sources(folder):
    return sorted(p for p in (root / folder).rglob("*") if p.suffix in (".h", ".cpp"))


def include_breaches():
    for layer, allowed in MAY_INCLUDE.items():
        for file in sources(layer):
            name = file.relative_to(root).as_posix()
            for bracket, included in INCLUDE.findall(file.read_text(encoding="utf8")):
                if bracket == "<":
                    for library, place in ONLY_IN.items():
                        if included.startswith(library) and not name.startswith(place):
                            yield f"{name} includes <{included}>, which only {place} may"
                    continue
                if included == "build_info.h":
                    continue
                if not (root / included).exists():
                    yield f'{name} includes "{included}", which is no file seen from the root'
                elif layer_of(included) != layer and layer_of(included) not in allowed:
                    yield f'{name} includes "{included}": {layer} may include {", ".join(allowed) or "nothing"} only'


def registry_breaches(program):
    for kind, folder, all_register in [("samplers", "samplers", True), ("mutations", "mutations", True),
                                       ("generators", "experiments/scenes", False)]:
        listed = {(item["file"], item["name"])
                  for item in json.loads(subprocess.check_output([program, "list", kind, "--json"]))}
        written = set()
        for file in sources(folder):
            names = REGISTRATION.findall(file.read_text(encoding="utf8"))
            if all_register and file.suffix == ".cpp" and not names:
                yield f"{file.relative_to(root)} registers nothing"
            written |= {(file.name, name) for name in names}
        for file, name in sorted(written - listed):
            yield f"{folder}/{file} registers {name}, which `ulam list {kind}` does not know"
        for file, name in sorted(listed - written):
            yield f"`ulam list {kind}` has {name} of {file}, which no file of {folder} registers"


def name_breaches():
    """Types of one name in one namespace are merged by the linker, though they differ: memory is overwritten."""
    places = {}
    for folder in [*MAY_INCLUDE, "tests"]:
        for file in sources(folder):
            namespaces = []
            for line in file.read_text(encoding="utf8").splitlines():
                if opened := NAMESPACE.match(line):
                    namespaces.append(opened[1])
                elif line.startswith("}  // namespace"):
                    namespaces.pop()
                elif (defined := TYPE.match(line)) and "" not in namespaces:
                    places.setdefault("::".join([*namespaces, defined[1]]), set()).add(file.relative_to(root).as_posix())
    for name, files in sorted(places.items()):
        if len(files) > 1:
            yield f"{name} is defined in {' and in '.join(sorted(files))}"


def main():
    breaches = [*include_breaches(), *name_breaches()]
    breaches += registry_breaches(os.environ.get("ULAM", root / "build/release/ulam"))
    for breach in breaches:
        print(breach)
    print(f"{len(breaches)} breaches")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
