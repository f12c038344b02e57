"""Wrong inputs of new users: each ends with a failing exit and a last line that says what to do, and nothing of theirs is changed or deleted."""

import hashlib
import json
import pathlib
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, skip, skip_in_cross_builds  # noqa: E402

WIDTH, HEIGHT = 64, 48
CALIBRATION = f"width: {WIDTH}\nheight: {HEIGHT}\nfx: 60\nfy: 60\ncx: 31.5\ncy: 23.5\ndistortion_model: none\nrate_hz: 30\n"
DIR = "mine"  # the user's folder, in which each case runs


def pgm(seed, width=WIDTH, height=HEIGHT):
    return f"P5\n{width} {height}\n255\n".encode() + random.Random(seed).randbytes(width * height)


def frames(form, count=4, **size):
    return {form.format(k): pgm(k, **size) for k in range(count)}


GOOD = {"calib.yaml": CALIBRATION, **frames("images/{:03d}.pgm")}
TIMES = "".join(f"{k} {k / 30:.6f} {k:03d}.pgm\n" for k in range(4))
TUM = {"rgb.txt": "# timestamp filename\n" + "".join(f"{k / 30:.6f} rgb/{k:03d}.pgm\n" for k in range(4)), "calib.yaml": CALIBRATION,
       **frames("rgb/{:03d}.pgm")}
EUROC = {"mav0/cam0/data.csv": "".join(f"{k * 33333333},{k:03d}.pgm\n" for k in range(4)), "mav0/cam0/sensor.yaml": CALIBRATION,
         **frames("mav0/cam0/data/{:03d}.pgm")}
HERE = ["--source", f"images:{DIR}"]
SCENE = ["--source", "sim:desk", "--frames", "5"]

