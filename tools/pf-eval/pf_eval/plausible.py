"""Units and orders that two trajectories tell of each other: notes with what to type."""

import numpy as np

from .association import associate
from .errors import compare
from .notes import note

FAR_DEG = 20.0  # a rotation error above this may be one of the order of numbers
NEAR = 0.25     # of it remains where it was


def tell_lengths(run, truth, align):
    """A note where a run in metres and its truth differ by a unit of length."""
    estimate, matched, _ = associate(run, truth)
    spreads = [np.linalg.norm(poses.p - poses.p.mean(axis=0)) for poses in (matched, estimate)]
    if align == "sim3" or not min(spreads) > 0:
        return
    for unit, factor in (("mm", 1000.0), ("cm", 100.0)):
        for ratio, file in ((spreads[0] / spreads[1], truth), (spreads[1] / spreads[0], run)):
            if 0.7 < ratio / factor < 1.4:
                note(f"{file.source}: its path is {ratio:.3g} times as large as the other; lengths are metres: a first line can say the unit: "
                     f"# timestamp, x [{unit}], y [{unit}], z [{unit}], qx, qy, qz, qw")


def _with_w_first(poses):
    """The poses as they are where x y z w of their file are w x y z."""
    moved = poses.select(slice(None))
    moved.q = poses.q[:, [1, 2, 3, 0]]
    return moved


def _off(summary):
    """Rotation error in the frames that the positions give [deg]."""
    return summary["rot_rmse_deg"] if summary["rot_by_positions_rmse_deg"] is None else summary["rot_by_positions_rmse_deg"]


def tell_order(run, truth, result):
    """A note where the quaternions of a file without names of columns fit the other's once they are read with w first."""
    off = _off(result.summary)
    if off < FAR_DEG:
        return
    for file, pair in ((truth, (run, _with_w_first(truth))), (run, (_with_w_first(run), truth))):
        rest = _off(compare(*pair, result.align).summary)
        if rest < NEAR * off:
            note(f"{file.source}: rotations are {off:.3g} degrees off, and {rest:.3g} where the quaternion's w is its first number; a first line can "
                 "say the order: # timestamp tx ty tz qw qx qy qz")
