"""pf-capture on a rendered scene: every file that it promises, and that they agree with each other."""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run, skip  # noqa: E402

PROGRAM = BIN / "pf-capture"
FRAMES = 75
NAMES = ["frames", "tracked", "lost", "resets", "start_frame", "start", "ms_per_frame", "ms_by_stage", "memory_bytes",
         "stack_bytes", "features", "features_in_view", "state_dim", "state_dim_points_only", "folding", "planes",
         "nis_per_dof"]


def rows(path):
    return [line.split() for line in path.read_text().splitlines() if not line.startswith("#")]


def require(condition, message):
    if not condition:
        fail(message)


def capture(out, *arguments, source="sim:desk"):
    run(PROGRAM, "--source", source, "--headless", "--quiet", "--out", out, *arguments)
    return json.loads((out / "report.json").read_text())


def check_planes(planes, vertices, faces):
    outlined = [plane for plane in planes if len(plane["outline"]) >= 3]
    require(outlined, "no plane was found")
    require(len(faces) == len(outlined), f"map.ply: {len(faces)} faces for {len(outlined)} outlines")
    for plane, face in zip(outlined, faces):
        require(all(key in plane for key in ("id", "normal", "distance", "sigma", "points", "area_m2")), f"a plane lacks a name: {plane}")
        require(abs(sum(x * x for x in plane["normal"]) - 1) < 1e-6, "a normal without unit length")
        require(plane["sigma"] > 0 and plane["area_m2"] > 0 and plane["points"] > 0, f"plane {plane}")
        require(int(face[0]) == len(plane["outline"]) == len(face) - 5 and int(face[-1]) == plane["id"], f"face {face}")
        edges = [sum((a - b) ** 2 for a, b in zip(*pair)) ** 0.5 for pair in zip(plane["outline"], plane["outline"][1:] + plane["outline"][:1])]
        require(min(edges) >= 0.001, f"an edge of {min(edges)} m")
        for index, corner in zip(face[1:-4], plane["outline"]):
            require(all(abs(float(a) - b) < 1e-6 for a, b in zip(vertices[int(index)], corner)), "a face's corner is not the outline's")
            off = sum(a * b for a, b in zip(plane["normal"], corner)) - plane["distance"]
            require(abs(off) < 1e-6, f"a corner lies {off} m off its plane")


