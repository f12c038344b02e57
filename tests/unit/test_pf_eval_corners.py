"""pf-eval --corners: targets and calibrations are read, corners are projected and compared."""

import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import venv  # noqa: E402

venv.enter()
import numpy as np  # noqa: E402

from pf_eval import Refused  # noqa: E402
from pf_eval.camera import Camera, camera_of_run, read_camera  # noqa: E402
from pf_eval.corners import compare_corners, read_target  # noqa: E402
from pf_eval.trajectories import Trajectory  # noqa: E402


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

    def test_corners_should_have_no_error_when_each_pose_goes_with_the_lens_of_its_frame(self):
        (self.path / "calib.yaml").write_text(
            "camera_model: pinhole\nwidth: 320\nheight: 240\nfx: 195\nfy: 195\ncx: 162\ncy: 125\ndistortion_model: none\n")
        lens = [(200.0 + i, 201.0, 160.0, 120.0) for i in range(3)]
        (self.path / "lens.csv").write_text("# lens\n" + "".join(
            f"{i / 30:.6f},{','.join(map(str, numbers))},0,0,0,0,0\n" for i, numbers in enumerate(lens)))
        with open(self.path / "corners.csv", "w") as file:
            for i, numbers in enumerate(lens):
                pixels = Camera("none", 320, 240, numbers, []).project(self.target - self.run.p[i])
                file.write(f"{i},{i / 30:.6f}," + ",".join(f"{value:.6f}" for value in pixels.ravel()) + "\n")
        camera = camera_of_run({"lens": {"estimate": "estimate"}}, self.path, self.path / "calib.yaml")
        summary, _ = compare_corners(self.run, camera, self.target, self.path / "corners.csv")
        self.assertLess(summary["corner_rms_px"], 1e-5)
        camera = camera_of_run({"lens": None}, self.path, self.path / "calib.yaml")
        summary, _ = compare_corners(self.run, camera, self.target, self.path / "corners.csv")
        self.assertGreater(summary["corner_rms_px"], 1.0)

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
        for name, prefix in (("orb_slam3", "Camera1"), ("orb_slam", "Camera")):
            numbers = {"fx": 458.6, "fy": 457.2, "cx": 367.2, "cy": 248.3, "k1": -0.28, "k2": 0.07, "p1": 0.0002, "p2": 0.00002}
            (self.path / f"{name}.yaml").write_text("%YAML:1.0\nCamera.width: 752\nCamera.height: 480\n" +
                                                    "".join(f"{prefix}.{key}: {value}\n" for key, value in numbers.items()))
        pixels = [read_camera(self.path / f"{form}.yaml").project([[0.3, 0.2, 1.0]])
                  for form in ("plain", "euroc", "kalibr", "ros", "orb_slam3", "orb_slam")]
        for other in pixels[1:]:
            np.testing.assert_array_equal(other, pixels[0])

    def test_calibration_should_be_refused_when_a_field_changes_what_others_mean(self):
        opencv = ("%YAML:1.0\nimage_width: 640\nimage_height: 480\ncamera_matrix: {rows: 3, cols: 3, data: [300, 0, 320, 0, 300, 240, 0, 0, 1]}\n"
                  "distortion_coefficients: {data: [0.1, 0.01, 0, 0]}\n")
        (self.path / "fish.yaml").write_text(opencv + "fisheye_model: 1\n")
        self.assertEqual(read_camera(self.path / "fish.yaml").model, "equidistant")
        (self.path / "flat.yaml").write_text(opencv + "fisheye_model: 0\n")
        self.assertEqual(read_camera(self.path / "flat.yaml").model, "radtan")
        chain = "  resolution: [640, 480]\n  intrinsics: [300, 300, 320, 240]\n  distortion_model: radtan\n  distortion_coeffs: [0, 0, 0, 0]\n"
        for name, text in (("four coefficients", opencv), ("skew", opencv.replace("[300, 0,", "[300, 2,") + "fisheye_model: 0\n"),
                           ("cam0, cam1", "cam0:\n" + chain + "cam1:\n" + chain), ("camera_model", "cam0:\n  camera_model: omni\n" + chain),
                           ("behind", opencv.replace("0, 0]", "0, 0, 0, 0.2]")), ("binning_x", opencv + "distortion_model: plumb_bob\nbinning_x: 2\n")):
            (self.path / "c.yaml").write_text(text)
            with self.assertRaisesRegex(Refused, name):
                read_camera(self.path / "c.yaml")

    def test_unknown_layout_should_be_refused_with_the_known_ones(self):
        (self.path / "other.yaml").write_text("lens: 8 mm\n")
        with self.assertRaisesRegex(Refused, "other.yaml.*Kalibr.*EuRoC.*ROS.*ORB-SLAM3"):
            read_camera(self.path / "other.yaml")


if __name__ == "__main__":
    unittest.main()
