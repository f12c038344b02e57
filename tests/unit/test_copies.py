"""copies: each kind gives a sequence of its own with calibration, times and truth that belong together; the same command makes the same pixels;
compare-runs --copies counts what the runs show."""

import contextlib
import io
import json
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import venv  # noqa: E402

venv.enter()
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools" / "lib"))

import numpy as np  # noqa: E402
import yaml  # noqa: E402
from copies.main import main as copies_main  # noqa: E402
from copies.options import KINDS, arguments  # noqa: E402
from copies.pictures import CHANGES  # noqa: E402
from pf_eval.compare_runs import main as compare_runs  # noqa: E402
from PIL import Image  # noqa: E402
from scipy.spatial.transform import Rotation  # noqa: E402

WIDTH, HEIGHT, FRAMES, RATE = 64, 48, 12, 30
CAMERA = dict(camera_model="pinhole", width=WIDTH, height=HEIGHT, fx=50.0, fy=52.0, cx=30.0, cy=25.0, distortion_model="radtan",
              distortion=[-0.1, 0.01, 0.002, -0.003], rate_hz=RATE)
POINTS_W = np.array([[0.3, -0.2, 3.0], [-0.4, 0.3, 4.0], [0.2, 0.25, 2.5]])


def project(camera, T, point):
    """Pixel of a point in W by a row of a trajectory."""
    p = Rotation.from_quat(T[4:8]).inv().apply(point - T[1:4])
    x, y = p[0] / p[2], p[1] / p[2]
    k1, k2, p1, p2 = camera["distortion"]
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2 * r2
    u = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    v = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    return np.array([camera["fx"] * u + camera["cx"], camera["fy"] * v + camera["cy"]])


def read_rows(path):
    return np.array([[float(word) for word in line.split()] for line in path.read_text().splitlines()])


