"""What half and double of each tuned number change, on a few short runs: tools/sweep-tuning --screen."""

import hashlib
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

FRAMES = 70
SEQUENCES = ("7scenes_redkitchen_a", "vamr_three_planes")


def _real(sequence, backend):
    return ["pf-capture", "--headless", "--no-film", "--quiet", "--no-inertial", "--frames", str(FRAMES), "--backend", backend, "--source",
            f"images:{os.environ.get('PLANEFOLD_DATA', '')}/{sequence}"]


# Name, back end or part, and words of each run.
RUNS = {
    **{f"{sequence}, {backend}": _real(sequence, backend) for sequence in SEQUENCES for backend in ("filter", "window")},
    "masks": [*_real(SEQUENCES[1], "filter"), "--masks", "partial"],
    "vio at rest": ["pf-sim", "vio", "--seeds", "1", "--seconds", "8"],
    "vio moving": ["pf-sim", "vio", "--seeds", "1", "--seconds", "8", "--start", "moving"],
    "vio phone": ["pf-sim", "vio", "--seeds", "1", "--seconds", "8", "--unit", "phone"],
    "box": ["pf-sim", "box", "--seeds", "1", "--frames", "60"],
}


def runs_of(name):
    """The runs that a number can matter to, by its folder."""
    def chosen(*words):
        return [run for run in RUNS if any(word in run for word in words)]

    if name.startswith("keyframe_slam"):
        return chosen("window")
    if name.startswith("inertial"):
        return chosen("vio")
    if name.startswith("filter_slam/patches") or re.search(r"patch|align|homography|wall", name):
        return chosen("box")
    if re.search(r"mask|template|normal", name):
        return chosen("masks", SEQUENCES[0])
    if name.startswith("filter_slam"):
        return chosen("filter", "vio at rest", "box")
    return chosen("filter", "window", "vio at rest")


def _ate(folder, sequence):
    """Position error after alignment by a similarity."""
    from evo.core import metrics, sync  # noqa: PLC0415 (the environment of the tools)
    from evo.tools import file_interface  # noqa: PLC0415
    truth = file_interface.read_tum_trajectory_file(f"{os.environ['PLANEFOLD_DATA']}/{sequence}/groundtruth.tum")
    run = file_interface.read_tum_trajectory_file(folder / "trajectory.txt")
    truth, run = sync.associate_trajectories(truth, run, max_diff=0.02)
    run.align(truth, correct_scale=True)
    metric = metrics.APE(metrics.PoseRelation.translation_part)
    metric.process_data((truth, run))
    return metric.get_statistic(metrics.StatisticsType.rmse)


