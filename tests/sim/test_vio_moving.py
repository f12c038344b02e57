"""pf-sim vio --start moving: most walks tell metres within three seconds and few of them wrong ones; in pictures, whose map begins with
the record of a start, poses, gravity and biases are as honest, and a healthy unit is not doubted."""

import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run  # noqa: E402


def require(condition, message):
    if not condition:
        fail(message)


def report(folder, *options):
    path = folder / "vio.json"
    print(run(BIN / "pf-sim", "vio", "--start", "moving", "--imu-exact", "mount,delay,scale", "--json", path, *options))
    return json.loads(path.read_text())


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    walks = report(folder, "--seeds", "20", "--first-seed", "501", "--seconds", "3")["starts"]
    require(walks["accepted"] >= 14 and walks["accepted_poor"] == 0 and walks["wrong"] <= 2, f"walks of 3 s: {walks}")
    require(walks["scale_nees"] < 4, f"scale is more certain than right: NEES {walks['scale_nees']} of 1")

    # Over 30 ms: pixels are taken to the frame's time, and the first bearings know that speeds and depths were open together. The rate of
    # the first frame was zero: pose NEES 15.2.
    rows = report(folder, "--seeds", "10", "--first-seed", "101", "--seconds", "5", "--readout", "0.03")
    require(rows["starts"]["accepted"] >= 7 and rows["starts"]["wrong"] <= 1, f"with rows: {rows['starts']}")
    require(rows["doubt"]["runs"] == 0 and rows["nees_gyro_bias"] < 9, f"with rows: {rows['doubt']}, gyro {rows['nees_gyro_bias']}")
    require(rows["nees_pose"]["mean"] < 9, f"with rows: pose NEES {rows['nees_pose']['mean']}, 6 expected")

    # The same in pictures, where an inlier of a frame may leave the map in that frame.
    rows = report(folder, "--rendered", "--seeds", "2", "--first-seed", "21", "--seconds", "5", "--readout", "0.03")
    require(rows["starts"]["accepted"] >= 1 and rows["starts"]["wrong"] == 0, f"rows in pictures: {rows['starts']}")
    require(rows["doubt"]["runs"] == 0 and rows["lost_runs"] == 0 and rows["nees_pose"]["mean"] < 18, f"rows in pictures: {rows['doubt']}")

    # Poses that turned away from the truth put gravity and bias off. Before the filter knew what these have in common with the rotation, the
    # NEES was 18.7 and 45.7.
    seen = report(folder, "--rendered", "--scene", "desk", "--seeds", "6", "--first-seed", "29", "--seconds", "6", "--readout", "0.03")
    require(seen["starts"]["accepted"] >= 3 and seen["starts"]["wrong"] <= 1, f"desk with rows: {seen['starts']}")
    require(seen["nees_gravity"] < 6 and seen["nees_accel_bias"] < 9, f"desk with rows: NEES {seen['nees_gravity']}, {seen['nees_accel_bias']}")

    for scene, seconds in (("room", "5"), ("desk", "7")):
        seen = report(folder, "--rendered", "--scene", scene, "--seeds", "2", "--seconds", seconds)
        require(seen["starts"]["accepted"] >= 1 and seen["starts"]["wrong"] == 0, f"{scene}: {seen['starts']}")
        require(seen["doubt"]["runs"] == 0 and seen["lost_runs"] == 0, f"{scene}: a healthy unit is doubted: {seen['doubt']}")
        # Two runs: an average of fewer independent frames than it has, so three times what is expected.
        require(seen["nees_pose"]["mean"] < 18, f"{scene}: pose NEES {seen['nees_pose']['mean']}, 6 expected")
        require(seen["nees_gravity"] < 6 and seen["nees_gyro_bias"] < 9, f"{scene}: NEES {seen['nees_gravity']}, {seen['nees_gyro_bias']}")
        require(seen["nees_accel_bias"] < 18, f"{scene}: NEES of the accelerometer's bias {seen['nees_accel_bias']}, 3 expected")
