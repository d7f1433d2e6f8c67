"""What other programs find in ours, at the full level: the sanitizers of the compilers, clang-tidy, the lines that no test
reaches, and builds with other options, which give the same images. Embree, TBB and OpenImageIO are Debian's, not instrumented."""

import json
import os
import pathlib
import signal
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
RELEASE = "build/release"
# Work and threads: more threads than processors, so that they interrupt each other.
EVERYTHING = ("2", "5")
MINUTES = 20  # for one command; a hang is an error too
# Programs that are slow to run when instrumented and reach no other code than the rest are left out.
SANITIZED = ("core_base", "core_config", "core_image", "core_scene", "core_path", "core_mcmc", "core_render",
             "experiments_engine", "experiments_report", "experiments_scenes")
COVERING = ("core_scene", "core_path", "core_mcmc", "core_render", "experiments")
COVERED = ("core/path", "core/mcmc", "mutations")
LEAST_COVERAGE = 0.95


class Tools(unittest.TestCase):
    def output(self, *command, **environment):
        """What the command prints; it must succeed. What it started ends with it."""
        process = subprocess.Popen(command, cwd=ROOT, env=os.environ | {"ULAM_TEST_LEVEL": "quick"} | environment,
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
                                   start_new_session=True)
        try:
            printed, _ = process.communicate(timeout=60 * MINUTES)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            self.fail(f"{command} takes longer than {MINUTES} minutes:\n{process.communicate()[0][-20000:]}")
        self.assertEqual(process.returncode, 0, f"{command}:\n{printed[-20000:]}")
        return printed

    def build(self, preset, *targets):
        if preset != "release":
            self.output("cmake", "--preset", preset)
        self.output("cmake", "--build", f"build/{preset}", "--target", *targets)

    def images(self, preset):
        """The hashes of the images of every sampler; every mutation is audited too."""
        self.build(preset, "test_everything")
        return self.output(f"build/{preset}/tests/test_everything", *EVERYTHING, UBSAN_OPTIONS="print_stacktrace=1")

    def run_program(self, program, *tests):
        print(program, flush=True)
        self.output(program, *tests, ULAM=str(ROOT / RELEASE / "ulam"), UBSAN_OPTIONS="print_stacktrace=1",
                    LSAN_OPTIONS="print_suppressions=0:suppressions=tests/tools/leaks.supp")

    def test_address_and_undefined_behaviour(self):
        # An unoptimised build of another compiler, but the same bytes.
        self.assertEqual(self.images("asan"), self.images("release"))
        self.build("asan", *(f"test_{name}" for name in SANITIZED))
        for name in SANITIZED:
            self.run_program(f"build/asan/tests/test_{name}", "~[speed]")  # of an instrumented program it says nothing

    def test_threads(self):
        self.assertEqual(self.images("tsan"), self.images("release"))

    def test_any_processor(self):
        self.assertEqual(self.images("portable"), self.images("release"))

    def test_clang_tidy(self):
        self.output("cmake", "--preset", "asan")  # its files of many files are parsed quickly
        self.output("run-clang-tidy", "-quiet", "-p", "build/asan", rf"/ulam_[a-z]+\.dir/Unity/|^{ROOT}/(core|mutations|samplers)/")

    def test_coverage(self):
        self.build("release", "covered")
        objects = ROOT / RELEASE / "tests/CMakeFiles/ulam_covered.dir"
        for counts in objects.rglob("*.gcda"):
            counts.unlink()
        for name in COVERING:
            self.run_program(f"{RELEASE}/tests/covered_{name}")
        report = json.loads(self.output("gcovr", "--json-summary", "-r", ".",
                                        *(f"--filter={folder}/" for folder in COVERED), str(objects)))
        for folder in COVERED:
            files = [f for f in report["files"] if f["filename"].startswith(folder + "/")]
            covered, total = (sum(f[key] for f in files) for key in ("line_covered", "line_total"))
            print(f"{folder}: {covered} of {total} lines, {covered / total:.1%}", flush=True)
            self.assertGreaterEqual(covered, LEAST_COVERAGE * total,
                                    [f"{f['filename']}: {f['line_covered']} of {f['line_total']}" for f in files])


if __name__ == "__main__":
    if os.environ.get("ULAM_TEST_LEVEL") != "full":
        print("other tools look at the full level only")
        sys.exit(0)
    unittest.main(verbosity=2)
