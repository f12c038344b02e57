"""A walk that comes back to nothing keeps its scale: the window along 32 m of road, whose beginning it can never see again."""

import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import venv  # noqa: E402
from script import BIN, fail, run, skip, skip_in_cross_builds  # noqa: E402

MAX_ERROR = 0.01  # of the path; 0.002 here. With the oldest keyframes of all held fixed it was 0.033, and 0.09 over twice the way

skip_in_cross_builds()
if not (BIN / "pf-capture").is_file() or not (BIN / "pf-eval").is_file():
    skip("pf-capture or pf-eval was not built")
venv.enter()
with tempfile.TemporaryDirectory(prefix="planefold_") as name:
    out = pathlib.Path(name) / "run"
    run(BIN / "pf-capture", "--source", "sim:road", "--seed", 2, "--start", "auto", "--frames", 300, "--backend", "window", "--lens", "estimate",
        "--headless", "--no-film", "--quiet", "--out", out)
    # Beside its answer it notes that nearly straight paths do not tell their rotation.
    error = json.loads(subprocess.run([BIN / "pf-eval", out, "--json"], text=True, stdout=subprocess.PIPE, check=True).stdout)
    share = error["ate_rmse_m"] / error["path_m"]
    print(f"{error['poses']} poses, {100 * share:.2f} % of {error['path_m']:.0f} m")
    if error["poses"] < 290 or not share < MAX_ERROR:
        fail(f"the map lost its scale on the way: {100 * share:.2f} % of the path")
