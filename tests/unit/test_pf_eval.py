"""pf-eval: known transforms are recovered, honest errors have an honest NEES, corners project, and mistakes get one line."""

import contextlib
import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

VENV = script.SOURCE / "build" / "venv"
if not (VENV / "bin" / "python").exists() or not list(VENV.glob("installed-*")):
    script.skip("build/venv is not there; the first run of pf-eval or tools/plot-run makes it")
if not os.path.samefile(sys.prefix, VENV):
    sys.exit(subprocess.run([VENV / "bin" / "python", *sys.argv]).returncode)

sys.path.insert(0, str(script.SOURCE / "tools" / "pf-eval"))
import numpy as np  # noqa: E402
from scipy.spatial.transform import Rotation  # noqa: E402

from pf_eval import Refused  # noqa: E402
from pf_eval.association import associate  # noqa: E402
from pf_eval.camera import Camera, read_camera  # noqa: E402
from pf_eval.corners import compare_corners, read_target  # noqa: E402
from pf_eval.errors import compare, default_alignment, nees  # noqa: E402
from pf_eval.files import Trajectory, read_run, read_tum  # noqa: E402
from pf_eval.main import main  # noqa: E402

SEED = 20240611
print(f"seed {SEED}", flush=True)


def wxyz(rotation):
    return rotation.as_quat()[:, [3, 0, 1, 2]]


def curve(count=200, rate=30.0):
    """A smooth hand-held path of a few decimetres."""
    t = np.arange(count) / rate
    p = np.stack([0.3 * np.sin(t), 0.2 * np.sin(1.7 * t + 0.5), 0.1 * np.cos(2.3 * t)], axis=1)
    turn = Rotation.from_rotvec(np.stack([0.3 * np.sin(0.9 * t), 0.4 * np.cos(t), 0.2 * t], axis=1))
    return Trajectory(t, p, wxyz(turn), source="curve")


def moved(trajectory, scale, turn, shift):
    """The same path in a world that is scaled, then turned, then shifted."""
    rotation = Rotation.from_quat(trajectory.q[:, [1, 2, 3, 0]])
    return Trajectory(trajectory.t, turn.apply(scale * trajectory.p) + shift, wxyz(turn * rotation), source="moved")


def write_tum(path, trajectory):
    rows = np.column_stack([trajectory.t, trajectory.p, trajectory.q[:, [1, 2, 3, 0]]])
    np.savetxt(path, rows, fmt="%.9f")


class Alignment(unittest.TestCase):
    def setUp(self):
        self.generator = np.random.default_rng(SEED)
        self.turn = Rotation.random(random_state=SEED)

    def test_sim3_should_recover_transform_when_run_is_scaled_turned_and_shifted(self):
        result = compare(moved(curve(), 0.4, self.turn, [1.0, -2.0, 3.0]), curve(), "sim3").summary
        self.assertAlmostEqual(result["scale"], 2.5, places=9)
        self.assertLess(result["ate_rmse_m"], 1e-9)
        self.assertLess(result["rot_rmse_deg"], 1e-5)
        self.assertLess(result["rpe_rmse_m"], 1e-9)
        self.assertEqual(result["pairs"], 200)
        self.assertIsNone(result["nees_position"])

    def test_se3_should_keep_the_scale_error_when_run_is_scaled(self):
        result = compare(moved(curve(), 0.9, self.turn, [0, 0, 1]), curve(), "se3").summary
        self.assertEqual(result["scale"], 1.0)
        spread = curve().p - curve().p.mean(axis=0)
        self.assertAlmostEqual(result["ate_rmse_m"], 0.1 * np.sqrt(np.mean(np.sum(spread ** 2, axis=1))), places=9)

    def test_none_should_report_shift_and_turn_when_run_is_off_by_them(self):
        turn = Rotation.from_rotvec([0, 0, np.radians(3)])
        about_end = moved(curve(), 1.0, turn, [0, 0, 0])
        about_end.p = curve().p + [0.03, 0, 0.04]
        result = compare(about_end, curve(), "none")
        self.assertAlmostEqual(result.summary["ate_rmse_m"], 0.05, places=9)
        self.assertAlmostEqual(result.summary["rot_rmse_deg"], 3.0, places=6)
        np.testing.assert_allclose(result.rotation_error, np.tile([0, 0, -np.radians(3)], (200, 1)), atol=1e-9)

    def test_noise_should_come_back_as_rmse_when_it_is_added(self):
        noisy = curve(2000)
        noisy.p = noisy.p + self.generator.normal(0, 0.01, noisy.p.shape)
        result = compare(noisy, curve(2000), "sim3").summary
        self.assertAlmostEqual(result["ate_rmse_m"], 0.01 * np.sqrt(3), delta=0.0005)
        self.assertAlmostEqual(result["rpe_rmse_m"], 0.01 * np.sqrt(6), delta=0.001)

    def test_alignment_should_be_refused_when_the_path_stands_still(self):
        still = curve()
        still.p = np.zeros_like(still.p)
        with self.assertRaises(Refused):
            compare(curve(), still, "sim3")

    def test_default_should_follow_the_start_of_the_report(self):
        self.assertEqual(default_alignment({"start": "target:a.yaml"}), "none")
        self.assertEqual(default_alignment({"start": "rectangle:0.2x0.1"}), "none")
        self.assertEqual(default_alignment({"start": "auto"}), "sim3")
        self.assertEqual(default_alignment({}), "sim3")


