"""pf-sim room with planes: walls are found and nothing else, the state shrinks, the gauge and the covariance stay sound."""

import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run, skip  # noqa: E402

PF_SIM = BIN / "pf-sim"
SEEDS = 4


def cases_of_a_room(folder):
    path = folder / "room.json"
    run(PF_SIM, "room", "--case", "ABE", "--seeds", SEEDS, "--frames", 600, "--jobs", 2, "--gauge-every", 25, "--json", path)
    return json.loads(path.read_text())["cases"]


def test_walls_should_be_found_and_nothing_else(cases):
    for name in "BE":
        planes = cases[name]["planes"]
        if planes["false"] or planes["ever_false"]:
            fail(f"{name}: false planes: {planes}")
        if planes["walls_seen_well"] < SEEDS or 3 * planes["walls_found"] < 2 * planes["walls_seen_well"]:
            fail(f"{name}: walls were missed: {planes}")
    if cases["A"]["planes"]["ever"]:
        fail("points only, and planes all the same")


def test_the_state_should_shrink(cases):
    for name in "BE":
        case = cases[name]
        if not case["state_dim"]["end"] < case["state_dim_points_only"]["end"]:
            fail(f"{name}: {case['state_dim']} against {case['state_dim_points_only']} unfolded")
        if not case["plane_points"]["end"] > 10:
            fail(f"{name}: next to no points were folded: {case['plane_points']}")
    if not cases["E"]["folded_points"]["fixed_per_run"] > 5:
        fail(f"E: nothing was fixed: {cases['E']['folded_points']}")
    if not cases["E"]["active_dim"]["end"] < 0.9 * cases["E"]["state_dim"]["end"]:
        fail("E: fixed points still carry a gain")


def test_folding_should_stay_honest(cases):
    for name in "ABE":
        case = cases[name]
        if case["lost_runs"] or case["covariance_unsound"]:
            fail(f"{name}: lost {case['lost_runs']}, unsound {case['covariance_unsound']}")
        growth = case["gauge_growth"]
        if growth["translation_rotation"] > 2e-3 or growth["scale"] > 2e-3:
            fail(f"{name}: information about the gauge grew: {growth}")
        if not case["nees_position"]["mean"] < 8:
            fail(f"{name}: {case['nees_position']}")


if not PF_SIM.exists():
    skip("pf-sim is not part of this build")
with tempfile.TemporaryDirectory() as name:
    measured = cases_of_a_room(pathlib.Path(name))
test_walls_should_be_found_and_nothing_else(measured)
test_the_state_should_shrink(measured)
test_folding_should_stay_honest(measured)
print("OK")
