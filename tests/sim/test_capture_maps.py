"""pf-capture on a camera that is carried to another place: a map of its own in files of its own, states that add up, and an exit code
that says where the camera was lost."""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run  # noqa: E402

DESK, ROOM, INTERVAL = 90, 220, 1 / 30


def require(condition, message):
    if not condition:
        fail(message)


def film(folder, parts):
    """A sequence of some of the pictures of several others."""
    (folder / "images").mkdir(parents=True)
    shutil.copy(parts[0][0] / "calib.yaml", folder)
    rows = []
    for source, count in parts:
        for name in sorted(path.name for path in (source / "images").iterdir())[:count]:
            rows.append(f"{len(rows)} {len(rows) * INTERVAL:.9f} {len(rows):06d}.png")
            shutil.copy(source / "images" / name, folder / "images" / rows[-1].split()[-1])
    (folder / "times.txt").write_text("\n".join(rows) + "\n")
    return len(rows)


def capture(source, out):
    words = [BIN / "pf-capture", "--source", f"images:{source}", "--start", "auto", "--headless", "--no-film", "--quiet", "--out", out]
    result = subprocess.run(words, capture_output=True, text=True, check=False)
    print(result.stdout, result.stderr)
    report = json.loads((out / "report.json").read_text())
    require(sum(report["frames_by_state"].values()) == report["frames"], f"states do not add up: {report['frames_by_state']}")
    require(sum(entry["tracked"] for entry in report["maps"]) == report["tracked"], f"maps do not add up: {report['maps']}")
    return result, report


def poses(path):
    return [line.split()[0] for line in path.read_text().splitlines() if not line.startswith("#")]


with tempfile.TemporaryDirectory() as name:
    root = pathlib.Path(name)
    for scene, count in (("desk", DESK), ("room", ROOM)):
        run(BIN / "pf-sim", "render", scene, "--out", root / scene, "--frames", count, "--width", 320)

    frames = film(root / "two places", [(root / "desk", DESK), (root / "room", ROOM)])
    result, report = capture(root / "two places", root / "two")
    require(result.returncode == 0 and report["frames"] == frames, f"{result.returncode}, {report['frames']} frames")
    require([entry["map"] for entry in report["maps"]] == [1, 2], f"maps: {report['maps']}")
    times = []
    for entry, end in zip(report["maps"], ("", "_2")):
        require(entry["trajectory"] == f"trajectory{end}.txt", f"map {entry}")
        tracked = poses(root / "two" / entry["trajectory"])
        covariances = [line.split(",")[0] for line in (root / "two" / f"covariance{end}.csv").read_text().splitlines()[1:]]
        require(tracked == covariances and len(tracked) == entry["tracked"] > 30, f"{entry}: {len(tracked)} poses")
        require(set(tracked) <= set(poses(root / "two" / f"trajectory_all{end}.txt")), f"{entry}: not all poses are in trajectory_all")
        times.append([float(t) for t in tracked])
    require(max(times[0]) < DESK * INTERVAL < min(times[1]), "a pose is in the file of another map")

    # One second later the state is lost, and two and a half later the new map would begin.
    film(root / "lost", [(root / "desk", DESK), (root / "room", 60)])
    result, report = capture(root / "lost", root / "lost at the end")
    require(result.returncode == 1 and "lost at the end: frame 89 is the last that was tracked" in result.stderr, result.stderr)
    require(result.stderr.count("\n") == 1 and len(report["maps"]) == 1, f"{result.stderr} {report['maps']}")
