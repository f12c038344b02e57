"""pf-sim rest on rendered frames: the pose of a camera at rest does not drift, and what is wrong with an option is said in one line."""

import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run  # noqa: E402

SECONDS, LONG_SECONDS = 1, 30
FRAMES, STOPS = 110, [50, 100]
MAX_DRIFT = 0.1  # of sigma, in all that time


def require(condition, message):
    if not condition:
        fail(message)


with tempfile.TemporaryDirectory() as folder:
    film, report = pathlib.Path(folder) / "film", pathlib.Path(folder) / "report.json"
    run(BIN / "pf-sim", "render", "desk", "--out", film, "--frames", FRAMES, "--width", 320)

    def rest(*options):
        run(BIN / "pf-sim", "rest", "--source", f"images:{film}", "--start", f"target:{film / 'target.yaml'}", "--at",
            ",".join(map(str, STOPS)), "--jobs", 2, "--json", report, *options)
        return json.loads(report.read_text())["stops"]

    short, long = rest("--seconds", SECONDS), rest("--seconds", LONG_SECONDS)
    bad = subprocess.run([BIN / "pf-sim", "rest", "--source", f"images:{film}", "--at", str(FRAMES)], capture_output=True, text=True,
                         check=False)

for soon, late in zip(short, long):
    drift = (late["worst_deg"] - soon["worst_deg"]) / late["sigma_deg"]
    print(f"frame {late['frame']}: {soon['worst_deg']:.3f} degrees within {SECONDS} s, {late['worst_deg']:.3f} within {LONG_SECONDS} s, "
          f"sigma {late['sigma_deg']:.3f}; NEES {late['worst_normalised']:.2f} of 6, sigma grew by {late['widest_sigma_ratio']:.2f}")
    require(late["tracked"] and late["not_tracked"] == 0 and late["frames_at_rest"] > soon["frames_at_rest"], "it is not tracked")
    require(drift < MAX_DRIFT, "the pose drifts")
    require(late["worst_sigmas"] < 2 and late["worst_normalised"] < 12 and late["widest_sigma_ratio"] < 3, "it is not where it was")
require([s["frame"] for s in long] == STOPS, "stops are missing")
require(bad.returncode == 2 and f"--at {FRAMES}: the source has frames 0 to {FRAMES - 1}" in bad.stderr and bad.stderr.count("\n") == 1,
        f"a bad option: {bad.returncode}, {bad.stderr}")
