"""For tests of the Python package: go on inside the environment of pf-eval, with the package that this build made, or be skipped."""

import sys

import script
import venv

PACKAGE = script.BUILD / "python"


def enter():
    """The module planefold."""
    if not list((PACKAGE / "planefold").glob("_core*.so")):
        script.skip("this build has no Python package: it needs nanobind in build/venv, and no sanitizer and no cross compiler")
    venv.enter()
    sys.path.insert(0, str(PACKAGE))
    import planefold
    return planefold


def track(planefold, frames, count=None, target=None):
    """(slam, poses of the tracked frames), as pf-capture runs and counts them."""
    config = planefold.Config(camera=frames.camera)
    if config.camera.sigma_focal > 1e-4:  # the calibration is of files, which pf-capture then improves
        config.camera.estimate = planefold.CameraEstimate.ESTIMATE
    slam = planefold.Slam(config)
    if target is not None:
        slam.start_from_target(target)
    poses = []
    for number, (image, t_ns) in enumerate(frames):
        if number == count:
            break
        status = slam.push_frame(image, t_ns)
        report = slam.report
        if status == planefold.Status.OK or (report.state == planefold.State.STARTING and report.inliers >= 8):
            poses.append(slam.pose)
    return slam, poses


def tum(pose):
    """A line as trajectory.txt of pf-capture has it."""
    w, x, y, z = pose.q_WC
    numbers = " ".join(f"{value:.9g}" for value in (*pose.p_WC, x, y, z, w))
    return f"{pose.t_ns // 10**9}.{pose.t_ns % 10**9:09d} {numbers}"


def covariance(pose):
    """A line as covariance.csv of pf-capture has it."""
    return f"{pose.t_ns // 10**9}.{pose.t_ns % 10**9:09d}," + ",".join(f"{value:.9g}" for value in pose.covariance.ravel())


def desk(planefold):
    """A configuration for the scene sim:desk."""
    return planefold.Config(camera=planefold.Sim("desk").camera)
