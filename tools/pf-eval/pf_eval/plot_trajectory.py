"""Trajectory, map and planes from above and from the side."""

import re

import numpy as np
from matplotlib.collections import EllipseCollection, LineCollection, PolyCollection
from matplotlib.colors import to_hex, to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from . import style
from .tables import read_text

AXES = "xyz"


def read_map(path):
    """(p (n,3), sigma (n), inverse_depth (n) bool, target (n) bool, in_map) of the points in a map.ply, without the corners of
    its faces, which are planes; empty where there is none. in_map: sigma is without what the whole map shares."""
    if not path.exists():
        return np.zeros((0, 3)), np.zeros(0), np.zeros(0, bool), np.zeros(0, bool), False
    head, _, body = read_text(path).partition("end_header\n")
    of_vertices = head.partition("element vertex ")[2].partition("element ")[0]
    count = int(of_vertices.split()[0])
    names = re.findall(r"^property \S+ (\S+)$", of_vertices, re.M)
    lines = [line.split() for line in body.splitlines() if line.strip()]
    corners = {int(word) for face in lines[count:] for word in face[1:1 + int(face[0])]}
    points = [[float(word) for word in line] for k, line in enumerate(lines[:count]) if k not in corners]
    rows = np.array(points).reshape(-1, len(names))
    column = {name: rows[:, i] for i, name in enumerate(names)}
    p = np.stack([column["x"], column["y"], column["z"]], axis=1)
    zero = np.zeros(len(rows))
    target = (column.get("red", zero) == 224) & (column.get("blue", zero) == 208)
    in_map = "sigma_in_map" in column
    return p, column.get("sigma_in_map" if in_map else "sigma", zero), column.get("inverse_depth", zero) > 0, target, in_map


def read_planes(path):
    """[(corners (n,3), colour)] of the faces of a map.ply."""
    if not path.exists():
        return []
    head, _, body = read_text(path).partition("end_header\n")
    count = int(head.partition("element vertex ")[2].split()[0])
    lines = [line.split() for line in body.splitlines() if line.strip()]
    planes = []
    for face in lines[count:]:
        corners = [[float(word) for word in lines[int(k)][:3]] for k in face[1:1 + int(face[0])]]
        colour = [int(word) / 255 for word in face[1 + int(face[0]):4 + int(face[0])]]
        planes.append((np.array(corners), to_hex(colour) if len(colour) == 3 else style.GREY))
    return planes


def draw_planes(axis, planes, a, b):
    """The outlines, filled; one that is seen from its edge is a line."""
    for corners, colour in planes:
        dark = tuple(0.7 * value for value in to_rgb(colour))  # pale ones would be lost on white
        axis.add_collection(PolyCollection([corners[:, [a, b]]], facecolors=[(*to_rgb(colour), 0.25)], edgecolors=[(*dark, 0.9)],
                                           linewidths=1.0, zorder=0.5))


def plane_handles(planes):
    """For the legend: a patch for each class of planes, or one for all where gravity gave none a class."""
    colours = {colour for _, colour in planes}
    if not colours:
        return []
    if not colours <= set(style.PLANE_CLASSES):
        return [Patch(facecolor=style.LIGHT, edgecolor=style.GREY, label="plane" if len(planes) == 1 else "planes")]
    return [Patch(facecolor=colour, alpha=0.5, label=name) for colour, name in style.PLANE_CLASSES.items() if colour in colours]


def view_axes(rotations):
    """Signed axes of W nearest to the right, up and forward of the cameras: three of (axis, sign)."""
    up, forward = -rotations[:, :, 1].mean(axis=0), rotations[:, :, 2].mean(axis=0)
    vertical = int(np.abs(up).argmax())
    depth = max((i for i in range(3) if i != vertical), key=lambda i: abs(forward[i]))
    side = 3 - vertical - depth
    right = np.cross(np.eye(3)[depth] * np.sign(forward[depth]), np.eye(3)[vertical] * np.sign(up[vertical]))
    return (side, np.sign(right[side])), (vertical, np.sign(up[vertical])), (depth, np.sign(forward[depth]))


def ellipses(covariance, a, b, sigmas=3.0):
    """Widths, heights, angles [deg] of the projected ellipsoids."""
    block = covariance[:, [[a, a], [b, b]], [[a, b], [a, b]]]
    values, vectors = np.linalg.eigh(0.5 * (block + np.swapaxes(block, 1, 2)))
    radius = sigmas * np.sqrt(np.maximum(values, 0))
    return 2 * radius[:, 1], 2 * radius[:, 0], np.degrees(np.arctan2(vectors[:, 1, 1], vectors[:, 0, 1]))


def limits(path, points, sigma):
    """What to show: the way and what of the map is known well, without the few that are far away."""
    shown = path
    if len(points):
        distance = np.linalg.norm(points - path.mean(axis=0), axis=1)
        good = sigma < 0.3 * np.maximum(distance, 1e-9)
        if good.sum() >= 4:
            low, high = np.percentile(points[good], [3, 97], axis=0)
            shown = np.vstack([path, low, high])
    low, high = shown.min(axis=0), shown.max(axis=0)
    margin = 0.08 * max(1e-6, (high - low).max())
    return low - margin, high + margin


