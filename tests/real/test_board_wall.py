"""A real board as a wall of the plan, which may be wrong: the camera is tracked by patches of it alone, and the wall is refined.

With --table every start and every wrong wall is run and listed. --points: with points beside patches; --as-published: with the
calibration of the sequence; --truth FILE: other poses than the published ones, for example of tools/adjust-tags."""

import argparse
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, skip, skip_in_cross_builds  # noqa: E402

NAME = "visp_apriltag_board"
STARTS = 5
SIGMA_START_M, SIGMA_START_DEG = 0.002, 0.1
SIGMA_DEG, SIGMA_M, ROUGHNESS_M = 4, 0.05, 0.002
EDGE_M = 0.03  # white paper around the tags
MAX_WALL_DEG = 2
# As tools/adjust-tags finds it; the published calibration has neither distortion nor readout.
CALIBRATION = """camera_model: pinhole
width: 640
height: 480
fx: 608.575
fy: 608.631
cx: 321.391
cy: 241.918
distortion_model: radtan
distortion: [0.095, 0, 0, 0]
rate_hz: 30
readout_s: 0.0328
"""
PLANS = {  # degrees about the board's own x, about its own y, metres along its normal
    "right": (0, 0, 0), "tilted by 6 about x": (6, 0, 0), "tilted by -6 about x": (-6, 0, 0), "tilted by 6 about y": (0, 6, 0),
    "tilted by -6 about y": (0, -6, 0), "5 cm before": (0, 0, 0.05), "5 cm behind": (0, 0, -0.05),
    "tilted by 6, 5 cm before": (4.24, 4.24, 0.05), "tilted by 6, 5 cm behind": (-4.24, 4.24, -0.05),
}


def read_tum(path):
    rows = [[float(v) for v in line.split()] for line in path.read_text().splitlines() if line and line[0] != "#"]
    return {round(row[0], 4): row[1:] for row in rows}


def board_of(layout):
    """Centre, x, y and normal of the board as its own poses have it, and half of its sides."""
    corners = [c for tag in layout["tag_corners_xyz"].values() for c in tag]
    half = [(max(c[k] for c in corners) - min(c[k] for c in corners)) / 2 + EDGE_M for k in (0, 1)]
    n = layout["plane_normal"]
    x, y = ((max(c[k] for c in corners) + min(c[k] for c in corners)) / 2 for k in (0, 1))
    z = (layout["plane_offset_n_dot_x"] - n[0] * x - n[1] * y) / n[2]
    along = [n[2], 0, -n[0]]
    length = math.hypot(*along)
    along = [v / length for v in along]
    up = [n[1] * along[2] - n[2] * along[1], n[2] * along[0] - n[0] * along[2], n[0] * along[1] - n[1] * along[0]]
    return (x, y, z), along, up, n, half


