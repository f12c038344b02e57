"""compare-runs: the command. One run decides nothing: it moves by centimetres with the frame that it starts in."""

import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import statistics
import subprocess
import sys

from . import Refused, compare_copies, compare_films
from .camera import camera_of_run
from .compare_options import arguments
from .corners import compare_corners, read_target
from .errors import compare
from .files import read_run
from .there_and_back import compare_passes, forward
from .trajectories import read_trajectory

SOURCE = pathlib.Path(__file__).resolve().parents[3]
START_TIMEOUT = 3600  # [s]

# Column: label, factor, digits, smallest is worst.
COLUMNS = {
    "ate": ("ATE [mm]", 1000, 1, False), "corners": ("corners [px]", 1, 3, False),
    "back": ("there and back [%]", 100, 2, False), "tracked": ("tracked [%]", 100, 1, True),
    "start": ("start frame", 1, 0, False), "nis": ("NIS per dof", 1, 2, False), "planes": ("planes", 1, 0, True),
    "folded": ("folded", 1, 0, True), "in_view": ("searched", 1, 0, True), "share": ("share folded [%]", 100, 1, True),
    "with_plane": ("frames with a plane [%]", 100, 0, True), "saved": ("rows saved [%]", 100, 1, True),
    "lost": ("lost", 1, 0, False), "track": ("track [frames]", 1, 1, True), "ms": ("ms", 1, 2, False),
}


def read_variants(words):
    """[(name, program, options)]"""
    variants = []
    for word in words or ["now=" + str(SOURCE / "build/release/bin/pf-capture")]:
        name, equals, command = word.partition("=")
        parts = shlex.split(command)
        if not equals or not name or not parts:
            raise Refused(f"'{word}': write NAME=PROGRAM, options in the same word")
        if (pathlib.Path(parts[0]) / "pf-capture").is_file():
            parts[0] = str(pathlib.Path(parts[0]) / "pf-capture")
        if not os.access(parts[0], os.X_OK) or pathlib.Path(parts[0]).is_dir():
            raise Refused(f"{parts[0]}: is no program; build pf-capture first")
        if name in [known for known, _, _ in variants]:
            raise Refused(f"'{name}' is there twice; give each variant its own name")
        variants.append((name, str(pathlib.Path(parts[0]).resolve()), parts[1:]))
    return variants


def find_sequences(options):
    data = options.data or os.environ.get("PLANEFOLD_DATA")
    if not data:
        raise Refused("no sequences: give --data DIR or set PLANEFOLD_DATA")
    data = pathlib.Path(data)
    found = {path.parent.name: path.parent for path in sorted(data.glob("*/calib.yaml"))
             if (path.parent / "times.txt").exists()}
    if not found:
        raise Refused(f"{data}: has no sequence (a folder with calib.yaml and times.txt); name another with --data")
    for name in options.only or []:
        if name not in found:
            raise Refused(f"{data / name}: is no sequence; there are {', '.join(found)}")
    return {name: found[name] for name in options.only or found}


def measure(folder, sequence):
    """What one run has shown, {column: value}. None where there is nothing to compare with."""
    run, report, folder = read_run(folder)
    row = {
        "ate": None, "corners": None, "back": None, "tracked": report["tracked"] / max(report["frames"], 1),
        "start": report["start_frame"] if report["start_frame"] >= 0 else None, "nis": report["nis_per_dof"],
        "planes": len(report["planes"]), "folded": report["features_in_map"]["folded"] + report["features_in_map"]["fixed"],
        "lost": report["lost"], "ms": report["ms_per_frame"]["median"],
    }
    folding = report.get("folding") or {}
    row["track"] = (report.get("track_length") or {}).get("mean")
    row["share"], row["with_plane"] = folding.get("share_folded"), folding.get("frames_with_plane")
    row["saved"] = folding.get("share_rows_saved")
    row["in_view"] = report.get("features_in_view", {}).get("median")
    if (sequence / "groundtruth.tum").exists():
        row["ate"] = compare(forward(run, report), read_trajectory(sequence / "groundtruth.tum"), "sim3").summary["ate_rmse_m"]
    if (sequence / "target.yaml").exists() and (sequence / "target_corners.csv").exists():
        target_W = read_target(sequence / "target.yaml")
        camera = camera_of_run(report, folder, folder / "calib.yaml")
        row["corners"] = compare_corners(run, camera, target_W, sequence / "target_corners.csv")[0]["corner_rms_px"]
    if report.get("there_and_back"):
        row["back"] = compare_passes(run, report, folder)["back_distance_median"]
    return row


