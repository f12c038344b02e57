"""pf-capture --imu: samples of a file reach the library in order with the frames, the report counts them, a recording holds them,
and replaying it pushes the same; poses depend on them only where their noise is known."""

import csv
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run, skip  # noqa: E402

PROGRAM = BIN / "pf-capture"
FREE = ["--headless", "--no-film", "--quiet"]
QUIET = [*FREE, "--start", "rectangle:0.20x0.14"]
FRAMES = 40
STEP_NS = 5_000_000
MISSING = range(100, 110)  # samples that are left out
SEED = 7


def capture(out, *arguments, start=QUIET):
    run(PROGRAM, *start, "--out", out, *arguments)
    return json.loads((out / "report.json").read_text())


def frame_times(out):
    return [round(1e9 * float(line.split(",")[0])) for line in (out / "frames.csv").read_text().splitlines()[1:]]


def recorded(folder):
    return (folder / "mav0/imu0/data.csv").read_text()


def rows_of(text):
    return [[float(word) for word in line.split(",")] for line in text.splitlines() if line[0] != "#"]


def write_samples(path, first_ns, last_ns):
    """Samples at 200 Hz, without those of MISSING. Gives their rows."""
    generator = random.Random(SEED)
    count = (last_ns - first_ns) // STEP_NS + 20
    rows = [[first_ns - 10 * STEP_NS + i * STEP_NS, *(generator.uniform(-1, 1) for _ in range(6))] for i in range(count) if i not in MISSING]
    path.write_text("#timestamp [ns],wx,wy,wz,ax,ay,az\n" + "".join(",".join(repr(word) for word in row) + "\n" for row in rows))
    return rows


def expect(condition, text):
    if not condition:
        fail(text)


def files_with_frames(root):
    plain = capture(root / "plain", "--source", "sim:desk", "--frames", FRAMES)
    expect("imu" not in plain and "imu" not in plain["ms_by_stage"], "a scene without samples reports an IMU")
    times = frame_times(root / "plain")
    rows = write_samples(root / "imu.csv", times[0], times[-1])
    before_the_end = [row for row in rows if row[0] <= times[-1]]
    with_imu = ["--imu", f"csv:{root}/imu.csv"]
    imu = capture(root / "a", "--source", "sim:desk", "--frames", FRAMES, *with_imu, "--record", root / "all")["imu"]
    print(imu)
    expect(imu["samples"] == len(before_the_end), f"{len(before_the_end)} samples lie before the last frame")
    expect(imu["gaps"] == 1 and imu["missing"] == len(MISSING), "the gap was not counted")
    expect(imu["late"] == 0 and imu["refused"] == 0, "samples came after their frame, or were refused")
    expect(abs(imu["interval_ms"]["max"] - 1e-6 * STEP_NS * (len(MISSING) + 1)) < 1e-6, "longest interval")
    expect(imu["used"] is False and imu["saturated"] is None, "what is not known is said to be known")
    for name in ("trajectory.txt", "covariance.csv", "map.ply"):
        expect((root / "plain" / name).read_bytes() == (root / "a" / name).read_bytes(), f"{name} depends on samples that are not used")
    expect(rows_of(recorded(root / "all")) == before_the_end, "the recording does not hold what was pushed")
    return times


def replay(root):
    again = capture(root / "b", "--source", f"euroc:{root}/all", "--record", root / "all again")["imu"]
    expect(recorded(root / "all again") == recorded(root / "all"), "a replay pushes other samples")
    expect("imu0" in again["source"] and again["late"] == 0, f"source of the replay: {again}")
    expect("imu" not in capture(root / "none", "--source", f"euroc:{root}/all", "--imu", "none", "--frames", "5"), "--imu none")


def late_tracker(root):
    """Frames are passed over; their samples are not."""
    late = capture(root / "late", "--source", f"euroc:{root}/all", "--realtime", "--delay", "100", "--record", root / "some")
    expect(late["live"]["passed_over"] >= 5, f"nothing was passed over: {late['live']}")
    again = capture(root / "late again", "--source", f"euroc:{root}/some", "--as-recorded", "--record", root / "some again")
    expect(recorded(root / "some again") == recorded(root / "some"), "a replay of what was tracked pushes other samples")
    expect(late["imu"]["late"] == 0 and late["imu"]["samples"] == again["imu"]["samples"], f"{late['imu']} {again['imu']}")
    times = frame_times(root / "late")
    expect(late["imu"]["samples"] == sum(row[0] <= times[-1] for row in rows_of(recorded(root / "all"))), "samples of frames that were passed over are lost")