class Association(unittest.TestCase):
    def test_truth_should_be_interpolated_when_it_comes_more_often(self):
        frames = curve(60, 20.0)
        frames.t = frames.t + 0.001
        _, matched, how = associate(frames, curve(700, 200.0))
        self.assertEqual(how, "interpolated")
        expected = 0.3 * np.sin(frames.t)
        np.testing.assert_allclose(matched.p[:, 0], expected, atol=2e-6)

    def test_nearest_truth_should_be_taken_once_when_rates_agree(self):
        frames, truth = curve(30), curve(30)
        frames.t = frames.t + 0.004
        kept, matched, how = associate(frames, truth.select(np.arange(0, 30, 2)))
        self.assertEqual(how, "nearest")
        np.testing.assert_allclose(kept.t - matched.t, 0.004, atol=1e-12)
        self.assertEqual(len(kept), 15)

    def test_frames_should_be_left_out_when_truth_has_a_hole(self):
        truth = curve(700, 200.0)
        truth = truth.select(np.flatnonzero((truth.t < 0.5) | (truth.t > 1.5)))
        kept, _, _ = associate(curve(60, 20.0), truth)
        self.assertFalse(((kept.t > 0.51) & (kept.t < 1.49)).any())
        self.assertTrue((kept.t > 1.5).any())

    def test_no_overlap_should_be_refused(self):
        late = curve()
        late.t = late.t + 1000
        with self.assertRaises(Refused):
            associate(curve(), late)


class Consistency(unittest.TestCase):
    def setUp(self):
        self.generator = np.random.default_rng(SEED)
        root = self.generator.normal(size=(2000, 6, 6)) * [1, 1, 1, 2, 2, 2]
        self.covariance = 1e-5 * np.einsum("nij,nkj->nik", root, root) + 1e-8 * np.eye(6)

    def test_nees_should_be_near_its_dof_when_errors_are_drawn_from_the_covariance(self):
        truth = curve(2000)
        drawn = np.array([self.generator.multivariate_normal(np.zeros(6), P) for P in self.covariance])
        rotation = Rotation.from_quat(truth.q[:, [1, 2, 3, 0]])
        # R_true = Exp(theta) R_est and p_true = p_est + e
        run = Trajectory(truth.t, truth.p - drawn[:, 3:], wxyz(Rotation.from_rotvec(drawn[:, :3]).inv() * rotation),
                         self.covariance, source="drawn")
        result = compare(run, truth, "none").summary
        self.assertAlmostEqual(result["nees_pose"], 6.0, delta=4 * np.sqrt(12 / 2000))
        self.assertAlmostEqual(result["nees_position"], 3.0, delta=4 * np.sqrt(6 / 2000))
        self.assertEqual(result["nees_frames"], 2000)

    def test_nees_should_be_withheld_when_the_run_was_aligned_or_chose_its_own_frame(self):
        run = curve(50)
        run.covariance = self.covariance[:50]
        self.assertIsNone(compare(run, curve(50), "se3").summary["nees_position"])
        self.assertIsNone(compare(run, curve(50), "none", own_frame=False).summary["nees_position"])

    def test_nees_should_leave_out_a_singular_covariance(self):
        values = nees(np.ones((2, 3)), np.array([np.eye(3), np.zeros((3, 3))]))
        self.assertEqual(values[0], 3.0)
        self.assertTrue(np.isnan(values[1]))


