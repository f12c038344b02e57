"""Plots of a run as plot-run draws them. Needs the extra [eval].

    planefold.plot.trajectory("trajectory.png", poses, slam.features, planes=slam.planes)
    planefold.plot.errors("errors.png", planefold.eval.compare(poses, truth))
"""

from __future__ import annotations

import os
import pathlib
from collections.abc import Iterable
from typing import Any

import numpy as np

from ._core import Feature, FeatureKind, Orientation, Plane, Pose
from ._errors import Refused
from ._extras import load
from .eval import Comparison, _trajectory

__all__ = ["errors", "trajectory"]


def _points(features: Iterable[Feature]) -> tuple[Any, ...]:
    """Of the map: positions, sigmas, which have no depth yet, which belong to the target."""
    found = list(features)
    p = np.array([feature.p_W for feature in found]).reshape(-1, 3)
    sigma = np.array([np.sqrt(max(0.0, float(np.trace(feature.covariance)) / 3)) for feature in found])
    loose = np.array([feature.kind == FeatureKind.INVERSE_DEPTH for feature in found], dtype=bool)
    target = np.array([feature.is_target != 0 for feature in found], dtype=bool)
    return p, sigma, loose, target, False


_COLOURS = {Orientation.VERTICAL: "#856bff", Orientation.HORIZONTAL_UP: "#e69900", Orientation.HORIZONTAL_DOWN: "#57b5e8",
            Orientation.OTHER: "#f7ed73", Orientation.UNKNOWN: "#9e9e9e"}


def _outlines(planes: Iterable[Plane]) -> list[tuple[Any, str]]:
    """Of each plane its corners in W, and the colour of its class."""
    outlines = []
    for plane in planes:
        corners = np.asarray(plane.outline_P)[:plane.outline_count]
        if len(corners) >= 3:
            R, p = np.asarray(plane.R_WP).reshape(3, 3), np.asarray(plane.p_WP)
            outlines.append((p + corners @ R[:, :2].T, _COLOURS.get(Orientation(plane.orientation), "#9e9e9e")))
    return outlines


def trajectory(path: str | os.PathLike[str], poses: Iterable[Pose], features: Iterable[Feature] = (), *,
               planes: Iterable[Plane] = (), comparison: Comparison | None = None, unit: str = "m", title: str = "") -> pathlib.Path:
    """The way of the camera and the map with its planes, from above and from the side, as a picture; the file's ending says which kind.

    comparison  draws the truth beside it, and everything in its frame
    """
    run = _trajectory(poses, "poses")
    p, rotations = run.p, run.rotations()
    covariance = None if run.covariance is None else run.covariance[:, 3:, 3:]
    points, sigma, loose, target, in_map = _points(features)
    outlines = _outlines(planes)
    truth = None
    if comparison is not None:
        scale, turn = comparison.scale, comparison.turn
        p, points, sigma = scale * p @ turn.T + comparison.shift, scale * points @ turn.T + comparison.shift, scale * sigma
        outlines = [(scale * corners @ turn.T + comparison.shift, colour) for corners, colour in outlines]
        rotations = turn @ rotations
        covariance = None if covariance is None else scale * scale * turn @ covariance @ turn.T
        truth = comparison.truth
    draw = load(".pf_eval.plot_trajectory", "eval").draw
    return _written(path, draw, p, rotations, covariance, truth, (points, sigma, loose, target, in_map), unit, title, outlines)


def errors(path: str | os.PathLike[str], comparison: Comparison, title: str = "") -> pathlib.Path:
    """Errors against truth over time, with 3-sigma bounds where the run is in the truth's own frame."""
    return _written(path, load(".pf_eval.plot_errors", "eval").draw, comparison, comparison.t[0], title)


def _written(path: str | os.PathLike[str], draw: Any, *what: Any) -> pathlib.Path:
    try:
        draw(pathlib.Path(path), *what)
    except (OSError, ValueError) as error:
        raise Refused(f"{os.fspath(path)}: cannot be drawn ({error})") from error
    return pathlib.Path(path)
