"""Reading what pf-capture writes and what sequences bring: trajectories, covariances, reports, tables."""

import csv
import json
import pathlib

import numpy as np
import yaml

from . import Refused
from .tables import read_numbers, read_text
from .trajectories import read_trajectory

def read_run(run):
    """(trajectory with covariance where there is one, report or {}, folder) of a run's folder or trajectory file. Of a run with several
    maps the trajectory in the map with the most tracked frames: poses in the others have another world."""
    run = pathlib.Path(run)
    if not run.exists():
        raise Refused(f"{run}: there is no such file or folder")
    if not run.is_dir():
        return read_trajectory(run), {}, run.parent
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
    trajectory = read_trajectory(run / name)
    table = run / name.replace("trajectory", "covariance").replace(".txt", ".csv")
    if table.exists():
        rows = read_numbers(table, 37)
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
        return json.loads(read_text(path))
    except json.JSONDecodeError as error:
        raise Refused(f"{path}: is no JSON ({error})") from error


def read_yaml(path):
    text = read_text(path)
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
    rows = list(csv.DictReader(read_text(path).splitlines()))
    if not rows:
        raise Refused(f"{path}: is empty")
    for number, row in enumerate(rows, 2):
        if None in row or None in row.values():
            raise Refused(f"{path}: line {number} has another number of columns than the line of names; was the file cut off?")
    table = {}
    for name in rows[0]:
        column = [row[name] for row in rows]
        try:
            table[name.strip().lstrip("#")] = np.array([float(word) if word else np.nan for word in column])
        except (TypeError, ValueError):
            table[name.strip().lstrip("#")] = np.array(column)
    return table
