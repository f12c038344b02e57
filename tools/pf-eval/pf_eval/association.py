"""Which true pose belongs to which frame."""

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from . import Refused
from .trajectories import Trajectory

TOLERANCE = 0.010  # [s]


def associate(run, truth, tolerance=TOLERANCE):
    """(run, truth, how), both of the same length. Frames without truth are left out.

    Where truth comes at least 1.5 times as often as the frames, and at most two tolerances apart, it is interpolated at each
    frame's time (position linearly, rotation on the shortest arc) if it has a pose within the tolerance on either side;
    otherwise the nearest pose within the tolerance is taken, and no true pose twice.
    """
    often = False
    if len(truth) > 2 and len(run) > 1:
        step = np.median(np.diff(truth.t))
        often = 1.5 * step <= np.median(np.diff(run.t)) and step <= 2 * tolerance
    after = np.searchsorted(truth.t, run.t)
    before = np.clip(after - 1, 0, len(truth) - 1)
    after = np.clip(after, 0, len(truth) - 1)
    if often:
        inside = ((run.t >= truth.t[before] - 1e-9) & (run.t <= truth.t[after] + 1e-9)
                  & (run.t - truth.t[before] <= tolerance) & (truth.t[after] - run.t <= tolerance))
        kept = np.flatnonzero(inside)
        matched = interpolate(truth, run.t[kept]) if len(kept) else None
        how = "interpolated"
    else:
        nearest = np.where(np.abs(truth.t[after] - run.t) < np.abs(truth.t[before] - run.t), after, before)
        gap = np.abs(truth.t[nearest] - run.t)
        best = {}
        for i in np.flatnonzero(gap <= tolerance):
            if nearest[i] not in best or gap[i] < gap[best[nearest[i]]]:
                best[nearest[i]] = i
        kept = np.array(sorted(best.values()), dtype=int)
        matched = truth.select(nearest[kept])
        how = "nearest"
    if len(kept) == 0:
        raise Refused(f"{truth.source}: has no pose within {1000 * tolerance:.0f} ms of any frame of {run.source} "
                      f"(truth {truth.t[0]:.3f} to {truth.t[-1]:.3f} s, run {run.t[0]:.3f} to {run.t[-1]:.3f} s)")
    return run.select(kept), matched, how


def interpolate(truth, t):
    """Truth at times within its own."""
    t = np.clip(t, truth.t[0], truth.t[-1])
    p = np.stack([np.interp(t, truth.t, truth.p[:, i]) for i in range(3)], axis=1)
    q = Slerp(truth.t, Rotation.from_quat(truth.q[:, [1, 2, 3, 0]]))(t).as_quat()
    return Trajectory(t, p, q[:, [3, 0, 1, 2]], source=truth.source)
