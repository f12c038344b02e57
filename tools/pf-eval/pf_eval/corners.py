"""Corners of a known target, projected with a run's poses, against the corners that were measured in the images."""

import numpy as np

from . import Refused
from .files import read_yaml
from .tables import read_numbers

TOLERANCE = 0.010  # [s]


def read_target(path):
    """The target's corners TL TR BR BL in W (4,3) [m].

      width, height   rectangle: W is its centre, x right, y down as seen upright, z into the wall
      points          four points in W, in the order TL TR BR BL
      features        SceneLib's form: four points TL TR BL BR; W has x left, y up, z away
    """
    fields = read_yaml(path)
    try:
        if "width" in fields and "height" in fields:
            x, y = 0.5 * float(fields["width"]), 0.5 * float(fields["height"])
            if not (x > 0 and y > 0):
                raise Refused(f"{path}: width and height must be more than 0")
            return np.array([[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]])
        for name, order in (("features", [0, 1, 3, 2]), ("points", [0, 1, 2, 3])):
            if name in fields:
                points = np.array(fields[name], dtype=float)
                if points.shape != (4, 3) or not np.isfinite(points).all():
                    raise Refused(f"{path}: {name} must be four points of three numbers each")
                return points[order]
    except (TypeError, ValueError) as error:
        raise Refused(f"{path}: a field of the target is wrong ({error})") from error
    raise Refused(f"{path}: is no target (no width and height, points, or features)")


def compare_corners(run, camera, target_W, corners_path, skip_frames=0):
    """(summary, rows). A row per frame with measured corners: frame, t, then the distance of TL TR BR BL [px].

    corner_rms_px is the root of the mean squared distance over all corners of all frames. A corner that would lie behind
    the camera counts with the length of the image's diagonal.
    """
    measured = read_numbers(corners_path, 10)
    measured = measured[np.isfinite(measured).all(axis=1)]
    measured = measured[measured[:, 0] >= skip_frames]
    diagonal = float(np.hypot(camera.width, camera.height))
    rows, behind, offsets = [], 0, []
    for row in measured:
        i = int(np.argmin(np.abs(run.t - row[1])))
        if abs(run.t[i] - row[1]) > TOLERANCE:
            continue
        one = run.select(slice(i, i + 1))
        pixels = camera.at(row[1]).project((target_W - one.p) @ one.rotations()[0])
        offset = pixels - row[2:].reshape(4, 2)
        distance = np.linalg.norm(offset, axis=1)
        hidden = ~np.isfinite(distance)
        behind += int(hidden.sum())
        distance[hidden] = diagonal
        offsets.append(offset[~hidden])
        rows.append([row[0], row[1], *distance])
    if not rows:
        raise Refused(f"{corners_path}: has no frame within {1000 * TOLERANCE:.0f} ms of a pose of {run.source}")
    distance = np.array(rows)[:, 2:]
    mean = np.concatenate(offsets).mean(axis=0) if any(len(part) for part in offsets) else [np.nan, np.nan]
    per_frame = np.sqrt(np.mean(distance ** 2, axis=1))
    summary = {
        "corner_rms_px": float(np.sqrt(np.mean(distance ** 2))),
        "corner_max_px": float(distance.max()),
        "corner_median_px": float(np.median(distance)),
        "corner_worst_frame": int(rows[int(per_frame.argmax())][0]),
        "corner_bias_u_px": float(mean[0]), "corner_bias_v_px": float(mean[1]),
        "corners_behind": behind,
        "frames": len(rows),
        "frames_measured": len(measured),
    }
    return summary, rows
