"""A hand-held room at 11 images a second: most are smeared by some pixels, and few points show at the finest level."""

import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import skip_in_cross_builds  # noqa: E402
from tracked_runs import require_tracked, sequence, tracked_share  # noqa: E402

skip_in_cross_builds()
room = sequence("l515_bedroom_2")
shares = []
with tempfile.TemporaryDirectory() as scratch:
    for backend in ("filter", "window"):
        options = ["--backend", backend, "--every", "2", "--frames", "150", "--no-inertial"]
        for start in range(3):
            shares.append(tracked_share(room, start, pathlib.Path(scratch) / f"{backend}_{start}", *options))
require_tracked(shares, least=0.95, runs=1.0)
