"""What the pictures contradict stands in the last lines of pf-capture, and not in report.json alone: calibration, inertial unit, its delay, walls;
and a target in millimetres gets a note with what to type."""

import pathlib
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, skip, skip_in_cross_builds  # noqa: E402

QUIET = ["--headless", "--no-film", "--quiet"]
NOISE = "gyro_noise_density: 1.7e-4\ngyro_random_walk: 2e-5\naccel_noise_density: 2e-3\naccel_random_walk: 3e-3\n"
SIDE, HIGH, EYE, FAR = 12, 6, 1.6, 5  # of the street's fronts [m]
failures = []


def capture(name, *words):
    """(exit code, lines of stdout and stderr in their order)"""
    result = subprocess.run([str(word) for word in [BIN / "pf-capture", *QUIET, *words]], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                            timeout=120, check=False)
    print(f"{name}: {result.returncode}\n{result.stdout}", end="")
    return result.returncode, result.stdout.strip().splitlines()


def expect(name, said, *parts, last=True):
    """The last line (or one of the notes) has all parts."""
    lines = said[1][-1:] if last else [line for line in said[1] if line.startswith("pf-capture: note: ")]
    if not any(all(part in line for part in parts) for line in lines):
        failures.append(f"{name}: exit {said[0]}, {lines} without {parts}")


def expect_silence(name, said):
    if said[0] != 0 or "contradict" in "".join(said[1]):
        failures.append(f"{name}: exit {said[0]}, {said[1]}")


def calibrations(root):
    record = root / "recorded"
    capture("recording", "--source", "sim:desk", "--frames", 120, "--record", record, "--out", root / "out")
    right = re.sub("sigma_focal: .*", "sigma_focal: 0.01", (record / "mav0/cam0/sensor.yaml").read_text())
    for factor in (1.0, 0.85):
        file = root / "sensor.yaml"
        file.write_text(right.replace("[205, 205,", f"[{205 * factor}, {205 * factor},"))
        said = capture(f"focal length times {factor}", "--source", f"euroc:{record}", "--calib", file, "--out", root / "out")
        if factor == 1.0:
            expect_silence("the right calibration", said)
        else:
            expect(f"a focal length times {factor}", said, "contradict the calibration", f"{205 * factor:.5g} was found as", "pf-calibrate")


def targets(root):
    desk = ["--source", "sim:desk", "--frames", 20, "--out", root / "out"]
    for size, away, unit in (("200x140", "627", "millimetres"), ("20x14", "62.7", "centimetres")):
        expect(size, capture(size, *desk, "--start", f"rectangle:{size}"), f"puts the camera {away}", unit, "--start rectangle:0.2x0.14", last=False)
    (root / "target.yaml").write_text("width: 200\nheight: 140\n")
    expect("target.yaml", capture("a file", *desk, "--start", f"target:{root}/target.yaml"), "target.yaml", "write width: 0.2 and height: 0.14", last=False)
    said = capture("metres", *desk, "--start", "rectangle:0.2x0.14")
    if "metres" in "".join(said[1]):
        failures.append(f"a target in metres: {said[1]}")


def units(root):
    record = root / "unit"
    room = ["--source", "sim:room", "--rest", "1.5", "--frames", "300", "--imu", "sim"]
    soon = ["--frames", "120"]
    expect_silence("a good unit", capture("recording", *room, "--record", record, "--out", root / "out"))
    (root / "noise.yaml").write_text(NOISE)
    report = (root / "out" / "report.json").read_text()
    q, p = ([float(word) for word in re.search(rf'"{name}": \[([^]]*)\]', report)[1].split(",")] for name in ("q_BC", "p_BC"))
    w, x, y, z = q
    R = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
         [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    (root / "mount.yaml").write_text(f"T_imu_cam: {[*R[0], p[0], *R[1], p[1], *R[2], p[2], 0, 0, 0, 1]}\n")
    words = ["--source", f"euroc:{record}", "--imu-noise", root / "noise.yaml", "--imu-mount", root / "mount.yaml", "--out", root / "out"]
    rows = [line.split(",") for line in (record / "mav0/imu0/data.csv").read_text().splitlines() if line[0] != "#"]
    (root / "upside.csv").write_text("".join(",".join([*row[:4], *(str(-float(word)) for word in row[4:])]) + "\n" for row in rows))
    upside = [*words, "--imu", f"csv:{root}/upside.csv"]
    expect("accelerations of the other sign, exact clock", capture("upside down", *upside, "--imu-exact", "mount,delay", *soon),
           "inertial unit contradicts the pictures", "and was left out", "--imu-mount", "signs")
    expect("accelerations of the other sign", capture("upside down", *upside), "inertial unit", "opposite sign")
    (root / "degrees.csv").write_text("".join(",".join([row[0], *(str(57.29578 * float(word)) for word in row[1:4]), *row[4:]]) + "\n" for row in rows))
    expect("rates in degrees", capture("degrees", *words, "--imu", f"csv:{root}/degrees.csv"), "57", "degrees per second")
    (root / "g.csv").write_text("".join(",".join([*row[:4], *(str(float(word) / 9.80665) for word in row[4:])]) + "\n" for row in rows))
    expect("accelerations in g", capture("g", *words, "--imu", f"csv:{root}/g.csv"), "accelerometer reads", "is it in g")
    late = capture("late by 80 ms", *words, "--imu-exact", "delay", "--imu-offset", "0.08")
    expect("samples that are late", late, "contradict the inertial unit's times by -8", "type --imu-offset -0.0", last=False)


def walls(root):
    corners = [[x, EYE - y, FAR + 0.1] for x, y in ((-SIDE / 2, 0), (SIDE / 2, 0), (SIDE / 2, HIGH), (-SIDE / 2, HIGH))]
    (root / "plan.json").write_text(
        '{"planefold_walls": 1, "up": [0, -1, 0], "faces": [{"name": "north", "corners": %s, "sigma_rotation_deg": 0.2, "sigma_vertical_deg": 0.2, '
        '"sigma_offset_m": 0.01}]}' % corners)
    (root / "first.tum").write_text("0 0 0 0 0 0 0 1 0.003 0.1\n")
    said = capture("a wall that is elsewhere", "--source", "sim:street", "--walls", root / "plan.json", "--start", f"pose:{root}/first.tum", "--frames", 150,
                   "--out", root / "out")
    expect("a wall that is elsewhere", said, "--walls: the pictures contradict wall 'north'")
    (root / "plan.json").write_text((root / "plan.json").read_text().replace(str(corners), str([[1000 * x for x in corner] for corner in corners])))
    said = capture("a wall in millimetres", "--source", "sim:street", "--walls", root / "plan.json", "--start", f"pose:{root}/first.tum", "--frames", 20,
                   "--out", root / "out")
    expect("a wall in millimetres", said, "wall 'north' measures 13416 m across", "write them times 0.001", last=False)


def main():
    skip_in_cross_builds()
    if not (BIN / "pf-capture").is_file():
        skip("pf-capture was not built")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        for check in (calibrations, targets, units, walls):
            check(pathlib.Path(name))
    if failures:
        fail("\n  ".join([f"{len(failures)} found:", *failures]))


if __name__ == "__main__":
    main()