def offset(root, times):
    """A unit whose clock is 2 s behind: with the offset the same samples come, on the camera's clock."""
    shifted = [[int(row[0]) - 2_000_000_000, *row[1:]] for row in rows_of(recorded(root / "all"))]
    (root / "behind.csv").write_text("".join(",".join(repr(word) for word in row) + "\n" for row in shifted))
    capture(root / "behind", "--source", "sim:desk", "--frames", FRAMES, "--imu", f"csv:{root}/behind.csv", "--imu-offset", "2",
            "--record", root / "shifted")
    expect(recorded(root / "shifted") == recorded(root / "all"), "--imu-offset")
    ahead = subprocess.run([str(word) for word in [PROGRAM, *QUIET, "--source", "sim:desk", "--frames", FRAMES, "--out", root / "ahead",
                                                   "--imu", f"csv:{root}/imu.csv", "--imu-offset", "1000"]],
                           text=True, capture_output=True, check=False)
    expect(ahead.returncode == 0 and "--imu-offset" in ahead.stderr, f"a clock that is far ahead: {ahead.stderr}")
    (root / "earlier.csv").write_text("".join(f"{i * STEP_NS},0,0,0,0,-9.81,0\n" for i in range(1, 400)))
    before = subprocess.run([str(word) for word in [PROGRAM, *QUIET, "--source", "sim:desk", "--frames", FRAMES, "--out", root / "before",
                                                    "--imu", f"csv:{root}/earlier.csv", "--imu-offset", "-1000"]],
                            text=True, capture_output=True, check=False)
    expect("earlier.csv: no sample between the first 30 frames" in before.stderr, f"samples before all frames: {before.stderr}")
    (root / "micro.csv").write_text("".join(f"{i * STEP_NS // 1000},0,0,0,0,-9.81,0\n" for i in range(1, 400)))
    micro = subprocess.run([str(word) for word in [PROGRAM, *QUIET, "--source", "sim:desk", "--frames", FRAMES, "--out", root / "micro",
                                                   "--imu", f"csv:{root}/micro.csv"]], text=True, capture_output=True, check=False)
    expect("micro.csv: in nanoseconds its samples come at" in micro.stderr and "taken as microseconds" in micro.stderr and
           "no sample between" not in micro.stderr, f"samples in microseconds: {micro.stderr}")
    expect(len(times) == FRAMES, f"{len(times)} frames")


def inertial(root):
    """A simulated unit from rest: metres and gravity with sigmas; a recording of it with its noise gives the same poses."""
    still = ["--source", "sim:room", "--rest", "1.5", "--frames", "100", "--imu", "sim"]
    report = capture(root / "vio", *still, "--record", root / "unit", start=FREE)
    imu = report["imu"]
    expect(imu["used"] is True and imu["start"] == "rest" and imu["metric"] is True, f"no start from rest: {imu}")
    with open(root / "vio" / "inertial.csv", newline="", encoding="ascii") as file:
        rows = list(csv.DictReader(file))
    expect(len(rows) == 100 and rows[0]["metric"] == "0", f"inertial.csv has {len(rows)} rows")
    expect([row["metric"] for row in rows].index("1") == imu["start_frame"], "inertial.csv becomes metric in another frame")
    for axis, value in zip("xyz", imu["gyro_bias"]["value"]):
        expect(abs(float(rows[-1][f"gyro_bias_{axis}"]) - value) < 1e-5, f"inertial.csv ends with another bias: {rows[-1]}")
    expect(float(rows[-1]["sigma_delay_s"]) < 0, "a delay that is not estimated has a sigma")
    expect(report["ms_by_stage"]["imu"] > 0, f"the samples take no time: {report['ms_by_stage']}")
    expect(30 <= imu["start_frame"] <= 45, f"at rest for 1.5 s, and metric from frame {imu['start_frame']} on")
    expect(abs(math.hypot(*imu["gravity_W"]["value"]) - 9.81) < 1e-3 and max(imu["gravity_W"]["sigma"]) < 0.1, f"{imu['gravity_W']}")
    for name, least in (("gyro_bias", 0), ("accel_bias", 0)):
        expect(len(imu[name]["value"]) == len(imu[name]["sigma"]) == 3 and min(imu[name]["sigma"]) > least, f"{name}: {imu[name]}")
    (root / "noise.yaml").write_text("gyro_noise_density: 1.7e-4\ngyro_random_walk: 2e-5\naccel_noise_density: 2e-3\naccel_random_walk: 3e-3\n")
    q, p = imu["mount"]["q_BC"], imu["mount"]["p_BC"]
    rows = [[*row, length] for row, length in zip(rotation_of(q), p)] + [[0, 0, 0, 1]]
    (root / "mount.yaml").write_text(f"T_imu_cam: {[number for row in rows for number in row]}\n")
    again = ["--source", f"euroc:{root}/unit", "--imu-noise", root / "noise.yaml", "--imu-mount", root / "mount.yaml", "--imu-exact", "mount,delay"]
    replayed = capture(root / "vio again", *again, start=FREE)["imu"]
    expect(replayed["start_frame"] == imu["start_frame"] and replayed["metric"], f"replay: {replayed}")
    apart = [abs(a - b) for one, two in zip(positions(root / "vio again"), positions(root / "vio"), strict=True) for a, b in zip(one, two)]
    expect(max(apart) < 1e-3, f"a replay gives other poses, by {max(apart)} m")
    left_out = capture(root / "not used", *again, "--no-inertial", "--frames", "30", start=FREE)["imu"]
    expect(left_out["used"] is False and "metric" not in left_out, f"--no-inertial: {left_out}")
    asked = subprocess.run([str(word) for word in [PROGRAM, *QUIET, "--source", f"euroc:{root}/unit", "--frames", "5", "--out", root / "asked"]],
                           text=True, capture_output=True, check=False)
    expect("--imu-noise" in asked.stderr, f"the noise is not asked for: {asked.stderr}")


