"""tools/ray-sequence without POV-Ray: where the camera is, which ray a pixel has, what exposure and lamps do."""

import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402
import venv  # noqa: E402

venv.enter()
sys.path.insert(0, str(script.SOURCE / "tools" / "lib"))
import numpy as np  # noqa: E402
from scipy.spatial.transform import Rotation  # noqa: E402

from pf_eval.trajectories import read_trajectory  # noqa: E402
from ray import scenes, sensor  # noqa: E402
from ray.camera import MARGIN, Camera, pov_vectors, rows_of_strip  # noqa: E402
from ray.options import SCENES, arguments  # noqa: E402
from ray.path import Path, tum_rows  # noqa: E402

STILL = {"shake_deg": 0, "shake_m": 0, "bounce_m": 0}


class RaySequence(unittest.TestCase):
    def test_camera_should_look_where_the_path_says(self):
        p, R = Path([(0, 1, 2, 3, 0, 0), (9, 1, 2, 3, 0, 0)], **STILL).poses([4.0])
        np.testing.assert_allclose(p, [[1, 2, 3]], atol=1e-12)
        np.testing.assert_allclose(R[0].as_matrix(), np.transpose([[0, -1, 0], [0, 0, -1], [1, 0, 0]]), atol=1e-12)
        forward = Path([(0, 0, 0, 0, 90, 30), (9, 0, 0, 0, 90, 30)], **STILL).poses([4.0])[1][0].apply([0, 0, 1])
        np.testing.assert_allclose(forward, [0, np.cos(np.pi / 6), 0.5], atol=1e-12)

    def test_path_should_depend_on_its_seed_alone(self):
        keys = [(0, 0, 0, 1, 0, 0), (5, 3, 0, 1, 40, 0)]
        first, again, other = (Path(keys, seed).poses([2.0])[0] for seed in (1, 1, 2))
        self.assertTrue((first == again).all() and (first != other).any())

    def test_trajectory_should_be_read_by_pf_eval(self):
        times = np.arange(5) / 10
        p, R = Path([(0, 0, 0, 1, 0, 0), (1, 3, 0, 1, 90, 10)]).poses(times)
        with tempfile.TemporaryDirectory(prefix="planefold_") as name:
            file = pathlib.Path(name) / "groundtruth.tum"
            file.write_text(tum_rows(times, p, R))
            read = read_trajectory(file)
        np.testing.assert_allclose(read.p, p, atol=1e-8)
        np.testing.assert_allclose(read.rotations(), R.as_matrix(), atol=1e-7)

    def test_rays_should_be_those_of_the_calibration(self):
        camera, R = Camera(width=32, height=24, fov_deg=80), Rotation.from_rotvec([0.3, -0.2, 0.5])
        for first, rows in camera.strips(3):
            direction, right, up = pov_vectors(camera, R, first, rows, MARGIN, (0, 0))
            for u, v in ((0, first), (31, first + rows - 1), (10, first + 2)):
                x, y = (u + MARGIN + 0.5) / (32 + 2 * MARGIN), (v - first + MARGIN + 0.5) / (rows + 2 * MARGIN)  # POV-Ray's, in 0 to 1
                ray = R.apply([(u - camera.centre[0]) / camera.focal, (v - camera.centre[1]) / camera.focal, 1])
                np.testing.assert_allclose(direction + (x - 0.5) * right + (0.5 - y) * up, ray, atol=1e-12)

    def test_rows_should_be_moved_by_their_own_rotation(self):
        camera, turn = Camera(width=40, height=40, readout_s=0.03), 0.02
        light = np.tile(np.arange(40 + 2 * MARGIN, dtype=float), (20 + 2 * MARGIN, 1))
        R = Rotation.from_rotvec([[0, k * turn / 19, 0] for k in range(20)])
        rows = rows_of_strip(camera, light, 10, 20, Rotation.identity(), R)
        np.testing.assert_allclose(rows[0], light[MARGIN, MARGIN:-MARGIN], atol=1e-6)
        self.assertAlmostEqual(rows[19, 20] - rows[0, 20], camera.focal * turn, delta=0.01)

    def test_lamps_should_flicker_twice_in_a_period(self):
        t = np.linspace(1e-5, 0.02 + 1e-5, 200, endpoint=False)
        light = sensor.lamp_light(t, 0.001, 0.3)
        self.assertEqual(int((np.diff(np.sign(light - 1)) > 0).sum()), 2)  # dark to bright
        np.testing.assert_allclose(sensor.lamp_light(t, 0.01, 0.3), 1, atol=1e-12)  # a whole period of light

    def test_exposure_should_jump_one_frame_late_when_the_light_changes(self):
        exposure = sensor.Exposure(sensor.Sensor(auto_exposure=True, target=0.2))
        gains = [exposure.next(np.full((2, 2), level)) for level in (0.2, 0.21, 0.8, 0.8, 0.8)]
        np.testing.assert_allclose(gains, [1, 1, 1, 0.25, 0.25])

    def test_scenes_should_be_made_from_their_seed(self):
        self.assertEqual(list(SCENES), list(scenes.SCENES))
        for name in SCENES:
            first, again, other = (scenes.make(name, seed).text for seed in (1, 1, 2))
            self.assertTrue(first == again and first != other, name)
            keys = np.array(scenes.make(name, 1).keys)
            self.assertTrue((np.diff(keys[:, 0]) > 0).all() and keys.shape[1] == 6, name)

    def test_numbers_beyond_their_bounds_should_be_refused(self):
        with self.assertRaises(SystemExit) as refused:
            arguments(["desk", "x", "--readout", "0.5"])
        self.assertEqual(refused.exception.code, 2)


unittest.main()