def run_one(variant, name, sequence, start, out):
    """One run, as a row of runs.json."""
    label, program, words = variant
    folder = out / re.sub(r"[^A-Za-z0-9_.-]+", "_", label) / name / str(start)
    command = [program, "--source", f"images:{sequence}", "--skip", str(start), "--headless", "--no-film", "--quiet",
               "--out", str(folder)]
    if (sequence / "target.yaml").exists() and "--start" not in words:
        command += ["--start", f"target:{sequence / 'target.yaml'}"]
    command += words
    stamp = {"command": command, "built_ns": os.stat(program).st_mtime_ns}
    row = {"variant": label, "sequence": name, "start": start, "failure": "", "values": {}}
    kept = folder.with_suffix(".json")  # beside it: in the folder are pf-capture's own files alone
    known = json.loads(kept.read_text()) if kept.exists() else {}
    if {name: known.get(name) for name in stamp} == stamp:
        row["failure"] = known["failure"]
    else:
        folder.parent.mkdir(parents=True, exist_ok=True)
        ended = subprocess.run(command, text=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False,
                               timeout=START_TIMEOUT)
        said = ended.stderr.strip().splitlines()
        if ended.returncode == 2:
            raise Refused(said[-1] if said else f"{program}: refused its command line")
        row["failure"] = "" if ended.returncode == 0 else (said[-1] if said else f"ended with {ended.returncode}")
        kept.write_text(json.dumps(dict(stamp, failure=row["failure"])))
    try:
        if not row["failure"]:
            row["values"] = measure(folder, sequence)
    except Refused as refused:
        row["failure"] = str(refused)
    return row


def run_all(options):
    variants = read_variants(options.variants)
    sequences = find_sequences(options)
    out = pathlib.Path(options.out)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Refused(f"{out}: cannot be made ({error.strerror}); choose another --out") from error
    if (out / "runs.json").exists():
        try:
            read_rows(out, "")
        except Refused as refused:
            raise Refused(f"{refused}, and would be overwritten; choose another --out") from refused
    jobs = [(variant, name, path, start) for start in range(options.starts) for name, path in sequences.items()
            for variant in variants]
    rows = []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        waiting = [pool.submit(run_one, *job, out) for job in jobs]
        try:
            for done, future in enumerate(waiting, 1):
                rows.append(future.result())
                if sys.stderr.isatty():
                    print(f"\r{done} of {len(jobs)} runs", end="", file=sys.stderr, flush=True)
        finally:
            for future in waiting:
                future.cancel()
    if sys.stderr.isatty():
        print(file=sys.stderr)
    (out / "runs.json").write_text(json.dumps(rows, indent=1) + "\n")
    return rows


def read_rows(folder, label):
    path = pathlib.Path(folder) / "runs.json"
    try:
        rows = json.loads(path.read_text())
    except (OSError, json.JSONDecodeError) as error:
        raise Refused(f"{path}: is no result of compare-runs ({error})") from error
    if not isinstance(rows, list) or not all(isinstance(row, dict) and {"variant", "sequence", "start", "failure", "values"} <= row.keys() for row in rows):
        raise Refused(f"{path}: is no result of compare-runs")
    for row in rows:
        row["variant"] = label + row["variant"]
    return rows


def summarise(rows, column):
    """Median and worst of one column over runs; a run without a value is worse than any. (None, None) where no run has one."""
    _, _, _, smallest_is_worst = COLUMNS[column]
    worst = float("-inf") if smallest_is_worst else float("inf")
    values = [row["values"].get(column) for row in rows]
    if all(value is None for value in values):
        return None, None
    values = [worst if value is None else value for value in values]
    return statistics.median(values), (min if smallest_is_worst else max)(values)


def cell(rows, column):
    _, factor, digits, _ = COLUMNS[column]
    median, worst = summarise(rows, column)
    if median is None:
        return ""
    show = lambda value: "none" if value in (float("inf"), float("-inf")) else f"{factor * value:.{digits}f}"  # noqa: E731
    return f"{show(median)} ({show(worst)})"


def table(rows):
    """One table of the medians per sequence."""
    lines = []
    for name in dict.fromkeys(row["sequence"] for row in rows):
        here = [row for row in rows if row["sequence"] == name]
        starts = len({row["start"] for row in here})
        variants = dict.fromkeys(row["variant"] for row in here)
        of = {variant: [row for row in here if row["variant"] == variant] for variant in variants}
        columns = [column for column in COLUMNS if any(cell(part, column) for part in of.values())]
        cells = [[f"{name}, {starts} starts"] + [COLUMNS[column][0] for column in columns]]
        cells += [[variant] + [cell(part, column) for column in columns] for variant, part in of.items()]
        width = [max(len(line[k]) for line in cells) for k in range(len(cells[0]))]
        cells.insert(1, ["-" * size for size in width])
        lines += ["| " + " | ".join(word.ljust(size) for word, size in zip(line, width)) + " |" for line in cells] + [""]
    for row in rows:
        if row["failure"]:
            lines.append(f"{row['variant']}, {row['sequence']}, start {row['start']}: {row['failure']}")
    return "\n".join(lines).rstrip()


def main(words=None):
    options = arguments(words)
    try:
        if options.copies:
            print(compare_copies.table(compare_copies.run_all(options, read_variants(options.variants))))
            return 0
        if options.films:
            print(compare_films.table(compare_films.run_all(options, read_variants(options.variants), find_sequences(options))))
            return 0
        if options.show:
            labels = [""] if len(options.show) == 1 else [pathlib.Path(folder).name + ": " for folder in options.show]
            rows = [row for folder, label in zip(options.show, labels) for row in read_rows(folder, label)]
        else:
            rows = run_all(options)
        print(table(rows))
    except Refused as refused:
        print(f"compare-runs: {refused}", file=sys.stderr)
        return 1
    return 0