# What the user did, the files, the words of pf-capture, and what the last line must say: what was met, and what to do.
CASES = [
    ("a film", {"walk.mp4": b"\0\0\0\x20ftypisom"}, ["--source", f"images:{DIR}/walk.mp4"], ["walk.mp4", "is a film; write video:"]),
    ("an archive", {"walk.zip": b"PK\3\4"}, ["--source", f"images:{DIR}/walk.zip"], ["walk.zip", "give the folder"]),
    ("a saved map and a start", {"room.pfmap": b"map"}, [*SCENE, "--map", f"{DIR}/room.pfmap", "--start", "target"],
     ["--map and --start", "leave one of them away"]),
    ("a file that is no saved map", {"room.pfmap": b"map"}, [*SCENE, "--map", f"{DIR}/room.pfmap"], ["room.pfmap", "no saved map"]),
    ("a map over a file of the user's", {"thesis.tex": "years"}, [*SCENE, "--save-map", f"{DIR}/thesis.tex"], ["thesis.tex", "no saved map; name another"]),
    ("a map into a folder that is not there", GOOD, [*SCENE, "--save-map", f"{DIR}/maps/room.pfmap"], ["maps/", "there is no folder"]),
    ("a folder for a saved map", GOOD, [*SCENE, "--map", DIR], [DIR, "is a folder"]),
    ("a saved map that is not there", GOOD, [*SCENE, "--map", f"{DIR}/rom.pfmap"], ["rom.pfmap", "check the path"]),
    ("the kind of a map that is not saved", GOOD, [*SCENE, "--map-kind", "continue"], ["--map-kind", "add --save-map FILE"]),
    ("the textbook filter in the window", GOOD, [*SCENE, "--plain-ekf", "--backend", "window"], ["--plain-ekf", "--backend filter"]),
    ("a scene that is misspelt", GOOD, ["--source", "sim:dsk"], ["'sim:dsk'", "desk, room"]),
    ("a source without its kind", GOOD, ["--source", DIR], [DIR, "images:"]),
    ("an unknown kind of source", GOOD, ["--source", f"folder:{DIR}"], ["folder:", "images:"]),
    ("a folder that is not there", GOOD, ["--source", "images:mime"], ["mime", "check the path"]),
    ("a folder without images", {"calib.yaml": CALIBRATION, "notes.txt": "later"}, HERE, ["PNG, JPEG or PGM", "check the path"]),
    ("images of an unknown format", {"calib.yaml": CALIBRATION, "000.bmp": b"BM", "001.bmp": b"BM"}, HERE, ["PNG, JPEG or PGM", "BMP", "mogrify -format png"]),
    ("no calibration", frames("{:03d}.pgm"), HERE, ["no calibration inside", "--calib FILE"]),
    ("a calibration of another size", {**GOOD, "calib.yaml": CALIBRATION.replace("64", "128").replace("48", "96")}, HERE,
     ["64 x 48", "128 x 96", "use the calibration of these images"]),
    ("a picture for a calibration", GOOD, [*HERE, "--calib", f"{DIR}/images/000.pgm"], ["000.pgm", "is not a YAML file"]),
    ("a phone's pictures", {"calib.yaml": CALIBRATION, "IMG_0001.HEIC": b"x", "IMG_0002.HEIC": b"x"}, HERE, ["HEIC", "mogrify -format png *.HEIC"]),
    ("settings for a calibration", {**GOOD, "vins.yaml": "imu: 1\ncam0_calib: \"cam0.yaml\"\n", "cam0.yaml": CALIBRATION}, [*HERE, "--calib", f"{DIR}/vins.yaml"],
     ["vins.yaml", "'cam0_calib'", f"give that: {DIR}/cam0.yaml"]),
    ("a calibration of a model that is not known", {**GOOD, "camera.txt": "FOV 0.9 1.2 0.5 0.5 0.93\n64 48\ncrop\n64 48\n"},
     [*HERE, "--calib", f"{DIR}/camera.txt"], ["camera.txt", "'FOV'", "RadTan"]),
    ("two cameras two folders down", {"calib.yaml": CALIBRATION, **frames("image_00/data/{:03d}.pgm"), **frames("image_01/data/{:03d}.pgm")}, HERE,
     ["image_00/data", f"--source images:{DIR}/image_00"]),
    ("times with decimal commas", {**GOOD, "times.txt": "0,00\n0,03\n0,07\n0,10\n"}, HERE, ["line 1", "'0,00'", "decimal points"]),
    ("two cameras in one folder", {"calib.yaml": CALIBRATION, **frames("left_{:03d}.pgm"), **frames("right_{:03d}.pgm")}, HERE,
     ["side by side", f"--source 'images:{DIR}/left_*.pgm'"]),
    ("two cameras in two folders", {"calib.yaml": CALIBRATION, **frames("left/{:03d}.pgm"), **frames("right/{:03d}.pgm")}, HERE,
     ["left/, right/", f"--source images:{DIR}/left"]),
    ("a TUM folder as images", TUM, HERE, ["rgb.txt", f"tum:{DIR}"]),
    ("an EuRoC folder as images", EUROC, HERE, ["cam0/data.csv", f"euroc:{DIR}"]),
    ("an EuRoC folder as TUM's", EUROC, ["--source", f"tum:{DIR}"], ["cam0/data.csv", f"write euroc:{DIR}"]),
    ("a TUM folder as EuRoC's", TUM, ["--source", f"euroc:{DIR}"], ["rgb.txt", f"write tum:{DIR}"]),
    ("a column of another program", {**GOOD, "times.txt": "time,name,gain\n0,000.pgm,2\n"}, HERE, ["times.txt", "'gain'", "known are time, name"]),
    ("fewer times than images", {**GOOD, "times.txt": "0\n0.033\n"}, HERE, ["2 times for 4 images", "as many of both"]),
    ("times in another order", {**GOOD, "times.txt": "0.1 000.pgm\n0.0 001.pgm\n"}, HERE, ["line 2", "runs back", "must grow"]),
    ("times of day", {**GOOD, "times.txt": "12:00:00 000.pgm\n12:00:01 001.pgm\n"}, HERE, ["line 1", "'12:00:00'", "seconds"]),
    ("the results into the images", GOOD, [*HERE, "--out", DIR], [DIR, "--out"]),
    ("the results among other files", {"thesis.tex": "years", **GOOD}, [*SCENE, "--out", DIR], [DIR, "--out"]),
    ("a size in words", GOOD, [*HERE, "--start", "rectangle:20cm"], ["rectangle:20cm", "metres", "rectangle:0.21x0.148"]),
    ("a calibration for a target", GOOD, [*HERE, "--start", f"target:{DIR}/calib.yaml"], ["calib.yaml", "width"]),
    ("an option of another program", GOOD, [*HERE, "--calibration", f"{DIR}/calib.yaml"], ["--calibration", "--help"]),
    ("more frames left out than there are", GOOD, [*HERE, "--skip", "99"], ["--skip 99", "4 frames"]),
    ("a table of ten columns for a unit", {**GOOD, "imu.csv": "1,2,3,4,5,6,7,8,9,10\n"}, HERE, ["imu.csv", "10 columns", "three rates"]),
    ("a phone's table of one sensor", {**GOOD, "imu.csv": "time,gyro_x,gyro_y,gyro_z\n0,1,2,3\n"}, HERE, ["imu.csv", "no accelerations", "csv:GYRO+ACCEL"]),
    ("a phone's table in turns", {**GOOD, "imu.csv": "t,gx [rpm],gy [rpm],gz [rpm],ax,ay,az\n0,1,2,3,4,5,6\n"}, HERE, ["'gx [rpm]'", "rad/s and deg/s"]),
    ("a logger that was started twice", {**GOOD, "imu.csv": "10.0,0,0,0,0,0,9.8\n10.1,0,0,0,0,0,9.8\n2.0,0,0,0,0,0,9.8\n"}, HERE,
     ["imu.csv line 3", "the time 2.0 (column 1) runs back by 8.1 s", "0.05 s"]),
    ("a unit's table without csv:", {**GOOD, "phone.csv": "0,0,0,0,0,0,9.8\n"}, [*HERE, "--imu", f"{DIR}/phone.csv"], [f"write csv:{DIR}/phone.csv"]),
    ("a phone's folder with one sensor", {**GOOD, "phone/Gyroscope.csv": "time,x,y,z\n0,1,2,3\n"}, [*HERE, "--imu", f"csv:{DIR}/phone"],
     ["phone", "Accelerometer.csv"]),
    ("a drawing for walls", {**GOOD, "plan.dxf": "0\nSECTION\n"}, [*HERE, "--walls", f"{DIR}/plan.dxf", "--start", "pose:x"], ["plan.dxf"]),
    ("another program's trajectory for a first pose", {**GOOD, "poses.txt": "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"},
     [*HERE, "--start", f"pose:{DIR}/poses.txt"], ["poses.txt", "more than one pose"]),
]


