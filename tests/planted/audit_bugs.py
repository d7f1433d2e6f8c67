#!/usr/bin/env python3
"""Plants each bug of bugs.toml in turn and has the audit look for it.

    tests/planted/audit_bugs.py [--level quick|full] [--retry] [--into FILE.md] [ID…]

Prints a row of a table for each bug; --into puts the rows in the place of those in a page. --retry: bugs that escape at
quick are audited again at full."""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = pathlib.Path(os.environ.get("ULAM", HERE.parent.parent / "build/release/ulam")).parent / "ulam_planted"
HEAD = "| id | bug | planted in | audited | found by | CPU seconds |\n| --: | --- | --- | --- | --- | --: |\n"


def bugs():
    with open(HERE / "bugs.toml", "rb") as file:
        return tomllib.load(file)["bug"]


def run(bug_id, *arguments):
    """Exit code, standard output and CPU seconds of the program with a bug in it."""
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        process = subprocess.Popen([PROGRAM, *arguments], stdout=out, stderr=err,
                                   env={**os.environ, "ULAM_PLANTED": str(bug_id)})
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0), err.seek(0)
        if process.returncode not in (0, 3):
            raise RuntimeError(f"bug {bug_id}: exit code {process.returncode}: {err.read()}")
        return process.returncode, out.read(), used.ru_utime + used.ru_stime


def audit(bug_id, subject, level="quick", threads=1):
    """What found the bug ('' where nothing did), the CPU seconds until then, and the report."""
    kind, name = subject.split()
    code, out, seconds = run(bug_id, "verify", f"--{kind}", name, "--level", level, "--threads", str(threads),
                             "--stop-at-first", "--json")
    report = json.loads(out)
    found = [f"{f['level']} {f['check']}".strip() for s in report["subjects"] for f in s["findings"]
             if f["outcome"] in ("rejected", "not covered")]
    if (code == 3) != bool(found):
        raise RuntimeError(f"bug {bug_id}: exit code {code}, but {found} found it")
    return ", ".join(found), seconds, report


def row(bug, level, found, seconds):
    files = dict.fromkeys(pathlib.Path(p["file"]).name for p in bug.get("places") or [bug])
    name = bug["name"] + (" *(classic)*" if bug.get("classic") else "")
    found = found and (found if level == "quick" else f"{found} ({level})")
    return f"| {bug['id']} | {name} | {', '.join(files)} | {bug['subject']} | {found or '**nothing**'} | {seconds:.1f} |\n"


def put_rows(page, rows):
    """Replaces the table's rows of these bugs; rows of bugs that are no more go."""
    known = {bug["id"] for bug in bugs()}
    lines = page.read_text(encoding="utf8").splitlines(keepends=True)
    old = {int(m[1]): line for line in lines if (m := re.match(r"\| (\d+) \|", line))}
    table = {i: text for i, text in {**old, **rows}.items() if i in known}
    begin = next(n for n, line in enumerate(lines) if line.startswith("| id |"))
    end = next((n for n in range(begin, len(lines)) if not lines[n].startswith("|")), len(lines))
    page.write_text("".join(lines[:begin]) + HEAD + "".join(table[i] for i in sorted(table)) + "".join(lines[end:]),
                    encoding="utf8")


def evidence(report):
    """The strongest deviations of an audit that rejected nothing, one a line."""
    for subject in report["subjects"]:
        for finding in subject["findings"]:
            yield f"    {finding['level']} {finding['check']}: {finding['summary']} {finding['numbers'].get('most_deviating', '')}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--level", choices=["quick", "full"], default="quick")
    parser.add_argument("--retry", action="store_true", help="audit what escaped again, at full")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--into", type=pathlib.Path, help="page whose table is brought up to date")
    parser.add_argument("ids", type=int, nargs="*")
    arguments = parser.parse_args()
    escaped = []
    for bug in bugs():
        if arguments.ids and bug["id"] not in arguments.ids:
            continue
        for level in [arguments.level] + ["full"] * arguments.retry:
            found, seconds, report = audit(bug["id"], bug["subject"], level, arguments.threads)
            if found:
                break
        text = row(bug, level, found, seconds)
        print(text, end="", flush=True)
        if not found:
            escaped.append(bug["id"])
            print("\n".join(evidence(report)), file=sys.stderr, flush=True)
        if arguments.into:
            put_rows(arguments.into, {bug["id"]: text})
    print(f"{len(escaped)} escaped: {escaped}", file=sys.stderr)


if __name__ == "__main__":
    main()
