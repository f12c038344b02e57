"""The motion since a mark: honest on geometric truth, and written by pf-capture window by window with its verdict where the truth is known."""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run  # noqa: E402

SEEDS, FIRST_SEED, FRAMES, WINDOW = 10, 1, 600, 30
CAPTURED, CAPTURED_AUTO = 100, 240


def require(condition, message):
    if not condition:
        fail(message)


def geometric(folder, case, *options):
    report = folder / "room.json"
    run(BIN / "pf-sim", "room", "--case", case, "--seeds", SEEDS, "--first-seed", FIRST_SEED, "--frames", FRAMES, "--jobs", 2,
        "--gauge-every", 0, "--relative", WINDOW, "--json", report, *options)
    return json.loads(report.read_text())["cases"][case]["motion"]


def test_motions_should_be_honest_when_all_models_are_true(folder):
    motion = geometric(folder, "A", "--layout", "model")
    print(f"seeds {FIRST_SEED}..{FIRST_SEED + SEEDS - 1}: {motion}")
    require(motion["windows"] == SEEDS * ((FRAMES - 1) // WINDOW), f"{motion['windows']} windows")
    low, high = motion["bound_low"], motion["bound_high"]
    require(low < motion["nees_per_dof"] < high, f"NEES of a motion per degree of freedom is {motion['nees_per_dof']}")
    for part in ("rotation", "translation"):  # half the degrees of freedom, twice the variance
        value = motion[f"{part}_nees_per_dof"]
        require(1 - 1.5 * (1 - low) < value < 1 + 1.5 * (high - 1), f"NEES of the {part} per degree of freedom is {value}")


def test_planes_should_leave_them_honest(folder):
    motion = geometric(folder, "B")
    require(0.85 < motion["nees_per_dof"] < 1.25, f"with planes: {motion}")


def test_a_lens_that_is_learnt_beside_the_first_depths_should_leave_them_honest(folder):
    report = folder / "rendered.json"
    run(BIN / "pf-sim", "rendered", "--scene", "room", "--draw-lens", "--lens", "estimate", "--seeds", 4, "--frames", 100, "--relative", WINDOW,
        "--jobs", 2, "--json", report)
    motion = json.loads(report.read_text())["cases"]["room"]["motion"]
    print(f"room, lens drawn and estimated: {motion}")
    require(motion["nees_per_dof"] < 2, f"with a lens that is estimated: {motion}")


def capture(folder, frames, *options):
    run(BIN / "pf-capture", "--source", "sim:desk", "--frames", frames, "--relative", WINDOW, "--headless", "--no-film", "--quiet",
        "--out", folder, *options)
    with open(folder / "relative.csv") as file:
        return list(csv.DictReader(file)), json.loads((folder / "report.json").read_text())["relative"]


def test_capture_should_write_a_row_per_window_and_its_verdict(folder):
    rows, summary = capture(folder / "target", CAPTURED, "--start", "target")
    require(len(rows) == summary["windows"] == 3 and summary["frames"] == WINDOW, f"{len(rows)} rows, {summary}")
    require(all(b["mark_t_s"] == a["t_s"] for a, b in zip(rows, rows[1:])), "windows that do not follow each other")
    require(all(row["nees_dof"] == "6" for row in rows), "a motion with a known length has six degrees of freedom")
    mean = sum(float(row["nees"]) for row in rows) / (6 * len(rows))
    require(abs(mean - summary["nees_per_dof"]) < 1e-4 * (1 + mean), f"{mean} in relative.csv, {summary} in report.json")
    require(0 < mean < 20, f"NEES of a motion per degree of freedom is {mean}")
    require(all(float(row[f"c{i}{i}"]) > 0 for row in rows for i in range(6)), "a variance that is not positive")


def test_capture_without_a_length_should_leave_the_scale_free(folder):
    rows, summary = capture(folder / "auto", CAPTURED_AUTO)
    require(rows and all(row["nees_dof"] == "5" for row in rows), f"degrees of freedom: {[row['nees_dof'] for row in rows]}")
    require(0 < summary["nees_per_dof"] < 20, f"{summary}")


def test_capture_should_say_so_when_no_window_came_to_its_end(folder):
    words = [BIN / "pf-capture", "--source", "sim:desk", "--frames", 8, "--relative", 9, "--headless", "--no-film", "--quiet", "--out", folder / "few"]
    said = subprocess.run([str(word) for word in words], text=True, capture_output=True, check=True).stderr
    require("note: --relative 9" in said, f"not a word of it: {said}")


with tempfile.TemporaryDirectory() as temporary:
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test(pathlib.Path(temporary))
