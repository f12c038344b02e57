"""Each fuzz target of tests/fuzz runs for a minute (PLANEFOLD_FUZZ_SECONDS) under sanitizers and finds nothing."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

if shutil.which("clang++") is None:
    script.skip("clang is not installed")
if script.cache("CMAKE_TOOLCHAIN_FILE") or script.cache("PLANEFOLD_SANITIZE"):
    script.skip("the fuzzers have a build of their own; the native one without sanitizers starts it")

seconds = os.environ.get("PLANEFOLD_FUZZ_SECONDS", "60")
build = script.BUILD.parent / "fuzz"
script.run("cmake", "--preset", "fuzz", "-B", build, cwd=script.SOURCE)
script.run("cmake", "--build", build, "--target", "fuzzers", "--parallel", "2")

found = False
for source in sorted((script.SOURCE / "tests" / "fuzz").glob("fuzz_*.cpp")):
    name = source.stem
    with tempfile.TemporaryDirectory() as corpus:
        seeds = script.SOURCE / "tests" / "fuzz" / (name[len("fuzz_"):] + "_seeds")
        command = [build / "bin" / name, f"-max_total_time={seconds}", "-timeout=20", "-rss_limit_mb=2048", "-seed=1",
                   "-max_len=8192", "-verbosity=0", "-print_final_stats=1", f"-artifact_prefix={build}/", corpus]
        command += [seeds] if seeds.is_dir() else []
        result = subprocess.run([str(word) for word in command], text=True, errors="replace", stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT)
    executed = [line for line in result.stdout.splitlines() if "number_of_executed_units" in line]
    print(name, *executed, flush=True)
    if result.returncode != 0:
        found = True
        print(result.stdout[-8000:])
if found:
    script.fail("a fuzzer found something; its input is kept beside the fuzz build")
