"""pf-capture: one clear line and the right exit code for everything that can be wrong, and complete files all the same."""

import json
import pathlib
import platform
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, skip, skip_in_cross_builds  # noqa: E402

PROGRAM = BIN / "pf-capture"
WIDTH, HEIGHT = 96, 64
CALIBRATION = f"""camera_model: pinhole
width: {WIDTH}
height: {HEIGHT}
fx: 80.0
fy: 80.0
cx: 48.0
cy: 32.0
distortion_model: none
distortion: []
rate_hz: 30
"""
SEED = 5
failures = []


def pgm(pixels, width=WIDTH, height=HEIGHT):
    return f"P5\n{width} {height}\n255\n".encode() + bytes(pixels)


def noise():
    generator = random.Random(SEED)
    return [generator.randrange(256) for _ in range(WIDTH * HEIGHT)]


def folder(root, name, images, times=None, calibration=CALIBRATION):
    """A sequence of images (bytes each), at 30 frames per second where times does not say otherwise."""
    path = root / name
    (path / "images").mkdir(parents=True)
    for i, image in enumerate(images):
        (path / "images" / f"{i:03d}.pgm").write_bytes(image)
    if times is None:
        times = "".join(f"{i} {i / 30:.6f} {i:03d}.pgm\n" for i in range(len(images)))
    (path / "times.txt").write_text(times)
    (path / "calib.yaml").write_text(calibration)
    return path


def capture(*arguments, quiet=True):
    words = [PROGRAM, *arguments] + (["--quiet", "--headless", "--no-film"] if quiet else [])
    return subprocess.run([str(word) for word in words], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          timeout=120, check=False)


def expect(name, code, parts, *arguments):
    """The program ends with code, and its last line on stderr has all the parts."""
    result = capture(*arguments)
    lines = result.stderr.strip().splitlines()
    last = lines[-1] if lines else ""
    wrong = [part for part in parts if part not in last]
    if result.returncode != code or wrong or not last.startswith("pf-capture: "):
        failures.append(f"{name}: code {result.returncode} (expected {code}), last line '{last}', without {wrong}")
    others = [line for line in lines[:-1] if not line.startswith("pf-capture: note: ")]
    if others:
        failures.append(f"{name}: more than one line: {others}")
    print(f"{name}: {result.returncode}: {last}")
    return result


def expect_complete_files(name, out):
    for file in ("report.json", "trajectory.txt", "trajectory_all.txt", "covariance.csv", "map.ply", "calib.yaml"):
        if not (out / file).is_file():
            failures.append(f"{name}: {file} is missing")
    return json.loads((out / "report.json").read_text())


