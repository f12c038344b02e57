"""pf-sim rendered: two short runs from images alone stay tracked, with errors that their covariance explains."""

import json
import math
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run  # noqa: E402

SEEDS, FIRST_SEED, FRAMES = 2, 1, 60
MOST_NEES = 30


def require(condition, message):
    if not condition:
        fail(message)


with tempfile.TemporaryDirectory() as folder:
    report = pathlib.Path(folder) / "report.json"
    run(BIN / "pf-sim", "rendered", "--seeds", SEEDS, "--first-seed", FIRST_SEED, "--frames", FRAMES, "--jobs", 2,
        "--json", report)
    case = json.loads(report.read_text())["cases"]["desk"]

print(f"seeds {FIRST_SEED}..{FIRST_SEED + SEEDS - 1}: position NEES {case['nees_position']['mean']:.2f}, "
      f"pose NEES {case['nees_pose']['mean']:.2f}, RMSE {case['camera_rmse_m']:.4f} m")
require(case["runs"] == SEEDS and case["frames"] == FRAMES, "not the runs that were asked for")
require(case["lost_runs"] == 0 and case["lost_frames"] == 0, "a run was lost")
require(case["tracked_share"] > 0.9, f"only {100 * case['tracked_share']:.1f} % of the frames were tracked")
for name in ("nees_position", "nees_pose"):
    for seed in case["each_run"]:
        require(math.isfinite(seed[name]) and 0 < seed[name] < MOST_NEES, f"seed {seed['seed']}: {name} {seed[name]}")
    require(0 <= case[name]["inside_share"] <= 1, f"{name}: share inside the bounds {case[name]['inside_share']}")
for kind, numbers in case["innovations"].items():
    require(numbers["inliers"] > 0 or kind == "point", f"no inliers of kind {kind}")
    require(math.isfinite(numbers["nis_per_dof"]) and abs(numbers["lag_one"]) <= 1, f"{kind}: {numbers}")
