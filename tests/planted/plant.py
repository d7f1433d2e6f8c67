#!/usr/bin/env python3
"""Writes altered copies of sources: each alteration of a list becomes a choice at run time, by ULAM_PLANTED.

    plant.py SOURCE_DIR OUT_DIR LIST.toml…

A list holds entries [[bug]] with an id (unique over all lists) and one or more places: `file`, `old` and `new`, either
in the entry itself or in its list `places`. `old` is an expression, which becomes (chosen ? (new) : (old)), or, where it
ends with ; or }, statements, which become if (chosen) { new } else { old }. It must occur exactly once: in the file, or
in `within`, a longer text that itself occurs once in the file.

Altered sources go to OUT_DIR/source, headers to OUT_DIR/include, which hides the originals from those that look there
first. OUT_DIR/sources.txt names, one a line, what must be compiled anew: sources that are altered or see an altered
header, directly or not."""

import pathlib
import re
import sys
import tomllib

INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.M)
CODE = ["core", "samplers", "mutations", "experiments"]
DECLARATION = "namespace ulam { extern const int plantedId; }\n"
DEFINITION = DECLARATION + """#include <cstdlib>
namespace ulam {
const int plantedId = [] {
    const char* id = std::getenv("ULAM_PLANTED");
    return id ? std::atoi(id) : 0;
}();
}
"""


class Breach(Exception):
    pass


def entries_of(lists):
    entries = []
    for path in lists:
        with open(path, "rb") as file:
            entries += tomllib.load(file)["bug"]
    ids = [e["id"] for e in entries]
    for i in ids:
        if i < 1 or ids.count(i) > 1:
            raise Breach(f"id {i} is not positive, or used twice")
    return entries


def places_of(entry):
    return entry.get("places") or [entry]


def position(text, old, what):
    if text.count(old) != 1:
        raise Breach(f"{what} occurs {text.count(old)} times instead of once: {old!r}")
    return text.index(old)


def chosen(old, alternatives):
    """The text that stands for `old`: alternatives are pairs of id and new text."""
    if old.rstrip()[-1] in ";}":
        return "".join(f"if (::ulam::plantedId == {i}) {{ {new} }} else " for i, new in alternatives) + f"{{ {old} }}"
    return "(" + "".join(f"::ulam::plantedId == {i} ? ({new}) : " for i, new in alternatives) + f"({old}))"


def altered(source_dir, entries):
    """The new text of every file that is touched, by its name."""
    places = {}
    for entry in entries:
        for place in places_of(entry):
            places.setdefault(place["file"], []).append((entry["id"], place))
    texts = {}
    for name, changes in places.items():
        path = source_dir / name
        if not path.exists():
            raise Breach(f"{name}: no such file")
        text = path.read_text(encoding="utf8")
        spans = {}
        for i, place in changes:
            what, old = f"{name}, bug {i}: the old text", place["old"]
            begin = position(text, place.get("within", old), what)
            if "within" in place:
                begin += position(place["within"], old, what + " in its surroundings")
            spans.setdefault((begin, begin + len(old)), []).append((i, place["new"]))
        end, out = 0, []
        for (begin, after), alternatives in sorted(spans.items()):
            if begin < end:
                raise Breach(f"{name}: the places of bug {alternatives[0][0]} and of another overlap; give them the same old text")
            out += [text[end:begin], chosen(text[begin:after], alternatives)]
            end = after
        texts[name] = DECLARATION + f'#line 1 "{path}"\n' + "".join(out) + text[end:]
    return texts


def affected(source_dir, names):
    """The sources among and behind the altered files."""
    includes = {}
    for folder in CODE:
        for path in (source_dir / folder).rglob("*"):
            if path.suffix in (".h", ".cpp"):
                includes[path.relative_to(source_dir).as_posix()] = INCLUDE.findall(path.read_text(encoding="utf8"))
    reached = set(names)
    while grown := {n for n, seen in includes.items() if n not in reached and reached.intersection(seen)}:
        reached |= grown
    return sorted(n for n in reached if n.endswith(".cpp"))


def write(path, text):
    """Only where it changes: what did not is not compiled again."""
    if path.exists() and path.read_text(encoding="utf8") == text:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf8")


def main():
    source_dir, out_dir = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    try:
        texts = altered(source_dir, entries_of(sys.argv[3:]))
    except Breach as breach:
        sys.exit(f"planted bugs: {breach}")
    for name, text in texts.items():
        write(out_dir / ("include" if name.endswith(".h") else "source") / name, text)
    write(out_dir / "source/planted_id.cpp", DEFINITION)
    write(out_dir / "sources.txt", "".join(name + "\n" for name in affected(source_dir, texts)))


if __name__ == "__main__":
    main()
