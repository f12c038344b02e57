"""pf-sim road: partial templates are tracked longer than whole ones past poles and parked boxes, either back end can be named, and
tools/plot-masoud draws what pf-sim wrote."""

import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, SOURCE, fail, run, skip_in_cross_builds  # noqa: E402

skip_in_cross_builds()
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    print(run(BIN / "pf-sim", "road", "--seeds", 1, "--jobs", 1, "--frames", 150, "--csv", folder, "--json", folder / "road.json"))
    cases = json.loads((folder / "road.json").read_text())["cases"]
    partial, whole = cases["partial"], cases["whole"]
    if partial["lost_runs"] > 0 or not partial["translation_rmse_m"] < 0.3:
        fail(f"lost on the way: {partial}")
    if not (partial["track_length"]["mean"] > whole["track_length"]["mean"] and partial["inliers"] > whole["inliers"]):
        fail(f"partial templates are not tracked longer than whole ones: {partial}, {whole}")
    rows = (folder / "road_partial.csv").read_text().splitlines()
    if len(rows) != 151 or len(rows[0].split(",")) != 8:
        fail(f"{len(rows)} rows of {rows[0]}")
    for wrong in ([BIN / "pf-sim", "road", "--backend", "none"], [SOURCE / "tools" / "plot-masoud", folder / "nothing"]):
        refused = subprocess.run(wrong, text=True, stderr=subprocess.PIPE, check=False)
        if refused.returncode == 0 or "Traceback" in refused.stderr or not refused.stderr:
            fail(f"{wrong}: {refused.returncode}, {refused.stderr!r}")