def share_within_map(out):
    """Median over the points of map.ply of sigma within the map over sigma in W; each of them lies between 0 and 1."""
    header, body = (out / "map.ply").read_text().split("end_header\n")
    names = [line.split()[-1] for line in header.partition("element face")[0].splitlines() if line.startswith("property")]
    lines = [line.split() for line in body.splitlines()]
    count = int(header.split("element vertex ")[1].split()[0])
    corners = {int(word) for face in lines[count:] for word in face[1:1 + int(face[0])]}
    columns = names.index("sigma"), names.index("sigma_in_map")
    shares = [float(line[columns[1]]) / float(line[columns[0]]) for k, line in enumerate(lines[:count]) if k not in corners]
    require(all(0 <= share <= 1.00001 for share in shares), f"map.ply: sigma_in_map is not within sigma: {min(shares)}, {max(shares)}")
    return sorted(shares)[len(shares) // 2]


def check_folding(table, report):
    """report.json says what the rows of frames.csv add up to."""
    head = "t_s state attempts matches inliers features state_dim ms nis nis_dof planes folded trial fixed rows_points_only tracked".split()
    table = [dict(zip(head, row)) for row in table]
    require(int(table[-1]["folded"]) == report["features_in_map"]["folded"] and int(table[-1]["planes"]) == len(report["planes"])
            and int(table[-1]["rows_points_only"]) == report["state_dim_points_only"], f"the last row is {table[-1]}")
    folding = report["folding"]
    counted = [row for row in table[folding["from_frame"]:] if row["tracked"] == "1"]
    shares = [(int(row["folded"]) + int(row["fixed"])) / int(row["features"]) for row in counted]
    saved = [1 - int(row["state_dim"]) / int(row["rows_points_only"]) for row in counted]
    require(folding["frames"] == len(counted) > 0, f"{len(counted)} frames are to be counted, not {folding['frames']}")
    for name, values in (("share_folded", shares), ("share_rows_saved", saved)):
        mean = sum(values) / len(values)
        require(abs(folding[name] - mean) < 1e-4, f"{name} is {folding[name]}, and {mean} in frames.csv")


def check_files(out, report):
    for name in NAMES:
        require(name in report, f"report.json has no '{name}'")
    require(report["frames"] == FRAMES, f"{report['frames']} frames in the report")
    require(report["tracked"] >= FRAMES - 5, f"only {report['tracked']} of {FRAMES} frames were tracked")
    require(report["lost"] == 0, "the run was lost")
    states = report["frames_by_state"]
    require(sum(states.values()) == report["frames"], f"the states {states} are not {report['frames']} frames")
    table = [row[0].split(",") for row in rows(out / "frames.csv")[1:]]
    require(states["tracked"] == report["tracked"] == sum(int(row[15]) for row in table), f"frames.csv has another count than {states}")
    check_folding(table, report)
    trajectory = rows(out / "trajectory.txt")
    require(len(trajectory) == report["tracked"], f"{len(trajectory)} poses, {report['tracked']} tracked")
    require(all(len(row) == 8 for row in trajectory), "trajectory.txt: a row without 8 numbers")
    require(all(float(a[0]) < float(b[0]) for a, b in zip(trajectory, trajectory[1:])), "times do not grow")
    length = [sum(float(x) ** 2 for x in row[4:]) for row in trajectory]
    require(all(abs(x - 1) < 1e-6 for x in length), "a quaternion without unit length")
    require(len(rows(out / "trajectory_all.txt")) >= len(trajectory), "trajectory_all.txt is shorter")
    require(len(rows(out / "truth.tum")) == FRAMES, "truth.tum has not one row per frame")
    covariance = [row[0].split(",") for row in rows(out / "covariance.csv")]
    require([row[0] for row in covariance] == [row[0] for row in trajectory], "covariance.csv has other times")
    require(all(len(row) == 37 for row in covariance), "covariance.csv: a row without 37 numbers")
    require(all(float(row[1 + 7 * i]) > 0 for row in covariance for i in range(6)), "a variance that is not positive")
    ply = (out / "map.ply").read_text().split("end_header\n")
    count = int(ply[0].split("element vertex ")[1].split()[0])
    faces = int(ply[0].split("element face ")[1].split()[0])
    lines = ply[1].splitlines()
    require(count > 20 and count + faces == len(lines), f"map.ply: {count} points and {faces} faces in the header")
    check_planes(report["planes"], [line.split() for line in lines[:count]], [line.split() for line in lines[count:]])
    for name in ("overlay_mid.png", "overlay_last.png", "calib.yaml", "tracks.csv"):
        require((out / name).is_file(), f"{name} is missing")
    film = out / "overlay.mp4"
    if shutil.which("ffmpeg"):
        require(film.stat().st_size > 10000, "overlay.mp4 is missing or empty")


def check_lens(out, report):
    require(report["lens"]["estimate"] == "estimate", f"the lens is {report['lens']}")
    lens = [[float(number) for number in row[0].split(",")] for row in rows(out / "lens.csv")]
    require(len(lens) == report["tracked"] and all(len(row) == 10 for row in lens), f"lens.csv has {len(lens)} rows")
    for i, name in enumerate(("fx", "fy", "cx", "cy")):
        error, sigma = abs(lens[-1][1 + i] - report["lens"][name]), report["lens"]["sigma"][name]
        require(error < 1e-6 * report["lens"][name] and sigma > 0, f"{name}: {lens[-1]} and {report['lens']}")


def check_target_of_a_folder(root):
    """--start target takes target.yaml of the folder: the run is that of target:FILE, to the last digit."""
    file = root / "recorded" / "target.yaml"
    file.write_text("width: 0.21\nheight: 0.1485\n")
    beside, named = (capture(root / ("target_beside" if start == "target" else "target_named"), "--no-film", "--start", start, "--frames", "10", source=f"euroc:{root / 'recorded'}")
                     for start in ("target", f"target:{file}"))
    require(beside["start"] == "target" and beside["tracked"] > 5, f"a target beside the frames: {beside['tracked']} frames tracked")
    texts = [path.read_text() for path in sorted(root.glob("target_*/trajectory.txt"))]
    require(len(texts) == 2 and texts[0] == texts[1], "target.yaml of the folder gives another run than target:FILE")
    require("starts at the target" in beside["log"][0] and beside["log"][0].startswith("frame 0: "), f"the log: {beside['log'][:1]}")


def check_motion_noise(root):
    """A pose is less certain, the more its motion may change between frames. Both densities reach both back ends."""
    def variances(name, backend, *words):
        capture(root / name, "--no-film", "--start", "target", "--frames", "15", "--backend", backend, *words)
        last = [float(word) for word in rows(root / name / "covariance.csv")[-1][0].split(",")[1:]]
        return sum(last[7 * k] for k in range(3)), sum(last[7 * k] for k in range(3, 6))

    for backend in ("filter", "window"):
        turn, shift = variances(f"motion_{backend}", backend)
        turn_a, shift_a = variances(f"motion_{backend}_a", backend, "--motion-acceleration", "20")
        turn_b, shift_b = variances(f"motion_{backend}_b", backend, "--motion-angular-acceleration", "40")
        print(f"{backend}: sigmas over the default's: {(shift_a / shift) ** 0.5:.3f} with more acceleration, {(turn_b / turn) ** 0.5:.3f} with more of rotation")
        require(shift_a > shift and turn_b > turn, f"{backend}: motion noise does not reach the covariance: {shift_a / shift}, {turn_b / turn}")


def main():
    if not PROGRAM.is_file():
        skip("pf-capture was not built")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        root = pathlib.Path(name)
        report = capture(root / "a", "--start", "target", "--frames", str(FRAMES), "--tracks")
        check_files(root / "a", report)
        # The calibration that was written is read again, and gives the same run to the last digit.
        capture(root / "b", "--start", "target", "--frames", str(FRAMES), "--no-film", "--calib", root / "a" / "calib.yaml")
        for file in ("trajectory.txt", "covariance.csv", "map.ply"):
            require((root / "a" / file).read_bytes() == (root / "b" / file).read_bytes(), f"{file} differs in a second run")
        require(not (root / "b" / "overlay.mp4").exists(), "--no-film wrote a film")
        # A scene knows its lens, and its calibration says so; that of another calibration is estimated.
        require(report["lens"] is None and not (root / "a" / "lens.csv").exists(), "the lens of a scene was estimated")
        text = (root / "a" / "calib.yaml").read_text()
        (root / "calib.yaml").write_text("".join(line for line in text.splitlines(True) if not line.startswith("sigma_")))
        capture(root / "g", "--frames", "40", "--no-film", "--record", root / "recorded")
        check_lens(root / "f", capture(root / "f", "--no-film", "--calib", root / "calib.yaml", source=f"euroc:{root / 'recorded'}"))
        said = run(PROGRAM, "--help")
        for folder in ("a", "f"):
            for file in (path.name for path in (root / folder).iterdir() if not path.name.startswith(".")):
                require(file in said, f"{file} was written, and pf-capture --help does not name it")
        check_target_of_a_folder(root)
        check_motion_noise(root)
        # A target tells place, turn and scale; without, they are most of what is not known.
        capture(root / "e", "--frames", str(FRAMES), "--no-film")
        shares = share_within_map(root / "a"), share_within_map(root / "e")
        print(f"median share of sigma that is left within the map: {shares[0]:.3f} with a target, {shares[1]:.3f} without")
        require(shares[1] < 0.5 < shares[0], f"sigma_in_map over sigma: {shares}")
        # Without ffmpeg on the path there is a note, and no failure.
        words = [PROGRAM, "--source", "sim:desk", "--headless", "--quiet", "--frames", "20", "--start", "target", "--out", root / "c"]
        result = subprocess.run([str(word) for word in words], env={"PATH": str(root)}, text=True, capture_output=True, check=False)
        require(result.returncode == 0 and "ffmpeg" in result.stderr, f"without ffmpeg: {result.returncode} {result.stderr}")
        require((root / "c" / "overlay_last.png").is_file(), "without ffmpeg there is no picture")
        withdrawn = capture(root / "d", "--start", "target", "--frames", "20", "--withdraw-target-after", "5", "--skip", "3",
                            "--no-film")
        require(withdrawn["withdraw_target_after"] == 5, "the withdrawal is not in the report")


main()
