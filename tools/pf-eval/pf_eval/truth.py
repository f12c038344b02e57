"""Ground truth: which file, of which frame, and from the body to the camera."""

import pathlib

import numpy as np
from scipy.spatial.transform import Rotation

from . import Refused
from .files import read_yaml
from .trajectories import Trajectory, read_trajectory


def named_truth(report, folder):
    """The file that a run's report names, or truth.tum of a scene."""
    if (folder / "truth.tum").exists():
        return folder / "truth.tum"
    if not report:
        raise Refused(f"{folder}: no report.json was read that would name the truth; give it with --truth FILE")
    if not report.get("truth"):
        raise Refused(f"{folder}/report.json: names no truth; give it with --truth FILE")
    if not pathlib.Path(report["truth"]).exists():
        raise Refused(f"{report['truth']}: the truth that {folder}/report.json names is not there; give it with --truth FILE")
    return pathlib.Path(report["truth"])


def _matrix(path, fields, name):
    """A rigid 4x4 from EuRoC's {rows, cols, data} or from rows of rows."""
    value = fields[name]
    try:
        T = np.array(value["data"] if isinstance(value, dict) else value, dtype=float).reshape(4, 4)
    except (KeyError, TypeError, ValueError) as error:
        raise Refused(f"{path}: {name} is no 4x4 matrix") from error
    R = T[:3, :3]
    if not np.allclose(R @ R.T, np.eye(3), atol=1e-3) or not np.allclose(T[3], [0, 0, 0, 1]) or np.linalg.det(R) < 0:
        raise Refused(f"{path}: {name} is no rotation and translation")
    return T


def camera_on_body(path):
    """T_BC [4x4] of EuRoC's sensor.yaml (T_BS) or of Kalibr's camchain (cam0: T_cam_imu, which is T_CB)."""
    fields = read_yaml(path)
    if isinstance(fields.get("cam0"), dict):
        fields = fields["cam0"]
    if "T_BS" in fields:
        return _matrix(path, fields, "T_BS")
    if "T_cam_imu" in fields:
        return np.linalg.inv(_matrix(path, fields, "T_cam_imu"))
    raise Refused(f"{path}: has neither T_BS nor T_cam_imu, so nobody knows where the camera is on the body")


def to_camera(body, T_BC):
    """Poses T_WC of a trajectory of T_WB."""
    R_WB = Rotation.from_quat(body.q[:, [1, 2, 3, 0]])
    q = (R_WB * Rotation.from_matrix(T_BC[:3, :3])).as_quat()
    return Trajectory(body.t, body.p + R_WB.apply(T_BC[:3, 3]), q[:, [3, 0, 1, 2]], source=body.source)


def _sensor_beside(path):
    """The file that says where the camera is on the body: cam0/sensor.yaml of EuRoC's layout, or a camchain of its recording."""
    mav0 = path.parent.parent
    places = [mav0 / "cam0" / "sensor.yaml", mav0.parent / "dso" / "camchain.yaml", mav0.parent / "camchain.yaml"]
    return next((place for place in places if place.exists()), places[0])


def read_truth(path, calibration=None):
    """(poses of the camera, a phrase that says how they became that).

    calibration  the camera's sensor.yaml, for a body's truth; None: the one beside the truth's folder
    """
    path = pathlib.Path(path)
    truth = read_trajectory(path)
    if not truth.of_body:
        return truth, "camera, as the truth has it"
    sensor = pathlib.Path(calibration) if calibration else _sensor_beside(path)
    if not sensor.exists():
        raise Refused(f"{path}: holds poses of the body, and there is no {sensor} that says where the camera is on it; give it with --calib")
    T_BC = camera_on_body(sensor)
    own = path.parent / "sensor.yaml"  # the body's frame may be another than that of the poses
    if own.exists() and "T_BS" in read_yaml(own):
        T_BC = np.linalg.inv(_matrix(own, read_yaml(own), "T_BS")) @ T_BC
    return to_camera(truth, T_BC), f"camera, from the body's poses by T_BS of {sensor}"