class Corners(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        self.camera = Camera("division", 320, 240, (195.0, 195.0, 162.0, 125.0), [9e-6])
        (self.path / "target.yaml").write_text("width: 0.1832\nheight: 0.1295\n")
        self.run = Trajectory(np.arange(3) / 30, np.array([[0, 0, -0.6], [0.1, 0, -0.6], [0, 0.1, -0.7]]),
                              np.tile([1.0, 0, 0, 0], (3, 1)), source="run")
        self.target = read_target(self.path / "target.yaml")

    def tearDown(self):
        self.folder.cleanup()

    def write_corners(self, offset):
        with open(self.path / "corners.csv", "w") as file:
            file.write("#frame,t,corners\n")
            for i in range(3):
                pixels = self.camera.project(self.target - self.run.p[i]) + offset
                file.write(f"{i},{i / 30:.6f}," + ",".join(f"{value:.6f}" for value in pixels.ravel()) + "\n")
        return self.path / "corners.csv"

    def test_rectangle_should_be_upright_when_seen_from_the_front(self):
        pixels = self.camera.project(self.target - self.run.p[0])
        self.assertTrue((pixels[0] < pixels[2]).all())  # TL is left of and above BR
        self.assertGreater(pixels[1, 0], pixels[3, 0])

    def test_corners_should_have_no_error_when_the_pose_is_true(self):
        summary, rows = compare_corners(self.run, self.camera, self.target, self.write_corners([0, 0]))
        self.assertLess(summary["corner_rms_px"], 1e-5)
        self.assertEqual(summary["frames"], 3)
        self.assertEqual(len(rows), 3)

    def test_corner_rms_should_be_the_distance_when_corners_are_shifted(self):
        summary, _ = compare_corners(self.run, self.camera, self.target, self.write_corners([3, 4]))
        self.assertAlmostEqual(summary["corner_rms_px"], 5.0, places=5)
        self.assertAlmostEqual(summary["corner_max_px"], 5.0, places=5)
        self.assertAlmostEqual(summary["corner_bias_u_px"], -3.0, places=5)

    def test_corner_should_count_as_the_diagonal_when_behind_the_camera(self):
        corners = self.write_corners([0, 0])
        self.run.p[1, 2] = 0.6
        summary, _ = compare_corners(self.run, self.camera, self.target, corners)
        self.assertEqual(summary["corners_behind"], 4)
        self.assertEqual(summary["corner_max_px"], 400.0)

    def test_scenelib_features_should_give_the_same_corners_as_seen_by_a_turned_camera(self):
        (self.path / "features.yaml").write_text(
            "features: [[0.0916, 0.06475, 0], [-0.0916, 0.06475, 0], [0.0916, -0.06475, 0], [-0.0916, -0.06475, 0]]\n")
        turned = np.diag([-1.0, -1.0, 1.0])
        np.testing.assert_allclose(read_target(self.path / "features.yaml") @ turned, self.target, atol=1e-12)

    def test_models_should_match_hand_computed_pixels(self):
        p_C = np.array([[0.2, -0.1, 1.0]])
        radtan = Camera("radtan", 640, 480, (500.0, 510.0, 320.0, 240.0), [-0.3, 0.1, 0.001, -0.002])
        r2 = 0.05
        radial = 1 - 0.3 * r2 + 0.1 * r2 ** 2
        a = 0.2 * radial + 2 * 0.001 * 0.2 * -0.1 - 0.002 * (r2 + 2 * 0.04)
        b = -0.1 * radial + 0.001 * (r2 + 2 * 0.01) + 2 * -0.002 * 0.2 * -0.1
        np.testing.assert_allclose(radtan.project(p_C), [[500 * a + 320, 510 * b + 240]], atol=1e-9)
        fisheye = Camera("equidistant", 640, 480, (300.0, 300.0, 320.0, 240.0), [0.1, 0, 0, 0])
        theta = np.arctan(np.sqrt(r2))
        expected = 300 * theta * (1 + 0.1 * theta ** 2) / np.sqrt(r2) * np.array([0.2, -0.1]) + [320, 240]
        np.testing.assert_allclose(fisheye.project(p_C)[0], expected, atol=1e-9)

    def test_calibration_forms_should_agree(self):
        (self.path / "plain.yaml").write_text("width: 752\nheight: 480\nfx: 458.6\nfy: 457.2\ncx: 367.2\ncy: 248.3\n"
                                              "distortion_model: radtan\ndistortion: [-0.28, 0.07, 0.0002, 0.00002]\n")
        (self.path / "euroc.yaml").write_text("%YAML:1.0\nresolution: [752, 480]\nintrinsics: [458.6, 457.2, 367.2, 248.3]\n"
                                              "distortion_model: radial-tangential\n"
                                              "distortion_coefficients: [-0.28, 0.07, 0.0002, 0.00002]\n")
        (self.path / "kalibr.yaml").write_text("cam0:\n  resolution: [752, 480]\n  intrinsics: [458.6, 457.2, 367.2, 248.3]\n"
                                               "  distortion_model: radtan\n  distortion_coeffs: [-0.28, 0.07, 0.0002, 0.00002]\n")
        (self.path / "ros.yaml").write_text("image_width: 752\nimage_height: 480\ndistortion_model: plumb_bob\n"
                                            "camera_matrix: {rows: 3, cols: 3, data: [458.6, 0, 367.2, 0, 457.2, 248.3, 0, 0, 1]}\n"
                                            "distortion_coefficients: {data: [-0.28, 0.07, 0.0002, 0.00002, 0]}\n")
        pixels = [read_camera(self.path / f"{form}.yaml").project([[0.3, 0.2, 1.0]])
                  for form in ("plain", "euroc", "kalibr", "ros")]
        for other in pixels[1:]:
            np.testing.assert_array_equal(other, pixels[0])


class Command(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        write_tum(self.path / "trajectory.txt", curve())
        write_tum(self.path / "truth.tum", moved(curve(), 2.0, Rotation.identity(), [0, 0, 1]))

    def tearDown(self):
        self.folder.cleanup()

    def pf_eval(self, *words):
        """(exit code, output, errors)"""
        with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as err:
            code = main([str(word) for word in words])
        return code, out.getvalue(), err.getvalue()

    def test_json_should_have_the_agreed_names(self):
        code, out, err = self.pf_eval(self.path, "--truth", self.path / "truth.tum", "--json")
        self.assertEqual(code, 0, err)
        result = json.loads(out)
        for name in ("ate_rmse_m", "ate_max_m", "rpe_rmse_m", "rot_rmse_deg", "pairs", "scale", "path_m",
                     "nees_position", "nees_pose"):
            self.assertIn(name, result)
        self.assertAlmostEqual(result["scale"], 2.0, places=6)

    def test_table_should_be_printed_when_json_goes_to_a_file(self):
        _, out, _ = self.pf_eval(self.path, "--truth", self.path / "truth.tum", "--json", self.path / "eval.json")
        self.assertIn("position error, RMS", out)
        self.assertIn("ate_rmse_m", json.loads((self.path / "eval.json").read_text()))

    def test_mistakes_should_get_one_line_and_a_failing_exit(self):
        (self.path / "words.tum").write_text("0 a b c d e f g\n")
        (self.path / "empty.tum").write_text("# nothing\n")
        (self.path / "short.csv").write_text("0,0.0,1,2\n")
        (self.path / "target.yaml").write_text("width: 0.2\nheight: 0.1\n")
        (self.path / "late.tum").write_text("5000 0 0 0 0 0 0 1\n")
        (self.path / "nan.tum").write_text("0 nan 0 0 0 0 0 1\n")
        truth = self.path / "truth.tum"
        for words in ([self.path / "none", "--truth", truth], [self.path, "--truth", self.path / "none.tum"],
                      [self.path, "--truth", self.path / "words.tum"], [self.path, "--truth", self.path / "empty.tum"],
                      [self.path, "--truth", self.path / "late.tum"], [self.path, "--truth", self.path / "nan.tum"],
                      [self.path, "--truth", self.path],
                      [self.path, "--corners", self.path / "short.csv", "--target", self.path / "target.yaml"]):
            code, out, err = self.pf_eval(*words)
            self.assertEqual(code, 1, f"{words}: {out}")
            self.assertEqual(len(err.strip().splitlines()), 1, f"{words}: {err}")
            self.assertTrue(err.startswith("pf-eval: "), err)

    def test_covariance_should_be_matched_by_time(self):
        times = curve().t[::-1]
        rows = np.column_stack([times, np.tile(np.eye(6).ravel(), (200, 1)) * (1 + times[:, None])])
        np.savetxt(self.path / "covariance.csv", rows, delimiter=",", fmt="%.9f")
        run, _, _ = read_run(self.path)
        np.testing.assert_allclose(run.covariance[:, 0, 0], 1 + run.t, atol=1e-8)

    def test_trajectory_should_be_read_as_written(self):
        np.testing.assert_allclose(read_tum(self.path / "trajectory.txt").p, curve().p, atol=1e-8)


if __name__ == "__main__":
    unittest.main()
