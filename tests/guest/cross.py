"""Cross builds for the tests of other processors: one for each, in the folder of its preset, which ./tools/test fills too."""

import fcntl
import os
import pathlib
import shutil
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

TRIPLES = {"aarch64": "aarch64-linux-gnu", "armhf": "arm-linux-gnueabihf", "cortex-m7": "arm-none-eabi"}
DEBIAN = {"aarch64": "arm64", "armhf": "armhf"}
EMULATORS = {"aarch64": "qemu-aarch64", "armhf": "qemu-arm", "cortex-m7": "qemu-system-arm"}
SESSION = script.SOURCE / "tests" / "guest" / "session"
WARNINGS = ["-std=c11", "-O2", "-Wall", "-Wextra", "-Werror"]


def compiler(name, language="gcc"):
    return f"{TRIPLES[name]}-{language}"


def emulator(name):
    """Path of the emulator, or None."""
    return shutil.which(EMULATORS[name]) or shutil.which(EMULATORS[name] + "-static")


def have(name):
    """Why this processor cannot be built for or emulated here; empty where it can."""
    if shutil.which(compiler(name, "g++")) is None:
        return f"there is no {compiler(name, 'g++')}"
    return "" if emulator(name) else f"there is no {EMULATORS[name]}"


def skip_without(name):
    script.skip_unless_plain_native_build()
    if have(name):
        script.skip(have(name))


def sysroot(name):
    """Libraries of the target for programs; skips where they cannot be had."""
    folder = script.SOURCE / "build" / "sysroot" / name
    if not (folder / "sysroot.stamp").exists():
        command = [str(script.SOURCE / "toolchains" / "make_sysroot.sh"), DEBIAN[name], str(folder)]
        print("+", *command, flush=True)
        if os.spawnvp(os.P_WAIT, command[0], command) != 0:
            script.skip(f"no sysroot for {name}: Debian's packages cannot be had here")
    return folder


def build(name, *targets, programs=False):
    """Builds targets for a processor and gives the folder of that build.

    programs  among the targets are programs, which need the target's libraries: skips where they cannot be had
    """
    if programs:
        sysroot(name)
    folder = script.SOURCE / "build" / name
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # tests run at the same time
        configure = ["cmake", "--preset", name]
        if (folder / "build.ninja").exists():  # what was asked for before stays, or everything would be compiled again
            configure = ["cmake", "-S", script.SOURCE, "-B", folder]
        if programs or (root_of(name) / "sysroot.stamp").exists():
            configure += ["-DPLANEFOLD_BUILD_PROGRAMS=ON", "-DPLANEFOLD_DRAWING=OFF"]
        script.run(*configure, cwd=script.SOURCE)
        script.run("cmake", "--build", folder, "--parallel", str(os.cpu_count()), "--target", *targets)
    return folder


def package(name):
    """The tarball that tools/package makes, by the build folder of this build; made once for the tests that want it."""
    folder = script.BUILD / "cross" / f"{name}-package"
    folder.mkdir(parents=True, exist_ok=True)
    with open(script.BUILD / "cross" / f"{name}-package.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # tests run at the same time
        said = script.run(script.SOURCE / "tools" / "package", name, "--build", folder)
    return script.SOURCE / said.splitlines()[-1]


def root_of(name):
    """Where the emulator finds the target's shared libraries."""
    folder = script.SOURCE / "build" / "sysroot" / name
    return folder if (folder / "sysroot.stamp").exists() else pathlib.Path("/usr") / TRIPLES[name]


def run_session(folder, archive, session, result, name=None):
    """Build the program of tests/guest/session against an archive, and run it here or under the emulator."""
    program = folder / ("run_session_" + result.stem)
    compile_with = compiler(name) if name else script.c_compiler()
    script.run(compile_with, *WARNINGS, "-DBLOCK_BYTES=8388608", "-I", script.SOURCE / "lib" / "include",
               SESSION / "run_session.c", SESSION / "hosted_io.c", archive, "-lm", "-o", program)
    before = [emulator(name), "-L", root_of(name)] if name else []
    return script.run(*before, program, session, result)