def test_usage(root):
    good = folder(root, "good", [pgm(noise())] * 2)
    source = f"images:{good}"
    out = ["--out", root / "usage"]
    expect("no source", 2, ["--source", "--help"])
    expect("unknown option", 2, ["--nonsense"], "--source", source, "--nonsense", "1")
    expect("number", 2, ["--frames"], "--source", source, "--frames", "many")
    expect("anchor without room", 2, ["--anchor", "--max-anchors"], "--source", source, "--anchor", "5,9,9", "--max-anchors", 0)
    for option in ("--readout", "--report-every", "--delay", "--rest", "--rate", "--exposure", "--imu-rate", "--imu-offset", "--vertical"):
        expect(f"no number for {option}", 2, [f"{option}: 'nan' is not a number from"], "--source", source, option, "nan", *out)
    for option, low, high in (("--fix-sigma", "-0.001", "11"), ("--fold-sigma", "0", "11"), ("--plane-distance", "0", "11"), ("--plane-radius", "0", "1e5"),
                              ("--plane-roughness", "0", "2"), ("--jerk", "0", "1e6"),
                              ("--motion-acceleration", "0", "2e4"), ("--motion-angular-acceleration", "-1", "2e4")):
        for wrong in (low, high, "nan", "much"):
            expect(f"{option} {wrong}", 2, [option, wrong], "--source", source, option, wrong, *out)
    expect("points of a plane", 2, ["--plane-points", "'3'"], "--source", source, "--plane-points", "3", *out)
    expect("a threshold without planes", 2, ["--fold-sigma is for planes", "--no-planes"], "--source", source, "--no-planes", "--fold-sigma", "0.1", *out)
    expect("fixed in the window", 2, ["--backend window", "plane.fix_sigma"], "--source", source, "--backend", "window", "--fix-sigma", "0.01", *out)
    expect("no such motion", 2, ["--motion walk", "velocity or acceleration"], "--source", source, "--motion", "walk", *out)
    expect("jerk without acceleration", 2, ["--jerk is for --motion acceleration"], "--source", source, "--jerk", "1", *out)
    expect("noise of a velocity that is not kept", 2, ["--motion-acceleration is for --motion velocity", "--jerk"], "--source", source, "--motion", "acceleration",
           "--motion-acceleration", "2", *out)
    expect("acceleration in the window", 2, ["--backend window", "motion.model"], "--source", source, "--backend", "window", "--motion", "acceleration", *out)
    expect("acceleration with a unit", 2, ["--motion acceleration", "--no-inertial"], "--source", "sim:desk", "--imu", "sim", "--motion", "acceleration", "--frames", "2", *out)
    expect("every scene", 2, ["--every is for folders"], "--source", "sim:desk", "--every", "3", *out)
    expect("every none", 2, ["--every", "'0'"], "--source", source, "--every", "0", *out)
    for option in ("--calib", "--walls", "--second-pose", "--record", "--imu-noise", "--imu-mount"):
        expect(f"no name for {option}", 2, [option, "is empty"], "--source", source, option, "", *out)
    expect("zero frames", 2, ["--frames"], "--source", source, "--frames", "0")
    expect("windows of no frames", 2, ["--relative"], "--source", source, "--relative", "0")
    expect("source kind", 2, ["film:x", "images:"], "--source", "film:x")
    expect("libcamera without calibration", 1, ["libcamera:0", "--calib"], "--source", "libcamera:0")
    expect("format of libcamera", 2, ["--format", "RGB888"], "--source", "libcamera:0", "--format", "MJPEG")
    expect("format", 2, ["--format", "MJPEG"], "--source", "v4l2:/dev/video0", "--format", "RGB")
    expect("keyframes of the filter", 2, ["--window-keyframes", "--backend window"], "--source", source, "--window-keyframes", "4")
    expect("fixed keyframes of the filter", 2, ["--window-fixed", "--backend window"], "--source", source, "--window-fixed", "0")
    expect("rows of the window", 2, ["--max-state-dim", "--backend filter"], "--source", source, "--backend", "window", "--max-state-dim", "100")
    expect("observations of the window", 2, ["--max-observations", "--backend filter"], "--source", source, "--backend", "window",
           "--max-observations", "30")
    for words in (["--max-observations", "20"], ["--backend", "window", "--max-features", "60"]):
        expect(f"room for few features: {words}", 1, ["same picture"], "--source", source, *words, *out)
    expect("second pose of the filter", 2, ["--second-pose", "--backend window"], "--source", source, "--second-pose", "x.tum")
    expect("second pose with a target", 2, ["--second-pose", "target"], "--source", source, "--second-pose", "x.tum", "--start", "rectangle:0.2x0.1",
           "--backend", "window")
    expect("no second pose", 2, ["x.tum"], "--source", source, "--second-pose", "/nowhere/x.tum", "--backend", "window")
    expect("a second pose where the first one is", 1, ["--second-pose", "no scale"], "--source", source, "--second-pose",
           written(root, "same.tum", "1 0 0 0 0 0 0 1"), "--backend", "window", *out)
    expect("every frame of a folder", 2, ["--every-frame", "--realtime"], "--source", source, "--every-frame")
    expect("skip of a camera", 2, ["--skip"], "--source", "v4l2:/dev/video0", "--skip", "3")
    expect("no direction", 2, ["--gravity", "0,1,0"], "--source", source, "--gravity", "0,0,0")
    expect("half a direction", 2, ["--gravity"], "--source", source, "--gravity", "0,1")
    expect("a tap without a place", 2, ["--tap", "FRAME,U,V"], "--source", source, "--tap", "12")
    expect("an anchor without a place", 2, ["--anchor", "FRAME,U,V"], "--source", source, "--anchor", "12")
    expect("laps of a camera", 2, ["--loop"], "--source", "v4l2:/dev/video0", "--loop", "10")
    expect("laps of one image", 2, ["--loop"], "--source", source, "--loop", "1")
    expect("laps with an IMU", 2, ["--loop", "--imu"], "--source", source, "--loop", "10", "--imu", "csv:x")
    expect("cover of a camera", 2, ["--cover", "hand"], "--source", "v4l2:/dev/video0", "--cover", "1,2")
    for times in ("1", "2,1", "1,2,3", "-1,2", "nan,2"):
        expect(f"cover {times}", 2, ["--cover", "7,8"], "--source", source, f"--cover={times}", *out)
    expect("swing of a folder", 2, ["--swing", "sim:"], "--source", source, "--swing", "8,11,200", *out)
    for swing in ("8,11", "8,8.5,200", "11,8,200", "8,11,0", "8,11,1e9", "-1,3,200", "8,11,nan", "nan,11,200"):
        expect(f"swing {swing}", 2, ["--swing", "8,11,200"], "--source", "sim:desk", f"--swing={swing}", *out)
    expect("there and back of a camera", 2, ["--there-and-back", "cannot go back"], "--source", "v4l2:/dev/video0",
           "--there-and-back")
    expect("there and back at its pace", 2, ["--there-and-back"], "--source", source, "--there-and-back", "--realtime")
    expect("there and back with an IMU", 2, ["--there-and-back", "--imu"], "--source", source, "--there-and-back", "--imu",
           "csv:samples.csv")
    expect("there and back by rows", 1, ["--there-and-back", "--readout 0"], "--source", source, "--there-and-back",
           "--readout", "0.03", *out)
    expect("seed of images", 2, ["--seed", "sim:"], "--source", source, "--seed", "3")
    expect("seed of a camera", 2, ["--seed", "sim:"], "--source", "v4l2:/dev/video0", "--seed", "1")
    expect("offset of no samples", 2, ["--imu-offset", "--imu"], "--source", source, "--imu-offset", "0.01", *out)
    expect("offset of samples that are left alone", 2, ["--imu none", "--imu-offset"], "--source", source, "--imu", "none", "--imu-offset", "0.01")
    expect("rate of a file", 2, ["--imu-rate", "iio:"], "--source", source, "--imu", "csv:x", "--imu-rate", "200")
    expect("capture thread of a folder", 2, ["--capture-cpu", "--realtime"], "--source", source, "--capture-cpu", "0")
    for option in ("--cpu", "--capture-cpu"):
        expect(f"no such processor for {option}", 2, [f"{option} 987654", "no such processor", "there are 0"], "--source", source, "--realtime", option, "987654")
    expect("as recorded", 2, ["--as-recorded", "euroc:"], "--source", source, "--as-recorded")
    expect("back end", 2, ["--backend", "filter"], "--source", source, "--backend", "magic")
    expect("start", 2, ["--start"], "--source", source, "--start", "somehow")
    expect("target without a file", 2, ["target:FILE"], "--source", source, "--start", "target:", *out)
    expect("pose without a file", 2, ["pose:FILE"], "--source", source, "--start", "pose:", *out)
    expect("rate of images", 2, ["--rate", "rate_hz"], "--source", source, "--rate", "15", *out)
    expect("exposure of images", 2, ["--exposure", "cameras"], "--source", source, "--exposure", "1000", *out)
    expect("rectangle", 2, ["rectangle:", "metres"], "--source", source, "--start", "rectangle:big", *out)
    expect("half a pose", 2, ["half.tum", "one line"], "--source", source, "--start", f"pose:{written(root, 'half.tum', '0 1 2 3')}", *out)
    expect("a long quaternion", 2, ["long.tum", "length 1"], "--source", source, "--start",
           f"pose:{written(root, 'long.tum', '0 0 0 0 1 1 1 1')}", *out)
    expect("a pose that is no number", 2, ["nan.tum", "number 3"], "--source", source, "--start",
           f"pose:{written(root, 'nan.tum', '0 0 nan 0 0 0 0 1')}", *out)
    expect("two poses", 2, ["two.tum", "more than one"], "--source", source, "--start",
           f"pose:{written(root, 'two.tum', '0 0 0 0 0 0 0 1' + chr(10) + '1 0 0 0 0 0 0 1')}", *out)
    expect("no pose", 2, ["none.tum"], "--source", source, "--start", f"pose:{root}/none.tum", *out)
    expect("withdrawn", 2, ["--withdraw-target-after"], "--source", source, "--withdraw-target-after", "5")
    expect("lens", 2, ["--lens", "auto, exact, consider or estimate"], "--source", source, "--lens", "free", *out)
    expect("considered lens of the window", 2, ["--backend window"], "--source", "sim:desk", "--backend", "window", "--lens", "consider", *out)
    expect("mounting without samples", 2, ["--estimate", "--imu-noise"], "--source", source, "--estimate", "mount", *out)
    expect("timestamps", 2, ["--timestamps", "real or nominal"], "--source", source, "--timestamps", "counted", *out)
    expect("kernels", 2, ["--kernels"], "--source", source, "--kernels", "fast", *out)
    foreign = "avx2" if platform.machine() in ("aarch64", "armv7l") else "neon"
    expect("kernels of another processor", 2, ["--kernels", "--kernels auto"], "--source", source, "--kernels", foreign, *out)
    for option, low, high in (("--max-features", 8, 1000), ("--max-planes", 1, 64), ("--max-state-dim", 32, 2000), ("--max-observations", 8, 200),
                              ("--features-in-view", 8, 1000)):
        for number in (low - 1, high + 1, "many"):
            expect(f"{option} {number}", 2, [f"{option}: '{number}' is not a whole number from {low} to {high}"], "--source", source, option, number,
                   *out)
    expect("few points of the window", 2, ["--max-features 49", "at least 50"], "--source", source, "--backend", "window", "--max-features", "49", *out)
    expect("many features in view", 2, ["--features-in-view 201", "200"], "--source", source, "--features-in-view", "201", *out)
    expect("more in view than are measured", 2, ["--features-in-view 60", "50 of --max-observations"], "--source", source, "--features-in-view", "60",
           "--max-observations", "50", *out)
    expect("more in view than in the map", 2, ["--features-in-view 300", "200 points", "--max-features"], "--source", source, "--backend", "window",
           "--features-in-view", "300", "--max-features", "200", *out)
    expect("a typing error", 2, ["'--calb' is no option that is known here"], "--source", source, "--calb", "x.yaml")
    if "false" in capture("--help", quiet=False).stdout:
        failures.append("--help shows how a flag is stored")
    expect("skip", 2, ["--skip", "2 frames"], "--source", source, "--skip", "2", *out)
    if capture("--help", quiet=False).returncode != 0:
        failures.append("--help does not end with 0")


