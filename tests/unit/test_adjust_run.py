"""tools/adjust-run: the adjustment of all frames finds poses and lens that made the pixels, its Jacobians are those of differences, and a
run without tracks gets one line."""

import dataclasses
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402
import venv  # noqa: E402

venv.enter()
import numpy as np  # noqa: E402
from scipy.spatial.transform import Rotation  # noqa: E402

from pf_eval.adjust_run import adjust, jacobians, make_problem, rays, residuals, with_lens  # noqa: E402
from pf_eval.camera import Camera, EstimatedCamera  # noqa: E402
from pf_eval.errors import compare  # noqa: E402
from pf_eval.trajectories import Trajectory  # noqa: E402

FRAMES, POINTS, SEED = 25, 120, 5
CAMERA = Camera("none", 640, 480, (500.0, 500.0, 320.0, 240.0), [])


def walk(random, pose_noise, pixel_noise, seen_by=CAMERA):
    """(true trajectory, one that is off, times, tracks as tracks.csv has them) past points 2 to 5 m away."""
    t = np.arange(FRAMES) / 30
    p = np.column_stack([0.04 * np.arange(FRAMES), 0.1 * np.sin(np.arange(FRAMES) / 4), np.zeros(FRAMES)])
    turn = Rotation.from_rotvec(0.02 * random.normal(size=(FRAMES, 3)))
    X = np.column_stack([random.uniform(-1.5, 2.5, POINTS), random.uniform(-1.2, 1.2, POINTS), random.uniform(2, 5, POINTS)])
    rows = {"frame": [], "id": [], "status": [], "measured_u": [], "measured_v": []}
    for i in range(FRAMES):
        pixels = seen_by.project((X - p[i]) @ turn[i].as_matrix())
        for j in np.flatnonzero(((pixels > 0) & (pixels < [640, 480])).all(axis=1)):
            u, v = pixels[j] + pixel_noise * random.normal(size=2)
            for name, value in zip(rows, (i, j, "inlier", u, v)):
                rows[name].append(value)
    wrong = Rotation.from_rotvec(pose_noise * random.normal(size=(FRAMES, 3))) * turn
    off = p + pose_noise * random.normal(size=(FRAMES, 3))
    trajectories = [Trajectory(t, at, q.as_quat()[:, [3, 0, 1, 2]], source="walk") for at, q in ((p, turn), (off, wrong))]
    return *trajectories, dict(enumerate(t)), {name: np.array(column) for name, column in rows.items()}


def positions(problem, trajectory):
    q = Rotation.from_matrix(problem.R).as_quat()[:, [3, 0, 1, 2]]
    return Trajectory(trajectory.t, problem.p, q, source="adjusted")


class AdjustRun(unittest.TestCase):
    def setUp(self):
        print(f"seed {SEED}")
        self.random = np.random.default_rng(SEED)

    def test_adjustment_should_find_the_poses_that_made_the_pixels(self):
        true, off, times, tracks = walk(self.random, pose_noise=0.01, pixel_noise=0.3)
        gross = self.random.random(len(tracks["id"])) < 0.02
        tracks["measured_u"][gross] += 40
        problem = make_problem(off, times, tracks, CAMERA)
        adjusted, _ = adjust(problem, CAMERA, free_lens=False, rounds=40)
        error = compare(positions(adjusted, off), true, "sim3").summary["ate_rmse_m"]
        self.assertLess(error, 0.003)
        self.assertGreater(compare(off, true, "sim3").summary["ate_rmse_m"], 0.01)
        self.assertLess(np.median(np.linalg.norm(residuals(adjusted, CAMERA), axis=1)), 0.5)

    def test_free_lens_should_come_to_the_one_that_made_the_pixels(self):
        true, off, times, tracks = walk(self.random, pose_noise=0.005, pixel_noise=0.1, seen_by=with_lens(CAMERA, np.array([0.01, -0.05])))
        problem = make_problem(off, times, tracks, CAMERA)
        adjusted, lens = adjust(problem, CAMERA, free_lens=True, rounds=60)
        self.assertAlmostEqual(lens.distortion[0], -0.05, delta=0.01)
        self.assertLess(np.median(np.linalg.norm(residuals(adjusted, lens), axis=1)), 0.2)

    def test_jacobians_should_be_those_of_differences(self):
        _, off, times, tracks = walk(self.random, pose_noise=0.01, pixel_noise=0.3)
        camera = Camera("radtan", 640, 480, (500.0, 505.0, 322.0, 238.0), [-0.2, 0.05, 0.001, -0.001])
        problem = make_problem(off, times, tracks, camera)
        by_pose, by_point, by_lens = jacobians(problem, camera, np.zeros(2), True)
        k, step = 17, 1e-6
        for axis in range(6):
            x = np.zeros((len(problem.p), 6))
            x[problem.frame[k], axis] = step
            moved = dataclasses.replace(problem, R=Rotation.from_rotvec(x[:, :3]).as_matrix() @ problem.R, p=problem.p + x[:, 3:])
            np.testing.assert_allclose((residuals(problem, camera) - residuals(moved, camera))[k] / step, by_pose[k, :, axis], rtol=1e-3, atol=0.05)
        for axis in range(3):
            X = problem.X.copy()
            X[problem.point[k], axis] += step
            moved = dataclasses.replace(problem, X=X)
            np.testing.assert_allclose((residuals(problem, camera) - residuals(moved, camera))[k] / step, by_point[k, :, axis], rtol=1e-3, atol=0.05)
        for axis in range(2):
            other = with_lens(camera, step * np.eye(2)[axis])
            np.testing.assert_allclose((residuals(problem, camera) - residuals(problem, other))[k] / step, by_lens[k, :, axis], rtol=1e-3, atol=0.05)

    def test_rays_should_project_to_their_pixels(self):
        pixels = np.array([[10.0, 20.0], [320.0, 240.0], [600.0, 470.0]])
        for camera in (CAMERA, Camera("radtan", 640, 480, (450.0, 450.0, 320.0, 240.0), [-0.28, 0.07])):
            np.testing.assert_allclose(camera.project(rays(camera, pixels)), pixels, atol=1e-6)

    def test_estimated_lens_of_a_calibration_without_distortion_should_have_one(self):
        lens = EstimatedCamera(CAMERA, np.array([[0.0, 500, 500, 320, 240, -0.1, 0, 0, 0, 0]])).at(0.0)
        np.testing.assert_allclose(lens.project(np.array([[0.5, 0.0, 1.0]])), [[500 * 0.5 * (1 - 0.1 * 0.25) + 320, 240]])

    def test_what_cannot_be_used_should_get_one_line(self):
        with tempfile.TemporaryDirectory(prefix="planefold_") as name:
            folder = pathlib.Path(name)
            (folder / "trajectory.txt").write_text("0 0 0 0 0 0 0 1\n")
            (folder / "mine.txt").write_text("mine")
            for words, code, part in (([folder], 1, "--tracks"), ([folder / "none"], 1, "no such file"), ([folder, "--rounds", "0"], 2, "--rounds 0"),
                                      ([folder, "--out", folder / "mine.txt"], 1, "name another file")):
                result = subprocess.run([script.SOURCE / "tools" / "adjust-run", *words], text=True, capture_output=True, check=False)
                self.assertEqual(result.returncode, code)
                self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
                self.assertIn(part, result.stderr)
            self.assertEqual((folder / "mine.txt").read_text(), "mine")


if __name__ == "__main__":
    unittest.main()
