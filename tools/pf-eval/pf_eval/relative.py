"""The motions of a run of pf-capture --relative against the truth: how honest their covariance is over a short time."""

import numpy as np
from scipy.spatial.transform import Rotation

from . import Refused
from .association import TOLERANCE, interpolate
from .files import read_table


def truth_at(truth, t):
    """(R_WC, p_WC, found) of the truth at times: interpolated between two poses within the tolerance, or the nearest within it."""
    after = np.clip(np.searchsorted(truth.t, t), 1, len(truth) - 1)
    gap = np.stack([np.abs(t - truth.t[after - 1]), np.abs(truth.t[after] - t)])
    between = (gap <= TOLERANCE).all(axis=0) & (truth.t[after - 1] <= t) & (t <= truth.t[after])
    nearest = truth.select(np.where(gap[0] < gap[1], after - 1, after))
    R, p = nearest.rotations(), nearest.p.copy()
    if between.any():
        smooth = interpolate(truth, t[between])
        R[between], p[between] = smooth.rotations(), smooth.p
    return R, p, (gap <= TOLERANCE).any(axis=0)


def compare_motions(folder, report, truth, align):
    """What pf-eval prints of relative.csv.

    A motion is the camera's pose in the frame K of the camera before, with errors (theta, e) in K: R_true = Exp(theta) R, and
    p_true = p + e, so nothing but the unit of length has to be aligned. With s lengths of the run to a true one, whitened
    by the covariance C = L L^T,

        e = a + s b,   a = (theta, -p),   b = (0, p_true),   y = L^-1 e

    s = 1 where the unit is known; otherwise the s that makes |y|^2 least, for each motion alone or for all of a map. Where the
    truth stands still there is no scale to be fitted.
    """
    path = folder / "relative.csv"
    if not path.exists():
        raise Refused(f"{path}: there is no such file; run pf-capture with --relative 30")
    table = read_table(path)
    turn = report.get("there_and_back")
    known = table["t_s"] <= turn["turn_s"] + 1e-4 if turn else np.ones(len(table["t_s"]), dtype=bool)
    R_WK, p_WK, at_mark = truth_at(truth, table["mark_t_s"])
    R_WC, p_WC, at_end = truth_at(truth, table["t_s"])
    free = align == "sim3"
    sums = {}  # of each map: |a|^2, a.b, |b|^2
    per_dof, rotations, dof = [], [], []
    for i in np.flatnonzero(known & at_mark & at_end):
        R_KC = Rotation.from_quat([table[name][i] for name in ("qx", "qy", "qz", "qw")]).as_matrix()
        p_KC = np.array([table[name][i] for name in ("px", "py", "pz")])
        C = np.array([[table[f"c{row}{column}"][i] for column in range(6)] for row in range(6)])
        theta = Rotation.from_matrix(R_WK[i].T @ R_WC[i] @ R_KC.T).as_rotvec()
        try:
            L = np.linalg.cholesky(0.5 * (C + C.T))
        except np.linalg.LinAlgError:
            continue
        a = np.linalg.solve(L, np.concatenate([theta, -p_KC]))
        b = np.linalg.solve(L, np.concatenate([np.zeros(3), R_WK[i].T @ (p_WC[i] - p_WK[i])]))
        part = sums.setdefault(table["map"][i], np.zeros(3))
        part += [a @ a, a @ b, b @ b]
        moved = free and b @ b > 0
        s = -(a @ b) / (b @ b) if moved else 1.0
        dof.append(5 if moved else 6)
        per_dof.append(float((a + s * b) @ (a + s * b)))
        rotations.append(float(a[:3] @ a[:3]))  # L is lower triangular: the first rows are those of theta alone
    if not per_dof:
        raise Refused(f"{path}: no motion begins and ends where {truth.source} has a pose")
    one_scale = None
    if free:
        one_scale = sum(aa - (ab * ab / bb if bb > 0 else 0) for aa, ab, bb in sums.values()) / (6 * len(per_dof) - len(sums))
    return {
        "motion_nees_per_dof": sum(per_dof) / sum(dof),
        "motion_nees_per_dof_median": float(np.median(np.array(per_dof) / dof)),
        "motion_rotation_nees_per_dof": sum(rotations) / (3 * len(rotations)),
        "motion_nees_per_dof_one_scale": one_scale,
        "motion_scales": {str(int(number)): float(-ab / bb) for number, (_, ab, bb) in sums.items() if bb > 0} if free else None,
        "motions": len(per_dof), "motions_without_truth": int(len(known) - len(per_dof)), "align": "sim3" if free else "none",
    }