def plan_of(board, about_x, about_y, ahead):
    """The walls file with the board turned about its own centre and moved along its normal."""
    centre, x, y, n, half = board
    # Turned by a small rotation vector, axis by axis: y and x tilt out of the board's plane.
    angle = math.radians(math.hypot(about_x, about_y))
    tilt = [math.radians(about_y) * a - math.radians(about_x) * b for a, b in zip(x, y)]
    size = math.hypot(*tilt) or 1
    normal = [math.cos(angle) * c + math.sin(angle) * t / size for c, t in zip(n, tilt)]

    def on_board(u, v):
        p = [c + u * a + v * b for c, a, b in zip(centre, x, y)]
        off = sum((q - c) * m for q, c, m in zip(p, centre, normal)) / sum(a * m for a, m in zip(n, normal))
        return [q - off * a + ahead * m for q, a, m in zip(p, n, normal)]

    corners = [on_board(u * half[0], v * half[1]) for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return {"planefold_walls": 1, "walls": [], "faces": [
        {"name": "board", "corners": corners, "sigma_rotation_deg": SIGMA_DEG, "sigma_vertical_deg": SIGMA_DEG,
         "sigma_offset_m": SIGMA_M, "roughness_m": ROUGHNESS_M}]}


def measure(data, folder, plan, start, chosen):
    layout = json.loads((data / "board_layout.json").read_text())
    truth = read_tum(pathlib.Path(chosen.truth or data / "groundtruth.tum"))
    board = board_of(layout)
    times = sorted(truth)
    first, walls, out = folder / "first.tum", folder / "walls.json", folder / "out"
    first.write_text(" ".join(map(str, [times[start], *truth[times[start]], SIGMA_START_M, SIGMA_START_DEG])) + "\n")
    walls.write_text(json.dumps(plan_of(board, *plan)))
    command = [BIN / "pf-capture", "--source", f"images:{data}", "--skip", start, "--start", f"pose:{first}", "--walls", walls,
               "--out", out, "--headless", "--no-film", "--quiet", "--lens", chosen.lens, *(["--patches", 8] if chosen.points else ["--no-points"])]
    if not chosen.as_published:
        (folder / "calib.yaml").write_text(CALIBRATION)
        command += ["--calib", folder / "calib.yaml"]
    # 1: a run that was lost at its end; its report says so.
    ended = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if not (out / "report.json").exists():
        fail(ended.stdout)
    report = json.loads((out / "report.json").read_text())
    found = read_tum(out / "trajectory.txt")
    squares = [math.dist(pose[:3], truth[min(times, key=lambda t: abs(t - time))][:3]) ** 2 for time, pose in found.items()]
    wall = report["walls"][0]
    plane = next((p for p in report["planes"] if p["id"] == wall["id"]), None)
    row = {"frames": report["frames"], "tracked": report["tracked"], "lost": report["lost"], "doubted": wall.get("doubted", True),
           "ate_m": math.sqrt(sum(squares) / len(squares)) if squares else math.inf,
           "largest_m": math.sqrt(max(squares)) if squares else math.inf, "wall_deg": 90.0, "wall_m": math.inf}
    if plane is not None:
        n, centre = board[3], board[0]
        cosine = sum(a * b for a, b in zip(n, plane["normal"])) / (math.hypot(*n) * math.hypot(*plane["normal"]))
        row["wall_deg"] = math.degrees(math.acos(max(-1.0, min(1.0, cosine))))
        row["wall_m"] = abs(sum(a * b for a, b in zip(plane["normal"], centre)) - plane["distance"])
    return row


def table(data, chosen):
    print("plan; median (worst) of", STARTS, "starts: untracked frames, position error RMS [mm], largest [mm], wall [deg], [mm], doubted")
    for name, plan in PLANS.items():
        rows = []
        for start in range(STARTS):
            with tempfile.TemporaryDirectory() as folder:
                rows.append(measure(data, pathlib.Path(folder), plan, start, chosen))
        columns = [[row["frames"] - row["tracked"] for row in rows], [1000 * row["ate_m"] for row in rows],
                   [1000 * row["largest_m"] for row in rows], [row["wall_deg"] for row in rows],
                   [1000 * row["wall_m"] for row in rows], [int(row["doubted"]) for row in rows]]
        print(f"| {name} |", " | ".join(f"{statistics.median(c):.3g} ({max(c):.3g})" for c in columns), "|", flush=True)


arguments = argparse.ArgumentParser()
arguments.add_argument("--table", action="store_true")
arguments.add_argument("--points", action="store_true")
arguments.add_argument("--as-published", action="store_true")
arguments.add_argument("--lens", default="exact")
arguments.add_argument("--truth")
asked = arguments.parse_args()
skip_in_cross_builds()
sequence = pathlib.Path(os.environ.get("PLANEFOLD_DATA", "nowhere")) / NAME
if not (sequence / "board_layout.json").exists():
    skip(f"no {NAME} below $PLANEFOLD_DATA")
if asked.table:
    table(sequence, asked)
    sys.exit(0)
for tried in ("right", "tilted by 6, 5 cm behind"):
    with tempfile.TemporaryDirectory() as scratch:
        seen = measure(sequence, pathlib.Path(scratch), PLANS[tried], 0, asked)
    print(f"{tried}: {seen}", flush=True)
    # The first frame has the pose that was given, and measures nothing.
    if seen["tracked"] + 1 < seen["frames"] or seen["lost"] > 0:
        fail("frames are not tracked")
    if seen["doubted"] or seen["wall_deg"] > MAX_WALL_DEG:
        fail("the board is not found where it is")