def written(root, name, text):
    (root / name).write_text(text)
    return root / name


def test_walls(root):
    source = f"images:{folder(root, 'good', [pgm(noise())] * 2)}"
    out = ["--out", root / "walls"]
    start = ["--start", f"pose:{written(root, 'pose.tum', '# as written by hand' + chr(10) + '0 0 0 0 0 0 0 1 0.01 1')}"]
    wall = {"name": "north", "from": [0, 4], "to": [6, 4], "base": 0, "height": 3, "seen_from": "right", "sigma_rotation_deg": 2,
            "sigma_vertical_deg": 1, "sigma_offset_m": 0.1}

    def refuse(name, code, parts, walls, *arguments, start=start):
        path = written(root, "plan.json", walls if isinstance(walls, str) else json.dumps({"planefold_walls": 1, "walls": walls}))
        expect(name, code, ["--walls", *parts], "--source", source, "--walls", path, *out, *start, *arguments)

    refuse("a field is missing", 2, ["plan.json", "wall 'north'", "'height'", "missing"], [{k: v for k, v in wall.items() if k != "height"}])
    refuse("a height of NaN", 2, ["plan.json", "wall 'north'", "'height'"], [wall | {"height": float("nan")}])
    refuse("a wall of no length", 2, ["plan.json", "wall 'north'", "'to'", "no length"], [wall | {"to": [0, 4]}])
    refuse("10,000 walls", 2, ["plan.json", "'walls'", "10000", "64"], [wall | {"name": f"wall {i}"} for i in range(10000)])
    refuse("no JSON", 2, ["plan.json"], "walls:")
    refuse("walls without a start in their frame", 2, ["--start pose:FILE", "q_WT"], [wall], start=[])
    refuse("walls without planes", 2, ["needs planes"], [wall], "--no-planes")
    refuse("too few planes", 2, ["'south'", "--max-planes"], [wall, wall | {"name": "south"}], "--max-planes", "1")
    corners = [[-1, -1, 3], [1, -1, 3], [1, 1, 3], [-1, 1, 3]]  # its front looks along z, as the camera does
    for behind, order in ((True, corners), (False, corners[::-1])):
        face = {"name": "board", "corners": order, "sigma_rotation_deg": 2, "sigma_vertical_deg": 2, "sigma_offset_m": 0.1}
        path = written(root, "plan.json", json.dumps({"planefold_walls": 1, "faces": [face]}))
        said = capture("--source", source, "--walls", path, *out, *start).stderr
        if ("wall 'board' from its back side" in said) != behind:
            failures.append(f"a wall whose back side is in view ({behind}): {said!r}")
    faces = [{"name": name, "corners": [[x, y, far] for x, y, _ in corners], "sigma_rotation_deg": 2, "sigma_vertical_deg": 2,
              "sigma_offset_m": 0.1} for name, far in (("board", 3), ("behind it", 5))]
    path = written(root, "plan.json", json.dumps({"planefold_walls": 1, "faces": faces}))
    said = capture("--source", source, "--walls", path, *out, *start).stderr
    if "wall 'board'" not in said or "behind it" in said:
        failures.append(f"one wall the wrong way round, and another behind it: {said!r}")
    for far, seen in ((-3, False), (3, True)):  # the first pose looks along z
        face = {"name": "board", "corners": [[x, y, far] for x, y, _ in corners[::-1]], "sigma_rotation_deg": 2, "sigma_vertical_deg": 2,
                "sigma_offset_m": 0.1}
        path = written(root, "plan.json", json.dumps({"planefold_walls": 1, "faces": [face]}))
        said = capture("--source", source, "--walls", path, *out, *start).stderr
        if ("sees no wall at the first pose" in said) == seen or said.count("--walls") > 1:
            failures.append(f"a plan whose wall is in view at the first pose ({seen}): {said!r}")
    expect("no such plan", 2, ["--walls", "none.json"], "--source", source, "--walls", root / "none.json", *start, *out)


