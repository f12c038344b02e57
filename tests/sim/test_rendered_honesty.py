"""pf-sim rendered: two short runs from images alone stay tracked, with errors that their covariance explains; and rows that are
read out one after the other cost nothing when the filter knows of it."""

import json
import math
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run  # noqa: E402

SEEDS, FIRST_SEED, FRAMES = 2, 1, 60
MOST_NEES = 30
ROLLING_FRAMES = 150  # long enough to walk away from the target


def require(condition, message):
    if not condition:
        fail(message)


def rendered(frames, *options):
    with tempfile.TemporaryDirectory() as folder:
        report = pathlib.Path(folder) / "report.json"
        run(BIN / "pf-sim", "rendered", "--seeds", SEEDS, "--first-seed", FIRST_SEED, "--frames", frames, "--jobs", 2,
            "--json", report, *options)
        return json.loads(report.read_text())["cases"]["desk"]


case = rendered(FRAMES)

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

known = rendered(ROLLING_FRAMES, "--readout", 0.03)
ignored = rendered(ROLLING_FRAMES, "--readout", 0.03, "--as-global")
print(f"rows over 30 ms: innovations per degree of freedom {known['nis_per_dof']:.2f} known, {ignored['nis_per_dof']:.2f} ignored, "
      f"RMSE {known['camera_rmse_m']:.4f}, {ignored['camera_rmse_m']:.4f} m")
require(known["lost_frames"] == 0, "a camera with a rolling shutter was lost")
require(known["nis_per_dof"] < 0.7 * ignored["nis_per_dof"], "knowing the readout explains the pixels no better")

# The same of the window.
window = ["--readout", 0.03, "--backend", "window", "--lens", "right"]
known = rendered(ROLLING_FRAMES, *window)
ignored = rendered(ROLLING_FRAMES, *window, "--as-global")
print(f"window, rows over 30 ms: innovations per degree of freedom {known['nis_per_dof']:.2f} known, {ignored['nis_per_dof']:.2f} ignored, "
      f"RMSE {known['camera_rmse_m']:.4f}, {ignored['camera_rmse_m']:.4f} m")
require(known["lost_frames"] == 0, "the window lost a camera with a rolling shutter")
require(known["nis_per_dof"] < 0.85 * ignored["nis_per_dof"], "knowing the readout explains the window's pixels no better")

# A bare camera from nothing known, on frames of a sim: source whose calibration has rows.
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    run(BIN / "pf-sim", "render", "room", "--frames", 1, "--readout", 0.03, "--out", folder / "scene")
    reports = []
    for told in ((), ("--readout", 0)):
        out = folder / f"out{len(reports)}"
        run(BIN / "pf-capture", "--source", "sim:room", "--calib", folder / "scene" / "calib.yaml", "--frames", ROLLING_FRAMES, "--headless",
            "--no-film", "--quiet", "--out", out, *told)
        reports.append(json.loads((out / "report.json").read_text()))
    told, untold = (report["nis_per_dof"] for report in reports)
    print(f"sim:room with rows: innovations per degree of freedom {told:.2f} told, {untold:.2f} untold")
    require(all(report["lost"] == 0 for report in reports), "a bare camera with a rolling shutter was lost")
    require(told < 0.7 * untold, "telling a sim: source's readout explains its pixels no better: its frames have no rows")
