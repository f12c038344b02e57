"""The window from nothing where the picture moves by ten pixels a frame, from many frames on: it is lost in few of the runs."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, skip, skip_in_cross_builds  # noqa: E402

SEQUENCE, STARTS = "euroc_mh01_clip", range(10, 30)
MIN_TRACKED = 0.9  # of a run's frames
MIN_RUNS = 0.95


def tracked_share(folder, start, out):
    command = [BIN / "pf-capture", "--backend", "window", "--source", f"images:{folder}", "--skip", str(start), "--headless", "--no-film",
               "--quiet", "--out", out]
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if result.returncode not in (0, 1):  # 1: lost at the end
        fail(f"{folder.name} from frame {start}: exit code {result.returncode}\n{result.stdout}")
    frames = json.loads((out / "report.json").read_text())["frames_by_state"]
    return frames["tracked"] / sum(frames.values())


skip_in_cross_builds()
data = pathlib.Path(os.environ.get("PLANEFOLD_DATA", ""))
if str(data) == "." or not (data / SEQUENCE).is_dir():
    skip(f"PLANEFOLD_DATA names no folder with {SEQUENCE}")
shares = []
with tempfile.TemporaryDirectory() as scratch:
    for start in STARTS:
        shares.append(tracked_share(data / SEQUENCE, start, pathlib.Path(scratch) / str(start)))
        print(f"from frame {start}: {shares[-1]:.1%} tracked")
good = sum(share >= MIN_TRACKED for share in shares)
print(f"{good} of {len(shares)} runs tracked at least {MIN_TRACKED:.0%} of their frames, the worst {min(shares):.0%}")
if good < MIN_RUNS * len(shares):
    fail(f"at least {MIN_RUNS:.0%} of the runs should")
