"""A clip begun while the camera is shaken, a fifth of its frames never come: young maps are followed over the gaps."""

import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, skip, skip_in_cross_builds  # noqa: E402

NAME = "euroc_mh01_clip"
SEEDS, STARTS = range(1, 5), range(12)
KEPT_FIRST = 3  # frames
DROPPED = 0.2
MIN_TRACKED = 0.9  # of a run's frames
MIN_RUNS = 0.9


def drop_frames(sequence, folder, seed):
    """The same sequence as links, without a part of its frames."""
    draw = random.Random(seed)
    (folder / "images").mkdir(parents=True)
    rows = [row for row in (sequence / "times.txt").read_text().splitlines() if row and row[0] != "#"]
    kept = [row for i, row in enumerate(rows) if i < KEPT_FIRST or draw.random() > DROPPED]
    (folder / "times.txt").write_text("\n".join(kept) + "\n")
    (folder / "calib.yaml").write_text((sequence / "calib.yaml").read_text())
    for row in kept:
        name = row.split()[2]
        (folder / "images" / name).symlink_to(sequence / "images" / name)


def tracked_share(folder, start, out):
    command = [BIN / "pf-capture", "--source", f"images:{folder}", "--skip", str(start), "--headless", "--no-film",
               "--quiet", "--out", out]
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if result.returncode not in (0, 1):  # 1: lost at the end
        fail(f"seed and start {folder.name}, {start}: exit code {result.returncode}\n{result.stdout}")
    frames = json.loads((out / "report.json").read_text())["frames_by_state"]
    return frames["tracked"] / sum(frames.values())


skip_in_cross_builds()
data = os.environ.get("PLANEFOLD_DATA", "")
sequence = pathlib.Path(data) / NAME
if not data or not sequence.is_dir():
    skip(f"PLANEFOLD_DATA names no folder with {NAME}")
shares = []
with tempfile.TemporaryDirectory() as scratch:
    for seed in SEEDS:
        folder = pathlib.Path(scratch) / str(seed)
        drop_frames(sequence, folder, seed)
        for start in STARTS:
            shares.append(tracked_share(folder, start, pathlib.Path(scratch) / f"run_{seed}_{start}"))
good = sum(share >= MIN_TRACKED for share in shares)
print(f"{good} of {len(shares)} runs tracked at least {MIN_TRACKED:.0%} of their frames, the worst {min(shares):.0%}")
if good < MIN_RUNS * len(shares):
    fail(f"at least {MIN_RUNS:.0%} of the runs should")
