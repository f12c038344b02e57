"""The window from nothing where the picture moves by ten pixels a frame, from many frames on: it is lost in few of the runs."""

import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import skip_in_cross_builds  # noqa: E402
from tracked_runs import require_tracked, sequence, tracked_share  # noqa: E402

STARTS = range(10, 30)

skip_in_cross_builds()
folder = sequence("euroc_mh01_clip")
with tempfile.TemporaryDirectory() as scratch:
    shares = [tracked_share(folder, start, pathlib.Path(scratch) / str(start), "--backend", "window") for start in STARTS]
print(" ".join(f"{share:.0%}" for share in shares))
require_tracked(shares, least=0.9, runs=0.95)
