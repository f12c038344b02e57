"""An inertial unit whose clock jumps by 44 years ends no run: poses become useless, and the files are complete.

The ellipses of the film were then so large that drawing one picture took minutes."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, skip, skip_in_cross_builds  # noqa: E402

NAME = "euroc_mh01_clip"
FRAMES = 20
SECOND = "1403636579"  # in which the samples begin; they are given times in second 3 instead

skip_in_cross_builds()
if not (BIN / "pf-capture").is_file():
    skip("pf-capture was not built")
data = os.environ.get("PLANEFOLD_DATA", "")
clip = pathlib.Path(data) / NAME
if not data or not clip.is_dir():
    skip(f"PLANEFOLD_DATA names no folder with {NAME}")
with tempfile.TemporaryDirectory(prefix="planefold_") as folder:
    folder = pathlib.Path(folder)
    rows = (clip / "imu.csv").read_text().splitlines()
    (folder / "jump.csv").write_text("".join((row.replace(SECOND, "3", 1) if row.startswith(SECOND) else row) + "\n" for row in rows))
    words = [BIN / "pf-capture", "--source", f"images:{clip}", "--frames", FRAMES, "--headless", "--no-film", "--quiet", "--imu",
             f"csv:{folder / 'jump.csv'}", "--imu-noise", clip / "calib.yaml", "--imu-mount", clip / "calib.yaml", "--out", folder / "out"]
    try:
        result = subprocess.run([str(word) for word in words], text=True, capture_output=True, timeout=100, check=False)
    except subprocess.TimeoutExpired:
        fail("does not end")
    print(result.returncode, result.stdout, result.stderr)
    report = json.loads((folder / "out" / "report.json").read_text())
    if result.returncode not in (0, 1) or report["frames"] != FRAMES:
        fail(f"code {result.returncode}, {report['frames']} of {FRAMES} frames")
