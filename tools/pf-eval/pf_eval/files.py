"""Reading what pf-capture writes and what sequences bring: trajectories, covariances, reports, tables."""

import csv
import json
import pathlib

import numpy as np
import yaml

from . import Refused


class Trajectory:
    """Poses T_WC by time. t [s], p (n,3) [m], q (n,4) as w x y z, covariance (n,6,6) of (theta, p) or None."""

    def __init__(self, t, p, q, covariance=None, source=""):
        self.t, self.p, self.q, self.covariance, self.source = t, p, q, covariance, source

    def __len__(self):
        return len(self.t)

    def select(self, index):
        covariance = None if self.covariance is None else self.covariance[index]
        return Trajectory(self.t[index], self.p[index], self.q[index], covariance, self.source)

    def rotations(self):
        """(n,3,3), R_WC."""
        w, x, y, z = self.q.T
        return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                         2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
                        axis=1).reshape(-1, 3, 3)

    def path(self):
        """Length of the way [m]."""
        return float(np.linalg.norm(np.diff(self.p, axis=0), axis=1).sum())


def _text(path):
    path = pathlib.Path(path)
    if not path.exists():
        raise Refused(f"{path}: there is no such file")
    if path.is_dir():
        raise Refused(f"{path}: is a folder, a file is needed")
    try:
        return path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise Refused(f"{path}: cannot be read ({error})") from error


def read_numbers(path, columns, separator=None):
    """Rows of numbers, comments after # left out; an array (n, columns)."""
    rows = []
    for number, line in enumerate(_text(path).splitlines(), 1):
        line = line.split("#", 1)[0].strip()
        if not line:
            continue
        try:
            row = [float(word) for word in line.split(separator)]
        except ValueError as error:
            raise Refused(f"{path}: line {number} has something that is no number") from error
        if len(row) < columns:
            raise Refused(f"{path}: line {number} has {len(row)} numbers, {columns} are needed")
        rows.append(row[:columns])
    if not rows:
        raise Refused(f"{path}: is empty")
    return np.array(rows)


def read_tum(path):
    """Trajectory in the TUM form, sorted by time, without repeated times."""
    rows = read_numbers(path, 8)
    if not np.isfinite(rows).all():
        raise Refused(f"{path}: has a number that is not finite")
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    rows = rows[np.concatenate([[True], np.diff(rows[:, 0]) > 0])]
    length = np.linalg.norm(rows[:, 4:8], axis=1)
    if (np.abs(length - 1) > 0.01).any():
        raise Refused(f"{path}: has a quaternion that is not of unit length (the columns are t x y z qx qy qz qw)")
    q = rows[:, [7, 4, 5, 6]] / length[:, None]
    return Trajectory(rows[:, 0], rows[:, 1:4], q, source=str(path))


def read_run(run):
    """(trajectory with covariance where there is one, report or {}, folder) of a run's folder or trajectory file. Of a run with several
    maps the trajectory in the map with the most tracked frames: poses in the others have another world."""
    run = pathlib.Path(run)
    if not run.exists():
        raise Refused(f"{run}: there is no such file or folder")
    if not run.is_dir():
        return read_tum(run), {}, run.parent
    if not (run / "trajectory.txt").exists():
        raise Refused(f"{run}: has no trajectory.txt, so it is no output folder of pf-capture")
    report = read_report(run)
    maps = list_maps(report)
    name = max(maps, key=lambda entry: entry["tracked"])["trajectory"] if maps else "trajectory.txt"
    return read_map(run, name), report, run


def list_maps(report):
    """The maps of a run in which something was tracked; empty where report.json names none."""
    return report.get("maps", [])


def read_map(run, name):
    """The trajectory of one map, with its covariance where there is one."""
    run = pathlib.Path(run)
    trajectory = read_tum(run / name)
    table = run / name.replace("trajectory", "covariance").replace(".txt", ".csv")
    if table.exists():
        rows = read_numbers(table, 37, ",")
        order = np.argsort(rows[:, 0], kind="stable")
        rows = rows[order]
        found = np.clip(np.searchsorted(rows[:, 0], trajectory.t - 5e-7), 0, len(rows) - 1)
        if (np.abs(rows[found, 0] - trajectory.t) > 1e-6).any():
            raise Refused(f"{table}: has not the times of {name}")
        trajectory.covariance = rows[found, 1:].reshape(-1, 6, 6)
    return trajectory


def read_report(run):
    path = pathlib.Path(run) / "report.json"
    if not path.exists():
        return {}
    try:
        return json.loads(_text(path))
    except json.JSONDecodeError as error:
        raise Refused(f"{path}: is no JSON ({error})") from error


def read_yaml(path):
    text = _text(path)
    lines = text.splitlines()
    if lines and lines[0].startswith("%YAML"):  # OpenCV's first line, which YAML readers refuse
        text = "\n".join(lines[1:])
    try:
        fields = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise Refused(f"{path}: is no YAML ({str(error).splitlines()[0]})") from error
    if not isinstance(fields, dict):
        raise Refused(f"{path}: has no fields")
    return fields


def read_table(path):
    """A CSV file with a line of names: {name: array}; empty fields become NaN, words stay words."""
    rows = list(csv.DictReader(_text(path).splitlines()))
    if not rows:
        raise Refused(f"{path}: is empty")
    table = {}
    for name in rows[0]:
        column = [row[name] for row in rows]
        try:
            table[name.strip().lstrip("#")] = np.array([float(word) if word else np.nan for word in column])
        except (TypeError, ValueError):
            table[name.strip().lstrip("#")] = np.array(column)
    return table
