"""A film without a calibration: the focal length of the camera that made it is found, and what is said of it is true."""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from films import make_film, make_folder, skip_without_ffmpeg  # noqa: E402
from script import BIN, fail, skip, skip_in_cross_builds  # noqa: E402

FRAMES = 120
FOCAL_PX = 205.0  # of the scene's camera: 76 degrees across
LARGEST_SIGMAS = 2.5
failures = []


def require(condition, what):
    print("ok  " if condition else "FAIL", what)
    if not condition:
        failures.append(what)


def capture(*words):
    return subprocess.run([str(word) for word in (BIN / "pf-capture", *words, "--headless", "--no-film", "--quiet")], text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300, check=False)


def check(film, out, *more):
    result = capture("--source", f"video:{film}", "--out", out, *more)
    print(result.stdout, result.stderr)
    said = re.search(r"focal length ([\d.]+) px, standard deviation ([\d.]+) px", result.stdout)
    if result.returncode != 0 or said is None:
        fail(f"{result.returncode} {result.stderr}")
    focal_px, sigma_px = float(said[1]), float(said[2])
    require("5 focal lengths" in result.stderr, "it is said that focal lengths were tried")
    require(abs(focal_px - FOCAL_PX) < LARGEST_SIGMAS * sigma_px, f"{focal_px} px, standard deviation {sigma_px} px, true {FOCAL_PX}")
    report = json.loads((out / "report.json").read_text())
    require(report["tracked"] >= 0.9 * FRAMES, f"{report['tracked']} frames of {FRAMES} are tracked")
    return focal_px


def main():
    skip_in_cross_builds()
    if not (BIN / "pf-capture").exists():
        skip("pf-capture was not built")
    skip_without_ffmpeg()
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        folder = make_folder(root, FRAMES)
        film = make_film(folder, root / "film.mkv", "-c:v", "libx264", "-crf", "15")
        check(film, root / "f", "--backend", "filter")
        focal_px = check(film, root / "a")
        found = root / "a" / "calib_found.yaml"
        require(f"fx: {focal_px:.1f}"[:-2] in found.read_text(), "the camera that was found is written")
        again = capture("--source", f"video:{film}", "--calib", found, "--out", root / "b")
        require(again.returncode == 0 and "focal length" not in again.stdout, f"it is a calibration: {again.stderr}")
        for words, part in ((("--calib", found, "--fov", "70"), "leave one of them away"), (("--fov", "200"), "from 10 to 150")):
            refused = capture("--source", f"video:{film}", "--out", root / "c", *words)
            require(refused.returncode == 2 and part in refused.stderr, f"{words}: {refused.stderr.strip()}")
        refused = capture("--source", "v4l2:/dev/video9", "--fov", "70", "--out", root / "c")
        require(refused.returncode == 2 and "for films and folders" in refused.stderr, refused.stderr.strip())
    if failures:
        fail(f"{len(failures)} of the above")


if __name__ == "__main__":
    main()
