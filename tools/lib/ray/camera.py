"""The camera of a rendered sequence: its numbers, the rays of strips of rows for POV-Ray, and the warp from strips to rows."""

import dataclasses
import math

import numpy as np
from scipy.ndimage import map_coordinates

MARGIN = 6  # [px] around a strip, for the rotation within it


@dataclasses.dataclass
class Camera:
    width: int = 320
    height: int = 240
    fov_deg: float = 70.0     # of the width
    rate_hz: float = 30.0
    exposure_s: float = 0.008
    readout_s: float = 0.0

    @property
    def focal(self):
        return self.width / 2 / math.tan(math.radians(self.fov_deg) / 2)

    @property
    def centre(self):
        return (self.width - 1) / 2, (self.height - 1) / 2

    def yaml(self, comment):
        cx, cy = self.centre
        text = f"comment: \"{comment}\"\ncamera_model: pinhole\nwidth: {self.width}\nheight: {self.height}\n"
        text += f"fx: {self.focal:.9g}\nfy: {self.focal:.9g}\ncx: {cx:.9g}\ncy: {cy:.9g}\ndistortion_model: none\ndistortion: []\n"
        text += f"rate_hz: {self.rate_hz:.9g}\n"
        return text + (f"readout_s: {self.readout_s:.9g}\n" if self.readout_s > 0 else "")

    def row_delay(self, row):
        """Of a row, from the middle of the frame [s]."""
        return self.readout_s * ((row + 0.5) / self.height - 0.5)

    def strips(self, count):
        """[(first row, rows)] of the parts that are rendered from one pose each."""
        edges = np.linspace(0, self.height, count + 1).round().astype(int)
        return [(int(a), int(b - a)) for a, b in zip(edges, edges[1:])]


def pov_vectors(camera, R_WC, first, rows, margin, shift):
    """direction, right and up of a POV-Ray camera for the rows from first on, with a margin on each side, moved by shift [px]."""
    R = R_WC.as_matrix()
    cx, cy = camera.centre
    u, v = (camera.width - 1) / 2 - cx + shift[0], first + (rows - 1) / 2 - cy + shift[1]
    direction = R[:, 2] + R[:, 0] * u / camera.focal + R[:, 1] * v / camera.focal
    return direction, R[:, 0] * (camera.width + 2 * margin) / camera.focal, -R[:, 1] * (rows + 2 * margin) / camera.focal


def rows_of_strip(camera, light, first, rows, R_strip, R_rows):
    """The rows of a strip as each one sees them from its own rotation R_rows; light has MARGIN pixels more on each side."""
    cx, cy = camera.centre
    u, v = np.meshgrid(np.arange(camera.width), np.arange(first, first + rows))
    rays = np.stack([(u - cx) / camera.focal, (v - cy) / camera.focal, np.ones_like(u, dtype=float)], axis=-1)
    back = np.einsum("rij,ruj->rui", (R_strip.inv() * R_rows).as_matrix(), rays)
    x = camera.focal * back[..., 0] / back[..., 2] + cx + MARGIN
    y = camera.focal * back[..., 1] / back[..., 2] + cy - first + MARGIN
    return map_coordinates(light, [y, x], order=3, mode="nearest")
