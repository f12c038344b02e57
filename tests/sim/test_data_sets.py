"""Data sets as they lie on disk after unpacking: each is tracked by one command, its truth is found and read, and the error comes with its coverage.
A recording of a built-in scene is laid out in the form of each."""

import contextlib
import io
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import venv  # noqa: E402
from script import BIN, fail, run, skip, skip_in_cross_builds  # noqa: E402

if not (BIN / "pf-capture").is_file():
    skip("pf-capture was not built")
venv.enter()
import numpy as np  # noqa: E402
from scipy.spatial.transform import Rotation  # noqa: E402

from pf_eval.main import main as pf_eval  # noqa: E402

FRAMES, RATE, SINCE = 90, 30, 1403636579
MOST_ATE = 0.02  # [m] after an alignment: the poses are those of the right frames
T_BC = np.eye(4)
T_BC[:3, :3], T_BC[:3, 3] = Rotation.from_euler("xyz", [0, 90, 10], degrees=True).as_matrix(), [0.05, -0.02, 0.01]
failures = []


class Recording:
    """Images, calibration and true poses of a scene."""

    def __init__(self, root):
        run(BIN / "pf-capture", "--headless", "--no-film", "--quiet", "--source", "sim:desk", "--frames", FRAMES, "--record", root / "scene", "--out", root / "out")
        camera = root / "scene" / "mav0" / "cam0"
        self.images = sorted((camera / "data").iterdir(), key=lambda path: int(path.stem))
        truth = np.loadtxt(root / "out" / "truth.tum")
        self.p, self.xyzw = truth[:, 1:4], truth[:, 4:8]
        self.T = np.tile(np.eye(4), (FRAMES, 1, 1))
        self.T[:, :3, :3], self.T[:, :3, 3] = Rotation.from_quat(self.xyzw).as_matrix(), self.p
        self.calibration = camera / "sensor.yaml"
        self.f, self.c = 205.0, (159.5, 119.5)

    def put_images(self, folder, name):
        folder.mkdir(parents=True, exist_ok=True)
        for k, image in enumerate(self.images):
            shutil.copy(image, folder / name(k))

    def tum(self, times):
        return "# timestamp tx ty tz qx qy qz qw\n" + "".join(
            f"{t:.6f} " + " ".join(f"{x:.7f}" for x in row) + "\n" for t, row in zip(times, np.hstack([self.p, self.xyzw])))


def stamps():
    return SINCE + np.arange(FRAMES) / RATE


def tum_rgbd(scene, folder):
    scene.put_images(folder / "rgb", lambda k: f"{stamps()[k]:.6f}.png")
    (folder / "rgb.txt").write_text("# color images\n# file: 'desk.bag'\n# timestamp filename\n" + "".join(f"{t:.6f} rgb/{t:.6f}.png\n" for t in stamps()))
    (folder / "depth.txt").write_text("# depth maps\n")
    (folder / "groundtruth.txt").write_text("# ground truth trajectory\n# file: 'desk.bag'\n" + scene.tum(stamps() + 0.002))
    return "tum:", folder / "groundtruth.txt"


def eth3d(scene, folder):
    source, truth = tum_rgbd(scene, folder)
    (folder / "calibration.txt").write_text(f"{scene.f} {scene.f} {scene.c[0]} {scene.c[1]}\n")
    (folder / "associated.txt").write_text("".join(f"{t:.6f} rgb/{t:.6f}.png {t:.6f} depth/{t:.6f}.png\n" for t in stamps()))
    return source, truth


def icl_nuim(scene, folder):
    scene.put_images(folder / "rgb", lambda k: f"{k}.png")
    (folder / "associations.txt").write_text("".join(f"{k} depth/{k}.png {k} rgb/{k}.png\n" for k in range(FRAMES)))
    (folder / "livingRoom1.gt.freiburg").write_text(scene.tum(range(FRAMES)).split("\n", 1)[1].replace(".000000 ", " "))
    return "tum:", folder / "livingRoom1.gt.freiburg"


def seven_scenes(scene, folder):
    scene.put_images(folder, lambda k: f"frame-{k:06d}.color.png")
    for k in range(FRAMES):
        shutil.copy(scene.images[0], folder / f"frame-{k:06d}.depth.png")
        (folder / f"frame-{k:06d}.pose.txt").write_text("".join("\t ".join(f"{x:.7e}" for x in row) + "\t \n" for row in scene.T[k]))
    (folder / "Thumbs.db").write_text("")
    return "images:", folder


