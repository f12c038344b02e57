"""A map of a kitchen that one back end has saved is found by the other one, within a second, and about where the first one was."""

import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, skip_in_cross_builds  # noqa: E402
from tracked_runs import sequence  # noqa: E402

SEEN, STARTS, LENGTH = 180, (60, 120), 60  # frames
SECOND = 1.0
MOST = 0.1  # of the extent of the way: median distance from where the first run was


def capture(folder, out, *options):
    words = [BIN / "pf-capture", "--source", f"images:{folder}", "--headless", "--no-film", "--quiet", "--out", out, *options]
    result = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    print(result.stdout, result.stderr)
    rows = [line.split() for line in (out / "trajectory.txt").read_text().splitlines() if not line.startswith("#")]
    return {float(row[0]): [float(number) for number in row[1:4]] for row in rows}


def distance(a, b):
    return sum((x - y) ** 2 for x, y in zip(a, b)) ** 0.5


skip_in_cross_builds()
folder = sequence("7scenes_redkitchen_a")
stamps = [float(line.split()[1]) for line in (folder / "times.txt").read_text().splitlines() if not line.startswith("#")]
with tempfile.TemporaryDirectory() as scratch:
    root = pathlib.Path(scratch)
    for first, second in (("filter", "window"), ("window", "filter")):
        saved = root / f"{first}.pfmap"
        before = capture(folder, root / first, "--backend", first, "--frames", SEEN, "--save-map", saved)
        extent = max(distance(a, b) for a in before.values() for b in before.values())
        for start in STARTS:
            after = capture(folder, root / f"{second} {start}", "--backend", second, "--skip", start, "--frames", LENGTH, "--map", saved)
            if not after or min(after) - stamps[start] > SECOND:
                fail(f"the {second} does not find itself in the map of the {first} within a second, from frame {start} on")
            apart = sorted(distance(after[t], before[t]) for t in after if t in before)
            print(f"{first} to {second} from {start}: found after {min(after) - stamps[start]:.2f} s, {len(after)} tracked, "
                  f"median {apart[len(apart) // 2] / extent:.3f} of the extent apart")
            if apart[len(apart) // 2] > MOST * extent:
                fail(f"the {second} is not where the {first} was")
