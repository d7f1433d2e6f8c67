"""What other programs find in ours: the sanitizers of the compiler, and at the full level clang-tidy and the lines that
no test reaches. Embree, TBB and OpenImageIO are Debian's, not instrumented."""

import json
import os
import pathlib
import shutil
import subprocess
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
FULL = os.environ.get("ULAM_TEST_LEVEL") == "full"
# Counted in allocations, compared with another renderer, or written in Python around the ordinary program.
ORDINARY_ONLY = r"\.py$|^mitsuba$|allocation"
COVERED = ("core/path", "core/mcmc", "mutations")
LEAST_COVERAGE = 0.95


class Tools(unittest.TestCase):
    def output(self, *command, **environment):
        done = subprocess.run(command, cwd=ROOT, env=os.environ | environment, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace")
        self.assertEqual(done.returncode, 0, f"{command}:\n{done.stdout[-20000:]}")
        return done.stdout

    def build(self, preset, target="all"):
        self.output("cmake", "--preset", preset)
        self.output("cmake", "--build", "--preset", preset, "--target", target)

    def run_programs(self, preset, **environment):
        self.output("ctest", "--test-dir", f"build/{preset}", "--output-on-failure", "--parallel", str(os.cpu_count()),
                    "-E", ORDINARY_ONLY, ULAM_TEST_LEVEL="quick", **environment)

    def test_address_and_undefined_behaviour(self):
        self.output("cmake", "--build", "--preset", "release", "--target", "test_instrumented")
        self.output("build/release/tests/test_instrumented", "1", "2", UBSAN_OPTIONS="print_stacktrace=1")

    @unittest.skipUnless(FULL, "takes long")
    def test_address_and_undefined_behaviour_of_test_programs(self):
        self.build("asan")
        self.build("asan", "test_everything")
        self.output("build/asan/tests/test_everything", "20", "2", UBSAN_OPTIONS="print_stacktrace=1")
        self.run_programs("asan", UBSAN_OPTIONS="print_stacktrace=1")

    @unittest.skipUnless(FULL, "takes long")
    def test_threads(self):
        self.build("tsan", "test_everything")
        self.output("build/tsan/tests/test_everything", "5", "5")

    @unittest.skipUnless(FULL and shutil.which("run-clang-tidy"), "takes long, and needs clang-tidy")
    def test_clang_tidy(self):
        self.output("cmake", "--preset", "asan")  # its files of many files are parsed quickly
        self.output("run-clang-tidy", "-quiet", "-p", "build/asan", "^(?!.*/tests/).*")

    @unittest.skipUnless(FULL and shutil.which("gcovr"), "takes long, and needs gcovr")
    def test_coverage(self):
        self.build("coverage")
        for counts in (ROOT / "build/coverage").rglob("*.gcda"):
            counts.unlink()
        self.run_programs("coverage")
        report = json.loads(self.output("gcovr", "--json-summary",
                                        *(f"--filter={folder}/" for folder in COVERED), "build/coverage"))
        for folder in COVERED:
            files = [f for f in report["files"] if f["filename"].startswith(folder + "/")]
            covered, total = (sum(f[key] for f in files) for key in ("line_covered", "line_total"))
            print(f"{folder}: {covered} of {total} lines, {covered / total:.1%}", flush=True)
            self.assertGreaterEqual(covered, LEAST_COVERAGE * total,
                                    [f"{f['filename']}: {f['line_covered']} of {f['line_total']}" for f in files])


if __name__ == "__main__":
    unittest.main(verbosity=2)
