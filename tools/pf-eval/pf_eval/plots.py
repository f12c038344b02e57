"""plot-run: the command."""

import pathlib
import sys

import numpy as np

from . import Refused, plot_errors, plot_frames, plot_inertial, plot_trajectory
from .errors import compare, default_alignment
from .files import read_run, read_table
from .output_folder import LIST, add_output_files, open_output_folder
from .plot_options import arguments
from .truth import read_truth


def describe(run, report, comparison):
    words = [pathlib.PurePath(str(report.get("source", run.source)).rstrip("/")).name]
    if report.get("frames"):
        words.append(f"tracked {report.get('tracked', '?')} of {report['frames']} frames")
    if comparison:
        aligned = {"none": "in the truth's own frame", "se3": "after SE(3) alignment", "sim3": "after Sim(3) alignment"}
        words.append(f"position error {1000 * comparison.summary['ate_rmse_m']:.1f} mm RMS {aligned[comparison.align]}")
    return "   ·   ".join(words)


def plot(options):
    run, report, folder = read_run(options.run)
    truth_path = options.truth or (folder / "truth.tum" if (folder / "truth.tum").exists() else None)
    align = options.align or default_alignment(report)
    truth = read_truth(truth_path)[0] if truth_path else None
    comparison = None
    if truth:
        try:
            comparison = compare(run, truth, align, own_frame=report.get("start") != "auto")
        except Refused as refused:
            if options.truth:
                raise
            print(f"plot-run: without truth: {refused}", file=sys.stderr)
            truth = None

    out = open_output_folder(options.out or folder / "plots", "--out", reads=folder)
    pictures = ["trajectory.png", "frames.png", "inertial.png", "errors.png"]
    add_output_files(out, *pictures)
    if not options.out and (folder / LIST).is_file():  # the next run into this folder takes them along
        add_output_files(folder, "plots/", *[f"plots/{name}" for name in [*pictures, LIST]])
    title = describe(run, report, comparison)
    known_scale = default_alignment(report) != "sim3" or truth is not None

    points, sigma, inverse_depth, target, in_map = plot_trajectory.read_map(folder / "map.ply")
    planes = plot_trajectory.read_planes(folder / "map.ply")
    p, rotations = run.p, run.rotations()
    covariance = None if run.covariance is None else run.covariance[:, 3:, 3:]
    true_path = None
    if comparison:  # into the truth's frame
        s, R, shift = comparison.scale, comparison.turn, comparison.shift
        p, points, sigma = s * p @ R.T + shift, s * points @ R.T + shift, s * sigma
        planes = [(s * corners @ R.T + shift, colour) for corners, colour in planes]
        rotations = R @ rotations
        covariance = None if covariance is None else s * s * R @ covariance @ R.T
        inside = (truth.t >= run.t[0] - 0.05) & (truth.t <= run.t[-1] + 0.05)
        true_path = truth.p[inside]
    yield plot_trajectory.draw(out / "trajectory.png", p, rotations, covariance, true_path,
                               (points, sigma, inverse_depth, target, in_map), "m" if known_scale else "first median depth", title, planes)
    start = run.t[0]
    if (folder / "frames.csv").exists():
        table = read_table(folder / "frames.csv")
        start = table["t_s"][0]
        yield plot_frames.draw(out / "frames.png", table, title)
    unit = folder / "inertial.csv"
    if unit.exists() and unit.read_text().count("\n") > 1:  # a unit that never began leaves the names of the columns only
        picture = plot_inertial.draw(out / "inertial.png", read_table(unit), start, title)
        if picture:
            yield picture
    if comparison:
        yield plot_errors.draw(out / "errors.png", comparison, start, title)


def main(words=None):
    options = arguments(words)
    try:
        with np.errstate(all="ignore"):
            for path in plot(options):
                print(path)
    except Refused as refused:
        print(f"plot-run: {refused}", file=sys.stderr)
        return 1
    return 0
