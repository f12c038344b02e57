"""Sessions of 50,000 frames that ran in double, of points alone and with planes, run in float on the observations that were accepted
there, and come to the same: the same map, sigma within 2 %, states within 0.1 sigma, and no update refused."""

import json
import os
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

FRAMES = int(os.environ.get("PLANEFOLD_REPLAY_FRAMES", "50000"))

script.skip_unless_plain_native_build()
record, follow = script.BIN / "pf-replay", script.BIN / "pf-replayf"
if not follow.exists():
    script.skip("the programs are not part of this build")



def follow_session(planes):
    with tempfile.TemporaryDirectory() as folder:
        tape, result = pathlib.Path(folder) / "tape", pathlib.Path(folder) / "result.json"
        script.run(record, "record", tape, "--frames", FRAMES, *(["--planes"] if planes else []))
        script.run(follow, "follow", tape, "--json", result)
        found = json.loads(result.read_text())
    print("with planes" if planes else "points alone", json.dumps(found, indent=1))

    problems = []
    for name, wanted in (("scalar", "float"), ("frames", FRAMES), ("not_tracked", 0), ("starts_again", 0), ("refused_again", 0),
                         ("frames_with_another_map", 0), ("frames_with_another_state", 0), ("map_points_of_another_kind", 0)):
        if found[name] != wanted:
            problems.append(f"{name} is {found[name]}, not {wanted}")
    for name, most in (("position_in_sigma", 0.1), ("rotation_in_sigma", 0.1), ("map_position_in_sigma", 0.1), ("sigma_relative", 0.02),
                       ("map_sigma_relative", 0.02)):
        if not found[name] <= most:
            problems.append(f"{name} is {found[name]}, allowed is {most}")
    if found["tracked"] < 0.95 * FRAMES or found["map_points"] < 100 or (planes and found["map_points_folded"] < 10):
        problems.append("the session is not much of one")
    return problems


problems = follow_session(False) + [f"with planes: {p}" for p in follow_session(True)]
if problems:
    script.fail("\n  ".join(problems))
