"""pf-sim gee2007 with the paper's filter: planes are found and folded, the state shrinks, the tables are whole, and the same seed
gives the same run."""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, SOURCE, fail, run, skip  # noqa: E402

PF_SIM = BIN / "pf-sim"
FRAMES, LOOP = 700, 450


def gee2007(folder, name, *words):
    out = folder / f"{name}.json"
    run(PF_SIM, "gee2007", "--seeds", "1", "--first-seed", "3", "--jobs", "1", "--frames", FRAMES, "--frames-per-loop", LOOP,
        "--target-frames", "0", "--sigma-turn", "0.02", "--sigma-step", "0.02", "--json", out, "--csv", folder / name, *words)
    return json.loads(out.read_text())


def test_cases_should_shrink_the_state_as_the_paper_has_it(folder):
    cases = gee2007(folder, "all", "--case", "ABDE")["cases"]
    for letter, case in cases.items():
        for name in ("nees_position", "state_dim", "active_dim", "camera_rmse_m", "map_rmse_m", "planes"):
            if name not in case:
                fail(f"no {name} in case {letter}")
        if case["lost_runs"]:
            fail(f"case {letter} was lost")
    size = {letter: case["state_dim"]["end"] for letter, case in cases.items()}
    if not size["A"] > size["B"] >= size["D"] > size["E"]:
        fail(f"sizes of the state: {size}")
    if cases["A"]["end"]["planes"] != 0 or cases["B"]["end"]["planar"] < 20 or cases["B"]["end"]["fixed"] != 0:
        fail(f"case A: {cases['A']['end']}, case B: {cases['B']['end']}")
    if cases["E"]["end"]["fixed"] < 20:
        fail(f"case E: {cases['E']['end']}")
    a = cases["A"]
    if not 1.5 < a["nees_position"]["mean"] < 40 or a["camera_rmse_m"] > 0.05 or a["map_rmse_m"] > 0.1:
        fail(f"case A: NEES {a['nees_position']}, camera {a['camera_rmse_m']} m, map {a['map_rmse_m']} m")
    planes = cases["B"]["planes"]
    if planes["true"] < 2:
        fail(f"case B found {planes}")


def test_tables_should_be_whole_when_the_runs_are_done(folder):
    with open(folder / "all" / "gee2007_B.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    if len(rows) != FRAMES or [int(rows[i]["loop"]) for i in (0, LOOP - 1, LOOP, FRAMES - 1)] != [0, 0, 1, 1]:
        fail(f"Figure 2 has {len(rows)} rows, or the loops are wrong")
    for row in (rows[0], rows[-1]):
        numbers = 7 + 6 * float(row["inverse_depths"]) + 3 * float(row["points"]) + 2 * float(row["planar"]) + 7 * float(row["planes"])
        if numbers != float(row["state_dim"]):
            fail(f"the parts of the state make {numbers} numbers: {row}")
    with open(folder / "all" / "gee2007_B_points.csv", newline="") as file:
        points = list(csv.DictReader(file))
    if sorted({row["moment"] for row in points}) != ["after", "before", "end"]:
        fail("Figure 1 lacks a moment")
    if any(float(row[name]) < 0 for row in points for name in ("xx", "yy", "zz")):
        fail("a variance is negative")


def test_run_should_be_the_same_twice(folder):
    first = gee2007(folder, "first", "--case", "F")["cases"]["F"]
    second = gee2007(folder, "second", "--case", "F")["cases"]["F"]
    for case in (first, second):
        case.pop("cpu_seconds_per_run")
    if first != second:
        fail("two runs with the same seed differ")


def test_wrong_words_should_be_refused_in_one_line(folder):
    for command in ([PF_SIM, "gee2007", "--case", "Z"], [PF_SIM, "gee2007", "--target-points", "9"],
                    [PF_SIM, "gee2007", "--filter", "none"], [PF_SIM, "gee2007", "--look", "up"],
                    [PF_SIM, "gee2007", "--rho", "-1"], [SOURCE / "tools" / "plot-gee2007", folder / "nothing"]):
        result = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        if result.returncode == 0 or len(result.stderr.strip().splitlines()) != 1:
            fail(f"{command}: exit {result.returncode}, said: {result.stderr}")


if not PF_SIM.exists():
    skip("pf-sim is not part of this build")
with tempfile.TemporaryDirectory() as name:
    test_cases_should_shrink_the_state_as_the_paper_has_it(pathlib.Path(name))
    test_tables_should_be_whole_when_the_runs_are_done(pathlib.Path(name))
    test_run_should_be_the_same_twice(pathlib.Path(name))
    test_wrong_words_should_be_refused_in_one_line(pathlib.Path(name))
print("OK")
