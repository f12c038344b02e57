"""Times that jump, or are in another unit than was meant, end no run of pf-capture before its files are complete.

Tracked frames more than a minute apart ended it with a segmentation fault."""

import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run, skip, skip_in_cross_builds  # noqa: E402

FRAMES = 12


def capture(name, folder, out):
    words = [BIN / "pf-capture", "--source", f"images:{folder}", "--headless", "--no-film", "--quiet", "--out", out]
    result = subprocess.run([str(word) for word in words], text=True, capture_output=True, timeout=100, check=False)
    if result.returncode not in (0, 1):
        fail(f"{name}: code {result.returncode}, {result.stderr}")
    report = json.loads((out / "report.json").read_text())
    if report["frames"] != FRAMES:
        fail(f"{name}: {report['frames']} of {FRAMES} frames, {result.stderr}")
    print(f"{name}: {result.returncode}, {report['tracked']} tracked: {result.stderr.strip()}")


def check_frames(root, folder):
    """Each frame later than the one before by more than what is kept to find the time offset of an inertial unit."""
    rows = [line.split() for line in (folder / "times.txt").read_text().splitlines() if line[0] != "#"]
    for name, factor in (("minutes apart", 1e4), ("nanoseconds taken for seconds", 1e9)):
        (folder / "times.txt").write_text("".join(f"{row[0]} {factor * float(row[1]):.3f} {row[2]}\n" for row in rows))
        capture(name, folder, root / name)


skip_in_cross_builds()
if not (BIN / "pf-capture").is_file() or not (BIN / "pf-sim").is_file():
    skip("pf-capture or pf-sim was not built")
with tempfile.TemporaryDirectory(prefix="planefold_") as name:
    root = pathlib.Path(name)
    run(BIN / "pf-sim", "render", "desk", "--frames", FRAMES, "--width", 320, "--out", root / "desk")
    check_frames(root, root / "desk")