def contents(folder):
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(folder.rglob("*")) if path.is_file()}


def try_case(root, name, files, words, parts):
    """What is wrong with the answer; empty: nothing."""
    work = root / name.replace(" ", "_")
    for file, content in files.items():
        path = work / DIR / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    before = contents(work / DIR)
    out = [] if "--out" in words else ["--out", "out"]
    result = subprocess.run([BIN / "pf-capture", "--headless", "--no-film", "--quiet", *words, *out], cwd=work, text=True, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, timeout=60, check=False)
    lines = result.stderr.strip().splitlines()
    last = lines[-1] if lines else ""
    print(f"{name}: {result.returncode}: {last}")
    missing = [part for part in parts if part not in last]
    if result.returncode <= 0 or missing or not last.startswith("pf-capture: "):
        return f"{name}: exit {result.returncode}, '{last}' without {missing}"
    if any(not line.startswith("pf-capture: note: ") for line in lines[:-1]):
        return f"{name}: more than one line: {lines}"
    if contents(work / DIR) != before:
        return f"{name}: files were changed: {json.dumps(sorted(set(before) ^ set(contents(work / DIR))))}"
    return ""


def main():
    skip_in_cross_builds()
    if not (BIN / "pf-capture").is_file():
        skip("pf-capture was not built")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        failures = [wrong for case in CASES if (wrong := try_case(pathlib.Path(name), *case))]
    if failures:
        fail("\n  ".join([f"{len(failures)} found:", *failures]))


if __name__ == "__main__":
    main()
