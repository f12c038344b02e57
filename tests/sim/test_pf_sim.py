"""pf-sim: the rendered layout on disk, the report of a short Monte Carlo run, the same twice, and clear refusals."""

import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run, skip  # noqa: E402

PF_SIM = BIN / "pf-sim"


def test_render_should_write_the_layout_of_recorded_sequences(folder):
    out = folder / "wall"
    run(PF_SIM, "render", "wall", "--out", out, "--frames", "3", "--camera", "division", "--seed", "4")
    times = (out / "times.txt").read_text().split("\n")[:-1]
    truth = [line for line in (out / "groundtruth.tum").read_text().splitlines() if not line.startswith("#")]
    if len(times) != 3 or len(truth) != 3:
        fail(f"{len(times)} times and {len(truth)} poses of 3 frames")
    for k, line in enumerate(times):
        index, seconds, name = line.split()
        if int(index) != k or abs(float(seconds) - k / 30) > 1e-6 or not (out / "images" / name).stat().st_size:
            fail(f"line {k} of times.txt: {line}")
    for line in truth:
        q = [float(v) for v in line.split()[4:]]
        if abs(sum(v * v for v in q) - 1) > 1e-6:
            fail(f"no unit quaternion: {line}")
    calib = (out / "calib.yaml").read_text()
    if "distortion_model: harris_division" not in calib or "9.0" not in calib and "9e-06" not in calib:
        fail(calib)
    if "width:" not in (out / "target.yaml").read_text():
        fail("no target")


def test_room_should_report_its_numbers_and_be_the_same_twice(folder):
    reports = []
    for k in range(2):
        path = folder / f"room{k}.json"
        run(PF_SIM, "room", "--case", "A", "--seeds", "2", "--frames", "40", "--jobs", "2", "--gauge-every", "10",
            "--json", path, "--csv", folder / "csv")
        report = json.loads(path.read_text())
        report["cases"]["A"].pop("frames_per_second")
        report["cases"]["A"].pop("cost")
        reports.append(report)
    if reports[0] != reports[1]:
        fail("two runs with the same seeds differ")
    case = reports[0]["cases"]["A"]
    for name in ("nees_position", "state_dim", "active_dim", "camera_rmse_m", "map_rmse_m", "planes", "gauge_growth"):
        if name not in case:
            fail(f"no {name} in the report")
    if case["lost_runs"] != 0 or not 0 < case["nees_position"]["mean"] < 15:
        fail(json.dumps(case, indent=1))
    if case["gauge_growth"]["translation_rotation"] > 1e-9:
        fail(f"information about the gauge grew: {case['gauge_growth']}")
    if len((folder / "csv" / "room_A.csv").read_text().splitlines()) != 41:
        fail("the per-frame table has the wrong length")


def test_many_starts_before_a_target_should_all_succeed(folder):
    """Half a second before the target, then points that are two to three times farther begin all at once."""
    path = folder / "starts.json"
    run(PF_SIM, "room", "--case", "A", "--seeds", "80", "--frames", "120", "--jobs", "2", "--json", path)
    case = json.loads(path.read_text())["cases"]["A"]
    if case["lost_runs"] or not case["nees_position"]["mean"] < 4 or not case["camera_rmse_m"] < 0.02:
        fail(json.dumps(case, indent=1))


def test_wrong_words_should_be_refused_in_one_line():
    wrong = [["render", "desk", "--out", "x", f"--{option}", value] for option, value in (
        ("frames", "-3"), ("width", "3"), ("noise", "-3"), ("noise", "nan"), ("exposure", "-1"), ("exposure", "1"), ("blur", "0"),
        ("readout", "nan"), ("exposure-step", "0"), ("drop", "3"), ("repeat", "-1"))]
    for words in (*wrong, ["render", "nowhere", "--out", "x"], ["room", "--case", "Z"], ["room", "--layout", "moon"],
                  ["gee2007", "--motion", "dance"], ["room", "--sigma-px", "1000"]):
        result = subprocess.run([str(PF_SIM), *words], capture_output=True, text=True)
        if result.returncode == 0 or len(result.stderr.strip().splitlines()) != 1:
            fail(f"{words}: exit {result.returncode}, said: {result.stderr}")
        if words in wrong and words[4] not in result.stderr:
            fail(f"{words}: {words[4]} is not named: {result.stderr}")


def test_every_scene_that_an_error_names_should_be_in_the_help():
    scenes = subprocess.run([str(PF_SIM), "render", "nowhere", "--out", "x"], capture_output=True, text=True).stderr.split("there are", 1)[1]
    said = run(PF_SIM, "render", "--help").split()
    missing = [scene for scene in scenes.split() if scene not in said]
    if missing:
        fail(f"pf-sim render --help does not name {missing}")


if not PF_SIM.exists():
    skip("pf-sim is not part of this build")
with tempfile.TemporaryDirectory() as name:
    test_render_should_write_the_layout_of_recorded_sequences(pathlib.Path(name))
    test_room_should_report_its_numbers_and_be_the_same_twice(pathlib.Path(name))
    test_many_starts_before_a_target_should_all_succeed(pathlib.Path(name))
test_wrong_words_should_be_refused_in_one_line()
test_every_scene_that_an_error_names_should_be_in_the_help()
print("OK")