def rotation_of(q):
    w, x, y, z = q
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


def positions(folder):
    text = sorted(folder.glob("trajectory*.txt"))[-1].read_text()
    return [[float(word) for word in line.split()[1:4]] for line in text.splitlines() if line[0] != "#"]


def refusals(root):
    bad = root / "bad.csv"
    for name, text, part in [("running back", "90000000,0,0,0,0,0,1\n9,0,0,0,0,0,1\n", "line 2"), ("not finite", "10,0,0,nan,0,0,1\n", "line 1"),
                             ("empty", "# nothing\n", "no sample")]:
        bad.write_text(text)
        result = subprocess.run([str(word) for word in [PROGRAM, *QUIET, "--source", "sim:desk", "--frames", 5, "--out", root / "bad",
                                                        "--imu", f"csv:{bad}"]], text=True, capture_output=True, check=False)
        expect(result.returncode == 2 and "bad.csv" in result.stderr and part in result.stderr, f"{name}: {result.returncode} {result.stderr}")
    # What no unit can have measured is refused by the library, and the rest goes on.
    bad.write_text("".join(f"{i},0,0,{0 if i != 3 else 5000},0,0,1\n" for i in range(1, 10)))
    report = capture(root / "absurd", "--source", "sim:desk", "--frames", "5", "--imu", f"csv:{bad}", "--imu-offset", "-1")
    expect(report["imu"]["samples"] == 8 and report["imu"]["refused"] == 1, f"absurd: {report['imu']}")
    for arguments, part in [(["--imu", "csv:x", "--imu-noise", "x", "--imu-exact", "mount"], "--imu-mount"),
                            (["--imu-noise", "x", "--imu-mount", "x", "--imu-exact", "delay", "--estimate", "delay"], "exclude each other"),
                            (["--imu-noise", "x", "--imu-mount", "x", "--imu-exact", "colour"], "mount, delay"),
                            (["--imu", "sim", "--imu-clock", "first-sample"], "--imu-clock"), (["--imu", "csv:x", "--imu-mount", "x"], "--imu-noise"),
                            (["--imu", "none", "--imu-noise", "x"], "--imu none"), (["--imu", "sim", "--imu-noise", "x", "--imu-mount", "x"], "--imu sim"),
                            (["--imu", "sim", "--realtime"], "--realtime"), (["--imu-noise", "x", "--imu-mount", "x"], "--imu"),
                            (["--rest", "-1"], "--rest"), (["--imu", "magic"], "csv:FILE"), (["--imu", "csv:"], "csv:FILE"), (["--imu-offset", "nan"], "--imu-offset"),
                            (["--imu-rate", "-5"], "--imu-rate")]:
        result = subprocess.run([str(word) for word in [PROGRAM, *QUIET, "--source", "sim:desk", *arguments]], text=True,
                                capture_output=True, check=False)
        expect(result.returncode == 2 and part in result.stderr, f"{arguments}: {result.returncode} {result.stderr}")


def main():
    if not PROGRAM.is_file():
        skip("pf-capture was not built")
    print("seed", SEED)
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        root = pathlib.Path(name)
        times = files_with_frames(root)
        replay(root)
        late_tracker(root)
        offset(root, times)
        inertial(root)
        refusals(root)


main()
