"""pf-capture before leaves that fill a volume: it tracks, and calls nothing a plane in any frame."""

import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run  # noqa: E402

FRAMES = 250

with tempfile.TemporaryDirectory() as folder:
    for seed in (1, 2):
        out = pathlib.Path(folder) / str(seed)
        run(BIN / "pf-capture", "--source", "sim:bushes", "--start", "target", "--seed", seed, "--frames", FRAMES, "--headless",
            "--no-film", "--quiet", "--out", out)
        report = json.loads((out / "report.json").read_text())
        points = report["features_in_map"]["points"]
        print(f"seed {seed}: {report['tracked']} of {report['frames']} frames tracked, {points} points at the end, "
              f"first plane in frame {report['folding']['first_plane']}")
        if report["tracked"] < 0.95 * FRAMES:
            fail(f"seed {seed}: only {report['tracked']} of {FRAMES} frames were tracked")
        if points < 20:
            fail(f"seed {seed}: {points} points are too few to search among")
        if report["folding"]["first_plane"] is not None or report["planes"]:
            fail(f"seed {seed}: found a plane among leaves")
