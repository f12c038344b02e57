"""pf-bench homography on a short run: its rows, its last three lines, and that the library's aligner follows the patch."""

import json
import math
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

PROGRAM = script.BIN / "pf-bench"
if not PROGRAM.exists():
    script.skip("pf-bench is not part of this build")

with tempfile.TemporaryDirectory() as folder:
    file = pathlib.Path(folder) / "homography.json"
    said = script.run(PROGRAM, "homography", "--seeds", "3", "--frames", "25", "--json", file)
    print(said)
    document = json.loads(file.read_text())
    rows = {row["name"]: row for row in document["rows"]}
    for name, line in zip(("plain", "occlusion", "light"), said.splitlines()[-3:]):
        row = rows[f"{name} planefold"]
        if not line.startswith(name) or "px RMSE" not in line or name not in document["notes"]:
            script.fail(f"the line of {name} is {line!r}")
        # Where 30 % is hidden some frames in a thousand are lost (lib/docs/theory/homography.md).
        most_lost = 1 if name == "occlusion" else 0
        if not (row["rmse_px"] < 0.1 and row["lost"] <= most_lost and 4 < row["nees"] < 16):
            script.fail(f"{name}: {row}")
    if "OpenCV" in document["notes"]["peers"] and "without" not in document["notes"]["peers"] and "plain KLT" not in rows:
        script.fail("the peers were there and have no rows")

# Stored frames: a picture that moves by what the file of truths says.
WIDTH, HEIGHT, STEP = 320, 240, (3, 2)


def grey(x, y):
    """Smooth, with detail of some pixels."""
    return int(128 + 50 * math.sin(0.21 * x + 0.05 * y) + 45 * math.sin(0.17 * y - 0.04 * x) + 25 * math.sin(0.4 * x) * math.sin(0.35 * y))


def write_frames(folder, count):
    (folder / "images").mkdir()
    for k in range(count):
        pixels = bytes(grey(x - k * STEP[0], y - k * STEP[1]) for y in range(HEIGHT) for x in range(WIDTH))
        (folder / "images" / f"{k:03d}.pgm").write_bytes(b"P5\n%d %d\n255\n" % (WIDTH, HEIGHT) + pixels)
    (folder / "times.txt").write_text("".join(f"{k} {k / 30:.6f} {k:03d}.pgm\n" for k in range(count)))
    (folder / "calib.yaml").write_text(f"camera_model: pinhole\nwidth: {WIDTH}\nheight: {HEIGHT}\nfx: 300.0\nfy: 300.0\ncx: 160.0\ncy: 120.0\n"
                                       "distortion_model: none\ndistortion: []\nrate_hz: 30\n")
    (folder / "H.txt").write_text("".join(f"1 0 {k * STEP[0]} 0 1 {k * STEP[1]} 0 0 1\n" for k in range(count)))


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    write_frames(folder, 12)
    stored = ["--source", f"images:{folder}", "--patch", "100,60,90,100", "--truth", folder / "H.txt"]
    said = script.run(PROGRAM, "homography", *stored, "--json", folder / "r.json")
    rows = {row["name"]: row for row in json.loads((folder / "r.json").read_text())["rows"]}
    own = next(row for name, row in rows.items() if name.endswith("planefold"))
    print(own)
    if own["lost"] or own["rmse_px"] > 0.1 or own["n"] != 90:
        script.fail(f"stored frames: {own}")
    (folder / "short.txt").write_text("1 0 0 0 1 0 0 0 1\n")
    (folder / "turned.txt").write_text("0 1 0 1 0 0 0 0 1\n" * 12)
    (folder / "flat.txt").write_text("1 0 0 0 1 0 0 0 1\n1 2 3 2 4 6 0 0 1\n")
    (folder / "words.txt").write_text("one\n")
    for words, expected in ((["--patch", "1,2,3", *stored[:2], *stored[4:]], "1,2,3"), (["--patch", "300,60,90,90", *stored[:2], *stored[4:]], "must lie in the image"),
                            ([*stored[:4], "--truth", folder / "short.txt"], "1 homographies for 12 frames"), ([*stored[:4], "--truth", folder / "turned.txt"], "identity"),
                            ([*stored[:4], "--truth", folder / "flat.txt"], "line 2"), ([*stored[:4], "--truth", folder / "words.txt"], "nine numbers"),
                            (stored[:4], "belong together"), ([*stored[:4], "--truth", folder / "none.txt"], "cannot be read")):
        result = subprocess.run([PROGRAM, "homography", *map(str, words)], capture_output=True, text=True)
        if result.returncode != 2 or len(result.stderr.strip().splitlines()) != 1 or expected not in result.stderr:
            script.fail(f"{words}: code {result.returncode}, {result.stderr!r}")