def draw(path_png, estimate, rotations, covariance, truth, map_points, unit, title, planes=()):
    """estimate (n,3), rotations (n,3,3), covariance (n,3,3) or None, truth (m,3) or None, planes [(corners, colour)], all in one frame."""
    points, sigma, inverse_depth, target, in_map = map_points
    right, up, forward = view_axes(rotations)
    whole = estimate if truth is None else np.vstack([estimate, truth])
    low, high = limits(whole, points, sigma)
    span = high - low
    tall = span[forward[0]] > 1.3 * span[right[0]]
    views = [("From above", right, forward), ("From the side", forward, up)]
    widths = [max(span[h[0]], 0.35 * span.max()) for _, h, _ in views]
    figure, axes = style.plt.subplots(1, 2, figsize=(10.5, 5.6 if tall else 4.6), width_ratios=widths, layout="constrained")
    for axis, (name, across, along) in zip(axes, views):
        a, b = across[0], along[0]
        draw_planes(axis, planes, a, b)
        groups = [(~inverse_depth & ~target, style.GREEN, 0.85, 9), (inverse_depth & ~target, style.BLUE, 0.35, 6),
                  (target, style.VIOLET, 1.0, 16)]
        for kept, colour, alpha, size in groups:
            size3 = 6 * sigma[kept]  # 3 sigma to either side
            small = (size3 < 0.5 * span.max()) & ~inverse_depth[kept]
            if small.any():
                axis.add_collection(EllipseCollection(
                    size3[small], size3[small], np.zeros(small.sum()), units="xy", offsets=points[kept][small][:, [a, b]],
                    transOffset=axis.transData, facecolors=colour if in_map else "none", edgecolors=colour,
                    linewidths=0.4, alpha=(0.2 if in_map else 0.25) * alpha, zorder=1))
            axis.scatter(points[kept, a], points[kept, b], s=size, c=colour, alpha=alpha, linewidths=0, zorder=3)
        if covariance is not None:
            step = max(1, len(estimate) // 60)
            w, h, angle = ellipses(covariance[::step], a, b)
            axis.add_collection(EllipseCollection(w, h, angle, units="xy", offsets=estimate[::step][:, [a, b]],
                                                  transOffset=axis.transData, facecolors=style.ORANGE, edgecolors="none",
                                                  alpha=0.15, zorder=2))
        if truth is not None:
            axis.plot(truth[:, a], truth[:, b], color=style.INK, linewidth=2.6, alpha=0.28, zorder=4)
        step = max(1, len(estimate) // 14)
        look = estimate[::step] + 0.05 * span.max() * rotations[::step, :, 2]
        axis.add_collection(LineCollection(np.stack([estimate[::step][:, [a, b]], look[:, [a, b]]], axis=1),
                                           colors=style.ORANGE, linewidths=0.8, alpha=0.7, zorder=4))
        axis.plot(estimate[:, a], estimate[:, b], color=style.ORANGE, linewidth=1.4, zorder=5)
        axis.plot(*estimate[0, [a, b]], "o", color="white", markeredgecolor=style.ORANGE, markersize=6, zorder=6)
        axis.plot(*estimate[-1, [a, b]], "s", color=style.ORANGE, markersize=5, zorder=6)
        axis.set(xlim=(low[a], high[a]), ylim=(low[b], high[b]), aspect="equal", title=name,
                 xlabel=f"{AXES[a]} [{unit}]", ylabel=f"{AXES[b]} [{unit}]")
        if across[1] < 0:
            axis.invert_xaxis()
        if along[1] < 0:
            axis.invert_yaxis()
    handles = [Line2D([], [], color=style.ORANGE, label="camera" + (", 3σ" if covariance is not None else ""))]
    if truth is not None:
        handles.append(Line2D([], [], color=style.INK, linewidth=2.6, alpha=0.28, label="truth"))
    handles += [Line2D([], [], marker=mark, color="none", markerfacecolor=fill, markeredgecolor=style.ORANGE, markersize=5,
                       label=label) for mark, fill, label in (("o", "white", "start"), ("s", style.ORANGE, "end"))]
    for kept, colour, label in ((~inverse_depth & ~target, style.GREEN, "point, 3σ " + ("within the map" if in_map else "with the scale that all share")),
                                (inverse_depth & ~target, style.BLUE, "depth not yet known"),
                                (target, style.VIOLET, "target")):
        if kept.any():
            handles.append(Line2D([], [], marker="o", color="none", markerfacecolor=colour, markeredgewidth=0,
                                  markersize=5, label=label))
    handles += plane_handles(planes)
    figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 6))
    figure.suptitle(title, x=0.01, ha="left", fontsize=9, color=style.GREY)
    return style.save(figure, path_png)
