"""pf-eval --planes: true planes are read, and a run's planes are held against them."""

import json
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import venv  # noqa: E402

venv.enter()
import numpy as np  # noqa: E402

from scipy.spatial.transform import Rotation  # noqa: E402

from pf_eval import Refused  # noqa: E402
from pf_eval.errors import compare  # noqa: E402
from pf_eval.trajectories import Trajectory  # noqa: E402
from pf_eval.planes import compare_planes, folding, read_planes  # noqa: E402

TRUTH = (np.array([[0.0, 0, 1], [1.0, 0, 0]]), np.array([2.0, 3.0]), ["front", "side"])


def plane(number, normal, middle, points=9):
    """A plane with a square outline about its middle."""
    normal = np.array(normal, float) / np.linalg.norm(normal)
    u = np.cross(normal, [0, 1, 0]) / np.linalg.norm(np.cross(normal, [0, 1, 0]))
    v = np.cross(normal, u)
    outline = [list(np.array(middle) + a * u + b * v) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return {"id": number, "normal": list(normal), "distance": float(normal @ middle), "points": points, "outline": outline}


class Planes(unittest.TestCase):
    def write(self, text):
        with tempfile.NamedTemporaryFile("w", suffix=".json", delete=False) as file:
            file.write(text)
        self.addCleanup(pathlib.Path(file.name).unlink)
        return file.name

    def test_plane_should_be_true_when_it_is_near_and_turned_either_way(self):
        tilt = np.radians(1.0)
        report = {"planes": [plane(4, [0, np.sin(tilt), -np.cos(tilt)], [0.5, 0.2, 2.01])]}
        result = compare_planes(report, TRUTH)
        self.assertEqual((result["planes_true"], result["planes_false"], result["planes_missing"]), (1, 0, 1))
        self.assertAlmostEqual(result["plane_normal_max_deg"], 1.0, places=6)
        self.assertAlmostEqual(result["plane_offset_max_m"], 0.01, places=6)
        self.assertEqual(result["planes"][0]["true"], "front")

    def test_plane_should_be_false_when_it_is_far_or_slanted(self):
        report = {"planes": [plane(1, [0, 0, 1], [0, 0, 2.2]), plane(2, [0.3, 0, 1], [0, 0, 2])]}
        result = compare_planes(report, TRUTH)
        self.assertEqual((result["planes_true"], result["planes_false"], result["planes_missing"]), (0, 2, 2))
        self.assertIsNone(result["plane_normal_max_deg"])

    def test_planes_should_count_as_duplicate_when_two_are_the_same(self):
        report = {"planes": [plane(1, [0, 0, 1], [0, 0, 2]), plane(2, [0, 0, 1], [1, 1, 2.05])]}
        result = compare_planes(report, TRUTH)
        self.assertEqual((result["planes_true"], result["planes_duplicate"]), (2, 1))

    def test_planes_should_follow_the_alignment_when_there_is_one(self):
        turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])  # the run's -y is the truth's x
        middle = (turn.T @ (np.array([3.0, 1, 1]) - [0.1, 0.2, 0.3])) / 2.0
        result = compare_planes({"planes": [plane(1, [0, -1, 1e-9], middle)]}, TRUTH, 2.0, turn, np.array([0.1, 0.2, 0.3]))
        self.assertEqual(result["planes"][0]["true"], "side")
        self.assertLess(result["plane_offset_max_m"], 1e-6)

    def test_alignment_by_rotations_should_be_exact_when_positions_tell_little_of_a_turn(self):
        generator = np.random.default_rng(7)
        print("seed 7")
        t = np.arange(40) / 30
        p = np.stack([t, 0.01 * np.sin(9 * t), 0.01 * np.cos(7 * t)], axis=1)  # nearly a straight line
        R = Rotation.from_rotvec(np.outer(t, [0, 0.5, 0]))
        turn = Rotation.from_rotvec([0.3, -0.5, 0.8])
        xyzw = [rotation.as_quat()[:, [3, 0, 1, 2]] for rotation in (R, turn.inv() * R)]
        truth = Trajectory(t, p, xyzw[0], source="truth")
        run = Trajectory(t, turn.inv().apply(p - [1, 2, 3]) / 2 + generator.normal(0, 0.005, p.shape), xyzw[1], source="run")
        result = compare(run, truth, "sim3")
        self.assertLess(np.abs(result.own_turn - turn.as_matrix()).max(), 1e-9)
        self.assertLess(np.abs(result.own_shift - [1, 2, 3]).max(), 0.05)
        self.assertGreater(np.abs(result.turn - turn.as_matrix()).max(), 0.01)

    def test_truth_should_be_read_when_it_is_a_list_or_one_plane(self):
        normals, distances, names = read_planes(self.write('{"planes": [{"name": "a", "normal": [0, 0, 2], "distance": 4}]}'))
        self.assertEqual((list(normals[0]), distances[0], names), ([0, 0, 1], 2.0, ["a"]))
        normals, distances, _ = read_planes(self.write('{"plane_normal": [1, 0, 0], "plane_offset_n_dot_x": 0.5}'))
        self.assertEqual((list(normals[0]), distances[0]), ([1, 0, 0], 0.5))

    def test_truth_should_be_refused_when_it_is_no_plane(self):
        for text in ("", "[]", "{}", '{"planes": []}', '{"planes": [{"normal": [0, 0, 0], "distance": 1}]}',
                     '{"planes": [{"normal": [0, 1], "distance": 1}]}', '{"planes": [{"normal": [0, 0, NaN], "distance": 1}]}'):
            with self.assertRaises(Refused, msg=text):
                read_planes(self.write(text))

    def test_folding_should_be_the_share_saved_when_the_report_says_both(self):
        report = json.loads('{"state_dim": {"end": 75}, "state_dim_points_only": 100, "planes": [{"points": 25}, {"points": 4}]}')
        self.assertEqual(folding(report), {"state_dim_end": 75, "state_dim_points_only": 100, "state_dim_saved": 0.25,
                                           "points_on_planes": 29})
        self.assertEqual(folding({}), {})


if __name__ == "__main__":
    unittest.main()
