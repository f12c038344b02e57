"""plot-run: pictures come out of whole runs and of poor ones, and mistakes get one line."""

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
import numpy as np  # noqa: E402

from pf_eval.plot_trajectory import ellipses, plane_handles, read_map, read_planes, view_axes  # noqa: E402
from pf_eval.plots import main  # noqa: E402

SEED = 7
COUNT = 60
print(f"seed {SEED}", flush=True)

PLY = """ply
format ascii 1.0
element vertex 3
property double x
property double y
property double z
property uchar red
property uchar green
property uchar blue
property float sigma
property uint id
property int observations
property uchar inverse_depth
end_header
0.1 0.2 1.0 53 208 127 0.01 1 40 0
-0.3 0.1 1.2 63 160 255 0.5 2 2 1
0.0 0.0 0.9 224 80 208 0.001 0 60 0
"""


class PlotRun(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        generator = np.random.default_rng(SEED)
        t = np.arange(COUNT) / 30
        p = np.stack([0.2 * np.sin(t), 0.05 * np.cos(t), 0.1 * t], axis=1)
        rows = np.column_stack([t, p, np.tile([0, 0, 0, 1], (COUNT, 1))])
        np.savetxt(self.path / "truth.tum", rows, fmt="%.9f")
        rows[:, 1:4] += generator.normal(0, 0.003, (COUNT, 3))
        np.savetxt(self.path / "trajectory.txt", rows, fmt="%.9f")
        covariance = np.tile((9e-6 * np.eye(6)).ravel(), (COUNT, 1))
        np.savetxt(self.path / "covariance.csv", np.column_stack([t, covariance]), delimiter=",")
        with open(self.path / "frames.csv", "w") as file:
            file.write("t_s,state,attempts,matches,inliers,features,state_dim,ms,nis,nis_dof\n")
            for i in range(COUNT):
                file.write(f"{t[i]:.6f},{'tracking' if i > 3 else 'starting'},50,45,40,60,200,0.5,79.0,{80 if i > 3 else 0}\n")
        (self.path / "map.ply").write_text(PLY)
        (self.path / "report.json").write_text(json.dumps({"source": "sim:desk", "start": "target:t.yaml", "frames": COUNT}))

    def tearDown(self):
        self.folder.cleanup()

    def plot(self, *words):
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()) as err:
            code = main([str(word) for word in words])
        return code, err.getvalue()

    def pictures(self):
        return sorted(path.name for path in (self.path / "plots").glob("*.png") if path.stat().st_size > 10000)

    def write_faces(self, *colours):
        """Beside the points a square for each colour."""
        corners = "0.0 0.0 1.0 {0} 0.02 {1} 40 0\n1.0 0.0 1.0 {0} 0.02 {1} 40 0\n1.0 1.0 1.0 {0} 0.02 {1} 40 0\n0.0 1.0 1.0 {0} 0.02 {1} 40 0\n"
        faces = "element face {}\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty uint id\n"
        head, rows = PLY.replace("vertex 3", f"vertex {3 + 4 * len(colours)}").split("end_header\n")
        rows += "".join(corners.format(colour, k) for k, colour in enumerate(colours))
        rows += "".join(f"4 {' '.join(str(3 + 4 * k + i) for i in range(4))} {colour} {k}\n" for k, colour in enumerate(colours))
        (self.path / "map.ply").write_text(head + faces.format(len(colours)) + "end_header\n" + rows)

    def test_planes_should_be_drawn_with_their_classes_where_they_have_one(self):
        self.assertEqual(read_planes(self.path / "none.ply"), [])
        self.assertEqual(read_planes(self.path / "map.ply"), [])
        self.assertEqual(plane_handles([]), [])
        for colours, labels in ((["133 107 255", "230 153 0"], ["wall", "floor, table"]), (["12 200 90"], ["plane"]), (["12 200 90"] * 2, ["planes"])):
            self.write_faces(*colours)
            planes = read_planes(self.path / "map.ply")
            self.assertEqual([corners.shape for corners, _ in planes], [(4, 3)] * len(colours))
            np.testing.assert_array_equal(planes[0][0][2], [1.0, 1.0, 1.0])
            self.assertEqual([handle.get_label() for handle in plane_handles(planes)], labels)
            self.assertEqual(len(read_map(self.path / "map.ply")[0]), 3)
        self.assertEqual(self.plot(self.path), (0, ""))

    def test_run_should_give_all_pictures_when_truth_lies_beside_it(self):
        self.assertEqual(self.plot(self.path), (0, ""))
        self.assertEqual(self.pictures(), ["errors.png", "frames.png", "trajectory.png"])

    def test_run_with_a_unit_should_give_its_biases_once_gravity_is_known(self):
        names = ["t_s", "map", "metric", "resting"] + [f"{v}_{x}" for v in ("gravity", "gyro_bias", "accel_bias") for x in "xyz"]
        names += ["delay_s", "readout_s", "sigma_gravity_1", "sigma_gravity_2"] + [f"sigma_{v}_{x}" for v in ("gyro", "accel") for x in "xyz"]
        names += ["sigma_delay_s", "sigma_readout_s"]
        for metric, expected in ((0, False), (1, True)):
            rows = [",".join(names)] + [f"{0.1 * i:.3f},1,{metric},{int(i < 3)}," + ",".join(["0.01"] * 20 + ["-1"]) for i in range(8)]
            (self.path / "inertial.csv").write_text("\n".join(rows) + "\n")
            self.assertEqual(self.plot(self.path), (0, ""))
            self.assertEqual("inertial.png" in self.pictures(), expected)
        (self.path / "inertial.csv").write_text(",".join(names) + "\n")
        self.assertEqual(self.plot(self.path), (0, ""))

    def test_run_should_be_aligned_when_it_chose_its_own_frame(self):
        (self.path / "report.json").write_text(json.dumps({"start": "auto"}))
        self.assertEqual(self.plot(self.path), (0, ""))
        self.assertIn("errors.png", self.pictures())

    def test_run_should_give_its_trajectory_when_nothing_else_is_there(self):
        for name in ("truth.tum", "covariance.csv", "frames.csv", "map.ply", "report.json"):
            (self.path / name).unlink()
        self.assertEqual(self.plot(self.path), (0, ""))
        self.assertEqual(self.pictures(), ["trajectory.png"])

    def test_mistakes_should_get_one_line_and_a_failing_exit(self):
        for words in ([self.path / "none"], [self.path, "--truth", self.path / "none.tum"],
                      [self.path, "--out", self.path / "report.json"]):
            code, err = self.plot(*words)
            self.assertEqual(code, 1)
            self.assertEqual(len(err.strip().splitlines()), 1, err)

    def test_map_should_be_read_by_the_names_of_its_properties(self):
        p, sigma, inverse_depth, target, in_map = read_map(self.path / "map.ply")
        self.assertFalse(in_map)
        np.testing.assert_allclose(p[1], [-0.3, 0.1, 1.2])
        np.testing.assert_allclose(sigma, [0.01, 0.5, 0.001])
        self.assertEqual(inverse_depth.tolist(), [False, True, False])
        self.assertEqual(target.tolist(), [False, False, True])

    def test_map_should_be_its_points_alone_when_it_has_planes_too(self):
        head, rows = PLY.replace("vertex 3", "vertex 6").split("end_header\n")
        head += "element face 1\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uint id\nend_header\n"
        corners = "".join(f"{k} 0 1 255 90 160 0 7 0 0\n" for k in range(3))
        (self.path / "map.ply").write_text(head + rows + corners + "3 3 4 5 255 7\n")
        p, sigma, _, _, _ = read_map(self.path / "map.ply")
        self.assertEqual(p.shape, (3, 3))
        np.testing.assert_allclose(sigma, [0.01, 0.5, 0.001])

    def test_points_should_be_drawn_by_what_is_known_within_the_map_when_the_file_says_it(self):
        head, rows = PLY.split("end_header\n")
        head += "property float sigma_in_map\nend_header\n"
        rows = "".join(f"{row} {sigma}\n" for row, sigma in zip(rows.splitlines(), (0.002, 0.4, 0.0005)))
        (self.path / "map.ply").write_text(head + rows)
        _, sigma, _, _, in_map = read_map(self.path / "map.ply")
        self.assertTrue(in_map)
        np.testing.assert_allclose(sigma, [0.002, 0.4, 0.0005])
        self.assertEqual(self.plot(self.path), (0, ""))

    def test_views_should_follow_the_cameras_when_the_world_is_another(self):
        self.assertEqual(view_axes(np.eye(3)[None]), ((0, 1), (1, -1), (2, 1)))  # x right, y down, z forward
        flipped = np.diag([-1.0, -1.0, 1.0])[None]  # camera in a world with x left, y up, z away
        self.assertEqual(view_axes(flipped), ((0, -1), (1, 1), (2, 1)))

    def test_ellipses_should_have_three_sigma_half_axes(self):
        width, height, angle = ellipses(np.diag([4.0, 1.0, 9.0])[None], 0, 2)
        np.testing.assert_allclose([width[0], height[0]], [18.0, 12.0])
        self.assertAlmostEqual(abs(angle[0]) % 180, 90.0)


if __name__ == "__main__":
    unittest.main()
