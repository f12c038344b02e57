"""compare-runs --copies: runs of both back ends on the copies that tools/copies makes, as one table by kind."""

import concurrent.futures
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys

import numpy as np

from . import Refused
from .errors import compare
from .files import read_run
from .there_and_back import forward
from .trajectories import read_trajectory

BACKENDS = ("filter", "window")
FEW = 0.9  # share of frames, below which a run is counted
WRONG_DEG, CONFIDENT_SIGMAS, LEAST_SIGMA_DEG = 5, 5, 0.1
RUN_TIMEOUT = 3600  # [s]


def find_copies(folder, only):
    """{(sequence, kind): folder}"""
    found = {}
    for path in sorted(pathlib.Path(folder).glob("*/copy.txt")):
        sequence, dot, kind = path.parent.name.rpartition(".")
        if dot and (not only or sequence in only or kind in only):
            found[(sequence, kind)] = path.parent
    if not found:
        raise Refused(f"{folder}: has no copies" + (f" of {', '.join(only)}" if only else "") + "; tools/copies --out makes them")
    return found


def angle_deg(R):
    return float(np.degrees(np.arccos(np.clip((np.trace(R) - 1) / 2, -1, 1))))


def wrong_and_confident(run, truth):
    """How many poses of a map have turned since its first by more than 5 degrees and 5 of their own sigmas from what the truth says, of how many."""
    at = {round(float(t), 3): k for k, t in enumerate(truth.t)}
    R, R_true = run.rotations(), truth.rotations()
    pairs = [(k, at[round(float(t), 3)]) for k, t in enumerate(run.t) if round(float(t), 3) in at]
    wrong = 0
    for k, j in pairs[1:]:
        i, i_true = pairs[0]
        degrees = angle_deg((R_true[i_true].T @ R_true[j]).T @ (R[i].T @ R[k]))
        sigma = np.degrees(np.sqrt(sum(np.trace(run.covariance[n][:3, :3]) for n in (i, k))))
        wrong += degrees > WRONG_DEG and degrees > CONFIDENT_SIGMAS * max(sigma, LEAST_SIGMA_DEG)
    return int(wrong), max(0, len(pairs) - 1)


def measure(folder, copy):
    run, report, folder = read_run(folder)
    row = {"tracked": report["tracked"] / max(report["frames"], 1), "maps": len(report["maps"]),
           "lost": report["lost"], "rotation": None, "ate": None, "wrong": 0, "judged": 0}
    if (copy / "groundtruth.tum").exists():
        truth = read_trajectory(copy / "groundtruth.tum")
        run = forward(run, report)
        try:
            summary = compare(run, truth, "sim3").summary
            row["rotation"], row["ate"] = summary["rot_rmse_deg"], summary["ate_rmse_m"]
        except Refused:
            pass  # too few poses at the truth's times
        if run.covariance is not None:
            row["wrong"], row["judged"] = wrong_and_confident(run, truth)
    return row


def kept_run(command, folder, measure):
    """Runs command, unless what the same program made from it is in folder. measure(its output) gives the values. {"failure", "values"}"""
    kept = folder.with_suffix(".json")
    stamp = {"command": command, "built_ns": os.stat(command[0]).st_mtime_ns}
    known = json.loads(kept.read_text()) if kept.exists() else {}
    if {name: known.get(name) for name in stamp} == stamp:
        return {name: known[name] for name in ("failure", "values")}
    folder.parent.mkdir(parents=True, exist_ok=True)
    ended = subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False, timeout=RUN_TIMEOUT)
    said = ended.stderr.strip().splitlines()
    if ended.returncode == 2:
        raise Refused(said[-1] if said else f"{command[0]}: refused its command line")
    row = {"failure": "" if ended.returncode == 0 else (said[-1] if said else f"ended with {ended.returncode}")}
    try:
        row["values"] = measure(ended.stdout)  # a run that was lost at its end has poses all the same
    except (Refused, OSError):
        row["values"] = {}
    kept.write_text(json.dumps(stamp | row))
    return row


def run_one(job, out):
    (label, program, words), backend, (sequence, kind), copy, start = job
    folder = out / re.sub(r"[^A-Za-z0-9_.-]+", "_", label) / backend / f"{sequence}.{kind}" / str(start)
    command = [program, "--source", f"images:{copy}", "--skip", str(start), "--backend", backend, "--headless", "--no-film", "--quiet", "--out", str(folder)]
    if (copy / "target.yaml").exists() and start == 0 and "--start" not in words:
        command += ["--start", f"target:{copy / 'target.yaml'}"]
    row = {"variant": label, "backend": backend, "sequence": sequence, "kind": kind, "start": start}
    return row | kept_run(command + words, folder, lambda _: measure(folder, copy))


def in_turn(jobs, run, workers, out, name):
    """The rows that run(job, out) gives for all jobs, which the file name in out keeps too."""
    rows = []
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        waiting = [pool.submit(run, job, out) for job in jobs]
        try:
            for done, future in enumerate(waiting, 1):
                rows.append(future.result())
                if sys.stderr.isatty():
                    print(f"\r{done} of {len(jobs)} runs", end="\n" if done == len(jobs) else "", file=sys.stderr, flush=True)
        finally:
            for future in waiting:
                future.cancel()
    (out / name).write_text(json.dumps(rows, indent=1) + "\n")
    return rows


def run_all(options, variants):
    copies = find_copies(options.copies, options.only)
    out = pathlib.Path(options.out)
    out.mkdir(parents=True, exist_ok=True)
    jobs = [(variant, backend, name, path, 10 * start) for name, path in copies.items() for start in range(options.starts)
            for backend in BACKENDS for variant in variants]
    return in_turn(jobs, run_one, options.jobs, out, "copies.json")


def line_of(rows):
    """Of some runs: tracked share, how many below FEW, maps, frames lost, wrong and confident, rotation error."""
    values = [row["values"] for row in rows]
    tracked = [value.get("tracked", 0.0) for value in values]
    rotation = [value["rotation"] for value in values if value.get("rotation") is not None]
    judged = sum(value.get("judged", 0) for value in values)
    return [f"{100 * statistics.mean(tracked):.1f}", f"{sum(share < FEW for share in tracked)} of {len(rows)}",
            f"{statistics.mean([value.get('maps') or 0 for value in values]):.2f}", f"{sum(value.get('lost', 0) for value in values)}",
            f"{sum(value.get('wrong', 0) for value in values)} of {judged}" if judged else "",
            f"{statistics.median(rotation):.2f} ({max(rotation):.2f})" if rotation else ""]


def table(rows):
    """A line for each kind, back end and variant, and one for all kinds."""
    head = ["kind", "back end", "", "tracked [%]", f"below {100 * FEW:.0f} %", "maps", "frames lost", "wrong and confident", "rotation error [deg]"]
    lines = [head]
    kinds = list(dict.fromkeys(row["kind"] for row in rows))
    for kind in [*kinds, "all"]:
        for backend in dict.fromkeys(row["backend"] for row in rows):
            for variant in dict.fromkeys(row["variant"] for row in rows):
                mine = [row for row in rows if row["variant"] == variant and row["backend"] == backend and kind in (row["kind"], "all")]
                lines.append([kind, backend, variant] + line_of(mine))
    width = [max(len(line[k]) for line in lines) for k in range(len(head))]
    lines.insert(1, ["-" * size for size in width])
    return "\n".join("| " + " | ".join(word.ljust(size) for word, size in zip(line, width)) + " |" for line in lines)
