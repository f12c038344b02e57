"""pf-sim vio: from rest, with nothing known but the unit's noise, lengths are metres and covariances honest; a covered lens loses nothing;
without the unit the same walk has no metres."""

import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run  # noqa: E402

SEEDS = 4
EXACT = ("--imu-exact", "mount,delay,scale")


def require(condition, message):
    if not condition:
        fail(message)


def report(folder, *options):
    path = folder / "vio.json"
    own = ("--estimate", "--unit", "--axes", "--no-imu")
    options = options if any(name in options for name in own) else (*options, *EXACT)
    text = run(BIN / "pf-sim", "vio", "--seeds", str(SEEDS), "--json", path, *options)
    print(text)
    return json.loads(path.read_text()), text


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    vio, text = report(folder, "--seconds", "20")
    require("verdict: " in text.splitlines()[-1], "the last line is no verdict")
    require(vio["starts"] == {"tried": SEEDS, "accepted": SEEDS}, f"starts: {vio['starts']}")
    require(vio["lost_runs"] == 0 and vio["tracked_share"] > 0.99, "a walk was not tracked throughout")
    # Four runs of 20 s: run averages scatter by 30 %, and the first second of motion is above.
    require(3.5 < vio["nees_pose"]["mean"] < 12, f"pose NEES {vio['nees_pose']['mean']}, 6 expected")
    require(vio["nees_gravity"] < 6 and vio["nees_gyro_bias"] < 9 and vio["nees_accel_bias"] < 9, "NEES of gravity or biases")
    require(vio["gauge_growth"] < 1e-9, f"information about six directions grew by {vio['gauge_growth']}")
    require(vio["scale_error"]["max"] < 0.02, f"scale off by {vio['scale_error']['max']}")

    # How the unit is mounted and how late it is, found from 2 degrees, 2 cm and 10 ms.
    mounted, _ = report(folder, "--seconds", "20", "--estimate", "mount,delay", "--first-seed", "3")
    require(mounted["lost_runs"] == 0 and mounted["doubt"]["runs"] == 0, f"with an uncertain mounting: {mounted['doubt']}")
    require(mounted["mount_error_deg"]["max"] < 0.1 and mounted["mount_error_m"]["max"] < 0.01, f"{mounted['mount_error_deg']}")
    require(mounted["delay_error_ms"]["max"] < 0.3 and mounted["mount_sigmas"]["max"] < 5, f"{mounted['delay_error_ms']}")
    require(3.5 < mounted["nees_pose"]["mean"] < 14, f"pose NEES {mounted['nees_pose']['mean']} with an uncertain mounting")
    require(mounted["gauge_growth"] < 1e-9, f"information about six directions grew by {mounted['gauge_growth']}")
    unknown = subprocess.run([BIN / "pf-sim", "vio", "--estimate", "colour"], capture_output=True, text=True)
    require(unknown.returncode == 2 and "mount, delay" in unknown.stderr, f"{unknown.returncode}: {unknown.stderr}")

    # Rows over 30 ms, known as 20 ms, through a turn of 450 degrees a second (seed 10): the samples' accelerations are part of the rows.
    rows, _ = report(folder, "--seconds", "34", "--readout", "0.03", "--estimate", "readout", "--first-seed", "8")
    require(rows["lost_runs"] == 0 and rows["doubt"]["runs"] == 0, f"with rows: {rows['doubt']}")
    require(rows["readout_error_ms"]["max"] < 2 and rows["readout_sigmas"]["max"] < 5, f"{rows['readout_error_ms']}")
    require(3.5 < rows["nees_pose"]["mean"] < 12, f"pose NEES {rows['nees_pose']['mean']} with rows")

    # The same in pictures, whose rows are drawn from the poses of their own times; without being told the unit comes into doubt.
    path = folder / "rows.json"
    run(BIN / "pf-sim", "vio", "--rendered", "--seeds", "2", "--seconds", "14", "--readout", "0.03", "--estimate", "readout", "--json", path)
    drawn = json.loads(path.read_text())
    require(drawn["lost_runs"] == 0 and drawn["doubt"]["runs"] == 0, f"rows in pictures: {drawn['doubt']}")
    require(drawn["readout_error_ms"]["max"] < 2 and drawn["readout_sigmas"]["max"] < 5, f"{drawn['readout_error_ms']}")
    require(1.5 < drawn["nees_pose"]["mean"] < 12, f"pose NEES {drawn['nees_pose']['mean']} with rows in pictures")
    run(BIN / "pf-sim", "vio", "--rendered", "--seeds", "1", "--seconds", "14", "--readout", "0.03", "--as-global", *EXACT, "--json", path)
    require(json.loads(path.read_text())["nees_pose"]["mean"] > 12, "rows that nobody tells of pass for none")

    dark, _ = report(folder, "--seconds", "12", "--blackout-at", "7", "--blackout", "1")
    require(dark["lost_runs"] == 0, "lost behind a covered lens")
    require(dark["frames_until_tracked_again"]["runs"] == SEEDS, "not tracked again")
    require(dark["frames_until_tracked_again"]["max"] <= 2, "tracked again too late")

    # Metres while it moves; not from a camera that only rotates (seed 20) or moves evenly (10).
    moving, text = report(folder, "--start", "moving", "--seconds", "8", "--first-seed", "1")
    require("verdict: " in text.splitlines()[-1], "the last line is no verdict")
    require(moving["starts"]["accepted"] >= 2 and moving["starts"]["wrong"] == 0, f"starts while it moves: {moving['starts']}")
    require(moving["scale_error"]["max"] < 0.03 and moving["tilt_deg"]["max"] < 1, f"moving: {moving['scale_error']}")
    require(moving["gauge_growth"] < 1e-9, f"information about six directions grew by {moving['gauge_growth']}")
    for seed in ("10", "20"):
        path = folder / "poor.json"
        run(BIN / "pf-sim", "vio", "--start", "moving", "--seeds", "1", "--first-seed", seed, "--seconds", "8", *EXACT, "--json", path)
        poor = json.loads(path.read_text())["starts"]
        require(poor["accepted_poor"] == 0 and poor["good"] == 0, f"metres from a camera that tells nothing: {poor}")

    without, _ = report(folder, "--seconds", "12", "--no-imu")
    require(without["starts"]["accepted"] == 0 and not without["verdict"], "metres without a unit")

    gap, _ = report(folder, "--seconds", "14", "--fault", "gap", "--fault-at", "7")
    require(gap["lost_runs"] == 0 and gap["refused"] == 0, "lost by a unit that stops for a second")
    require(gap["fault"]["tracked_after"] > 0.99 and gap["fault"]["worst_sigmas_after"] < 4, f"after a gap: {gap['fault']}")

    # Nor does the second of rest behind the one that began the map: the camera is held in it.
    require(vio["resting_share"] * vio["settings"]["seconds"] > 0.9, f"of 2 s at rest held: {vio['resting_share']}")

    # A longer rest tells nothing new of depths, and must not seem to.
    rested, _ = report(folder, "--seconds", "28", "--rest", "20")
    require(rested["doubt"]["runs"] == 0 and rested["scale_error"]["max"] < 0.03, f"after a long rest: {rested['scale_error']}")
    still, _ = report(folder, "--still", "--seconds", "30")
    require(still["resting_share"] > 0.9 and still["wander_m"]["median"] < 0.002, f"at rest: {still['wander_m']}")
    turns, _ = report(folder, "--still", "--seconds", "10", "--turn", "0.5")
    require(turns["resting_share"] == 0, f"at rest on a turntable in {turns['resting_share']} of frames")

    require(vio["doubt"]["runs"] == 0, f"a healthy unit was doubted: {vio['doubt']}")
    mount, _ = report(folder, "--seconds", "14", "--fault", "mount", "--fault-at", "2")
    require(mount["doubt"]["runs"] == SEEDS and mount["doubt"]["at_s"]["max"] < 2 + 5, f"mounted wrongly: {mount['doubt']}")
    require(mount["lost_runs"] == 0 and mount["refused"] == 0, "lost by a unit that is mounted wrongly")
    require(mount["fault"]["tracked_after"] > 0.99 and mount["fault"]["metric_after"] == 0, f"{mount['fault']}")

    back, _ = report(folder, "--seconds", "20", "--fault", "reversed", "--fault-at", "8")
    require(back["doubt"]["runs"] == SEEDS and back["doubt"]["at_s"]["max"] < 8.5, f"doubted late: {back['doubt']}")
    require(back["lost_runs"] == 0 and back["fault"]["tracked_after"] > 0.99, f"readings reversed: {back['fault']}")
    # What wrong samples say is not used, so that the map is what it was.
    require(back["fault"]["nees_after"] < 12 and back["fault"]["worst_sigmas_after"] < 4, f"after the doubt: {back['fault']}")

    # Search ellipses about a wrong prediction hold nothing.
    path = folder / "rendered.json"
    run(BIN / "pf-sim", "vio", "--rendered", "--seeds", "1", "--seconds", "13", "--fault", "reversed", "--fault-at", "6", *EXACT, "--json", path)
    seen = json.loads(path.read_text())
    require(seen["lost_runs"] == 0 and seen["doubt"]["runs"] == 1, f"reversed in pictures: {seen['doubt']}")
    require(seen["fault"]["tracked_after"] > 0.99 and seen["fault"]["worst_sigmas_after"] < 4, f"{seen['fault']}")

    # A unit as phones have it, of which nothing but a third of its noise and about how it is mounted is told.
    phone, _ = report(folder, "--seconds", "14", "--unit", "phone")
    require(phone["doubt"]["runs"] == 0 and phone["lost_runs"] == 0, f"a phone's unit: {phone['doubt']}")
    require(1.5 < phone["nees_pose"]["mean"] < 12, f"pose NEES {phone['nees_pose']['mean']} with a phone's unit")
    require(phone["nees_gyro_bias"] < 9 and phone["nees_accel_bias"] < 9, "NEES of a phone's biases")
    require(phone["starts"]["accepted"] == SEEDS, f"a phone's unit: {phone['starts']}")
    # Axes of which nothing is told are found.
    turned, _ = report(folder, "--seconds", "10", "--axes", "13")
    require(turned["starts"]["accepted"] == SEEDS and turned["mount_error_deg"]["max"] < 1, f"any axes: {turned['mount_error_deg']}")

    unknown = subprocess.run([BIN / "pf-sim", "vio", "--fault", "magic"], capture_output=True, text=True)
    require(unknown.returncode == 2 and "clock-jump" in unknown.stderr, f"{unknown.returncode}: {unknown.stderr}")
    bad = subprocess.run([BIN / "pf-sim", "vio", "--seeds", "0"], capture_output=True, text=True)
    require(bad.returncode == 2 and len(bad.stderr.splitlines()) == 1, f"{bad.returncode}: {bad.stderr}")
