"""pf-capture from a known pose: a hand that moves slowly at first is tracked, in the world that the pose says."""

import json
import math
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run  # noqa: E402

FRAMES, SLOWER = 100, 3
MAX_STARTING = 30       # frames until depths are known
MAX_OFF_M, MAX_OFF_DEG = 0.02, 2


def require(condition, message):
    if not condition:
        fail(message)


def poses(path):
    rows = [line.split() for line in path.read_text().splitlines() if line and line[0] != "#"]
    return {round(float(row[0]), 3): [float(v) for v in row[1:]] for row in rows}


with tempfile.TemporaryDirectory() as folder:
    film, out = pathlib.Path(folder) / "film", pathlib.Path(folder) / "out"
    run(BIN / "pf-sim", "render", "desk", "--out", film, "--frames", FRAMES, "--width", 320)
    for name, column in (("times.txt", 1), ("groundtruth.tum", 0)):
        lines = []
        for line in (film / name).read_text().splitlines():
            fields = line.split()
            if line and line[0] != "#":
                fields[column] = f"{float(fields[column]) * SLOWER:.9f}"
            lines.append(" ".join(fields))
        (film / name).write_text("\n".join(lines) + "\n")
    truth = poses(film / "groundtruth.tum")
    first = pathlib.Path(folder) / "first.tum"
    first.write_text(" ".join(map(str, [0.0, *next(iter(truth.values())), 0.003, 0.2])) + "\n")
    run(BIN / "pf-capture", "--source", f"images:{film}", "--start", f"pose:{first}", "--out", out, "--headless", "--no-film", "--quiet")
    report = json.loads((out / "report.json").read_text())
    found = poses(out / "trajectory.txt")

states = report["frames_by_state"]
time, pose = next(iter(found.items()))
p, q = truth[time][:3], truth[time][3:]
off = math.dist(pose[:3], p)
turned = 2 * math.degrees(math.acos(min(1.0, abs(sum(a * b for a, b in zip(pose[3:], q))))))
print(f"{states}; the first tracked pose, at {time:.2f} s, is {off:.4f} m and {turned:.2f} degrees off")
require(states["lost"] == 0 and states["tracked"] + MAX_STARTING >= FRAMES, "it is not tracked")
require(off < MAX_OFF_M and turned < MAX_OFF_DEG, "it does not begin where the given pose is")
