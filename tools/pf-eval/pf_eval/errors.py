"""Trajectory errors after alignment, by evo, and the consistency of the covariance."""

import copy

import numpy as np
from evo.core import metrics
from evo.core.geometry import GeometryException
from evo.core.trajectory import PoseTrajectory3D
from evo.core.units import Unit
from scipy.spatial.transform import Rotation

from . import Refused
from .association import associate


class Comparison:
    """A run beside its truth, frame by frame.

    t [s]; estimate, truth  (n,3) positions after alignment [m]; position_error (n,3) truth - estimate, in W [m]
    rotation_error (n,3) theta of R_true = Exp(theta) R_est, in W [rad]; covariance (n,6,6) or None after alignment
    rotations      (n,3,3) of the estimate, after alignment
    scale, turn, shift  the alignment: p_truth = scale turn p_run + shift
    own_turn, own_shift  likewise, with the turn that fits the rotations best: the better one for directions
    summary        what pf-eval prints
    """


def nees(error, covariance):
    """e^T P^-1 e for rows of errors; NaN where P is not positive definite."""
    result = np.full(len(error), np.nan)
    for i, (e, P) in enumerate(zip(error, covariance)):
        try:
            y = np.linalg.solve(np.linalg.cholesky(0.5 * (P + P.T)), e)
            result[i] = y @ y
        except np.linalg.LinAlgError:
            pass
    return result


def default_alignment(report):
    """Runs from a known target or pose are in the frame of that target; others choose their own frame, and their own scale too unless an
    inertial unit has told it."""
    start = str(report.get("start", ""))
    if start.startswith(("target", "rectangle", "points", "pose")):
        return "none"
    return "se3" if (report.get("imu") or {}).get("metric") else "sim3"


def is_degenerate(p, position_error):
    """The path is so straight that its second axis drowns in the errors: the rotation about the first is then not known."""
    across = np.linalg.svd(p - p.mean(axis=0), compute_uv=False)[1] / np.sqrt(len(p))
    return bool(across < 5 * np.sqrt(np.mean(np.sum(position_error ** 2, axis=1))))


def _evo(trajectory):
    return PoseTrajectory3D(positions_xyz=trajectory.p.copy(), orientations_quat_wxyz=trajectory.q.copy(),
                            timestamps=trajectory.t.copy())


def _statistic(metric, pair, name="rmse"):
    metric.process_data(pair)
    return float(metric.get_statistic(metrics.StatisticsType[name]))


def _rpe(pair, delta):
    """RMSE of the relative translation over delta frames, from every frame [m]; None for too short a run."""
    if pair[0].num_poses <= delta:
        return None
    return _statistic(metrics.RPE(metrics.PoseRelation.translation_part, delta, Unit.frames, all_pairs=True), pair)


def compare(run, truth, align, own_frame=True):
    """Comparison of a run with truth. align: none, se3, sim3. own_frame false: nobody told the run the truth's frame."""
    estimate, matched, how = associate(run, truth)
    reference, aligned = _evo(matched), _evo(estimate)
    turn, shift, scale = np.eye(3), np.zeros(3), 1.0
    if align != "none":
        if len(estimate) < 3:
            raise Refused(f"{run.source}: has {len(estimate)} frames with truth; alignment needs at least 3")
        try:
            turn, shift, scale = aligned.align(reference, correct_scale=align == "sim3")[:3]
        except GeometryException as error:
            raise Refused(f"{run.source}: cannot be aligned, its positions or the true ones do not spread "
                          "(standing still, or on a straight line)") from error
    pair = (reference, aligned)
    rotation = metrics.APE(metrics.PoseRelation.rotation_angle_deg)

    result = Comparison()
    result.scale, result.turn, result.shift = float(scale), turn, shift
    result.t, result.estimate, result.truth = estimate.t, aligned.positions_xyz, matched.p
    result.rotations = np.array([pose[:3, :3] for pose in aligned.poses_se3])
    result.position_error = matched.p - aligned.positions_xyz
    off = Rotation.from_matrix(np.einsum("nij,nkj->nik", matched.rotations(), result.rotations))
    # Where the run chose its own frame, the rotation between the frames is the one that fits the rotations best: what the positions
    # give is not defined about a straight path.
    own = off if align == "none" else off * off.mean().inv()
    result.rotation_error = own.as_rotvec()
    result.covariance = estimate.covariance if align == "none" else None
    result.align = align

    rate = 1.0 / np.median(np.diff(estimate.t)) if len(estimate) > 1 else 0.0
    if align != "none":
        result.own_turn = off.mean().as_matrix() @ turn
        result.own_shift = (matched.p - result.scale * estimate.p @ result.own_turn.T).mean(axis=0)
    else:
        result.own_turn, result.own_shift = turn, shift
    result.summary = {
        "ate_rmse_m": _statistic(metrics.APE(metrics.PoseRelation.translation_part), pair),
        "ate_max_m": _statistic(metrics.APE(metrics.PoseRelation.translation_part), pair, "max"),
        "rpe_rmse_m": _rpe(pair, 1),
        "rpe_1s_rmse_m": _rpe(copy.deepcopy(pair), max(1, round(rate))),
        "rot_rmse_deg": float(np.degrees(np.sqrt(np.mean(own.magnitude() ** 2)))),
        "rot_max_deg": float(np.degrees(own.magnitude().max())),
        "rot_by_positions_rmse_deg": None if align == "none" else _statistic(rotation, pair),
        "alignment_degenerate": None if align == "none" else is_degenerate(matched.p, result.position_error),
        "pairs": len(estimate),
        "poses": len(run),
        "scale": result.scale,
        "path_m": matched.path(),
        "align": align,
        "association": how,
        "nees_position": None, "nees_pose": None, "nees_frames": 0,
        "nees_position_median": None, "nees_pose_median": None,
    }
    result.nees_position = result.nees_pose = None
    if align == "none" and own_frame and estimate.covariance is not None:
        result.nees_position = nees(result.position_error, estimate.covariance[:, 3:, 3:])
        result.nees_pose = nees(np.hstack([result.rotation_error, result.position_error]), estimate.covariance)
        used = np.isfinite(result.nees_pose)
        if used.any():
            result.summary.update(
                nees_position=float(np.mean(result.nees_position[used])), nees_pose=float(np.mean(result.nees_pose[used])),
                nees_position_median=float(np.median(result.nees_position[used])),
                nees_pose_median=float(np.median(result.nees_pose[used])), nees_frames=int(used.sum()))
    return result
