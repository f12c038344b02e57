"""Where the features of a run truly are, and which of them lie on one plane: from a scene, from depth images, or from the run's own tracks
triangulated with the true poses."""

import dataclasses
import json
import pathlib

import numpy as np

from . import Refused
from .adjust_run import rays

SAME_DEG, SAME_M = 1.0, 0.005  # of two surfaces of a scene that are one plane
MIN_SHARE = 0.8                # of the frames of a feature that see one surface; another is at a rim, and is not judged
MIN_PARALLAX_DEG = 3.0         # between two rays of a feature that is triangulated
MAX_RESIDUAL_PX = 0.5          # of its pixels, RMS
SIGMA_PX = 0.3                 # of a pixel
ROUGHNESS = 0.002              # of real surfaces, relative to the depth
DEPTH_SIGMA = 0.005            # of a depth image, likewise
MAX_SIGMA = 0.01               # of a depth by which a feature is judged, likewise
NEAR = 3.0                     # standard deviations within which a feature is on a plane
MIN_ON_PLANE = 8               # features of a plane that could fold
TRIPLES = 400                  # drawn for one plane


@dataclasses.dataclass
class Places:
    """By the number of a feature: place (n,3) and sigma of its depth (n) in the truth's world, label of its true plane; -1: on none, -2: not
    judged."""

    ids: np.ndarray
    place: np.ndarray
    sigma: np.ndarray
    label: np.ndarray
    source: str


def merge_surfaces(normals, distances):
    """The number of the first surface in the same plane, for each surface of a scene."""
    group = np.arange(len(normals))
    for i in range(len(normals)):
        for j in range(i):
            cosine = normals[i] @ normals[j]
            if abs(cosine) > np.cos(np.radians(SAME_DEG)) and abs(distances[i] - np.sign(cosine) * distances[j]) < SAME_M:
                group[i] = group[j]
                break
    return group


def places_of_scene(rows, folder):
    """From the columns surface and depth of tracks.csv and truth_planes.json. Places are not needed: surfaces say which plane it is."""
    data = json.loads((folder / "truth_planes.json").read_text())["planes"]
    group = merge_surfaces(np.array([p["normal"] for p in data], float), np.array([p["distance"] for p in data], float))
    ids = np.unique(rows["id"])
    label = np.full(len(ids), -2)
    for k, number in enumerate(ids):
        seen = rows["surface"][rows["id"] == number].astype(int)
        groups = np.where(seen < 0, -1, group[np.maximum(seen, 0)])
        values, counts = np.unique(groups, return_counts=True)
        if counts.max() >= MIN_SHARE * len(groups):
            label[k] = values[counts.argmax()]
    return Places(ids, np.full((len(ids), 3), np.nan), np.full(len(ids), np.nan), label, "scene")


def meet(centres, directions):
    """The place nearest to all rays, and the information that they give: sum of I - d dT."""
    projectors = np.eye(3) - directions[:, :, None] * directions[:, None, :]
    A = projectors.sum(axis=0)
    return np.linalg.solve(A, (projectors @ centres[:, :, None]).sum(axis=0)[:, 0])


def triangulate(rows, poses, camera):
    """From the pixels of each feature and the true poses (R, p by frame; NaN where there is none)."""
    R, p = poses
    known = np.isfinite(p[rows["frame"], 0])
    d = np.einsum("kij,kj->ki", R[rows["frame"]], rays(camera, rows["z"]))
    ids = np.unique(rows["id"])
    place, sigma = np.full((len(ids), 3), np.nan), np.full(len(ids), np.nan)
    for k, number in enumerate(ids):
        mine = np.flatnonzero((rows["id"] == number) & known)
        if len(mine) < 3 or (d[mine] @ d[mine].T).min() > np.cos(np.radians(MIN_PARALLAX_DEG)):
            continue
        c, R_mine = p[rows["frame"][mine]], R[rows["frame"][mine]]
        X = meet(c, d[mine])
        p_C = np.einsum("kji,kj->ki", R_mine, X - c)
        r = camera.project(p_C) - rows["z"][mine]
        if not np.isfinite(r).all() or np.sqrt((r ** 2).sum(axis=1).mean()) > MAX_RESIDUAL_PX:
            continue
        depth = np.linalg.norm(X - c, axis=1).mean()
        # Information of the depth along the first ray, from how far a pixel moves with it.
        step = 1e-3 * depth
        moved = camera.project(p_C + step * np.einsum("kji,j->ki", R_mine, d[mine[0]])) - camera.project(p_C)
        place[k], sigma[k] = X, SIGMA_PX / max(np.sqrt((moved ** 2).sum()) / step, 1e-12)
        if sigma[k] > MAX_SIGMA * depth:
            place[k] = np.nan
        sigma[k] = np.hypot(sigma[k], ROUGHNESS * depth)
    return ids, place, sigma


