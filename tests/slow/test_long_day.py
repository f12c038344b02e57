"""A day of frames at full speed, and an hour with the window: resident memory, time per frame and the estimate stay as they were after the
first thousand frames.

A small map makes a day of 2,592,000 frames (30 per second) take some seven minutes of processor time. PLANEFOLD_DAY_FRAMES says how many
frames instead, and the hour is no longer than that; each writes about a kilobyte."""

import json
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, skip, skip_unless_plain_native_build  # noqa: E402
from small_camera import CALIBRATION, RATE  # noqa: E402

PROGRAM = BIN / "pf-capture"
FRAMES = int(os.environ.get("PLANEFOLD_DAY_FRAMES", "2592000"))
HOUR = 108000  # [frames]
FILLED = 10000  # [frames] what the pictures remember of a run is full: 8,192 places of the path, 4,096 columns of the time line
GROWTH = 1 << 20  # [bytes]
problems = []


def require(condition, message):
    if not condition:
        problems.append(message)


def resident_bytes(pid):
    """Anonymous pages alone: those of files on disk come and go with the system's memory."""
    for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("RssAnon:"):
            return 1024 * int(line.split()[1])
    return None


def frames_so_far(table):
    """By the time in the last whole row."""
    if not table.exists():
        return 0
    with open(table, "rb") as file:
        file.seek(max(0, table.stat().st_size - 400))
        lines = file.read().split(b"\n")[1:-1]
    return round(RATE * float(lines[-1].split(b",")[0])) if lines else 0


def rows(path, first, count):
    """count rows from about the share first of a file."""
    with open(path) as file:
        file.seek(int(first * path.stat().st_size))
        file.readline()
        lines = [file.readline() for _ in range(count)]
    return [line.strip().split(",") for line in lines if line.endswith("\n") and line.count(",")]


def is_positive(values):
    """Cholesky of a 6x6, scaled to a diagonal of ones."""
    if any(not values[7 * i] > 0 for i in range(6)):
        return False
    scale = [values[7 * i] ** 0.5 for i in range(6)]
    lower = [[0.0] * 6 for _ in range(6)]
    for i in range(6):
        for j in range(i + 1):
            rest = values[6 * i + j] / scale[i] / scale[j] - sum(lower[i][k] * lower[j][k] for k in range(j))
            if i == j:
                if not rest > 0:
                    return False
                lower[i][i] = rest ** 0.5
            else:
                lower[i][j] = rest / lower[j][j]
    return True


def run(frames, options):
    """One run of so many frames; what is wrong with it goes to problems."""
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        root = pathlib.Path(name)
        (root / "small.yaml").write_text(CALIBRATION)
        out = root / "out"
        command = [PROGRAM, "--source", "sim:desk", "--calib", root / "small.yaml", "--start", "target", "--loop", 570, "--frames", frames,
                   "--headless", "--no-film", "--quiet", "--report-every", 5, "--out", out, *options]
        seen = []
        with subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
            while process.poll() is None:
                try:
                    seen.append((frames_so_far(out / "frames.csv"), resident_bytes(process.pid)))
                except OSError:
                    break
                time.sleep(0.05)
            said, _ = process.communicate()
        if process.returncode != 0:
            fail(f"pf-capture ended with {process.returncode}: {said}")
        report = json.loads((out / "report.json").read_text())

        # The picture of the middle frame, which fetches fonts, once takes a few megabytes. That of the last frame takes some again, when
        # the table has all of its rows already.
        halves = [[size for done, size in seen if low < done / frames < high and done > FILLED and size]
                  for low, high in ((0.0, 0.49), (0.53, 0.99))]
        require(min(map(len, halves)) > 5, f"too short a run: {[len(half) for half in halves]} looks at its memory")
        growth = sum(half[-1] - half[0] for half in halves)
        require(growth < GROWTH, f"resident memory grew by {growth} bytes")

        table = out / "frames.csv"
        # The first tenth of the times: what else the machine does only makes frames slower.
        ms = [statistics.quantiles([float(row[7]) for row in rows(table, share, 5000)], n=10)[0] for share in (0.1, 0.45, 0.9)]
        require(max(ms) < 1.3 * min(ms), f"time per frame at a tenth, the middle and nine tenths of the day: {ms} ms")

        require(report["frames"] == frames and report["lost"] == 0 and report["losses"] == 0, f"lost {report['lost']} frames")
        require(report["tracked"] > 0.999 * frames, f"tracked {report['tracked']} of {frames} frames")
        unsound = [row[0] for share in (0.0, 0.25, 0.5, 0.75, 0.95) for row in rows(out / "covariance.csv", share, 500)
                   if len(row) != 37 or not is_positive([float(word) for word in row[1:]])]
        require(not unsound, f"covariances that are none, at {unsound[:5]} s")
        print(f"{frames} frames: resident {halves[0][0] / 2**20:.2f} MiB, grew by {growth / 2**10:.0f} KiB; {ms} ms per frame; tracked "
              f"{report['tracked']}; start {report['start']}; features {report['features']}", flush=True)


def main():
    skip_unless_plain_native_build()
    if not PROGRAM.is_file():
        skip("pf-capture was not built")
    need = 1200 * FRAMES
    if shutil.disk_usage(tempfile.gettempdir()).free < need:
        skip(f"{tempfile.gettempdir()} has less than {need / 1e9:.1f} GB free; TMPDIR names another folder")
    run(FRAMES, ["--max-features", 30, "--features-in-view", 16, "--max-state-dim", 110])
    run(min(FRAMES, HOUR), ["--backend", "window"])
    if problems:
        fail("\n  ".join(problems))


main()
