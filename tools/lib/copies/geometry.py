"""Copies whose pixels are elsewhere: pictures, the calibration that belongs to them, and what becomes of the truth.

A camera that is mirrored left to right sees the world mirrored at x = 0 of W: p -> (-x, y, z), q (w, x, y, z) -> (w, x, -y, -z). One that
is turned about its axis by half a turn has R_WC Rz(180) in place of R_WC. Images that are made smaller by means of 2 x 2 pixels have
c' = (c + 1/2) / 2 - 1/2."""

import numpy as np


def mirrored(image):
    return image[:, ::-1]


def turned(image):
    return image[::-1, ::-1]


def half_size(image):
    height, width = image.shape[0] // 2 * 2, image.shape[1] // 2 * 2
    blocks = image[:height, :width].astype(np.uint16).reshape(height // 2, 2, width // 2, 2)
    return ((blocks.sum((1, 3)) + 2) // 4).astype(np.uint8)


def tangential(camera, signs):
    """p1 and p2 of a radial-tangential lens, with other signs."""
    values = list(camera.get("distortion") or [])
    if camera.get("distortion_model") in ("radtan", "plumb_bob") and len(values) >= 4:
        values[2:4] = [sign * value for sign, value in zip(signs, values[2:4])]
        camera["distortion"] = values


def camera_mirrored(camera):
    camera["cx"] = camera["width"] - 1 - camera["cx"]
    tangential(camera, (1, -1))


def camera_turned(camera):
    camera["cx"], camera["cy"] = camera["width"] - 1 - camera["cx"], camera["height"] - 1 - camera["cy"]
    tangential(camera, (-1, -1))


def camera_half_size(camera):
    for name in ("fx", "fy"):
        camera[name] /= 2
    for name in ("cx", "cy"):
        camera[name] = (camera[name] + 0.5) / 2 - 0.5
    for name in ("width", "height"):
        camera[name] //= 2
    if camera.get("distortion_model") == "harris_division":
        camera["distortion"] = [4 * value for value in camera["distortion"]]  # [1/px^2]


def crop(left, top, right, bottom):
    """Shares of the width and height that are cut away."""
    def box(width, height):
        return round(left * width), round(top * height), width - round(right * width), height - round(bottom * height)

    def image_of(image):
        x0, y0, x1, y1 = box(image.shape[1], image.shape[0])
        return image[y0:y1, x0:x1]

    def camera_of(camera):
        x0, y0, x1, y1 = box(camera["width"], camera["height"])
        camera.update(cx=camera["cx"] - x0, cy=camera["cy"] - y0, width=x1 - x0, height=y1 - y0)

    return image_of, camera_of


def truth_mirrored(row):
    t, x, y, z, qx, qy, qz, qw = row
    return [t, -x, y, z, qx, -qy, -qz, qw]


def truth_turned(row):
    t, x, y, z, qx, qy, qz, qw = row
    return [t, x, y, z, qy, -qx, qw, -qz]


PLACES = {
    "mirrored": (mirrored, camera_mirrored, truth_mirrored),
    "turned": (turned, camera_turned, truth_turned),
    "half-size": (half_size, camera_half_size, None),
    "crop-around": (*crop(0.075, 0.075, 0.075, 0.075), None),
    "crop-above": (*crop(0, 0.15, 0, 0), None),
}
