"""pf-sim street: along fronts that a coarse plan knows the camera is not lost, and knows where it is."""

import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run, skip_in_cross_builds  # noqa: E402

skip_in_cross_builds()
refused = subprocess.run([BIN / "pf-sim", "street", "--cases", "absent"], text=True, stderr=subprocess.PIPE, check=False)
if refused.returncode != 2 or "refined exact points plain" not in refused.stderr:
    fail(f"a case that the street has not: {refused.returncode}, {refused.stderr!r}")

with tempfile.TemporaryDirectory() as folder:
    file = pathlib.Path(folder) / "street.json"
    print(run(BIN / "pf-sim", "street", "--seeds", 1, "--first-seed", 11, "--frames", 300, "--cases", "refined", "--json", file))
    refined = json.loads(file.read_text())["cases"]["refined"]

if refined["lost"]["frames"] > 0 or refined["tracked_share"] < 0.98:
    fail(f"lost on the way: {refined['lost']}, {refined['tracked_share']} tracked")
# Ten metres on, the place is no better known than the front's in the plan (0.2 m).
if not (refined["end_error_m"]["worst"] < 0.6 and refined["end_error_in_sigmas"]["worst"] < 3):
    fail(f"the end: {refined['end_error_m']}, {refined['end_error_in_sigmas']}")
walls = refined["walls"]
if walls["count"] < 1 or walls["doubted_ever"] > 0 or not walls["angle_deg"] < 1:
    fail(f"fronts: {walls}")
