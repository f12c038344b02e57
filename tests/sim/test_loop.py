"""pf-sim loop: a camera that comes back around a block has drifted by what the window forgot, and places bring it back."""

import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run, skip_in_cross_builds  # noqa: E402

skip_in_cross_builds()
refused = subprocess.run([BIN / "pf-sim", "loop", "--seeds", "0"], text=True, stderr=subprocess.PIPE, check=False)
if refused.returncode != 2 or "must be positive" not in refused.stderr:
    fail(f"no seeds: {refused.returncode}, {refused.stderr!r}")

with tempfile.TemporaryDirectory() as folder:
    file = pathlib.Path(folder) / "loop.json"
    print(run(BIN / "pf-sim", "loop", "--seeds", 1, "--first-seed", 104, "--json", file))
    walk = json.loads(file.read_text())["cases"]["loop"]["each_run"][0]

without, places = walk["without"], walk["with"]
if without["lost"] + places["lost"] > 0 or without["returned"] > 0 or places["returned"] == 0:
    fail(f"lost, places where there are none, or no return: {walk}")
# Half a per cent of the way, so that there is something to correct, and two tenths of the corridor's width at most.
if not 0.12 < without["end_m"] < 0.4 or not places["end_m"] < 0.2 * without["end_m"]:
    fail(f"the end: {without}, with places {places}")