def play(programs, run, table):
    """Fingerprint of the run's numbers, its error and its share of tracked frames; an error of None where there is none."""
    words = RUNS[run]
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder)
        option = ["--out", out] if words[0] == "pf-capture" else ["--json", out / "report.json"]
        done = subprocess.run([programs / words[0], *words[1:], *option], env={**os.environ, "PLANEFOLD_TUNING": str(table)}, check=False,
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        if done.returncode < 0:
            return {"print": f"signal {-done.returncode}", "error": None, "tracked": 0}
        try:
            report = json.loads((out / "report.json").read_text())
        except (OSError, ValueError):
            return {"print": "none", "error": None, "tracked": 0}
        if words[0] == "pf-sim":
            numbers = list(report["cases"].values())[-1] if "cases" in report else report
            timeless = {k: v for k, v in numbers.items() if not re.search(r"us_per|share_of_frame|patches|settings|_ms$", k)}
            text = json.dumps(timeless, sort_keys=True)
            return {"print": hashlib.sha1(text.encode()).hexdigest(), "error": numbers.get("camera_rmse_m"),
                    "tracked": numbers.get("tracked_share", numbers.get("frames_judged"))}
        text = (out / "trajectory.txt").read_bytes()
        try:
            error = _ate(out, run.split(",")[0] if "," in run else SEQUENCES[1])
        except Exception:  # noqa: BLE001 (evo raises what it likes about runs without poses)
            error = None
        return {"print": hashlib.sha1(text).hexdigest(), "error": error, "tracked": report["tracked"] / report["frames"]}


def verdict(now, then):
    """One cell of the table: how many runs change, and by what ratio their errors."""
    changed = [run for run in then if then[run]["print"] != now[run]["print"]]
    if not changed:
        return "same"
    lost = [run for run in changed if (then[run]["tracked"] or 0) < 0.9 * (now[run]["tracked"] or 0)]
    ratios = [then[run]["error"] / now[run]["error"] for run in changed if then[run]["error"] and now[run]["error"]]
    text = f"{len(changed)} of {len(then)}"
    if ratios:
        text += f": {statistics.median(ratios):.2f} ({min(ratios):.2f} .. {max(ratios):.2f})"
    return text + (f", {len(lost)} lost" if lost else "")


def screen(programs, numbers, kept):
    """Halves and doubles each number; results are kept in a file and not made again."""
    done = json.loads(kept.read_text()) if kept.is_file() else {}
    table = kept.with_suffix(".table")
    table.write_text("")
    now = done.setdefault("now", {})
    for run in RUNS:
        if run not in now:
            now[run] = play(programs, run, table)
    for index, constant in enumerate(numbers):
        row = done.setdefault(constant.name, {"value": constant.value})
        for word, factor in (("half", 0.5), ("double", 2)):
            if word in row:
                continue
            table.write_text(f"{constant.name} {constant.number(factor)!r}\n")
            row[word] = {run: play(programs, run, table) for run in runs_of(constant.name)}
        if index % 10 == 0 or index == len(numbers) - 1:
            kept.write_text(json.dumps(done))
            print(f"\r{index + 1} of {len(numbers)} numbers", end="", file=sys.stderr, flush=True)
    kept.write_text(json.dumps(done))
    print(file=sys.stderr)
    return done


def page(done, numbers, revision, date):
    """The page as Markdown: tables by folder, and the numbers that change nothing."""
    lines, dead, folder = [], [], None
    for constant in numbers:
        if "double" not in done.get(constant.name, {}):
            continue
        row = done[constant.name]
        cells = [verdict({r: done["now"][r] for r in row[word]}, row[word]) for word in ("half", "double")]
        if cells == ["same", "same"]:
            dead.append(constant.name)
            continue
        here = constant.name.split(".")[0]
        if here != folder:
            folder = here
            lines += ["", f"## {folder}", "", f"*Old numbers, {date}.*", "", "| number | value | half | double |", "|---|---|---|---|"]
        lines.append(f"| `{constant.name[len(here) + 1:]}` | {constant.value} | {cells[0]} | {cells[1]} |")
    judged = sum("double" in done.get(c.name, {}) for c in numbers)
    head = [
        "# Results: sensitivity", "",
        f"What half and double of each tuned number change: `tools/sweep-tuning --screen lib/docs/results/sensitivity.md`, at {revision} of {date}.", "",
        f"{len(RUNS)} short runs: {FRAMES} frames of two sequences in both back ends, one with masks, three of `pf-sim vio`, one of `pf-sim box`; "
        "each number in those that its folder has to do with. A cell has how many of them change, and by what ratio the camera's position error "
        "does: median (least .. largest). *Lost*: runs that track less than nine tenths of the frames that they track now. "
        "Small ratios mean little: the error of one short run scatters when anything changes.", "",
        f"Of {judged} numbers {judged - len(dead)} change a run, and {len(dead)} change none: they are listed at the end.",
    ]
    tail = ["", "## Numbers that change none of these runs", "",
            "They bound what did not occur there (losses, wrong units, zoom, masks, saved maps, bad input), or only one of many conditions. "
            "None of them may be removed for this alone.", "", *(f"- `{name}`" for name in dead)]
    return "\n".join(head + lines + tail) + "\n"