def read_depths(folder, unit):
    """(function that gives the depth image of a frame [m], number of images): 16 bits, PNG, in the order of their names."""
    from matplotlib import image
    names = sorted(pathlib.Path(folder).glob("*.png"))
    if not names:
        raise Refused(f"{folder}: holds no depth images (PNG of 16 bits)")

    def read(i):
        grey = image.imread(names[i])
        if grey.ndim != 2:
            raise Refused(f"{names[i]}: is no depth image of one channel")
        z = np.round(grey * 65535.0)
        return np.where((z > 0) & (z < 65535), z * unit, np.nan)
    return read, len(names)


def places_from_depths(rows, poses, camera, folder, unit, skip):
    """Each feature at the median of where the depth images of its frames put it."""
    read, count = read_depths(folder, unit)
    R, p = poses
    d = rays(camera, rows["z"])
    X = np.full((len(d), 3), np.nan)
    for frame in np.unique(rows["frame"]):
        if frame + skip >= count:
            raise Refused(f"{folder}: holds {count} depth images, and none for frame {frame + skip}")
        mine, z = np.flatnonzero(rows["frame"] == frame), read(frame + skip)
        column, row = np.round(rows["z"][mine]).astype(int).T
        inside = (column >= 0) & (row >= 0) & (column < z.shape[1]) & (row < z.shape[0])
        depth = np.where(inside, z[np.clip(row, 0, z.shape[0] - 1), np.clip(column, 0, z.shape[1] - 1)], np.nan)
        X[mine] = (depth / d[mine, 2])[:, None] * d[mine] @ R[frame].T + p[frame]
    ids = np.unique(rows["id"])
    place, sigma = np.full((len(ids), 3), np.nan), np.full(len(ids), np.nan)
    for k, number in enumerate(ids):
        mine = np.flatnonzero((rows["id"] == number) & np.isfinite(X[:, 0]))
        if len(mine):
            place[k] = np.median(X[mine], axis=0)
            depth = np.linalg.norm(place[k] - p[rows["frame"][mine[0]]])
            sigma[k] = np.hypot(DEPTH_SIGMA, ROUGHNESS) * depth
    return ids, place, sigma


def fit_plane(place, sigma, generator):
    """(n, d, which are on it): the plane of most places within NEAR sigma, of TRIPLES drawn, fitted again to those."""
    best = None
    for _ in range(TRIPLES):
        a, b, c = place[generator.choice(len(place), 3, replace=False)]
        n = np.cross(b - a, c - a)
        length = np.linalg.norm(n)
        if not length > 1e-12:
            continue
        on = np.abs((place - a) @ n) < NEAR * length * sigma
        if best is None or on.sum() > best.sum():
            best = on
    if best is None or best.sum() < 3:
        return None
    for _ in range(3):
        w = 1 / sigma[best] ** 2
        middle = (w[:, None] * place[best]).sum(axis=0) / w.sum()
        n = np.linalg.svd(np.sqrt(w)[:, None] * (place[best] - middle), full_matrices=False)[2][2]
        on = np.abs((place - middle) @ n) < NEAR * sigma
        if on.sum() < 3:
            break
        best = on
    return n, float(n @ middle), best


def label_planes(place, sigma):
    """Planes one after the other, each with at least MIN_ON_PLANE features: what could fold, at most, since clutter holds planes too."""
    generator = np.random.default_rng(1)
    label = np.where(np.isfinite(place[:, 0]), -1, -2)
    for number in range(32):
        free = np.flatnonzero(label == -1)
        if len(free) < MIN_ON_PLANE:
            break
        found = fit_plane(place[free], sigma[free], generator)
        if found is None or found[2].sum() < MIN_ON_PLANE:
            break
        label[free[found[2]]] = number
    return label