def kitti(scene, folder):
    sequence = folder / "sequences" / "00"
    for camera in ("image_0", "image_1"):
        scene.put_images(sequence / camera, lambda k: f"{k:06d}.png")
    rows = [f"P{i}: {scene.f:.12e} 0 {scene.c[0]:.12e} {-scene.f * base:.12e} 0 {scene.f:.12e} {scene.c[1]:.12e} 0 0 0 1 0" for i, base in enumerate((0, 0.54, 0, 0.54))]
    (sequence / "calib.txt").write_text("\n".join(rows) + "\n")
    (sequence / "times.txt").write_text("".join(f"{k / RATE:.6e}\n" for k in range(FRAMES)))
    poses = folder / "poses"
    poses.mkdir()
    (poses / "00.txt").write_text("".join(" ".join(f"{x:.6e}" for x in T[:3].ravel()) + "\n" for T in scene.T))
    return "images:", poses / "00.txt", sequence


def kitti_colour(scene, folder):
    kitti(scene, folder)
    sequence = folder / "sequences" / "00"
    for grey, colour in (("image_0", "image_2"), ("image_1", "image_3")):
        (sequence / grey).rename(sequence / colour)
    return "images:", folder / "poses" / "00.txt", sequence


def tum_vi(scene, folder):
    ns = [round(1e9 * t) for t in stamps()]
    scene.put_images(folder / "mav0" / "cam0" / "data", lambda k: f"{ns[k]}.png")
    (folder / "mav0" / "cam0" / "data.csv").write_text("#timestamp [ns],filename\n" + "".join(f"{t},{t}.png\n" for t in ns))
    (folder / "mav0" / "mocap0").mkdir()
    body = scene.T @ np.linalg.inv(T_BC)
    q = Rotation.from_matrix(body[:, :3, :3]).as_quat()[:, [3, 0, 1, 2]]
    rows = "".join(f"{t}," + ",".join(f"{x:.9f}" for x in [*T[:3, 3], *wxyz]) + "\n" for t, T, wxyz in zip(ns, body, q))
    head = "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n"
    (folder / "mav0" / "mocap0" / "data.csv").write_text(head + rows)
    (folder / "dso").mkdir()
    matrix = "".join(f"  - {[float(x) for x in row]}\n" for row in np.linalg.inv(T_BC))
    (folder / "dso" / "camchain.yaml").write_text(
        f"cam0:\n  T_cam_imu:\n{matrix}  camera_model: pinhole\n  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]\n  distortion_model: radtan\n"
        f"  intrinsics: [{scene.f}, {scene.f}, {scene.c[0]}, {scene.c[1]}]\n  resolution: [320, 240]\n")
    return "euroc:", folder / "mav0" / "mocap0" / "data.csv"


def evaluate(name, words):
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as err:
        code = pf_eval([str(word) for word in [*words, "--json"]])
    if code != 0:
        failures.append(f"{name}: {err.getvalue()}")
        return {}
    print(err.getvalue(), end="")
    return json.loads(out.getvalue())


def check(scene, root, form, calibrated):
    name = form.__name__
    folder = root / name
    folder.mkdir()
    kind, truth, *below = form(scene, folder)
    out = root / f"{name} out"
    words = [] if calibrated else ["--calib", scene.calibration]
    result = subprocess.run([str(word) for word in [BIN / "pf-capture", "--headless", "--no-film", "--quiet", "--source", f"{kind}{below[0] if below else folder}",
                                                    "--out", out, *words]], text=True, capture_output=True, timeout=120, check=False)
    print(f"{name}: {result.returncode}\n{result.stderr}", end="")
    if result.returncode != 0:
        failures.append(f"{name}: {result.stderr}")
        return
    # found beside the images; given by name; and a run that is a trajectory alone
    for label, more in (("found", []), ("given", ["--truth", truth])):
        found = evaluate(f"{name}, truth {label}", [out, *more])
        if not found or found["ate_rmse_m"] > MOST_ATE or found["pairs"] < FRAMES - 5:
            failures.append(f"{name}, truth {label}: {found.get('ate_rmse_m')} m, {found.get('pairs')} pairs")
        elif not (0.9 < found["coverage"] <= 1 and 0 <= found["first_pose_s"] < 0.2):
            failures.append(f"{name}: coverage {found['coverage']}, first pose after {found['first_pose_s']} s")


def main():
    skip_in_cross_builds()
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        root = pathlib.Path(name)
        scene = Recording(root)
        for form, calibrated in ((tum_rgbd, False), (eth3d, True), (icl_nuim, False), (seven_scenes, False), (kitti, True), (kitti_colour, True), (tum_vi, True)):
            check(scene, root, form, calibrated)
    if failures:
        fail("\n  ".join([f"{len(failures)} found:", *failures]))


if __name__ == "__main__":
    main()
