"""tools/package aarch64, where it is meant for: in an arm64 guest with a camera of the kernel (vivid). pf-capture of the tarball
sets the camera up and tracks it; a stranger's C program of 25 lines, the one in README.md in the camera's size, built against the
tarball alone, then reads the camera's frames, and says the same about them as it does here."""

import json
import os
import pathlib
import re
import subprocess
import sys
import tarfile
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import cross  # noqa: E402
import guest  # noqa: E402
import script  # noqa: E402

NAME = "aarch64"
WIDTH, HEIGHT, FRAMES = 320, 180, 30  # a size that the camera has
RUN = f"""set -e
vivid="n_devs=1 node_types=0x1 num_inputs=1 input_types=0x0"
. /share/modules.sh
cp /share/pf-capture /share/track /tmp
/tmp/pf-capture --list
timeout -s INT 8 /tmp/pf-capture --source v4l2:/dev/video0 --format GREY --calib /share/camera.yaml --headless --no-film --quiet \\
  --max-features 20 --features-in-view 12 --max-state-dim 90 --delay 200 --out /share/capture && code=0 || code=$?
echo "pf-capture: $code"
# The driver keeps the format, and gives a frame for every read.
dd if=/dev/video0 bs={WIDTH * HEIGHT} count={FRAMES} of=/tmp/frames.raw
cp /tmp/frames.raw /share/frames.raw
/tmp/track </tmp/frames.raw >/share/there.txt
"""


def compile_program(compiler, source, target, prefix):
    environment = dict(os.environ, PKG_CONFIG_LIBDIR=str(next(prefix.rglob("pkgconfig"))))
    flags = script.run("pkg-config", "--cflags", "--libs", "planefold", env=environment).split()
    script.run(compiler, "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", source, *flags, "-o", target)
    return target


def check_capture(share, problems):
    report = share / "capture" / "report.json"
    if not report.is_file():
        script.fail("pf-capture of the tarball wrote no report.json")
    live = json.loads(report.read_text())["live"]
    print(f"pf-capture of the tarball: {json.dumps(live)}")
    camera = live["camera"]
    if live["captured"] < 60 or camera["format"] != "GREY" or camera["damaged"] != 0 or live["interval_ms"]["min"] <= 0:
        problems.append(f"pf-capture of the tarball on vivid: {live}")


def check_program(share, here, problems):
    frames = (share / "frames.raw").read_bytes()
    if len(frames) != WIDTH * HEIGHT * FRAMES or max(frames) - min(frames) < 100:
        problems.append(f"{len(frames)} bytes of the camera, not {FRAMES} frames, or no picture in them")
    said_here = subprocess.run([here], input=frames, capture_output=True, check=True).stdout.decode().splitlines()
    said_there = (share / "there.txt").read_text().splitlines()
    print(f"the program of README.md says {len(said_there)} lines there and {len(said_here)} here, the last: {said_there[-1:]}")
    numbers = [[[float(v) for v in line.split()[:3]] for line in lines] for lines in (said_there, said_here)]
    words = [[line.split()[3:] for line in lines] for lines in (said_there, said_here)]
    apart = max((abs(a - b) for p, q in zip(*numbers) for a, b in zip(p, q)), default=0.0)
    if len(said_there) != FRAMES or words[0] != words[1] or apart > 0.002:
        problems.append(f"the program says other things there: {said_there[:5]} and {said_here[:5]}, {apart} apart")


def main():
    script.skip_unless_plain_native_build()
    guest.require_tools()
    guest.CACHE.mkdir(parents=True, exist_ok=True)
    root = guest.fetch_packages()
    cross.sysroot(NAME)
    tarball = cross.package(NAME)
    problems = []
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        folder = pathlib.Path(name)
        share = folder / "share"
        share.mkdir()
        with tarfile.open(tarball) as archive:
            archive.extractall(folder)
        prefix = next(folder.glob("planefold-*"))
        program = re.findall(r"^```c\n(.*?)^```$", (script.SOURCE / "README.md").read_text(), re.S | re.M)[0]
        (folder / "track.c").write_text(program.replace("240", str(HEIGHT)).replace("119.5", str((HEIGHT - 1) / 2)))
        track = compile_program(cross.compiler(NAME), folder / "track.c", share / "track", prefix)
        script.install_tree(folder / "here")
        here = compile_program(script.c_compiler(), folder / "track.c", folder / "track_here", folder / "here")
        capture = share / "pf-capture"
        capture.write_bytes((prefix / "bin" / "pf-capture").read_bytes())
        capture.chmod(0o755)
        (share / "camera.yaml").write_text(
            f"camera_model: pinhole\nwidth: {WIDTH}\nheight: {HEIGHT}\nfx: 280\nfy: 280\ncx: 159.5\ncy: {(HEIGHT - 1) / 2}\n"
            "distortion_model: none\ndistortion: []\nrate_hz: 30\n")
        files = {}
        for binary in (capture, track):
            files.update({f"lib/{name}": path for name, path in guest.libraries(binary, guest.SYSROOT).items()})
        print(guest.boot(root, share, RUN, load=("vivid",), files=files, seconds=120))
        check_capture(share, problems)
        check_program(share, here, problems)
    if problems:
        script.fail("\n  ".join([f"{len(problems)} found:", *problems]))


main()
