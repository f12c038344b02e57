"""pf-sim street, the first three seconds: a filter that takes the street for its hollow twin begins again, and a sign is not taken for its wall."""

import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run, skip_in_cross_builds  # noqa: E402

skip_in_cross_builds()
# Seed 6 is turned inside out after two frames; in seed 8 a patch on a sign passes the gate of the wall behind it.
for seed in (6, 8):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "street.json"
        print(run(BIN / "pf-sim", "street", "--seeds", 1, "--first-seed", seed, "--frames", 100, "--cases", "refined", "--json", file))
        refined = json.loads(file.read_text())["cases"]["refined"]
    # After 2 m of the way 5 cm are expected. Before: 0.6 and 1.7 m.
    if not (refined["end_error_m"]["worst"] < 0.2 and refined["end_error_in_sigmas"]["worst"] < 3):
        fail(f"seed {seed}: {refined['end_error_m']}, {refined['end_error_in_sigmas']}")
    if refined["walls"]["doubted"] > 0 or refined["lost"]["frames"] > 0:
        fail(f"seed {seed}: {refined['walls']}, {refined['lost']}")
