"""--backend of pf-sim's experiments: what the window can do runs, and what it cannot is refused by name in one line."""

import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run  # noqa: E402

PF_SIM = BIN / "pf-sim"


def require(condition, message):
    if not condition:
        fail(message)


def expect_refusal(names, *words):
    done = subprocess.run([str(word) for word in (PF_SIM, *words)], capture_output=True, text=True, check=False)
    require(done.returncode == 2 and done.stderr.count("\n") == 1 and all(name in done.stderr for name in names),
            f"{words}: {done.returncode}, {done.stderr}")


def report_of(folder, *words):
    path = folder / f"{words[0]}.json"
    run(PF_SIM, *words, "--backend", "window", "--json", path)
    report = json.loads(path.read_text())
    require(report["settings"]["backend"] == "window", f"{words[0]}: the report does not name its back end")
    return report


def test_window_should_run_what_needs_pictures_alone(folder):
    box = report_of(folder, "box", "--seeds", 1, "--frames", 150)
    require(list(box["cases"]) == ["points"] and box["cases"]["points"]["tracked_share"] > 0, f"box: {box['cases']}")
    street = report_of(folder, "street", "--seeds", 1, "--frames", 150, "--cases", "plain")
    require(street["cases"]["plain"]["tracked_share"] > 0, f"street: {street['cases']}")
    vio = report_of(folder, "vio", "--no-imu", "--rendered", "--seeds", 1, "--seconds", 6)
    require(vio["tracked_share"] > 0, f"vio: {vio['tracked_share']} tracked")


def test_gaps_should_be_judged_for_the_window_one_by_one(folder):
    film = folder / "film"
    run(PF_SIM, "render", "desk", "--out", film, "--frames", 110, "--width", 320)
    report = report_of(folder, "kidnap", "--source", f"images:{film}", "--start", f"target:{film / 'target.yaml'}", "--every", 50,
                       "--random-frames", 10, "--random-runs", 1)
    gaps, every = report["gaps"], report["all"]
    require(len(gaps) == every["trials"] > 10, f"{len(gaps)} gaps of {every['trials']} trials")
    for gap in gaps:
        require(gap["old_measured"] <= gap["old_features"], f"more is measured than there is: {gap}")
        require(gap["wrong"] or not gap["wrong_and_confident"], f"confident of what is not wrong: {gap}")
    measured = [gap for gap in gaps if gap["in_view"]]
    require(len(measured) == every["many_measured"] > 0, "nothing is in view")
    require(sum(gap["found_within_1_s"] for gap in measured) == every["found_of_measured"], "found again in other gaps")
    require(sum(gap["wrong_and_confident"] for gap in gaps) == every["wrong_beyond_5_sigma"], "wrong in other gaps")


def test_what_the_window_cannot_do_should_be_refused_by_name():
    window = ("--backend", "window")
    expect_refusal(["--backend window", "ungated", "patches"], "box", *window, "--cases", "points", "ungated")
    expect_refusal(["--backend window", "--geometric"], "box", *window, "--geometric")
    expect_refusal(["--backend window", "--no-points"], "box", *window, "--no-points")
    expect_refusal(["--backend window", "--gross"], "box", *window, "--gross", 0.1)
    expect_refusal(["--backend window", "--no-points"], "street", *window, "--no-points")
    expect_refusal(["--backend window", "--max-state-dim"], "street", *window, "--max-state-dim", 800)
    for experiment in ("box", "street", "vio", "rendered", "clutter", "road"):
        expect_refusal(["--backend", "keyframes"], experiment, "--backend", "keyframes")


test_what_the_window_cannot_do_should_be_refused_by_name()
with tempfile.TemporaryDirectory() as made:
    test_window_should_run_what_needs_pictures_alone(pathlib.Path(made))
    test_gaps_should_be_judged_for_the_window_one_by_one(pathlib.Path(made))
