"""pf-capture's live loop with everything on: capture, recorder and tracker in threads of their own, inertial samples, a tracker that
is too slow, and Ctrl-C in the middle. Nothing is said but that it was interrupted (a sanitizer would), the files are complete, and
the recording gives the same run again."""

import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, cache, fail, run, skip  # noqa: E402

PROGRAM = BIN / "pf-capture"
QUIET = ["--headless", "--no-film", "--quiet", "--start", "rectangle:0.20x0.14"]
FRAMES, RECORDED_BEFORE_THE_END = 60, 20


def expect(condition, text):
    if not condition:
        fail(text)


def pictures(folder):
    return len(list((folder / "mav0/cam0/data").glob("*.png")))


def write_samples(path, first_ns, last_ns):
    rows = (f"{t},0.1,-0.2,0.05,0,-9.81,0.1\n" for t in range(first_ns, last_ns + 20_000_000, 5_000_000))
    path.write_text("".join(rows))


def interrupted_run(root, name, *arguments):
    """Ctrl-C when some frames are recorded. Gives the report."""
    out, record = root / name / "out", root / name / "rec"
    command = [str(word) for word in [PROGRAM, *QUIET, "--source", f"euroc:{root}/scene", "--realtime", "--delay", 100,
                                      "--imu", f"csv:{root}/imu.csv", "--no-inertial", "--record", record, "--out", out, *arguments]]
    print("+", *command, flush=True)
    with subprocess.Popen(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        while process.poll() is None and pictures(record) < RECORDED_BEFORE_THE_END:
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate()
    print(said, end="")
    report = json.loads((out / "report.json").read_text())
    expect(process.returncode == 1, f"exit status {process.returncode}")
    expect(said == f"pf-capture: interrupted after {report['frames']} of {FRAMES} frames\n", "something else was said")
    expect(0 < report["frames"] < FRAMES and report["imu"]["samples"] > 0, "it ran to the end, or not at all")
    lines = len((out / "frames.csv").read_text().splitlines())
    expect(lines == report["frames"] + 1, f"frames.csv has {lines} lines")
    listed = len((record / "mav0/cam0/data.csv").read_text().splitlines()) - 1
    expect(listed == pictures(record) == report["live"]["captured"], f"{listed} of {pictures(record)} pictures are listed")
    return report


def main():
    if not PROGRAM.is_file():
        skip("pf-capture was not built")
    if cache("CMAKE_TOOLCHAIN_FILE"):
        skip("programs are run in native builds")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        root = pathlib.Path(name)
        run(PROGRAM, *QUIET, "--source", "sim:desk", "--frames", FRAMES, "--record", root / "scene", "--out", root / "first")
        times = [int(row.split(",")[0]) for row in (root / "scene/mav0/cam0/data.csv").read_text().splitlines()[1:]]
        write_samples(root / "imu.csv", times[0], times[-1])

        report = interrupted_run(root, "newest")
        expect(report["live"]["passed_over"] > 0, "no frame was passed over")
        run(PROGRAM, *QUIET, "--source", f"euroc:{root}/newest/rec", "--as-recorded", "--out", root / "again")
        for file in ("trajectory.txt", "covariance.csv"):
            expect((root / "again" / file).read_bytes() == (root / "newest/out" / file).read_bytes(), f"{file} of the replay differs")

        report = interrupted_run(root, "every", "--every-frame")
        expect(report["live"]["passed_over"] == 0, "--every-frame passed frames over")


main()
