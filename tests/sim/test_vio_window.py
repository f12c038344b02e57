"""pf-sim vio --backend window: samples give the map of the window its metres while the camera moves, with the unit's mounting and delay known
and with both estimated, and bridge a second without a picture; a unit that is wrong is rejected, and the map goes on; rows of a phone that
nothing tells are no other lens."""

import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run  # noqa: E402

WALK = ("--backend", "window", "--rendered", "--scene", "room", "--start", "moving", "--jobs", "2")


def require(condition, message):
    if not condition:
        fail(message)


def report(folder, *options):
    path = folder / "vio.json"
    print(run(BIN / "pf-sim", "vio", *WALK, "--json", path, *options))
    return json.loads(path.read_text())


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    known = ("--imu-exact", "mount,delay,scale")
    walk = report(folder, *known, "--seeds", "2", "--first-seed", "41", "--seconds", "14", "--blackout", "1", "--blackout-at", "9")
    require(walk["starts"]["accepted"] == 2 and walk["starts"]["wrong"] == 0, f"starts: {walk['starts']}")
    require(walk["doubt"]["runs"] == 0 and walk["lost_runs"] == 0, f"a healthy unit: {walk['doubt']}, lost {walk['lost_runs']}")
    require(walk["scale_error_5s"]["median"] < 0.03 and walk["nees_pose"]["mean"] < 12, f"{walk['scale_error_5s']}, {walk['nees_pose']}")

    drawn = report(folder, "--seeds", "2", "--first-seed", "41", "--seconds", "12")
    require(drawn["starts"]["accepted"] == 2 and drawn["starts"]["wrong"] == 0, f"mounting and delay estimated: {drawn['starts']}")
    require(drawn["doubt"]["runs"] == 0 and drawn["lost_runs"] == 0, f"mounting and delay estimated: {drawn['doubt']}")

    wrong = report(folder, *known, "--seeds", "1", "--first-seed", "41", "--seconds", "15", "--fault", "reversed", "--fault-at", "8")
    require(wrong["doubt"]["runs"] == 1 and wrong["lost_runs"] == 0, f"a unit whose axes turn round: {wrong['doubt']}")

    phone = report(folder, "--seeds", "2", "--first-seed", "603", "--seconds", "14", "--unit", "phone")
    require(phone["starts"]["accepted"] == 2 and phone["doubt"]["runs"] == 0 and phone["lost_runs"] == 0, f"a phone: {phone['starts']}, lost {phone['lost_runs']}")
    require(phone["nees_pose"]["mean"] < 12, f"a phone: {phone['nees_pose']}")
