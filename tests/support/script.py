"""What the script tests share: the environment that ctest gives them, skipping, running commands."""

import os
import pathlib
import subprocess
import sys

BUILD = pathlib.Path(os.environ.get("PLANEFOLD_BUILD", "build/release")).resolve()
SOURCE = pathlib.Path(os.environ.get("PLANEFOLD_SOURCE", pathlib.Path(__file__).resolve().parents[2]))
BIN = pathlib.Path(os.environ.get("PLANEFOLD_BIN", BUILD / "bin"))


def skip(reason):
    """End the test as skipped, with a reason that ./tools/test repeats in its summary."""
    print(f"SKIP: {reason}", flush=True)
    sys.exit(77)


def fail(message):
    print(f"FAIL: {message}", flush=True)
    sys.exit(1)


def run(*command, **options):
    """Run a command, show it, and end the test where it fails. Gives its output."""
    print("+", *command, flush=True)
    result = subprocess.run([str(word) for word in command], text=True, stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, **options)
    if result.returncode != 0:
        print(result.stdout)
        fail(f"{command[0]} ended with {result.returncode}")
    return result.stdout


def cache(name, default=""):
    """Value of a CMake cache entry of this build."""
    for line in (BUILD / "CMakeCache.txt").read_text().splitlines():
        if line.startswith(name + ":"):
            return line.split("=", 1)[1]
    return default


def is_on(name):
    return cache(name).upper() in ("ON", "1", "TRUE", "YES")


def skip_in_cross_builds():
    if cache("CMAKE_TOOLCHAIN_FILE"):
        skip("programs are run in native builds")


def skip_unless_plain_native_build():
    """For tests of the package as it ships: not instrumented, and able to run here."""
    if cache("PLANEFOLD_SANITIZE") or is_on("PLANEFOLD_COVERAGE"):
        skip("the package is tested in builds without instrumentation")
    if cache("CMAKE_TOOLCHAIN_FILE"):
        skip("the package is built and run in native builds")


def install_tree(prefix):
    """Install headers, archives and package files of this build under prefix."""
    run("cmake", "--install", BUILD, "--prefix", prefix, "--component", "development")


def c_compiler():
    return cache("CMAKE_C_COMPILER", "cc")
