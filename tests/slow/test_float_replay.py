"""Sessions of 50,000 frames that ran in double, of points alone and with planes, run in float on the observations that were accepted
there, and come to the same: the same map and the same rows in every frame, sigma within 2 %, states within 0.1 sigma, and no update
refused.

The rows are not the same in all frames (lib/docs/theory/kernels.md), and the test says so. Beside that it bounds by how much they differ. What
is decided about a feature (its conversion to a place, its fold into a plane) falls a few frames earlier or later where it depends on numbers
that differ by as much as is allowed above; at the end all is decided alike. The bounds follow from what is allowed of the numbers:

- A feature is converted when its linearity index, which is proportional to its sigma, has fallen to a bound. It falls at least as the
  root of the number of its frames, so a sigma that is off by a share s comes to the bound 2 s of the feature's age earlier or later.
- A point is folded when its distance is within 2.57 sigma (0.99) of the plane. Where the distance is off by e sigma, points whose
  distance is within e of one of the two bounds may be decided otherwise: 4 e phi(2.57) of them. A plane that is found a few tries
  earlier takes all of its points along, so this bounds the sum over points and frames, and no single one."""

import json
import math
import os
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

FRAMES = int(os.environ.get("PLANEFOLD_REPLAY_FRAMES", "50000"))

POSITION = 0.1  # [sigma] that a state may be off
SIGMA = 0.02  # share by which a sigma may be off
GATE = 2.575  # [sigma] of a fold: the root of 6.63
CONVERTED_APART = 2 * SIGMA  # of the features that wait for their conversion, summed over frames
FOLDED_APART = 4 * POSITION * math.exp(-GATE**2 / 2) / math.sqrt(2 * math.pi)  # of the points, likewise

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
                         ("frames_with_another_map", 0), ("frames_with_another_state", 0), ("another_state_at_the_end", False),
                         ("map_points_of_another_kind", 0)):
        if found[name] != wanted:
            problems.append(f"{name} is {found[name]}, not {wanted}")
    for name, most in (("position_in_sigma", POSITION), ("rotation_in_sigma", POSITION), ("map_position_in_sigma", POSITION),
                       ("sigma_relative", SIGMA), ("map_sigma_relative", SIGMA), ("converted_apart", CONVERTED_APART * found["open_depths"]),
                       ("folded_apart", FOLDED_APART * found["places"])):
        if not found[name] <= most:
            problems.append(f"{name} is {found[name]}, allowed is {most}")
    if found["tracked"] < 0.95 * FRAMES or found["map_points"] < 100 or (planes and found["map_points_folded"] < 10):
        problems.append("the session is not much of one")
    return problems


problems = follow_session(False) + [f"with planes: {p}" for p in follow_session(True)]
if problems:
    script.fail("\n  ".join(problems))
