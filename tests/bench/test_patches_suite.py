"""pf-bench patches: homographies of patches alone refine a wrong plan and keep the camera, and a plan taken as exact misleads."""

import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

PROGRAM = script.BIN / "pf-bench"
if not PROGRAM.exists():
    script.skip("pf-bench is not part of this build")

with tempfile.TemporaryDirectory() as folder:
    file = pathlib.Path(folder) / "patches.json"
    print(script.run(PROGRAM, "patches", "--seeds", "10", "--json", file))
    refined, exact, alone = json.loads(file.read_text())["rows"]
if not (refined["name"] == "refined" and refined["rmse_worst_cm"] < 2.5 and refined["largest_worst_cm"] < 8):
    script.fail(f"camera: {refined}")
if not (refined["plan_deg"] > 2 and refined["wall_deg"] < 0.5 and 3 < refined["nees_pose"] < 12):
    script.fail(f"walls and NEES: {refined}")
if not exact["rmse_cm"] > 4 * refined["rmse_cm"]:
    script.fail(f"a wrong plan taken as exact: {exact}")
if not (alone["nees_pose"] > 20 and alone["rmse_cm"] > 1.3 * refined["rmse_cm"]):
    script.fail(f"the reference's own noise left out: {alone}")
