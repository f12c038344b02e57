"""Frames of the desk in random order: hardly any is said to be tracked, and where two are, the turn between them is right but for a few."""

import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, skip_in_cross_builds  # noqa: E402
from tracked_runs import sequence  # noqa: E402

MOST_TRACKED, MOST_WRONG = 0.005, 0.001  # of the frames

skip_in_cross_builds()
desk = sequence("monoslam_desk_a")
with tempfile.TemporaryDirectory() as folder:
    report = pathlib.Path(folder) / "report.json"
    # Few trials, which are not what this looks at.
    subprocess.run([BIN / "pf-sim", "kidnap", "--source", f"images:{desk}", "--start", f"target:{desk / 'target.yaml'}", "--every", "300",
                    "--jobs", "2", "--json", report], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    order = json.loads(report.read_text())["random_order"]
print(order)
if not order["frames"] == 4 * 700:
    fail(f"{order['frames']} frames were shown")
if order["tracking"] > MOST_TRACKED * order["frames"]:
    fail(f"{order['tracking']} of {order['frames']} frames in random order are said to be tracked")
if order["turns_wrong"] > MOST_WRONG * order["frames"]:
    fail(f"{order['turns_wrong']} of {order['turns']} turns between two of them are wrong")
