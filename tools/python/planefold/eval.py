"""Trajectories against ground truth, as pf-eval compares them (by evo). Needs the extra [eval].

    comparison = planefold.eval.compare(poses, "truth.tum", align="sim3")
    comparison.summary["ate_rmse_m"]
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any, Protocol, Union, cast

import numpy as np
import numpy.typing as npt

from ._core import Pose
from ._errors import Refused
from ._extras import load

Floats = npt.NDArray[np.float64]
Run = Union[str, "os.PathLike[str]", Iterable[Pose]]

__all__ = ["Comparison", "Run", "compare"]


class Comparison(Protocol):
    """A run beside its truth, frame by frame, after alignment.

    t [s]; estimate, truth  (n,3) positions [m]; rotations (n,3,3) of the estimate
    position_error (n,3) truth - estimate [m]; rotation_error (n,3) theta of R_true = Exp(theta) R_est [rad]
    covariance     (n,6,6), or None after an alignment
    scale, turn, shift  the alignment: p_truth = scale turn p_run + shift
    summary        what pf-eval prints: ate_rmse_m, rpe_rmse_m, rot_rmse_deg, pairs, scale, nees_pose, ...
    """

    t: Floats
    estimate: Floats
    truth: Floats
    rotations: Floats
    position_error: Floats
    rotation_error: Floats
    covariance: Floats | None
    scale: float
    turn: Floats
    shift: Floats
    align: str
    summary: dict[str, Any]


def _trajectory(poses: Iterable[Pose], source: str) -> Any:
    """Poses as pf-eval has them, with their covariance where there is one."""
    found = list(poses)
    if not found:
        raise Refused(f"{source}: there are no poses")
    covariance = np.array([pose.covariance for pose in found])
    return load(".pf_eval.trajectories", "eval").Trajectory(
        np.array([1e-9 * pose.t_ns for pose in found]), np.array([pose.p_WC for pose in found]),
        np.array([pose.q_WC for pose in found]), covariance if covariance.any() else None, source)


def compare(run: Run, truth: Run, align: str | None = None, calibration: str | os.PathLike[str] | None = None) -> Comparison:
    """Errors of a run against truth.

    run          poses of tracked frames, or a file in the TUM form, or an output folder of pf-capture
    truth        poses, or a file: TUM, or EuRoC's data.csv of the body
    align        "none", "se3" or "sim3"; without, what the run's report suggests, and "sim3" where there is none
    calibration  the camera's sensor.yaml, where the truth is of the body and it does not lie beside it
    """
    errors, files = load(".pf_eval.errors", "eval"), load(".pf_eval.files", "eval")
    refused = load(".pf_eval", "eval").Refused
    if align not in (None, "none", "se3", "sim3"):
        raise Refused(f"align: {align} is none of none, se3, sim3")
    report: dict[str, Any] = {}
    try:
        if isinstance(run, (str, os.PathLike)):
            estimate, report, _ = files.read_run(run)
        else:
            estimate = _trajectory(run, "run")
        if isinstance(truth, (str, os.PathLike)):
            true = load(".pf_eval.truth", "eval").read_truth(truth, calibration)[0]
        else:
            true = _trajectory(truth, "truth")
        estimate, true = load(".pf_eval.trajectories", "eval").on_one_clock(estimate, true)
        how = align or errors.default_alignment(report)
        return cast(Comparison, errors.compare(estimate, true, how, own_frame=report.get("start") != "auto"))
    except refused as line:
        raise Refused(str(line)) from None