def test_sources(root):
    out = ["--out", root / "sources"]
    expect("missing folder", 1, ["nowhere", "no such folder"], "--source", f"images:{root}/nowhere", *out)
    (root / "file").write_text("x")
    expect("file for a folder", 1, ["not a folder", "video:FILE"], "--source", f"images:{root}/file", *out)
    (root / "empty").mkdir()
    expect("no calibration", 1, ["calibration", "--calib"], "--source", f"images:{root}/empty", *out)
    (root / "empty" / "calib.yaml").write_text(CALIBRATION)
    expect("no image", 1, ["no PNG"], "--source", f"images:{root}/empty", *out)
    for layout, file, kind in (("TUM", "rgb.txt", "tum:"), ("EuRoC", "mav0/cam0/data.csv", "euroc:")):
        (root / layout / file).parent.mkdir(parents=True)
        (root / layout / file).write_text("# as downloaded\n")
        expect(f"images in the layout of {layout}", 1, [file.split("/", 1)[-1], f"write {kind}{root}/{layout}"], "--source",
               f"images:{root}/{layout}", *out)
    unit = ["--imu", f"csv:{written(root, 'imu.csv', '1,0,0,0,0,0,9.8')}", "--imu-mount", root / "none.yaml", "--imu-noise", root / "none.yaml"]
    expect("no noise", 2, ["none.yaml", "no such inertial noise file"], "--source", f"images:{folder(root, 'still', [pgm(noise())])}", *unit, *out)
    expect("tum", 1, ["rgb.txt"], "--source", f"tum:{root}/empty", *out)
    expect("euroc", 1, ["data.csv"], "--source", f"euroc:{root}", *out)
    frame = pgm(noise())
    for name, times, part in [("repeating times", "0 0.1 000.pgm\n1 0.1 001.pgm\n", "repeats"),
                              ("times running back", "0 0.1 000.pgm\n1 0.05 001.pgm\n", "runs back"),
                              ("no times", "0 soon 000.pgm\n", "not a time")]:
        path = folder(root, name, [frame, frame], times=times)
        expect(name, 1, ["times.txt", "line", part], "--source", f"images:{path}", *out)
    for name, old, new in [("absurd focal length", "fx: 80.0", "fx: 0.0"), ("missing width", "width: 96\n", ""),
                           ("NaN centre", "cx: 48.0", "cx: .nan")]:
        path = folder(root, name, [frame], calibration=CALIBRATION.replace(old, new))
        field = (old.split(":")[0])
        expect(name, 2, ["calib.yaml", f"'{field}'"], "--source", f"images:{path}", *out)
    path = folder(root, "target", [frame])
    (root / "nan.yaml").write_text("width: 0.2\nheight: .nan\n")
    expect("no target in the folder", 2, ["--start target", "target.yaml", "target:FILE"], "--source", f"images:{path}", "--start", "target", *out)
    expect("a scene without a target", 2, ["--start target", "target:FILE"], "--source", "sim:box", "--start", "target", *out)
    (path / "target.yaml").write_text("width: 0.2\nheight: .nan\n")
    expect("NaN in the folder's target", 2, ["target.yaml", "'height'"], "--source", f"images:{path}", "--start", "target", *out)
    expect("NaN in a target", 2, ["nan.yaml", "'height'"], "--source", f"images:{path}", "--start",
           f"target:{root}/nan.yaml", *out)
    expect("missing target", 2, ["none.yaml"], "--source", f"images:{path}", "--start", f"target:{root}/none.yaml", *out)
    expect("out is a file", 2, ["--out"], "--source", f"images:{path}", "--out", root / "file")
    expect("calibration given", 2, ["other.yaml"], "--source", f"images:{path}", "--calib", f"{root}/other.yaml", *out)


