"""Calibration files and projection, for comparing with what was measured in the images."""

import numpy as np

from . import Refused
from .files import read_yaml
from .tables import read_numbers


class Camera:
    """model: none, radtan, equidistant, division. K fx fy cx cy [px]; distortion as planefold.h orders it."""

    def __init__(self, model, width, height, intrinsics, distortion):
        self.model, self.width, self.height = model, width, height
        self.fx, self.fy, self.cx, self.cy = intrinsics
        self.distortion = np.zeros(8)
        self.distortion[:len(distortion)] = distortion

    def at(self, _):
        """The lens at a time [s]: always the same."""
        return self

    def project(self, p_C):
        """Pixels (n,2) of points in C (n,3); NaN where a point cannot be seen."""
        x, y, z = np.asarray(p_C, dtype=float).T
        with np.errstate(divide="ignore", invalid="ignore"):
            if self.model == "equidistant":
                r = np.hypot(x, y)
                theta = np.arctan2(r, z)
                k = self.distortion
                t2 = theta * theta
                bent = theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))))
                ratio = np.where(r > 1e-12, bent / np.maximum(r, 1e-300), 1 / z)
                a, b = ratio * x, ratio * y
            else:
                a, b = x / z, y / z
                if self.model == "radtan":
                    a, b = self._radtan(a, b)
            u, v = self.fx * a, self.fy * b
            if self.model == "division":
                shrink = 1 / np.sqrt(1 + 2 * self.distortion[0] * (u * u + v * v))
                u, v = shrink * u, shrink * v
        pixels = np.stack([u + self.cx, v + self.cy], axis=1)
        if self.model != "equidistant":
            pixels[z <= 0] = np.nan
        return pixels

    def _radtan(self, a, b):
        k1, k2, p1, p2, k3 = self.distortion[:5]
        r2 = a * a + b * b
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        return (a * radial + 2 * p1 * a * b + p2 * (r2 + 2 * a * a),
                b * radial + p1 * (r2 + 2 * b * b) + 2 * p2 * a * b)


MODELS = {"": "none", "none": "none", "radtan": "radtan", "plumb_bob": "radtan", "radial-tangential": "radtan",
          "equidistant": "equidistant", "fisheye": "equidistant", "harris_division": "division", "division": "division"}


def _model(path, name):
    try:
        return MODELS[str(name or "").lower()]
    except KeyError as error:
        raise Refused(f"{path}: distortion_model {name} is none of {', '.join(sorted(m for m in MODELS if m))}") from error


ORB_SLAM_MODELS = {"PinHole": ("radtan", ("k1", "k2", "p1", "p2", "k3")), "KannalaBrandt8": ("equidistant", ("k1", "k2", "k3", "k4")),
                   "Rectified": ("none", ())}


def _orb_slam(path, fields, prefix):
    """Settings of ORB-SLAM3 (prefix Camera1.) or ORB-SLAM (prefix Camera.)."""
    kind = fields.get("Camera.type", "PinHole")
    if kind not in ORB_SLAM_MODELS:
        raise Refused(f"{path}: Camera.type {kind} is none of {', '.join(ORB_SLAM_MODELS)}")
    model, names = ORB_SLAM_MODELS[kind]
    return Camera(model, int(fields["Camera.width"]), int(fields["Camera.height"]),
                  [float(fields[prefix + name]) for name in ("fx", "fy", "cx", "cy")],
                  [float(fields.get(prefix + name, 0.0)) for name in names])


def read_camera(path):
    """The plain form, Kalibr's camchain (cam0), EuRoC's sensor.yaml, ROS camera_info, or settings of ORB-SLAM3 or ORB-SLAM."""
    fields = read_yaml(path)
    try:
        for prefix in ("Camera1.", "Camera."):
            if prefix + "fx" in fields:
                return _orb_slam(path, fields, prefix)
        if "cam0" in fields:
            fields = fields["cam0"]
        if "fx" in fields:
            intrinsics = [fields[name] for name in ("fx", "fy", "cx", "cy")]
            size, distortion = (fields["width"], fields["height"]), fields.get("distortion")
        elif "camera_matrix" in fields:
            K = fields["camera_matrix"]["data"]
            intrinsics = [K[0], K[4], K[2], K[5]]
            size, distortion = (fields["image_width"], fields["image_height"]), fields["distortion_coefficients"]["data"]
        elif "intrinsics" in fields:
            intrinsics, size = fields["intrinsics"], fields["resolution"]
            distortion = fields.get("distortion_coefficients", fields.get("distortion_coeffs"))
        else:
            raise Refused(f"{path}: is a calibration of no known layout; known are the plain form (fx), Kalibr's camchain (cam0), EuRoC's "
                          "sensor.yaml (intrinsics), ROS camera_info (camera_matrix), ORB-SLAM3 (Camera1.fx) and ORB-SLAM (Camera.fx)")
        return Camera(_model(path, fields.get("distortion_model")), int(size[0]), int(size[1]),
                      [float(value) for value in intrinsics], [float(value) for value in distortion or []])
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise Refused(f"{path}: a field of the calibration is missing or wrong ({error})") from error


class EstimatedCamera:
    """The lens that a run estimated, over time: a pose belongs to the lens of its frame."""

    def __init__(self, last, rows):
        """last: the Camera at the end; rows of lens.csv: t, fx, fy, cx, cy, distortion."""
        self.width, self.height, self.rows = last.width, last.height, rows
        self.model = "radtan" if last.model == "none" else last.model  # a calibration without distortion gets a k1

    def at(self, t):
        row = self.rows[int(np.argmin(np.abs(self.rows[:, 0] - t)))]
        return Camera(self.model, self.width, self.height, row[1:5], row[5:])


def camera_of_run(report, folder, calibration):
    """The lens that a run has estimated, or that of the calibration file."""
    if (report.get("lens") or {}).get("estimate") != "estimate":
        return read_camera(calibration)
    return EstimatedCamera(read_camera(folder / "calib.yaml"), read_numbers(folder / "lens.csv", 10))
