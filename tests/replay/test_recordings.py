"""pf-capture --record: what was recorded replays to the same trajectory, to the last digit; also after an interruption."""

import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run, skip  # noqa: E402

PROGRAM = BIN / "pf-capture"
TARGET = "rectangle:0.20x0.14"
QUIET = ["--headless", "--no-film", "--quiet", "--start", TARGET]
FILES = ("trajectory.txt", "covariance.csv", "map.ply")


def capture(out, *arguments):
    run(PROGRAM, *QUIET, "--out", out, *arguments)
    return json.loads((out / "report.json").read_text())


def expect_same(a, b, what):
    for name in FILES:
        if (a / name).read_bytes() != (b / name).read_bytes():
            fail(f"{what}: {name} differs")


def record_and_replay(root):
    first = capture(root / "a", "--source", "sim:desk", "--frames", "60", "--record", root / "all")
    again = capture(root / "b", "--source", f"euroc:{root}/all")
    if first["tracked"] < 50 or again["frames"] != 60:
        fail(f"tracked {first['tracked']} frames, replayed {again['frames']}")
    expect_same(root / "a", root / "b", "a recording of every frame")
    capture(root / "w", "--source", "sim:desk", "--frames", "60", "--backend", "window")
    capture(root / "v", "--source", f"euroc:{root}/all", "--backend", "window")
    expect_same(root / "w", root / "v", "the window on a recording")
    lens = ["--backend", "window", "--lens", "estimate"]
    capture(root / "wl", "--source", "sim:desk", "--frames", "60", *lens)
    capture(root / "vl", "--source", f"euroc:{root}/all", *lens)
    expect_same(root / "wl", root / "vl", "the window with its lens on a recording")
    result = subprocess.run([PROGRAM, *QUIET, "--source", "sim:desk", "--record", root / "all", "--out", root / "c"], text=True,
                            capture_output=True, check=False)
    if result.returncode != 2 or "recording already" not in result.stderr:
        fail(f"a recording was written over: {result.returncode} {result.stderr}")


def late_tracker(root):
    live = capture(root / "late", "--source", f"euroc:{root}/all", "--realtime", "--delay", "100", "--record", root / "some")["live"]
    print(live)
    if live["captured"] + live["camera"]["lost"] != 60 or live["passed_over"] < 20:
        fail(f"of 60 frames {live['captured']} were captured and {live['passed_over']} passed over")
    again = capture(root / "late again", "--source", f"euroc:{root}/some", "--as-recorded")
    if again["frames"] != live["captured"] - live["passed_over"]:
        fail(f"{again['frames']} frames were replayed")
    expect_same(root / "late", root / "late again", "a recording with frames that were passed over")
    every = capture(root / "every", "--source", f"euroc:{root}/all", "--realtime", "--every-frame", "--delay", "20")
    if every["live"]["passed_over"] != 0 or every["frames"] + every["live"]["camera"]["lost"] != 60:
        fail(f"--every-frame: {every['frames']} frames, {every['live']}")


def interrupted(root):
    words = [PROGRAM, *QUIET, "--source", f"euroc:{root}/all", "--realtime", "--record", root / "cut", "--out", root / "cut out"]
    table = root / "cut/mav0/cam0/data.csv"
    with subprocess.Popen([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and process.poll() is None:
            if table.is_file() and len(table.read_text().splitlines()) > 5:
                break
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        _, stderr = process.communicate(timeout=60)
    report = json.loads((root / "cut out/report.json").read_text())
    if process.returncode != 1 or "interrupted" not in stderr or "interrupted" not in report["ended_early"]:
        fail(f"interrupted: code {process.returncode}, '{stderr}'")
    rows = [line.split(",") for line in table.read_text().splitlines()[1:]]
    images = {path.name for path in (root / "cut/mav0/cam0/data").iterdir()}
    if not rows or images != {row[1] for row in rows}:
        fail(f"interrupted: {len(rows)} frames in the table, {len(images)} images")
    capture(root / "cut again", "--source", f"euroc:{root}/cut", "--as-recorded")
    expect_same(root / "cut out", root / "cut again", "an interrupted recording")


def main():
    if not PROGRAM.is_file():
        skip("pf-capture was not built")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        root = pathlib.Path(name)
        record_and_replay(root)
        late_tracker(root)
        interrupted(root)


main()
