"""pf-eval: the command."""

import json
import math
import pathlib
import sys

import numpy as np

from . import Refused
from .camera import camera_of_run, read_camera
from .corners import compare_corners, read_target
from .errors import compare, default_alignment
from .files import list_maps, read_map, read_run, read_table
from .options import arguments
from .output_folder import write
from .planes import compare_planes, folding, read_planes
from .planes_truth import compare_planes_with_truth
from .plausible import tell_lengths, tell_order
from .relative import compare_motions
from .there_and_back import compare_passes, forward
from .trajectories import on_one_clock
from .truth import named_truth, read_truth

TABLE = {
    "ate_rmse_m": ("position error, RMS", "m"),
    "coverage": ("of it: share of the sequence's frames tracked", ""), "first_pose_s": ("time to the first pose", "s"),
    "ate_max_m": ("position error, largest", "m"),
    "rpe_rmse_m": ("position error frame to frame, RMS", "m"), "rpe_1s_rmse_m": ("position error over 1 s, RMS", "m"),
    "rot_rmse_deg": ("rotation error, RMS", "deg"), "rot_max_deg": ("rotation error, largest", "deg"),
    "rot_by_positions_rmse_deg": ("rotation error, aligned by the positions", "deg"),
    "alignment_degenerate": ("path too straight to align its rotation", ""), "frame": ("frame compared", ""),
    "pairs": ("frames compared", ""), "poses": ("of tracked frames", ""), "scale": ("scale found", ""),
    "path_m": ("true path", "m"), "align": ("alignment", ""), "association": ("truth taken", ""),
    "nees_position": ("NEES position, mean (3 is honest)", ""), "nees_pose": ("NEES pose, mean (6 is honest)", ""),
    "nees_position_median": ("NEES position, median (2.4 is honest)", ""),
    "nees_pose_median": ("NEES pose, median (5.3 is honest)", ""),
    "corner_rms_px": ("corner distance, RMS", "px"), "corner_max_px": ("corner distance, largest", "px"),
    "corner_median_px": ("corner distance, median", "px"), "corner_worst_frame": ("worst frame", ""),
    "corner_bias_u_px": ("mean offset, horizontal", "px"), "corner_bias_v_px": ("mean offset, vertical", "px"),
    "planes_true": ("planes that are true ones", ""), "planes_false": ("planes that are none", ""),
    "planes_duplicate": ("planes that are there twice", ""), "planes_missing": ("true planes not found", ""),
    "plane_normal_median_deg": ("normal of a plane, median", "deg"), "plane_normal_max_deg": ("normal, largest", "deg"),
    "plane_offset_median_m": ("offset of a plane, median", "m"), "plane_offset_max_m": ("offset, largest", "m"),
    "state_dim_end": ("rows of the state at the end", ""), "state_dim_points_only": ("the same map without folding", ""),
    "state_dim_saved": ("share of the state saved by folding", ""), "points_on_planes": ("points on planes", ""),
    "truth_source": ("truth taken from", ""), "found": ("features found in a frame", ""), "judged": ("of them: judged", ""),
    "could_fold": ("on a true plane with eight or more", ""), "could_tell": ("likewise, and turned by 3 degrees", ""),
    "earned": ("on a plane by their own parallax", ""), "on_trial": ("began on a plane", ""),
    "power": ("of those that could tell: earned", ""), "false_members": ("earned ones on a wrong surface", ""),
    "false_trial": ("those on trial on a wrong surface", ""), "planes_lived": ("planes that lived for 30 frames", ""),
    "planes_lived_false": ("of them: false", ""), "planes_lived_not_judged": ("of them: not judged", ""),
    "motion_nees_per_dof": ("NEES of a motion per degree of freedom (1 is honest)", ""),
    "motion_nees_per_dof_median": ("likewise, median (0.9 is honest)", ""),
    "motion_rotation_nees_per_dof": ("likewise, of its rotation", ""),
    "motion_nees_per_dof_one_scale": ("likewise, with one scale for each map", ""),
    "motions": ("motions compared", ""), "motions_without_truth": ("motions without truth", ""),
    "back_distance_median": ("distance of an image's two poses, median", "of extent"),
    "back_distance_max": ("distance of an image's two poses, largest", "of extent"),
    "back_rotation_median_deg": ("rotation between them, median", "deg"),
    "back_rotation_max_deg": ("rotation between them, largest", "deg"), "images": ("of images", ""),
    "frames_in_other_maps": ("tracked in other maps, counted as untracked", ""),
    "frames": ("frames compared", ""), "frames_measured": ("of frames with measured corners", ""),
}


def frames_of_run(folder, report):
    """frames.csv of a run, on the way there; None where there is none."""
    if not (folder / "frames.csv").is_file():
        return None
    frames = read_table(folder / "frames.csv")
    turn = report.get("there_and_back")
    kept = frames["t_s"] <= turn["turn_s"] + 1e-4 if turn else np.ones(len(frames["t_s"]), dtype=bool)
    return {name: column[kept] for name, column in frames.items()}


def number_of_unreadable(report):
    return int(report.get("unreadable_frames") or 0)


def coverage(run, frames, report):
    """How much of the sequence an error speaks of: nothing is known of a trajectory alone."""
    if frames is None or len(frames["t_s"]) == 0:
        return {"coverage": None, "first_pose_s": None}
    tracked = frames["t_s"][frames["tracked"] == 1] if "tracked" in frames else run.t
    first = float(tracked[0] - frames["t_s"][0]) if len(tracked) else None
    known = int((run.t <= frames["t_s"][-1] + 1e-4).sum())
    return {"coverage": known / (len(frames["t_s"]) + number_of_unreadable(report)), "first_pose_s": first}


