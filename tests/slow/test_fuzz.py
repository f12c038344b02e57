"""Every fuzz target of tests/fuzz runs for a minute (PLANEFOLD_FUZZ_SECONDS) under sanitizers and finds nothing."""

import os
import pathlib
import shutil
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

FUZZ = script.SOURCE / "tests" / "fuzz"
if script.cache("CMAKE_TOOLCHAIN_FILE") or script.cache("PLANEFOLD_SANITIZE"):
    script.skip("the fuzzers have a build of their own; the native one without sanitizers starts it")
names = ", ".join(path.stem for path in sorted(FUZZ.glob("fuzz_*.cpp")))
if shutil.which("clang++") is None:
    script.skip(f"clang is not installed, so that these were not run: {names}")

# The targets of the library run twice, in double and in float.
count = sum(1 if "platform" in path.read_text() else 2 for path in FUZZ.glob("fuzz_*.cpp"))
seconds = float(os.environ.get("PLANEFOLD_FUZZ_SECONDS", "60"))
result = subprocess.run([script.SOURCE / "tools" / "fuzz", f"{seconds * count / 60:.3f}", "--jobs", "2"], cwd=script.SOURCE)
if result.returncode != 0:
    script.fail("a fuzzer found something, or was not built")