def test_cameras(root):
    out = ["--out", root / "cameras"]
    (root / "calib.yaml").write_text(CALIBRATION)
    calib = ["--calib", root / "calib.yaml"]
    expect("camera without calibration", 1, ["--calib"], "--source", "v4l2:/dev/video0", *out)
    expect("no such device", 1, ["/dev/video987", "--list"], "--source", "v4l2:/dev/video987", *calib, *out)
    expect("no camera at all", 1, ["/dev/null", "--list"], "--source", "v4l2:/dev/null", *calib, *out)
    expect("a file for a camera", 1, ["calib.yaml", "--list"], "--source", f"v4l2:{root}/calib.yaml", *calib, *out)
    expect("no such name", 1, ["nonesuch", "--list"], "--source", "v4l2:nonesuch", *calib, *out)
    if capture("--list", quiet=False).returncode != 0:
        failures.append("--list does not end with 0")


def test_unusable_images(root):
    """One of them does not end a run: it is left out, counted and named."""
    frame, other = pgm(noise()), pgm(list(reversed(noise())))
    cases = [("truncated image", frame[:-100], "ends after"), ("empty image", b"", "0 bytes"), ("no image at all", b"hello, world", "neither PNG"),
             ("missing image", None, "no such image"), ("single image of another size", pgm([0] * 64 * 64, 64, 64), "64 x 64 pixels among")]
    for name, bad, why in cases:
        path = folder(root, name, [frame, other, bad if bad is not None else frame, frame])
        if bad is None:
            (path / "images" / "002.pgm").unlink()
        out = root / (name + " out")
        result = capture("--source", f"images:{path}", "--out", out)
        named = [line for line in result.stderr.splitlines() if "left out" in line]
        if result.returncode != 0 or len(named) != 1 or not all(part in named[0] for part in ("frame 2", "002.pgm", why, "1 image was")):
            failures.append(f"{name}: code {result.returncode}, {result.stderr}")
        report = expect_complete_files(name, out)
        if report["frames"] != 3 or report["unusable"] != 1 or "002.pgm" not in report["unreadable"][0]:
            failures.append(f"{name}: the report says {report['frames']} frames, {report['unusable']} unusable, {report['unreadable']}")
        if not (out / "overlay_last.png").is_file():
            failures.append(f"{name}: no picture of the last frame")
    path = folder(root, "none usable", [b"", b"x"])
    expect("none usable", 1, ["none of the images can be used", "2 images were", "000.pgm"], "--source", f"images:{path}", "--out", root / "none")