def times_of_frames(frames, report):
    """Times by the number of a frame in the sequence; None where they are not known."""
    if frames is None or number_of_unreadable(report) > 0:
        return None
    return np.concatenate([np.full(int(report.get("skip") or 0), np.nan), frames["t_s"]])


def compare_maps(report, folder, truth, align):
    """Each map of a run by itself, aligned by itself; nothing where there is one map only. The frames of all but the largest map count as
    untracked."""
    maps = list_maps(report)
    if len(maps) < 2:
        return {}
    rows = []
    for entry in maps:
        row = {"map": entry["map"], "tracked": entry["tracked"]}
        try:
            found = compare(read_map(folder, entry["trajectory"]), truth, align, own_frame=False).summary
            row.update({name: found[name] for name in ("pairs", "ate_rmse_m", "scale")})
        except Refused as refused:
            row["not_compared"] = str(refused)
        rows.append(row)
    tracked = [entry["tracked"] for entry in maps]
    return {"maps": rows, "frames_in_other_maps": sum(tracked) - max(tracked)}


def evaluate_truth(options):
    run, report, folder = read_run(options.run)
    truth_path = options.truth or named_truth(report, folder)
    truth, frame = read_truth(truth_path, options.calib)
    if pathlib.Path(truth_path).resolve() != (folder / "truth.tum").resolve():  # a scene knows the way back, too
        run = forward(run, report)
    frames = frames_of_run(folder, report) if pathlib.Path(options.run).is_dir() else None
    run, truth = on_one_clock(run, truth, times_of_frames(frames, report))
    align = options.align or default_alignment(report)
    result = compare(run, truth, align, own_frame=report.get("start") != "auto")
    tell_lengths(run, truth, align)
    tell_order(run, truth, result)
    if options.per_frame:
        columns = [result.t[:, None], result.position_error, result.rotation_error]
        names = "t_s,e_x_m,e_y_m,e_z_m,theta_x_rad,theta_y_rad,theta_z_rad"
        if result.nees_pose is not None:
            columns += [result.nees_position[:, None], result.nees_pose[:, None]]
            names += ",nees_position,nees_pose"
        write_rows(options.per_frame, names, np.hstack(columns))
    summary = dict(result.summary, frame=frame, **coverage(run, frames, report), **folding(report))
    if result.summary["alignment_degenerate"]:
        print("pf-eval: note: the path is nearly straight, so the rotation of the alignment about it is not known; rot_rmse_deg is "
              "aligned by the rotations", file=sys.stderr)
    summary.update(compare_maps(report, folder, truth, align))
    if options.planes:
        summary.update(compare_planes(report, read_planes(options.planes), result.scale, result.own_turn, result.own_shift))
    return summary


def evaluate_corners(options):
    run, report, folder = read_run(options.run)
    places = [folder / "calib.yaml", pathlib.Path(options.corners).parent / "calib.yaml"]
    calibration = options.calib or next((place for place in places if place.exists()), None)
    if calibration is None:
        raise Refused(f"{places[0]}: there is no such file; give the calibration with --calib")
    target_W = read_target(options.target)
    camera = read_camera(options.calib) if options.calib else camera_of_run(report, folder, calibration)
    summary, rows = compare_corners(run, camera, target_W, options.corners, options.skip_frames)
    if options.per_frame:
        write_rows(options.per_frame, "frame,t_s,TL_px,TR_px,BR_px,BL_px", rows)
    return summary


def evaluate_planes(options):
    run, report, folder = read_run(options.run)
    try:
        truth = read_truth(options.truth or named_truth(report, folder), options.calib)[0]
    except Refused:
        if options.truth:
            raise
        truth = None  # a scene tells without it
    if truth is not None:
        truth = on_one_clock(run, truth, times_of_frames(frames_of_run(folder, report), report))[1]
    return compare_planes_with_truth(folder, report, truth, options)


def evaluate(options):
    if options.planes_truth:
        return evaluate_planes(options)
    if options.there_and_back:
        return compare_passes(*read_run(options.run))
    if options.relative:
        run, report, folder = read_run(options.run)
        truth_path = options.truth or named_truth(report, folder)
        truth = on_one_clock(run, read_truth(truth_path, options.calib)[0], times_of_frames(frames_of_run(folder, report), report))[1]
        return compare_motions(folder, report, truth, options.align or default_alignment(report))
    if options.corners:
        return evaluate_corners(options)
    return evaluate_truth(options)


def write_rows(path, names, rows):
    write(path, names + "\n" + "".join(",".join(f"{value:.9g}" for value in row) + "\n" for row in rows), names.rsplit(",nees_position", 1)[0])


def finite(summary):
    return {name: None if isinstance(value, float) and not math.isfinite(value) else value
            for name, value in summary.items()}


def table(summary):
    lines = []
    for name, (label, unit) in TABLE.items():
        if summary.get(name) is not None:
            value = summary[name]
            shown = f"{value:.4g}" if isinstance(value, float) else str(value)
            lines.append(f"  {label:48s} {shown:>10s} {unit}".rstrip())
    return "\n".join(lines)


def main(words=None):
    options = arguments(words)
    try:
        summary = finite(evaluate(options))
        text = json.dumps(summary, indent=2) + "\n"
        if options.json == "-":
            sys.stdout.write(text)
        else:
            if options.json:
                mark = {"written_by": "pf-eval"}
                write(options.json, json.dumps(dict(summary, **mark), indent=2) + "\n", json.dumps(mark)[1:-1])
            print(f"{options.run}\n{table(summary)}")
    except Refused as refused:
        print(f"pf-eval: {refused}", file=sys.stderr)
        return 1
    return 0
