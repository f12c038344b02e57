"""A camera that has not moved yet stands still while somebody walks through the picture: its pose does not go with them, and no map
begins from their motion. (The filter's pose had turned by 6.3 and 6.4 degrees.)"""

import json
import math
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run  # noqa: E402

REST_S, FRAMES = 5, 140
MAX_DEG, MAX_DEPTHS = 1.5, 0.03

with tempfile.TemporaryDirectory() as folder:
    for backend in ("filter", "window"):
        for seed in (1, 2):
            out = pathlib.Path(folder) / f"{backend}-{seed}"
            run(BIN / "pf-capture", "--source", "sim:person", "--seed", seed, "--rest", REST_S, "--frames", FRAMES, "--imu", "none",
                "--backend", backend, "--headless", "--no-film", "--quiet", "--out", out)
            states = [line.split(",")[1] for line in (out / "frames.csv").read_text().splitlines()[1:]]
            poses = [[float(x) for x in line.split()] for line in (out / "trajectory.txt").read_text().splitlines() if line[0] != "#"]
            far = max(math.hypot(*pose[1:4]) for pose in poses)
            turned = max(math.degrees(2 * math.asin(min(1, math.hypot(*pose[4:7])))) for pose in poses)
            log = json.loads((out / "report.json").read_text())["log"]
            print(f"{backend}, seed {seed}: {len(poses)} poses, at most {turned:.2f} degrees and {far:.3f} depths from the first")
            if set(states) != {"starting"} or len(poses) < FRAMES - 1:
                fail(f"a map began at rest, or poses are missing: {len(poses)}, {sorted(set(states))}")
            if turned > MAX_DEG or far > MAX_DEPTHS:
                fail("the pose has gone with the person")
            if backend == "filter" and (len(log) != 1 or "stands still" not in log[0]):
                fail(f"the log does not say that it waits: {log}")
