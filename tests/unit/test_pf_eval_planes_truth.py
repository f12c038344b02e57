"""pf-eval --planes-truth: members of planes are judged by a scene, by depth images, and by tracks triangulated with the true poses."""

import json
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import venv  # noqa: E402

venv.enter()
import numpy as np  # noqa: E402

from pf_eval import Refused  # noqa: E402
from pf_eval.options import arguments  # noqa: E402
from pf_eval.planes_truth import compare_planes_with_truth  # noqa: E402
from pf_eval.trajectories import Trajectory  # noqa: E402
from pf_eval.true_places import merge_surfaces  # noqa: E402

WIDTH, HEIGHT, FOCAL = 320, 240, 250.0
FRAMES, ON, OFF = 40, 12, 6  # points on a wall at z = 2, and before it


def world():
    """(true centres of the camera, which looks along z; points): the first ON on the wall, the others nearer."""
    generator = np.random.default_rng(3)
    X = np.column_stack([generator.uniform(-0.5, 0.5, ON + OFF), generator.uniform(-0.5, 0.5, ON + OFF), np.full(ON + OFF, 2.0)])
    X[ON:, 2] = generator.uniform(1.2, 1.7, OFF)
    return np.column_stack([np.linspace(0, 0.3, FRAMES), np.zeros((FRAMES, 2))]), X


class PlanesTruth(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "calib.yaml").write_text(f"model: pinhole\nwidth: {WIDTH}\nheight: {HEIGHT}\nfx: {FOCAL}\nfy: {FOCAL}\n"
                                                f"cx: {WIDTH / 2}\ncy: {HEIGHT / 2}\n")
        self.t = np.arange(FRAMES) / 30
        self.centres, self.X = world()
        self.truth = Trajectory(self.t, self.centres, np.tile([1.0, 0, 0, 0], (FRAMES, 1)), source="truth")

    def write(self, plane_of, trial_of=lambda point: 0, surface_of=lambda point: ""):
        (self.folder / "frames.csv").write_text("t_s,tracked\n" + "".join(f"{t:.6f},1\n" for t in self.t))
        (self.folder / "planes.csv").write_text("frame,id\n0,1\n")
        rows = ["frame,id,status,measured_u,measured_v,plane,trial,surface,depth"]
        for frame in range(FRAMES):
            for i, X in enumerate(self.X):
                p = X - self.centres[frame]
                u, v = FOCAL * p[0] / p[2] + WIDTH / 2, FOCAL * p[1] / p[2] + HEIGHT / 2
                rows.append(f"{frame},{i + 1},inlier,{u:.3f},{v:.3f},{plane_of(i)},{trial_of(i)},{surface_of(i)},")
        (self.folder / "tracks.csv").write_text("\n".join(rows) + "\n")

    def judge(self, truth="known", *words):
        options = arguments([str(self.folder), "--planes-truth", *words])
        return compare_planes_with_truth(self.folder, {}, self.truth if truth else None, options)

    def require_shares(self, result, earned, false_members):
        total = ON + OFF
        self.assertAlmostEqual(result["found"], total)
        self.assertAlmostEqual(result["could_fold"], ON / total, delta=0.01)
        self.assertAlmostEqual(result["earned"], earned / total)
        self.assertAlmostEqual(result["false_members"], false_members, delta=0.01)

    def test_members_should_be_judged_when_only_tracks_and_true_poses_are_there(self):
        self.write(lambda i: 7 if i < ON + 1 else 0)  # one of 13 members stands before the wall
        result = self.judge()
        self.assertIn("triangulated", result["truth_source"])
        self.require_shares(result, ON + 1, 1 / (ON + 1))
        self.assertEqual((result["planes_lived"], result["planes_lived_false"]), (1, 0))
        self.assertGreater(result["power"], 0.99)

    def test_members_should_be_judged_by_surfaces_when_the_run_is_of_a_scene(self):
        planes = [{"normal": [0, 0, 1], "distance": 2.0}, {"normal": [0, 0, -1], "distance": -2.001}, {"normal": [0, 0, 1], "distance": 1.5}]
        (self.folder / "truth_planes.json").write_text(json.dumps({"planes": planes}))
        self.write(lambda i: 7 if i < ON + 2 else 0, lambda i: int(i % 2), lambda i: i % 2 if i < ON else 2)
        result = self.judge(None)
        self.assertEqual(result["truth_source"], "scene")
        self.require_shares(result, (ON + 2) // 2, 1 / (ON // 2 + 1))
        self.assertAlmostEqual(result["on_trial"], (ON + 2) // 2 / (ON + OFF))

    def test_plane_should_be_false_when_its_members_are_on_no_plane(self):
        self.write(lambda i: 7 if i >= ON - 2 else 0)
        result = self.judge()
        self.assertEqual((result["planes_lived"], result["planes_lived_false"]), (1, 1))

    def test_plane_should_not_be_judged_when_its_members_are_all_on_trial(self):
        self.write(lambda i: 7 if i < ON else 0, lambda i: 1)
        result = self.judge()
        self.assertEqual((result["planes_lived_not_judged"], result["earned"], result["power"]), (1, 0.0, 0.0))

    def test_members_should_be_judged_by_depth_images_when_they_are_given(self):
        import PIL.Image
        (self.folder / "depth").mkdir()
        self.write(lambda i: 7 if i < ON + 1 else 0)
        for frame in range(FRAMES):
            z = np.zeros((HEIGHT, WIDTH), dtype=np.uint16)
            for X in self.X:
                p = X - self.centres[frame]
                u, v = round(FOCAL * p[0] / p[2] + WIDTH / 2), round(FOCAL * p[1] / p[2] + HEIGHT / 2)
                z[max(0, v - 1):v + 2, max(0, u - 1):u + 2] = round(1000 * p[2])
            PIL.Image.fromarray(z).save(self.folder / "depth" / f"{frame:03d}.png")
        result = self.judge("known", "--depth", str(self.folder / "depth"))
        self.assertEqual(result["truth_source"], "depth images")
        self.require_shares(result, ON + 1, 1 / (ON + 1))

    def test_run_should_be_refused_in_one_line_when_nothing_says_where_things_are(self):
        self.write(lambda i: 7)
        with self.assertRaisesRegex(Refused, "a scene .* depth images .* or true poses"):
            self.judge(None)
        (self.folder / "planes.csv").unlink()
        with self.assertRaisesRegex(Refused, "pf-capture --tracks"):
            self.judge()

    def test_surfaces_should_be_one_plane_when_they_differ_by_millimetres(self):
        normals = np.array([[0, 0, 1], [0, 0, -1], [0, 0, 1], [1, 0, 0]], float)
        self.assertEqual(list(merge_surfaces(normals, np.array([2.0, -2.002, 2.02, 2.0]))), [0, 0, 2, 3])


if __name__ == "__main__":
    unittest.main()
