"""pf-eval RUN --planes-truth: which members of the planes of a run are right.

Features that were found in a frame are counted by what truth says of them (true_places.py) and by what the run says: earned (on a plane, by
their own parallax), on trial (began on it), or neither.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from . import Refused
from .camera import camera_of_run
from .files import read_table
from .true_places import (MIN_ON_PLANE, MIN_PARALLAX_DEG, NEAR, Places, fit_plane, label_planes, places_from_depths, places_of_scene,
                          triangulate)

FOUND = ("inlier", "new")
MIN_LIFE = 30      # frames of a plane that counts
MIN_JUDGED = 4     # earned members by which a plane is judged
MIN_RIGHT = 0.7    # of them, on one true plane; another plane is false
NEEDS = "a scene (pf-capture --source sim:NAME --tracks), depth images (--depth DIR) or true poses (--truth FILE)"


def read_rows(folder):
    """Columns of tracks.csv of the features that were found in tracked frames, without the target's points; and the frames' times."""
    for name in ("tracks.csv", "planes.csv", "frames.csv"):
        if not (folder / name).is_file():
            raise Refused(f"{folder}: has no {name}; --planes-truth needs a run of pf-capture --tracks")
    table, frames = read_table(folder / "tracks.csv"), read_table(folder / "frames.csv")
    if "plane" not in table:
        raise Refused(f"{folder}/tracks.csv: has no column plane; it was written by an older pf-capture")
    frame = table["frame"].astype(int)
    kept = np.isin(table["status"], FOUND) & np.isfinite(table["plane"]) & np.isfinite(table["measured_u"]) & (frames["tracked"][frame] == 1)
    rows = {name: table[name][kept] for name in ("id", "plane", "trial", "surface")}
    rows.update(frame=frame[kept], z=np.column_stack([table["measured_u"], table["measured_v"]])[kept].astype(float))
    rows["id"], rows["plane"] = rows["id"].astype(int), rows["plane"].astype(int)
    return rows, frames["t_s"]


def true_poses(truth, times):
    """(R, p) of the true pose nearest to each time; NaN where there is none within 10 ms."""
    nearest = np.abs(truth.t[None, :] - times[:, None]).argmin(axis=1)
    near = np.abs(truth.t[nearest] - times) <= 0.010
    R = Rotation.from_quat(truth.q[nearest][:, [1, 2, 3, 0]]).as_matrix()
    return R, np.where(near[:, None], truth.p[nearest], np.nan)


def find_places(rows, folder, report, poses, options):
    if options.depth is None and np.isfinite(rows["surface"]).any() and (folder / "truth_planes.json").is_file():
        return places_of_scene(rows, folder)
    if poses is None:
        raise Refused(f"{folder}: --planes-truth needs {NEEDS}")
    camera = camera_of_run(report, folder, folder / "calib.yaml").at(0.0)
    if options.depth is not None:
        found, source = places_from_depths(rows, poses, camera, options.depth, options.depth_unit, int(report.get("skip") or 0)), "depth images"
    else:
        found, source = triangulate(rows, poses, camera), "tracks triangulated with the true poses"
    return Places(*found, label_planes(*found[1:]), source)


def judge_plane(rows, mine, places, index):
    """Which of the rows of one plane are right (1), wrong (0) or not judged (-1). A scene says it by surfaces; else the plane of most."""
    verdict = np.full(len(mine), -1)
    own = index[mine]
    earned = rows["trial"][mine] == 0
    if places.source == "scene":
        label = places.label[own]
        judged = label >= -1
        by = label[judged & earned & (label >= 0)] if (judged & earned & (label >= 0)).any() else label[judged & (label >= 0)]
        main = np.bincount(by).argmax() if len(by) else -3
        verdict[judged] = label[judged] == main
        return verdict
    for chosen in (np.unique(own[earned]), np.unique(own)):
        chosen = chosen[np.isfinite(places.place[chosen, 0])]
        if len(chosen) >= MIN_JUDGED:
            break
    else:
        return verdict
    found = fit_plane(places.place[chosen], places.sigma[chosen], np.random.default_rng(2))
    if found is not None:
        n, d, _ = found
        judged = np.isfinite(places.place[own, 0])
        verdict[judged] = np.abs(places.place[own[judged]] @ n - d) < NEAR * places.sigma[own[judged]]
    return verdict


def judge_planes(rows, places, index):
    """A verdict for each row, and a list of the planes."""
    verdict, planes = np.full(len(index), -1), []
    for number in np.unique(rows["plane"][rows["plane"] > 0]):
        mine = np.flatnonzero(rows["plane"] == number)
        verdict[mine] = judge_plane(rows, mine, places, index)
        life = len(np.unique(rows["frame"][mine]))
        earned = mine[(rows["trial"][mine] == 0) & (verdict[mine] >= 0)]
        members = len(np.unique(rows["id"][earned]))
        right = float(verdict[earned].mean()) if len(earned) else None
        is_false = bool(right < MIN_RIGHT) if members >= MIN_JUDGED else None
        planes.append({"id": int(number), "frames": life, "members": members, "right": right, "false": is_false})
    return verdict, planes


def tell_by_parallax(rows, poses, camera):
    """Which rows have turned by MIN_PARALLAX_DEG about the feature since it was first found, by the true poses and its pixels."""
    from .adjust_run import rays
    R, p = poses
    d = np.einsum("kij,kj->ki", R[rows["frame"]], rays(camera, rows["z"]))
    first = {}
    told = np.zeros(len(d), dtype=bool)
    for k in np.argsort(rows["frame"], kind="stable"):
        number = rows["id"][k]
        if not np.isfinite(p[rows["frame"][k], 0]):
            continue
        seen = first.setdefault(number, [d[k], False])
        seen[1] = seen[1] or bool(d[k] @ seen[0] < np.cos(np.radians(MIN_PARALLAX_DEG)))
        told[k] = seen[1]
    return told


def share(part, whole):
    return float(part / whole) if whole else None


def compare_planes_with_truth(folder, report, truth, options):
    """Shares are means over tracked frames of counts over the features found in that frame."""
    rows, times = read_rows(folder)
    poses = true_poses(truth, times) if truth is not None else None
    places = find_places(rows, folder, report, poses, options)
    index = np.searchsorted(places.ids, rows["id"])
    label = places.label[index]
    verdict, planes = judge_planes(rows, places, index)
    told = np.zeros(len(index), dtype=bool)
    if poses is not None:
        told = tell_by_parallax(rows, poses, camera_of_run(report, folder, folder / "calib.yaml").at(0.0))
    on = rows["plane"] > 0
    earned, trial = on & (rows["trial"] == 0), on & (rows["trial"] == 1)
    could = np.zeros(len(index), dtype=bool)
    frames = np.unique(rows["frame"])
    for frame in frames:
        here = np.flatnonzero((rows["frame"] == frame) & (label >= 0))
        counts = np.bincount(label[here]) if len(here) else np.zeros(1)
        could[here] = counts[label[here]] >= MIN_ON_PLANE
    found = np.bincount(rows["frame"])[frames]

    def mean(mask):
        return float((np.bincount(rows["frame"][mask], minlength=frames.max() + 1)[frames] / found).mean())
    old = [plane for plane in planes if plane["frames"] >= MIN_LIFE]
    return {
        "truth_source": places.source, "found": float(found.mean()), "judged": mean(label >= -1), "could_fold": mean(could),
        "could_tell": mean(could & told), "earned": mean(earned), "on_trial": mean(trial),
        "power": share((earned & could & told).sum(), (could & told).sum()),
        "false_members": share((earned & (verdict == 0)).sum(), (earned & (verdict >= 0)).sum()),
        "false_trial": share((trial & (verdict == 0)).sum(), (trial & (verdict >= 0)).sum()),
        "planes_lived": len(old), "planes_lived_false": sum(plane["false"] is True for plane in old),
        "planes_lived_not_judged": sum(plane["false"] is None for plane in old), "planes_judged": planes,
    }
