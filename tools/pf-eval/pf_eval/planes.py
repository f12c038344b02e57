"""Planes of a run against true ones, and what folding points into them saved."""

import json
import pathlib

import numpy as np

from . import Refused

# A plane further off than this is no estimate of a true one.
MATCH_DEG, MATCH_M = 10.0, 0.1


def read_planes(path):
    """True planes: (n,3) unit normals, (n,) distances n . p [m], names.

    {"planes": [{"name", "normal", "distance"}]}, or one plane as {"plane_normal", "plane_offset_n_dot_x"}."""
    try:
        data = json.loads(pathlib.Path(path).read_text())
        if "planes" in data:
            rows = [(str(p.get("name", i)), p["normal"], p["distance"]) for i, p in enumerate(data["planes"])]
        else:
            rows = [("plane", data["plane_normal"], data["plane_offset_n_dot_x"])]
        normals = np.array([row[1] for row in rows], float).reshape(len(rows), 3)
        distances = np.array([row[2] for row in rows], float)
    except OSError as error:
        raise Refused(f"{path}: cannot be read ({error.strerror})") from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise Refused(f"{path}: is no file of true planes ({error})") from error
    length = np.linalg.norm(normals, axis=1)
    if not len(rows) or not (np.isfinite(normals).all() and np.isfinite(distances).all() and (length > 0).all()):
        raise Refused(f"{path}: a plane needs a normal that is not zero, and a distance")
    return normals / length[:, None], distances / length, [row[0] for row in rows]


def aligned(plane, scale, turn, shift):
    """Normal and middle of the outline after p_truth = scale turn p_run + shift."""
    normal = np.array(plane["normal"], float)
    outline = np.array(plane["outline"], float).reshape(-1, 3)
    middle = outline.mean(axis=0) if len(outline) else plane["distance"] * normal
    return turn @ normal, scale * (turn @ middle) + shift


def compare_planes(report, truth, scale=1.0, turn=None, shift=None):
    """Each plane of report.json beside the nearest true one. The offset is that of the outline's middle."""
    normals, distances, names = truth
    turn = np.eye(3) if turn is None else turn
    shift = np.zeros(3) if shift is None else shift
    each, found = [], {}
    for plane in report.get("planes", []):
        normal, middle = aligned(plane, scale, turn, shift)
        degrees = np.degrees(np.arctan2(np.linalg.norm(np.cross(normals, normal), axis=1), np.abs(normals @ normal)))
        offsets = np.abs(normals @ middle - distances)
        near = (degrees <= MATCH_DEG) & (offsets <= MATCH_M)
        row = {"id": plane["id"], "points": plane["points"], "true": None}
        if near.any():
            best = int(np.flatnonzero(near)[np.argmin(offsets[near])])
            row.update(true=names[best], normal_deg=float(degrees[best]), offset_m=float(offsets[best]))
            found.setdefault(best, []).append(plane["id"])
        each.append(row)
    matched = [row for row in each if row["true"] is not None]
    return {
        "planes_true": len(matched),
        "planes_false": len(each) - len(matched),
        "planes_duplicate": sum(len(ids) - 1 for ids in found.values()),
        "planes_missing": len(names) - len(found),
        "plane_normal_max_deg": max((row["normal_deg"] for row in matched), default=None),
        "plane_normal_median_deg": float(np.median([row["normal_deg"] for row in matched])) if matched else None,
        "plane_offset_max_m": max((row["offset_m"] for row in matched), default=None),
        "plane_offset_median_m": float(np.median([row["offset_m"] for row in matched])) if matched else None,
        "planes": each,
    }


def folding(report):
    """How many rows the state has at the end, against what the same map needs without folding."""
    end, alone = report.get("state_dim", {}).get("end"), report.get("state_dim_points_only")
    if not end or not alone:
        return {}
    return {"state_dim_end": end, "state_dim_points_only": alone, "state_dim_saved": 1 - end / alone,
            "points_on_planes": sum(plane["points"] for plane in report.get("planes", []))}
