"""tools/package aarch64: a stranger's C program of 25 lines, the one in README.md, cross-builds against the tarball with
the C compiler and pkg-config alone, and runs; pf-capture of the tarball tracks a real sequence, or a built-in scene where
there is none, as it is tracked here."""

import math
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import cross  # noqa: E402
import script  # noqa: E402

NAME = "aarch64"
BOUND_M, FRAMES = 1e-4, 100
SCENE_BOUND_M, SCENE_FRAMES = 1e-2, 30  # pixels that are rendered may round to another grey level there
cross.skip_without(NAME)
root = cross.sysroot(NAME)
HERE = script.BIN / "pf-capture"
if not HERE.exists():
    script.skip("pf-capture is not built")


def c_library_alone(root, program, folder):
    """A root for the emulator that holds the C library of Debian 12 and nothing else, which is all that the program may need; no
    version of it that is later than Debian 12's."""
    said = script.run(cross.compiler(NAME, "readelf"), "-dV", program)
    needed = set(re.findall(r"NEEDED.*\[(.*)\]", said))
    if not needed <= {"libc.so.6", "libm.so.6", "ld-linux-aarch64.so.1"}:
        script.fail(f"pf-capture of the tarball needs {sorted(needed)}; devices have the C library for certain, and no more")
    latest = max(tuple(map(int, version.split("."))) for version in re.findall(r"GLIBC_([\d.]+)", said))
    print(f"pf-capture of the tarball needs {', '.join(sorted(needed))} of glibc {'.'.join(map(str, latest))}")
    if latest > (2, 36):
        script.fail("pf-capture of the tarball does not start on Debian 12, whose glibc is 2.36")
    (folder / "lib").mkdir(parents=True)
    for name in ("libc.so.6", "libm.so.6", "ld-linux-aarch64.so.1"):
        found = next(path for path in (root / "lib/aarch64-linux-gnu" / name, root / "lib" / name) if path.exists())
        shutil.copy(found.resolve(), folder / "lib" / name)
    return folder


def film(width, height, frames):
    """Blocks of grey that move to the left."""
    print("seed 1", flush=True)
    random.seed(1)
    rows = [[random.randrange(40, 216) for _ in range((width + 64) // 8)] for _ in range(height // 8)]
    return b"".join(bytes(rows[y // 8][(x + 2 * k) // 8] for y in range(height) for x in range(width)) for k in range(frames))


def places(path):
    return {line.split()[0]: [float(v) for v in line.split()[1:4]] for line in path.read_text().splitlines()
            if line and not line.startswith("#")}


def capture(program, out, *arguments):
    script.run(*program, *arguments, "--headless", "--no-film", "--quiet", "--out", out)
    return places(out / "trajectory.txt")


def furthest_apart(one, other, fewest):
    if one.keys() != other.keys() or len(one) < fewest:
        script.fail(f"{len(one)} and {len(other)} frames were tracked, or not the same ones")
    return max(math.dist(one[t], other[t]) for t in one)


tarball = cross.package(NAME)
with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    with tarfile.open(tarball) as archive:
        archive.extractall(folder)
    prefix = next(folder.glob("planefold-*"))
    print(f"{tarball.name}: {tarball.stat().st_size} bytes")

    program = re.findall(r"^```c\n(.*?)^```$", (script.SOURCE / "README.md").read_text(), re.S | re.M)[0]
    (folder / "track.c").write_text(program)
    environment = dict(os.environ, PKG_CONFIG_LIBDIR=str(prefix / "lib" / "pkgconfig"))
    for package in ("planefold", "planefoldf"):
        flags = script.run("pkg-config", "--cflags", "--libs", package, env=environment).split()
        script.run(cross.compiler(NAME), "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", folder / "track.c", *flags,
                   "-o", folder / package)
        ran = subprocess.run([cross.emulator(NAME), "-L", root, folder / package], input=film(320, 240, 5), capture_output=True)
        print(ran.stdout.decode(), end="")
        if ran.returncode != 0 or len(ran.stdout.splitlines()) != 5:
            script.fail(f"the program of README.md, with {package}, ended with {ran.returncode}")

    there = [cross.emulator(NAME), "-L", c_library_alone(root, prefix / "bin" / "pf-capture", folder / "alone"), prefix / "bin" / "pf-capture"]
    script.run(*there, "--help")
    data = os.environ.get("PLANEFOLD_DATA")
    desk = pathlib.Path(data or "/nonexistent") / "monoslam_desk_a"
    if not desk.is_dir():
        print("PLANEFOLD_DATA has no monoslam_desk_a: a built-in scene takes its place")
        scene = ["--source", "sim:desk", "--start", "target", "--frames", SCENE_FRAMES]
        apart = furthest_apart(capture([HERE], folder / "a", *scene), capture(there, folder / "b", *scene), SCENE_FRAMES // 2)
        print(f"sim:desk: at most {apart:.3g} m apart in {SCENE_FRAMES} frames, allowed {SCENE_BOUND_M:g} m")
        if apart > SCENE_BOUND_M:
            script.fail(f"sim:desk: the two runs are {apart:.3g} m apart")
    else:
        real = ["--source", f"images:{desk}", "--start", f"target:{desk}/target.yaml", "--frames", str(FRAMES)]
        apart = furthest_apart(capture([HERE], folder / "c", *real), capture(there, folder / "d", *real), FRAMES // 2)
        print(f"monoslam_desk_a: at most {apart:.3g} m apart in {FRAMES} frames, allowed {BOUND_M:g} m")
        if apart > BOUND_M:
            script.fail(f"monoslam_desk_a: the two runs are {apart:.3g} m apart")
