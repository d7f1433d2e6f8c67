"""Every reader of files against broken files: each fuzzing program runs for a while and must find nothing."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parent
BUILD = SOURCE.parent.parent / "build" / "fuzz"
FULL = os.environ.get("ULAM_TEST_LEVEL") == "full"
SECONDS = 60 if FULL else 10
FEWEST = 1000  # executions; a reader that manages less is too slow for its input


def build():
    """None, or why the programs cannot be built."""
    if not shutil.which("clang++"):
        return "there is no clang++"
    with tempfile.TemporaryDirectory() as folder:
        probe = pathlib.Path(folder) / "probe.cpp"
        probe.write_text('extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }\n')
        linked = subprocess.run(["clang++", "-fsanitize=fuzzer,address,undefined", probe, "-o", probe.with_suffix("")],
                                capture_output=True, text=True)
    if linked.returncode != 0:
        return "clang++ has no libFuzzer: " + linked.stderr.strip()
    for command in (["cmake", "-G", "Ninja", "-S", SOURCE, "-B", BUILD, "-DCMAKE_CXX_COMPILER=clang++"],
                    ["cmake", "--build", BUILD]):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"{command} failed:\n{done.stdout}")
    return None


class Fuzz(unittest.TestCase):
    def run_target(self, name):
        with tempfile.TemporaryDirectory() as folder:
            corpus = pathlib.Path(folder) / "corpus"
            shutil.copytree(SOURCE / "corpus" / name, corpus)  # new inputs are written there
            done = subprocess.run(
                [BUILD / f"fuzz_{name}", "-seed=1", "-max_len=4096", f"-max_total_time={SECONDS}", "-timeout=10",
                 "-rss_limit_mb=1024", "-print_final_stats=1", f"-artifact_prefix={folder}/", corpus],
                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, cwd=folder)
            output = done.stdout.decode(errors="replace")
            found = "".join(f"\n{file.name}: {file.read_bytes()!r}" for file in pathlib.Path(folder).glob("*-*") if file.is_file())
        self.assertEqual(done.returncode, 0, f"{output[-8000:]}{found}")
        executions = int(re.search(r"stat::number_of_executed_units:\s*(\d+)", output).group(1))
        self.assertGreaterEqual(executions, FEWEST)
        print(f"{name}: {executions} files", flush=True)


for target in ("json", "obj", "pbrt", "ply", "serialized", "xml"):
    setattr(Fuzz, f"test_{target}", lambda self, name=target: self.run_target(name))

if __name__ == "__main__":
    missing = build()
    if missing:
        print(f"{missing}: readers are not fuzzed")
        sys.exit(0)
    unittest.main(verbosity=2)
