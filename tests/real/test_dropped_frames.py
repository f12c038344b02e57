"""A clip begun while the camera is shaken, a fifth of its frames never come: young maps are followed over the gaps."""

import pathlib
import random
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import skip_in_cross_builds  # noqa: E402
from tracked_runs import require_tracked, sequence, tracked_share  # noqa: E402

SEEDS, STARTS = range(1, 5), range(12)
KEPT_FIRST = 3  # frames
DROPPED = 0.2


def drop_frames(whole, folder, seed):
    """The same sequence as links, without a part of its frames."""
    draw = random.Random(seed)
    (folder / "images").mkdir(parents=True)
    rows = [row for row in (whole / "times.txt").read_text().splitlines() if row and row[0] != "#"]
    kept = [row for i, row in enumerate(rows) if i < KEPT_FIRST or draw.random() > DROPPED]
    (folder / "times.txt").write_text("\n".join(kept) + "\n")
    (folder / "calib.yaml").write_text((whole / "calib.yaml").read_text())
    for row in kept:
        name = row.split()[2]
        (folder / "images" / name).symlink_to(whole / "images" / name)


skip_in_cross_builds()
whole = sequence("euroc_mh01_clip")
shares = []
with tempfile.TemporaryDirectory() as scratch:
    for seed in SEEDS:
        folder = pathlib.Path(scratch) / str(seed)
        drop_frames(whole, folder, seed)
        for start in STARTS:
            shares.append(tracked_share(folder, start, pathlib.Path(scratch) / f"run_{seed}_{start}"))
require_tracked(shares, least=0.9, runs=0.9)
