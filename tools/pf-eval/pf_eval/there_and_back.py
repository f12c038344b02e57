"""A run that went through a sequence and back again: each image has two poses, which should be one. No truth is needed."""

import numpy as np
from scipy.spatial.transform import Rotation

from . import Refused
from .files import read_table

TOLERANCE = 1e-4  # [s]


def forward(run, report):
    """The poses of the way there. On the way back times are mirrored, and truth that goes on in time does not belong to them."""
    turn = report.get("there_and_back")
    return run.select(run.t <= turn["turn_s"] + TOLERANCE) if turn else run


def compare_passes(run, report, folder):
    """What pf-eval prints of a run of pf-capture --there-and-back.

    Frames come back in mirrored time: the image of time t is seen again at 2 turn - t. Only pairs of poses that both come from
    the state tracking count; the poses of a start without a target have no scale yet. The distance of the two is given as a
    share of the extent, the largest distance between two places of the way there, so that the unknown scale cancels.
    """
    turn = report.get("there_and_back")
    if not isinstance(turn, dict) or not isinstance(turn.get("turn_s"), (int, float)):
        raise Refused(f"{folder}: report.json names no time of turning back; run pf-capture with --there-and-back")
    frames = read_table(folder / "frames.csv")
    tracking = frames["t_s"][frames["state"] == "tracking"]
    if len(tracking) > 0:
        near = np.clip(np.searchsorted(tracking, run.t - TOLERANCE), 0, len(tracking) - 1)
        run = run.select(np.abs(tracking[near] - run.t) <= TOLERANCE)
    if len(tracking) == 0 or len(run) == 0:
        raise Refused(f"{folder}: no frame was tracked")
    there = run.select(run.t < turn["turn_s"] - TOLERANCE)
    mirrored = 2.0 * turn["turn_s"] - there.t
    back = np.clip(np.searchsorted(run.t, mirrored - TOLERANCE), 0, len(run) - 1)
    paired = np.abs(run.t[back] - mirrored) <= TOLERANCE
    if paired.sum() < 2:
        raise Refused(f"{folder}: fewer than two images were tracked both there and back")
    first, second = there.select(paired), run.select(back[paired])
    way = forward(run, report).p
    extent = max(np.linalg.norm(way - p, axis=1).max() for p in way)
    if not extent > 0.0:
        raise Refused(f"{folder}: the camera did not move")
    distance = np.linalg.norm(first.p - second.p, axis=1) / extent
    turned = Rotation.from_matrix(np.einsum("nij,nkj->nik", first.rotations(), second.rotations())).magnitude()
    return {
        "back_distance_median": float(np.median(distance)), "back_distance_max": float(distance.max()),
        "back_rotation_median_deg": float(np.degrees(np.median(turned))),
        "back_rotation_max_deg": float(np.degrees(turned.max())),
        "pairs": int(paired.sum()), "images": int(turn["images"]),
    }