def test_wrong_images(root):
    """Images of another type, and many of another size, are no damage but a mistake."""
    frame, other = pgm(noise()), pgm(list(reversed(noise())))
    small = pgm([0] * 64 * 64, 64, 64)
    path = folder(root, "wrong sizes", [frame, small, small, frame])
    expect("wrong sizes", 1, ["frame 1", "001.pgm", "64 x 64", "calib.yaml"], "--source", f"images:{path}", "--out", root / "wrong sizes out")
    cases = [("wrong type", f"P5\n{WIDTH} {HEIGHT}\n65535\n".encode() + bytes(2 * WIDTH * HEIGHT), ["002.pgm", "16 bits", "000.pgm"])]
    for name, bad, parts in cases:
        path = folder(root, name, [frame, other, bad, frame])
        out = root / (name + " out")
        expect(name, 1, ["frame 2", *parts], "--source", f"images:{path}", "--out", out)
        report = expect_complete_files(name, out)
        if report["frames"] != 2 or "002.pgm" not in report["ended_early"]:
            failures.append(f"{name}: the report says {report['frames']} frames, '{report['ended_early']}'")


def test_kinds_side_by_side(root):
    """Colour and depth in one folder were read in turns."""
    frame, depth = pgm(noise()), pgm([7] * WIDTH * HEIGHT)
    path = folder(root, "7-Scenes", [])
    (path / "times.txt").unlink()
    for i in range(4):
        (path / "images" / f"frame-{i:06d}.color.pgm").write_bytes(frame)
        (path / "images" / f"frame-{i:06d}.depth.pgm").write_bytes(depth)
        (path / "images" / f"frame-{i:06d}.pose.txt").write_text("1 0 0 0\n")
    out = root / "7-Scenes out"
    result = capture("--source", f"images:{path}", "--out", out)
    if json.loads((out / "report.json").read_text())["frames"] != 4 or "frame-#.color.pgm are taken" not in result.stderr:
        failures.append(f"colour and depth side by side: {result.stderr}")
    for i in range(4):
        (path / "images" / f"frame-{i:06d}.color.pgm").rename(path / "images" / f"frame-{i:06d}.b.pgm")
    expect("two kinds without a word for either", 1, ["side by side", "frame-#.b.pgm", "frame-#.depth.pgm"], "--source", f"images:{path}",
           "--out", root / "kinds")


