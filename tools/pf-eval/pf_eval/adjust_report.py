"""tools/adjust-run: the command."""

import sys

import numpy as np
from scipy.spatial.transform import Rotation

from . import Refused
from .adjust_run import adjust, make_problem, residuals
from .camera import camera_of_run, read_camera
from .errors import compare
from .files import read_run, read_table
from .output_folder import is_foreign, write
from .trajectories import Trajectory, read_trajectory

MARK = "# T_WC of all tracked frames, adjusted together"


def w_first(R):
    """Quaternions as Trajectory has them, of matrices (n,3,3)."""
    return Rotation.from_matrix(R).as_quat()[:, [3, 0, 1, 2]]


def tum(trajectory):
    rows = (" ".join([f"{t:.9f}", *(f"{v:.9g}" for v in (*p, *q[1:], q[0]))]) for t, p, q in zip(trajectory.t, trajectory.p, trajectory.q))
    return f"{MARK}: timestamp tx ty tz qx qy qz qw\n" + "".join(row + "\n" for row in rows)


def show(text):
    if sys.stderr.isatty():
        print(f"\r{text}   ", end="", file=sys.stderr, flush=True)


def line(label, text):
    print(f"  {label:34s} {text}")


def run(options):
    if options.out and is_foreign(options.out, MARK):  # known before the work and not after it
        raise Refused(f"{options.out}: is there and was not written by adjust-run; name another file")
    trajectory, report, folder = read_run(options.run)
    tracks = folder / "tracks.csv"
    if not tracks.exists():
        raise Refused(f"{folder}: has no tracks.csv; make the run with pf-capture --tracks")
    truth = read_trajectory(options.truth) if options.truth else None
    calibration = options.calib or folder / "calib.yaml"
    camera = read_camera(calibration) if options.calib else camera_of_run(report, folder, calibration).at(trajectory.t[-1])
    problem = make_problem(trajectory, dict(enumerate(read_table(folder / "frames.csv")["t_s"])), read_table(tracks), camera)
    adjusted, lens = adjust(problem, camera, not options.exact_lens, options.rounds, show)
    if sys.stderr.isatty():
        print(file=sys.stderr)
    told = problem.told()
    poses = Trajectory(trajectory.t[told], adjusted.p[told], w_first(adjusted.R[told]), source="adjusted poses")
    trajectory = trajectory.select(told)
    if options.out:
        write(options.out, tum(poses), MARK, "adjust-run")

    before, after = (np.nanmedian(np.linalg.norm(residuals(p, c), axis=1)) for p, c in ((problem, camera), (adjusted, lens)))
    print(f"{options.run}: {len(told)} tracked frames, {len(told) - told.sum()} of them left out for too few pixels, "
          f"{len(problem.X)} points, {len(problem.z)} pixels")
    line("pixels from where they should be", f"{before:.3f} px in the run, {after:.3f} px adjusted (medians)")
    if not options.exact_lens:
        line("focal length and k1", f"{camera.fx:.2f} px, {camera.distortion[0]:.4g} in the run; {lens.fx:.2f} px, {lens.distortion[0]:.4g} adjusted")
    unit = "m" if truth is not None else "units of the run"
    if truth is not None:
        ours, best = compare(trajectory, truth, "sim3"), compare(poses, truth, "sim3")
        line("from the truth, after Sim(3)", f"{ours.summary['ate_rmse_m']:.4g} m RMS of the run, {best.summary['ate_rmse_m']:.4g} m adjusted")
        poses = Trajectory(best.t, best.estimate, w_first(best.rotations), source="adjusted poses")
    off = compare(trajectory, poses, "sim3")
    line("run from adjusted, after Sim(3)", f"{off.summary['ate_rmse_m']:.4g} {unit} RMS, {off.summary['ate_max_m']:.4g} at most")


def main(options):
    try:
        run(options)
    except Refused as refused:
        print(f"adjust-run: {refused}", file=sys.stderr)
        return 1
    return 0
