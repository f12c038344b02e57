"""The path of a hand-held camera: poses T_WC at any time, from a list of places and directions. z is up in W."""

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

STEP = 1e-3        # [s] between samples of the path
SMOOTHING = 0.15   # [s] of the Gaussian that rounds the corners of the path
LEAD = 1.0         # [s] before and after, so that neither end is smoothed away
SHAKE_SLOW, SHAKE_FAST = 0.25, 0.035  # [s] the hand's tremor lies between these two Gaussians
STEP_HZ = 1.9      # of a person who walks


class Path:
    """keys    rows of t, x, y, z, yaw, pitch [s, m, degrees]; yaw 0 looks along x, pitch above zero looks up
    shake_deg, shake_m   standard deviation of the hand's tremor
    bounce_m             amplitude of the steps of a walk at 1 m/s"""

    def __init__(self, keys, seed=1, shake_deg=0.4, shake_m=0.004, bounce_m=0.012):
        keys = np.asarray(keys, dtype=float)
        self.t = np.arange(keys[0, 0] - LEAD, keys[-1, 0] + LEAD, STEP)
        at = np.stack([np.interp(self.t, keys[:, 0], column) for column in keys[:, 1:].T], axis=1)
        at = gaussian_filter1d(at, SMOOTHING / STEP, axis=0, mode="nearest")
        tremor = np.random.default_rng(seed).standard_normal((len(self.t), 6))
        tremor = gaussian_filter1d(tremor, SHAKE_FAST / STEP, axis=0) - gaussian_filter1d(tremor, SHAKE_SLOW / STEP, axis=0)
        tremor /= tremor.std(axis=0)
        speed = gaussian_filter1d(np.linalg.norm(np.gradient(at[:, :2], STEP, axis=0), axis=1), 0.2 / STEP)
        self.p = at[:, :3] + shake_m * tremor[:, :3]
        self.p[:, 2] += bounce_m * speed * np.sin(2 * np.pi * STEP_HZ * self.t)
        self.angles = at[:, 3:5] + shake_deg * tremor[:, 3:5]
        self.roll = shake_deg * tremor[:, 5] + 0.7 * np.minimum(speed, 1.5) * np.sin(np.pi * STEP_HZ * self.t)

    def poses(self, times):
        """(positions [n, 3], rotations R_WC) of a camera whose x points right, y down and z forward."""
        times = np.asarray(times, dtype=float)
        p = np.stack([np.interp(times, self.t, column) for column in self.p.T], axis=1)
        yaw, pitch, roll = (np.interp(times, self.t, column) for column in (*self.angles.T, self.roll))
        level = Rotation.from_matrix([[0, 0, 1], [-1, 0, 0], [0, -1, 0]])
        turns = Rotation.from_euler("ZYX", np.stack([yaw, -pitch, roll], axis=1), degrees=True)
        return p, turns * level


def tum_rows(times, p, R_WC):
    """Lines of a trajectory: t x y z qx qy qz qw."""
    return "".join("%.9f %s\n" % (t, " ".join(f"{x:.9f}" for x in row)) for t, row in zip(times, np.hstack([p, R_WC.as_quat()])))