class Copies(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="planefold_")
        self.folder = pathlib.Path(self.temporary.name)
        self.addCleanup(self.temporary.cleanup)
        sequence = self.folder / "data" / "hall"
        (sequence / "images").mkdir(parents=True)
        draw = np.random.default_rng(1)
        self.pixels = draw.integers(60, 190, (FRAMES, HEIGHT, WIDTH)).astype(np.uint8)
        for k in range(FRAMES):
            Image.fromarray(self.pixels[k]).save(sequence / "images" / f"{k}.png")
        (sequence / "times.txt").write_text("".join(f"{k} {k / RATE:.6f} {k}.png\n" for k in range(FRAMES)))
        (sequence / "calib.yaml").write_text(yaml.safe_dump(CAMERA, default_flow_style=None))
        q = Rotation.from_rotvec([[0.02 * k, -0.03 * k, 0.01 * k] for k in range(FRAMES)]).as_quat()
        self.truth = np.array([[k / RATE, 0.02 * k, -0.01 * k, 0.03 * k, *q[k]] for k in range(FRAMES)])
        (sequence / "groundtruth.tum").write_text("\n".join(" ".join(f"{v:.12g}" for v in row) for row in self.truth) + "\n")

    def copy(self, *words, out="copies"):
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()) as errors:
            code = copies_main(arguments(["--data", str(self.folder / "data"), "--out", str(self.folder / out), "--quiet", *words]))
        return code, errors.getvalue()

    def read(self, kind, out="copies"):
        folder = self.folder / out / f"hall.{kind}"
        rows = [line.split() for line in (folder / "times.txt").read_text().splitlines()]
        images = [np.asarray(Image.open(folder / "images" / row[2])) for row in rows]
        return yaml.safe_load((folder / "calib.yaml").read_text()), [float(row[1]) for row in rows], images, read_rows(folder / "groundtruth.tum")

    def test_every_kind_should_be_a_whole_sequence_and_the_same_twice(self):
        for out in ("copies", "again"):
            self.assertEqual(self.copy("--all", out=out), (0, ""))
        for kind in KINDS:
            camera, times, images, truth = self.read(kind)
            self.assertEqual(images[0].shape, (camera["height"], camera["width"]), kind)
            self.assertTrue(all(a < b for a, b in zip(times, times[1:])), kind)
            self.assertTrue(set(np.round(times, 6)) <= set(np.round(truth[:, 0], 6)), kind)
            self.assertTrue(all((a == b).all() for a, b in zip(images, self.read(kind, "again")[2])), kind)
            if kind == "plain":
                self.assertTrue((np.array(images) == self.pixels).all())
            elif kind in CHANGES:
                self.assertFalse((np.array(images) == self.pixels).all(), kind)

    def test_what_is_fixed_in_the_picture_should_not_move(self):
        self.copy("--kinds", "body", "frame", "dust")
        for kind, rows in (("body", slice(HEIGHT - HEIGHT // 5 + 5, HEIGHT)), ("frame", slice(HEIGHT // 4, HEIGHT // 4 + 1))):
            images = np.array(self.read(kind)[2])[:, rows, WIDTH // 4:3 * WIDTH // 4]
            self.assertTrue((images == images[0]).all(), kind)

    def test_pixels_calibration_and_truth_should_belong_together(self):
        self.copy("--kinds", "mirrored", "turned", "half-size", "crop-around", "crop-above")
        for k in (0, 7):
            for point in POINTS_W:
                u, v = project(CAMERA, self.truth[k], point)
                expected = {"mirrored": (WIDTH - 1 - u, v), "turned": (WIDTH - 1 - u, HEIGHT - 1 - v),
                            "half-size": ((u + 0.5) / 2 - 0.5, (v + 0.5) / 2 - 0.5),
                            "crop-around": (u - round(0.075 * WIDTH), v - round(0.075 * HEIGHT)), "crop-above": (u, v - round(0.15 * HEIGHT))}
                for kind, pixel in expected.items():
                    camera, _, _, truth = self.read(kind)
                    there = point * [-1, 1, 1] if kind == "mirrored" else point  # the world that a mirror shows
                    np.testing.assert_allclose(project(camera, truth[k], there), pixel, atol=1e-6, err_msg=kind)
        self.assertTrue((self.read("mirrored")[2][3] == self.pixels[3][:, ::-1]).all())

    def test_frames_that_are_left_should_keep_their_times(self):
        self.copy("--kinds", "backwards", "rate-10", "third", "dropped-35")
        _, times, images, truth = self.read("backwards")
        self.assertTrue((np.array(images) == self.pixels[::-1]).all())
        np.testing.assert_allclose(truth[0, 1:], self.truth[-1, 1:])
        self.assertEqual(len(self.read("rate-10")[1]), 4)
        self.assertEqual(self.read("third")[0]["rate_hz"], 10)
        self.assertLess(len(self.read("dropped-35")[1]), FRAMES)

    def test_mistakes_should_get_one_line(self):
        code, said = self.copy("--only", "nowhere")
        self.assertEqual((code, said.count("\n")), (1, 1))
        self.assertIn("nowhere", said)
        other = self.folder / "copies" / "hall.plain"
        other.mkdir(parents=True)
        (other / "letter.txt").write_text("mine")
        code, said = self.copy("--kinds", "plain")
        self.assertEqual(code, 1)
        self.assertIn("hall.plain", said)
        self.assertTrue((other / "letter.txt").exists())

    def test_table_should_say_who_was_wrong_and_confident(self):
        self.copy("--kinds", "plain", "body")
        program = self.folder / "pf-capture"
        # Right on the plain copy; on the other it stands still, and is certain of that.
        program.write_text(f"""#!{sys.executable}
import json, pathlib, sys
value = lambda name: sys.argv[sys.argv.index(name) + 1]
out, source = pathlib.Path(value("--out")), pathlib.Path(value("--source").split(":")[1])
out.mkdir(exist_ok=True)
rows = (source / "groundtruth.tum").read_text().splitlines()
if source.name.endswith("body"):
    rows = [" ".join([row.split()[0], *rows[0].split()[1:4], *rows[0].split()[4:]]) for row in rows]
(out / "trajectory.txt").write_text("\\n".join(rows) + "\\n")
sigmas = ",".join(str(1e-6 if i % 7 == 0 else 0) for i in range(36))
(out / "covariance.csv").write_text("".join(row.split()[0] + "," + sigmas + "\\n" for row in rows))
(out / "report.json").write_text(json.dumps({{"frames": {FRAMES}, "tracked": {FRAMES} - 2 * source.name.endswith("body"), "lost": 0, "maps": [{{"map": 1, "trajectory": "trajectory.txt", "start_frame": 0, "tracked": 9}}]}}))
""")
        program.chmod(0o755)
        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
            code = compare_runs(["--copies", str(self.folder / "copies"), "--out", str(self.folder / "runs"), f"old={self.folder}"])
        self.assertEqual(code, 0)
        lines = {tuple(cell.strip() for cell in line.split("|")[1:3]): [cell.strip() for cell in line.split("|")[4:]] for line in out.getvalue().splitlines()}
        self.assertEqual(lines[("plain", "filter")][:5], ["100.0", "0 of 1", "1.00", "0", f"0 of {FRAMES - 1}"])
        self.assertEqual(lines[("body", "window")][:2], ["83.3", "1 of 1"])
        self.assertNotEqual(lines[("body", "window")][4].split()[0], "0")
        self.assertEqual(json.loads((self.folder / "runs" / "copies.json").read_text())[0]["failure"], "")


if __name__ == "__main__":
    unittest.main()
