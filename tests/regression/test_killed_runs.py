"""pf-capture is ended by a signal at a random time, or by a full disk: its text files are whole and up to date, report.json too, and the
film plays.

SIGHUP left no report; killed runs left half rows, hundreds of rows late, and a film without an index. PLANEFOLD_KILLS says how many runs
(default 6); PLANEFOLD_SEED the seed."""

import json
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, cache, fail, skip, skip_in_cross_builds  # noqa: E402

PROGRAM = BIN / "pf-capture"
KILLS = int(os.environ.get("PLANEFOLD_KILLS", "6"))
SEED = int(os.environ.get("PLANEFOLD_SEED", "1"))
SOURCE = ["--source", "sim:desk", "--realtime", "--headless", "--quiet", "--start", "target", "--tracks", "--report-every", "0.5"]
COLUMNS = {"trajectory.txt": (" ", 8), "trajectory_all.txt": (" ", 8), "truth.tum": (" ", 8), "covariance.csv": (",", 37),
           "frames.csv": (",", 20), "tracks.csv": (",", 15), "planes.csv": (",", 10)}


def require(condition, message):
    if not condition:
        fail(message)


def whole_rows(path, separator, columns):
    text = path.read_text()
    require(text == "" or text.endswith("\n"), f"{path.name} ends in the middle of a row: ...{text[-80:]!r}")
    rows = [line.split(separator) for line in text.splitlines() if not line.startswith("#")]
    bad = [row for row in rows if len(row) != columns]
    require(not bad, f"{path.name}: rows without {columns} columns: {bad[:3]}")
    return rows


def check_texts(out, behind_s, longest_s):
    """behind_s: from when the table of frames was last seen to grow to the signal; longest_s: the longest time that it took between rows
    before, which on a busy machine may be long."""
    rows = {name: whole_rows(out / name, *form) for name, form in COLUMNS.items()}
    require(len(rows["covariance.csv"]) >= len(rows["trajectory.txt"]), "poses without a covariance")
    frames = len(rows["frames.csv"]) - 1
    require(frames >= 1 and abs(frames - len(rows["truth.tum"])) <= 1, f"{frames} frames and {len(rows['truth.tum'])} true poses")
    require(behind_s < 1.0 + longest_s, f"frames.csv is {behind_s:.2f} s behind")
    return frames


def check_film(path):
    ffprobe = shutil.which("ffprobe")
    if ffprobe is None or not path.exists():
        return 0
    command = [ffprobe, "-v", "error", "-count_frames", "-select_streams", "v:0", "-show_entries", "stream=nb_read_frames", "-of", "csv=p=0",
               path]
    result = subprocess.run([str(word) for word in command], text=True, capture_output=True, check=False)
    require(result.returncode == 0, f"the film does not play: {result.stderr}")
    count = result.stdout.strip().strip(",")
    return int(count) if count.isdigit() else 0  # N/A: killed before the first fragment


def is_running(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def kill_once(out, number, after_s, kill_film):
    command = [str(word) for word in [PROGRAM, *SOURCE, "--out", out]]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        table = out / "frames.csv"
        while process.poll() is None and not (table.is_file() and table.read_text().count("\n") > 3):
            time.sleep(0.01)
        until = time.monotonic() + after_s
        size, grown, longest = 0, time.monotonic(), 0.0
        while time.monotonic() < until:  # how far behind is the file?
            if table.stat().st_size != size:
                longest = max(longest, time.monotonic() - grown)
                size, grown = table.stat().st_size, time.monotonic()
            time.sleep(0.02)
        children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        for child in children if kill_film else []:  # as a power cut would
            os.kill(int(child), signal.SIGKILL)
        require(process.poll() is None, f"the run ended by itself: {process.stderr.read() if process.poll() is not None else ''}")
        behind = time.monotonic() - grown
        process.send_signal(number)
        _, stderr = process.communicate(timeout=60)
    name = signal.Signals(number).name
    frames = check_texts(out, behind, longest)
    reported = 0
    if number == signal.SIGKILL:
        if (out / "report.json").exists():
            report = json.loads((out / "report.json").read_text())
            require("killed" in report["ended_early"], f"after SIGKILL: {report['ended_early']}")
            reported = report["frames"]
        require(after_s < 0.8 or frames - reported < 40, f"report.json is {frames - reported} frames behind")
    else:
        report = json.loads((out / "report.json").read_text())
        require("interrupted after" in report["ended_early"] and process.returncode == 1, f"{name}: {report['ended_early']}, {stderr}")
        require(report["frames"] == frames, f"{name}: {report['frames']} frames in the report, {frames} in the table")
    deadline = time.monotonic() + 60  # ffmpeg finishes by itself
    while time.monotonic() < deadline and any(is_running(child) for child in children):
        time.sleep(0.05)
    played = check_film(out / "overlay.mp4")
    if number != signal.SIGKILL and shutil.which("ffprobe"):
        require(played == frames or kill_film, f"{name}: {played} of {frames} frames in the film")
    print(f"{name:8s} after {after_s:.2f} s{' with its ffmpeg' if kill_film else '':16s}: {frames} frames, {reported} in the last report, "
          f"{played} in the film", flush=True)


def full_disk(root):
    """A limit on the size of files stands for a full disk: the run ends, says so, and its rows are whole."""
    out = root / "full"
    limit = 60000
    command = [str(word) for word in [PROGRAM, *SOURCE, "--no-film", "--out", out]]
    begin = time.monotonic()
    result = subprocess.run(command, text=True, capture_output=True, check=False, timeout=60,
                            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
    took = time.monotonic() - begin
    require(result.returncode == 1 and "is the disk full" in result.stderr, f"a full disk: {result.returncode} {result.stderr}")
    rows = {name: whole_rows(out / name, *form) for name, form in COLUMNS.items()}
    require(len(rows["frames.csv"]) > 5, "nothing was written before the disk was full")
    require((out / "tracks.csv").stat().st_size > limit - 8000, "the limit was not reached")
    # tracks.csv grows by some 4 kB a frame, so the limit comes within a second of the first frame.
    require(took < 10, f"the run went on for {took:.1f} s")
    print(f"full disk: told after {took:.1f} s, {len(rows['frames.csv'])} rows in frames.csv; {result.stderr.strip()}")


def main():
    skip_in_cross_builds()
    if not PROGRAM.is_file():
        skip("pf-capture was not built")
    generator = random.Random(SEED)
    print(f"seed {SEED}", flush=True)
    slow = 3.0 if cache("PLANEFOLD_SANITIZE") else 1.0
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        root = pathlib.Path(name)
        for i in range(KILLS):
            number = (signal.SIGHUP, signal.SIGKILL, signal.SIGTERM)[i % 3]
            kill_once(root / f"run{i}", number, slow * generator.uniform(0.1, 3.0), number == signal.SIGKILL and i % 2 == 1)
            shutil.rmtree(root / f"run{i}")
        full_disk(root)


main()
