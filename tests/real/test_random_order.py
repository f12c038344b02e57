"""Frames in random order. On the desk hardly any is tracked, and where two are, the turn between them is right but for a few. Before the
three planes each frame is near many others, so that many are tracked; hardly any of them is wrong beyond its covariance."""

import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, skip_in_cross_builds  # noqa: E402
from tracked_runs import sequence  # noqa: E402

MOST_TRACKED, MOST_WRONG, MOST_CONFIDENT = 0.005, 0.001, 0.002  # of the frames

skip_in_cross_builds()


def random_order(every, *options):
    """The report of random order; with few trials, which are not what this looks at."""
    with tempfile.TemporaryDirectory() as folder:
        report = pathlib.Path(folder) / "report.json"
        subprocess.run([BIN / "pf-sim", "kidnap", "--every", str(every), "--jobs", "2", "--json", report, *options], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        order = json.loads(report.read_text())["random_order"]
    print(order)
    if order["frames"] != 4 * 700:
        fail(f"{order['frames']} frames were shown")
    return order


desk = sequence("monoslam_desk_a")
order = random_order(300, "--source", f"images:{desk}", "--start", f"target:{desk / 'target.yaml'}")
if order["tracking"] > MOST_TRACKED * order["frames"]:
    fail(f"{order['tracking']} of {order['frames']} frames in random order are said to be tracked")
if order["turns_wrong"] > MOST_WRONG * order["frames"]:
    fail(f"{order['turns_wrong']} of {order['turns']} turns between two of them are wrong")

order = random_order(60, "--source", f"images:{sequence('vamr_three_planes')}", "--backend", "window")
if order["wrong_and_confident"] > MOST_CONFIDENT * order["frames"]:
    fail(f"{order['wrong_and_confident']} of {order['judged']} poses are wrong beyond their covariance: {order['wrong']}")