def test_useless_images(root):
    count = 20
    cases = [("black", [pgm([0] * WIDTH * HEIGHT)] * count, ["usable"]),
             ("white", [pgm([255] * WIDTH * HEIGHT)] * count, ["usable"]),
             ("dark noise", [pgm([(i + k) % 2 for i in range(WIDTH * HEIGHT)]) for k in range(count)], ["usable"]),
             ("frozen", [pgm(noise())] * count, ["same picture"])]
    for name, images, parts in cases:
        path = folder(root, name, images)
        for start in ("auto", "rectangle:0.2x0.1"):
            out = root / (name + " out " + start[:4])
            expect(f"{name}, {start}", 1, [str(count), *parts], "--source", f"images:{path}", "--start", start, "--out", out)
            report = expect_complete_files(name, out)
            if report["frames"] != count or report["tracked"] != 0 and name != "frozen":
                failures.append(f"{name}: the report says {report['frames']} frames, {report['tracked']} tracked")


def main():
    skip_in_cross_builds()
    if not PROGRAM.is_file():
        skip("pf-capture was not built")
    print("seed", SEED)
    for test in (test_usage, test_walls, test_sources, test_cameras, test_unusable_images, test_wrong_images, test_kinds_side_by_side, test_useless_images):
        with tempfile.TemporaryDirectory(prefix="planefold_") as name:
            test(pathlib.Path(name))
    if failures:
        fail("\n  ".join([f"{len(failures)} found:", *failures]))


main()
