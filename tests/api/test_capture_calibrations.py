"""Calibration files that people have, as pf-capture takes them: which camera, which notes, which exit code; what else reads calibrations says the same."""

import json
import pathlib
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, skip_in_cross_builds  # noqa: E402

skip_in_cross_builds()
SIDE = 64
SEED = 11
failures = []


def camera(name, fx):
    return (f"{name}:\n  camera_model: pinhole\n  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]\n  distortion_model: radtan\n"
            f"  intrinsics: [{fx}, 50.0, 31.5, 31.5]\n  resolution: [{SIDE}, {SIDE}]\n")


CHAIN = camera("cam0", 50.0) + camera("cam1", 52.0)


def run(program, *arguments):
    return subprocess.run([str(BIN / program), *map(str, arguments)], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          timeout=120, check=False)


def folder(root, name):
    """Six images of noise, without times."""
    path = root / name
    path.mkdir()
    generator = random.Random(SEED)
    for i in range(6):
        pixels = bytes(generator.randrange(256) for _ in range(SIDE * SIDE))
        (path / f"{i}.pgm").write_bytes(f"P5\n{SIDE} {SIDE}\n255\n".encode() + pixels)
    return path


def capture(root, images, *arguments):
    """(exit code, notes, all that was said, focal length in the report)"""
    out = root / "out"
    done = run("pf-capture", "--source", f"images:{images}", "--headless", "--no-film", "--quiet", "--out", out, *arguments)
    report = out / "report.json"
    fx = json.loads(report.read_text()).get("camera", {}).get("fx") if done.returncode != 2 and report.exists() else None
    before = "pf-capture: note: "
    notes = [line[len(before):] for line in done.stderr.splitlines() if line.startswith(before)]
    return done.returncode, notes, done.stderr, fx


def check(name, good, what):
    if not good:
        failures.append(f"{name}: {what}")


with tempfile.TemporaryDirectory() as temporary:
    root = pathlib.Path(temporary)
    images = folder(root, "images")
    (root / "chain.yaml").write_text("serial: 12\n" + CHAIN)

    code, notes, said, fx = capture(root, images, "--calib", root / "chain.yaml")
    check("first camera", code != 2 and fx == 50.0, said)
    for part in ("no times.txt", "'serial'", "cam0 and cam1; that of cam0 is taken"):
        check("notes", sum(part in note for note in notes) == 1, f"{part} in {notes}")
    for choice in ("cam1", "1"):
        code, notes, said, fx = capture(root, images, "--calib", root / "chain.yaml", "--camera", choice)
        check(f"--camera {choice}", code != 2 and fx == 52.0, said)
        check(f"--camera {choice}", not any("cam0" in note for note in notes), notes)
    code, _, said, _ = capture(root, images, "--calib", root / "chain.yaml", "--camera", "2")
    check("no such camera", code == 2 and "cam0 and cam1" in said, said)

    # Beside the images, under any name.
    (images / "front.yml").write_text(
        f"%YAML:1.0\n---\nmodel_type: PINHOLE\nimage_width: {SIDE}\nimage_height: {SIDE}\n"
        "distortion_parameters:\n   k1: 0.0\n   k2: 0.0\n   p1: 0.0\n   p2: 0.0\n"
        "projection_parameters:\n   fx: 51.0\n   fy: 50.0\n   cx: 31.5\n   cy: 31.5\n")
    code, notes, said, fx = capture(root, images)
    check("beside the images", code != 2 and fx == 51.0, said)
    code, _, said, _ = capture(root, images, "--camera", "1")
    check("one camera alone", code == 2 and "leave --camera away" in said, said)
    (images / "front.yml").write_text((images / "front.yml").read_text().replace("PINHOLE", "SCARAMUZZA"))
    code, _, said, _ = capture(root, images)
    check("refused beside the images", code == 2 and "'model_type'" in said, said)
    code, _, said, _ = capture(root, "no/such/folder", "--calib", root / "chain.yaml")
    check("no such folder", code == 1 and "no such folder" in said, said)

    done = run("pf-capture", "--source", "sim:desk", "--camera", "1", "--headless")
    check("--camera of a scene", done.returncode == 2 and "--calib" in done.stderr, done.stderr)
    done = run("pf-capture", "--help")
    check("help", all(word in done.stdout for word in ("OpenVINS", "OpenCV", "COLMAP", "--camera")), done.stdout)
    if (BIN / "pf-digest").exists():
        source = f"images:{images}"
        done = run("pf-digest", source, "--calib", root / "chain.yaml", "--camera", "5")
        check("pf-digest", done.returncode == 1 and "cam0 and cam1" in done.stderr, done.stderr)
        done = run("pf-digest", source, "--calib", root / "chain.yaml", "--auto")
        check("pf-digest", done.returncode == 0 and "note: " in done.stderr and "'serial'" in done.stderr, done.stderr)

if failures:
    fail("\n  ".join([f"{len(failures)} of the calibrations:"] + failures))
print("all calibrations were taken as they should be")
