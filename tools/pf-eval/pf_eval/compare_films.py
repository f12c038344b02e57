"""compare-runs --films: sequences as films without a calibration, with both back ends: what is tracked, and the focal length that is found."""

import pathlib
import re
import statistics
import subprocess

from . import Refused
from .camera import read_camera
from .compare_copies import BACKENDS, in_turn, kept_run
from .files import read_run

APART = 10                # frames between two starts
NEAR, FAR_SIGMAS = 3, 2   # percent, and standard deviations, beyond which a focal length counts as wrong
FOCAL = re.compile(r"focal length ([\d.]+) px, standard deviation ([\d.]+) px")


def make_film(sequence, film):
    """A lossless grey film of the sequence's images at its own times (Matroska keeps milliseconds)."""
    rows = [line.split() for line in (sequence / "times.txt").read_text().splitlines() if line.strip() and not line.startswith("#")]
    if len(rows) < 2 or any(len(row) < 3 for row in rows):
        raise Refused(f"{sequence / 'times.txt'}: rows of number, seconds and file name make a film")
    t = [float(row[1]) for row in rows]
    t.append(2 * t[-1] - t[-2])
    listed = film.with_suffix(".ffconcat")
    # Each image has a time base of its own; that of the first is the film's.
    listed.write_text("ffconcat version 1.0\n" + "".join(
        f"file '{sequence.resolve() / 'images' / row[2]}'\noption framerate 1000000\nduration {t[k + 1] - t[k]:.6f}\n" for k, row in enumerate(rows)))
    part = film.with_suffix(".part.mkv")
    ended = subprocess.run(["ffmpeg", "-v", "error", "-nostdin", "-y", "-f", "concat", "-safe", "0", "-i", f"file:{listed}", "-vf", "format=gray",
                            "-c:v", "ffv1", "-fps_mode", "passthrough", f"file:{part}"], text=True, stderr=subprocess.PIPE, check=False)
    if ended.returncode != 0:
        raise Refused(f"{film}: ffmpeg cannot make it ({(ended.stderr.strip().splitlines() or ['no reason given'])[-1]})")
    part.rename(film)


def measure(folder, said, true_px):
    _, report, _ = read_run(folder)
    focal = FOCAL.search(said)
    return {"tracked": report["tracked"] / max(report["frames"], 1), "true_px": true_px,
            "focal_px": float(focal[1]) if focal else None, "sigma_px": float(focal[2]) if focal else None}


def run_one(job, out):
    (label, program, words), backend, name, film, true_px, start = job
    folder = out / re.sub(r"[^A-Za-z0-9_.-]+", "_", label) / backend / name / str(start)
    command = [program, "--source", f"video:{film}", "--skip", str(start), "--backend", backend, "--headless", "--no-film", "--quiet", "--out", str(folder), *words]
    row = {"variant": label, "backend": backend, "sequence": name, "start": start}
    return row | kept_run(command, folder, lambda said: measure(folder, said, true_px))


def run_all(options, variants, sequences):
    films, out = pathlib.Path(options.films), pathlib.Path(options.out)
    for folder in (films, out):
        folder.mkdir(parents=True, exist_ok=True)
    jobs = []
    for name, path in sequences.items():
        film = films / f"{name}.mkv"
        if not film.exists():
            make_film(path, film)
        true_px = read_camera(path / "calib.yaml").fx
        jobs += [(variant, backend, name, film, true_px, APART * start) for start in range(options.starts) for backend in BACKENDS for variant in variants]
    return in_turn(jobs, run_one, options.jobs, out, "films.json")


def line_of(rows):
    """Of some runs: frames tracked, median (least); error of the focal length, median (largest); its own standard deviation; wrong ones."""
    values = [row["values"] for row in rows]
    tracked = [100 * value.get("tracked", 0.0) for value in values]
    found = [value for value in values if value.get("focal_px")]
    cells = [f"{statistics.median(tracked):.1f} ({min(tracked):.1f})"]
    if not found:
        return cells + ["none"] * 5
    percent = [100 * (value["focal_px"] / value["true_px"] - 1) for value in found]
    sigmas = [(value["focal_px"] - value["true_px"]) / max(value["sigma_px"], 1e-9) for value in found]
    relative = [100 * value["sigma_px"] / value["focal_px"] for value in found]
    return cells + [f"{statistics.median(percent):+.1f} ({max(percent, key=abs):+.1f})", f"{statistics.median(relative):.1f} ({min(relative):.1f})",
                    f"{statistics.median(sigmas):+.1f} ({max(sigmas, key=abs):+.1f})", f"{sum(abs(one) < NEAR for one in percent)} of {len(rows)}",
                    f"{sum(abs(one) > FAR_SIGMAS for one in sigmas)} of {len(rows)}"]


def table(rows):
    """A line for each sequence, back end and variant."""
    lines = [["film", "back end", "", "tracked [%]", "focal length off by [%]", "own sigma [%]", "off by [sigma]", f"within {NEAR} %", f"beyond {FAR_SIGMAS} sigma"]]
    for key in dict.fromkeys((row["sequence"], row["backend"], row["variant"]) for row in rows):
        lines.append([*key] + line_of([row for row in rows if (row["sequence"], row["backend"], row["variant"]) == key]))
    width = [max(len(line[k]) for line in lines) for k in range(len(lines[0]))]
    lines.insert(1, ["-" * size for size in width])
    text = ["| " + " | ".join(word.ljust(size) for word, size in zip(line, width)) + " |" for line in lines]
    text += [f"{row['variant']}, {row['backend']}, {row['sequence']}, start {row['start']}: {row['failure']}" for row in rows if row["failure"]]
    return "\n".join(text)
