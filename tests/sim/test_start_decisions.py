"""A start from nothing, decision by decision: features begin, are followed, first depths are known once there is parallax and not before, for
enough of the features, of the right shape, and tracking goes on. What fails is named by its frame, its counts and the line of the log."""

import math
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from decisions import MIN_INLIERS, Run  # noqa: E402
from script import fail, skip_in_cross_builds  # noqa: E402

skip_in_cross_builds()

RATE = 30              # [1/s]
FRAMES = 110
REST_S = 1.0
MIN_BEGUN = 20         # features of the first frame
MIN_SHARE = 0.25       # of the features of a record that have a depth
MAX_START = 75         # frames of motion until there are depths
MAX_SHAPE = 0.1        # of the extent, error of a distance in the frames after the start; 0.5 to 5.3 % in these runs
problems = []


def require(condition, test, subject, run, begin=0, end=0):
    if not condition:
        problems.append(f"{run.name}\n {test}: {subject}" + (f"\n  {run.decisions(begin, end)}" if end > begin else ""))


def check(folder, scene, backend, seed, rest_s):
    words = ["--source", f"sim:{scene}", "--seed", seed, "--imu", "none", "--backend", backend, "--frames", FRAMES]
    if rest_s > 0:
        words += ["--rest", rest_s]
    run = Run(folder / f"{scene}-{backend}-{seed}-{rest_s}", *words)
    moves = round(rest_s * RATE)
    begun = int(run.number(0, "features"))
    require(begun >= MIN_BEGUN, "begin", f"{begun} features begin in the first frame, {MIN_BEGUN} expected", run)
    depths = run.logged("first depths without a target")
    at = depths[0] if depths else len(run)
    few = [k for k in range(1, at) if run.number(k, "matches") < MIN_INLIERS]
    require(not few, "follow", f"{len(few)} frames of the record have fewer than {MIN_INLIERS} matches, so that it begins again", run, *(few[:1] + [few[0] + 3] if few else (0, 0)))
    way = math.dist(run.truth[min(run.truth)], run.truth[round(run.number(min(at, len(run) - 1), "t_s"), 6)])
    said = f"frame {at}, {100 * way:.1f} cm of true way: {depths and depths[1]}"
    require(at >= moves, "parallax", f"depths while the camera stands still: {said}", run)
    require(at < moves + MAX_START, "parallax", f"no depths in the first {MAX_START} frames of motion: {said}", run, at - 2, at)
    if depths is None:
        return
    known, of = (int(word) for word in depths[1].split("target: ")[1].split(" features")[0].split(" of "))
    require(known >= max(MIN_INLIERS, MIN_SHARE * of), "depths", f"too few of the record's features have a depth: {said}", run)
    untracked = [k for k in range(at + 1, len(run)) if not run.is_tracked(k)]
    require(not untracked, "afterwards", f"{len(untracked)} frames after the start are not tracked", run, *(untracked[:1] + [untracked[0] + 3] if untracked else (0, 0)))
    error = run.shape_error(at, at + 30)
    print(f"{scene}, {backend}, seed {seed}, {rest_s} s of rest: {said}; distances wrong by {100 * (error or 0):.2f} % of the extent")
    require(error is not None and error < MAX_SHAPE, "shape", f"distances between places of the 30 frames after are wrong by {error} of the extent: {said}", run)


with tempfile.TemporaryDirectory() as root:
    for each_backend in ("filter", "window"):
        for each_scene in ("desk", "room"):
            check(pathlib.Path(root), each_scene, each_backend, 1, 0)
        check(pathlib.Path(root), "desk", each_backend, 2, REST_S)
if problems:
    fail("\n".join(problems))
