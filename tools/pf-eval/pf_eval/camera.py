"""Calibration files and projection, for comparing with what was measured in the images."""

import re

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
    _refuse_changes(path, {name: value for name, value in fields.items() if str(name).startswith(prefix)}, {"Camera.imageScale", prefix + "k4"})
    if "LEFT.K" in fields or "Camera.model" in fields:
        raise Refused(f"{path}: {'LEFT.K' if 'LEFT.K' in fields else 'Camera.model'} says that Camera.fx may be of another kind; {OWN_CALIBRATION}")
    kind = fields.get("Camera.type", "PinHole")
    if kind not in ORB_SLAM_MODELS:
        raise Refused(f"{path}: Camera.type {kind} is none of {', '.join(ORB_SLAM_MODELS)}")
    model, names = ORB_SLAM_MODELS[kind]
    return Camera(model, int(fields["Camera.width"]), int(fields["Camera.height"]),
                  [float(fields[prefix + name]) for name in ("fx", "fy", "cx", "cy")],
                  [float(fields.get(prefix + name, 0.0)) for name in names])


# Words in names of fields that may change what others mean; pf-capture has the full list (platform/sequence/meaning.cpp).
CHANGING = re.compile(r"fisheye|omni|(^|_)xi$|mirror|skew|binning|(^|_)roi$|scale|rectified|unit|rotated|flip|crop|prism|tilt|(^|[_.])k[4-9]$")
OWN_CALIBRATION = "the calib.yaml that pf-capture writes into its --out has the camera that it took"


def _is_neutral(name, value):
    if isinstance(value, dict):
        return all(_is_neutral(name, inner) for inner in value.values())
    if isinstance(value, (list, tuple)):
        return all(_is_neutral(name, inner) for inner in value)
    return value in (None, 0, False, "", "none", "px") or (value == 1 and re.search("binning|scale", name) is not None)


def _refuse_changes(path, fields, read):
    """Fields that may change what others mean, other than those that are read."""
    for name, value in fields.items():
        if name == "camera_model" and value != "pinhole":
            raise Refused(f"{path}: camera_model {value} is not known, pinhole is; {OWN_CALIBRATION}")
        if name not in read and not str(name).startswith("depth_") and CHANGING.search(str(name)) and not _is_neutral(str(name), value):
            raise Refused(f"{path}: field {name} may change what others mean, and is not known here; {OWN_CALIBRATION}")


def _model_without_name(path, fields, distortion):
    """OpenCV's files say the model by a flag, or by the number of coefficients alone."""
    if not any(distortion or []):
        return "fisheye" if fields.get("fisheye_model") else "none"
    if fields.get("fisheye_model"):
        return "fisheye"
    if len(distortion) == 4 and "fisheye_model" not in fields:
        raise Refused(f"{path}: has four coefficients, and nothing says of which model; add distortion_model")
    return "radtan"


def _checked(path, model, distortion):
    """Coefficients of a model, of which those that the model does not have must be zero."""
    count = {"none": 0, "radtan": 5, "equidistant": 4, "division": 1}[model]
    if any(distortion[count:]):
        raise Refused(f"{path}: has coefficients behind the {count} that the model {model} has; {OWN_CALIBRATION}")
    return distortion[:count]


def read_camera(path):
    """The plain form, Kalibr's camchain of one camera (cam0), EuRoC's sensor.yaml, ROS camera_info, OpenCV, or settings of ORB-SLAM3 or
    ORB-SLAM."""
    fields = read_yaml(path)
    model_name = None
    try:
        for prefix in ("Camera1.", "Camera."):
            if prefix + "fx" in fields:
                return _orb_slam(path, fields, prefix)
        if "cam0" in fields:
            others = [name for name in fields if re.fullmatch(r"cam[1-9]\d*", str(name))]
            if others:
                raise Refused(f"{path}: has the cameras cam0, {', '.join(others)}; {OWN_CALIBRATION}")
            fields = fields["cam0"]
        _refuse_changes(path, fields, {"fisheye_model"} if "camera_matrix" in fields else ())
        if "fx" in fields:
            intrinsics = [fields[name] for name in ("fx", "fy", "cx", "cy")]
            size, distortion = (fields["width"], fields["height"]), fields.get("distortion")
        elif "camera_matrix" in fields:
            K = fields["camera_matrix"]["data"]
            if K[1] or K[3]:
                raise Refused(f"{path}: camera_matrix has skew, which is not known here")
            intrinsics = [K[0], K[4], K[2], K[5]]
            size, distortion = (fields["image_width"], fields["image_height"]), fields["distortion_coefficients"]["data"]
            model_name = fields.get("distortion_model") or _model_without_name(path, fields, distortion)
        elif "intrinsics" in fields:
            intrinsics, size = fields["intrinsics"], fields["resolution"]
            distortion = fields.get("distortion_coefficients", fields.get("distortion_coeffs"))
        else:
            raise Refused(f"{path}: is a calibration of no known layout; known are the plain form (fx), Kalibr's camchain (cam0), EuRoC's "
                          "sensor.yaml (intrinsics), ROS camera_info and OpenCV (camera_matrix), ORB-SLAM3 (Camera1.fx) and ORB-SLAM "
                          f"(Camera.fx); {OWN_CALIBRATION}")
        model = _model(path, model_name or fields.get("distortion_model"))
        return Camera(model, int(size[0]), int(size[1]), [float(value) for value in intrinsics],
                      _checked(path, model, [float(value) for value in distortion or []]))
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
