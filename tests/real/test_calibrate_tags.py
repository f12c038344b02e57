"""A board of tags is none that pf-calibrate knows, though its finder of chessboards sees grids of corners in it: it neither proposes such a
grid as a chessboard, nor writes a calibration from one when it is told to."""

import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, skip, skip_in_cross_builds  # noqa: E402

PROGRAM = BIN / "pf-calibrate"


def main():
    skip_in_cross_builds()
    if not PROGRAM.is_file():
        skip("pf-calibrate is not built: it needs OpenCV's calib3d")
    folder = pathlib.Path(os.environ.get("PLANEFOLD_DATA", "")) / "visp_apriltag_board"
    if "PLANEFOLD_DATA" not in os.environ or not folder.is_dir():
        skip("PLANEFOLD_DATA has no visp_apriltag_board")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        for more, part in ((["--look-at", "40"], "squares is in none of 40 frames; is it sharp"),
                           (["--target", "chessboard", "--board", "6x4:0.03"], "is no board of 6 x 4 squares")):
            out = pathlib.Path(name) / "out"
            command = [PROGRAM, "--quiet", "--source", f"images:{folder}", "--out", out, *more]
            result = subprocess.run([str(word) for word in command], text=True, capture_output=True, check=False)
            print(result.stderr.strip())
            if result.returncode != 1 or part not in result.stderr or result.stderr.count("\n") != 1 or (out / "calib.yaml").exists():
                fail(f"exit status {result.returncode}, expected one line with '{part}': {result.stdout}{result.stderr}")


main()
