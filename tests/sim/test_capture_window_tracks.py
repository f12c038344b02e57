"""tracks.csv of the window has all its points: none is first heard of after it began."""

import csv
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run  # noqa: E402

FRAMES = 40

known, late = set(), 0
with tempfile.TemporaryDirectory() as scratch:
    out = pathlib.Path(scratch) / "run"
    run(BIN / "pf-capture", "--source", "sim:room", "--frames", str(FRAMES), "--backend", "window", "--features-in-view", "250", "--tracks",
        "--headless", "--no-film", "--quiet", "--out", out)
    for row in csv.DictReader((out / "tracks.csv").open()):
        late += row["id"] not in known and row["status"] != "new" and int(row["frame"]) > 0
        known.add(row["id"])
print(f"{len(known)} points, {late} of them first heard of after they began")
if late > 0:
    fail("every point should be in tracks.csv from its first frame on")
