"""planefold.eval gives the numbers of pf-eval, for files and for poses in memory; planefold.plot draws what plot-run draws."""

import contextlib
import io
import json
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import python_package  # noqa: E402
import script  # noqa: E402

planefold = python_package.enter()
import planefold.eval  # noqa: E402
import planefold.plot  # noqa: E402
from pf_eval.main import main  # noqa: E402

FRAMES = 90


class AsPfEval(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.run_folder = pathlib.Path(cls.folder.name) / "run"
        script.run(script.BIN / "pf-capture", "--source", "sim:desk", "--frames", FRAMES, "--headless", "--no-film", "--quiet", "--out",
                   cls.run_folder)
        scene = planefold.Sim("desk")
        cls.slam, cls.poses = python_package.track(planefold, scene, count=FRAMES)
        cls.truth = [scene.pose_at(pose.t_ns) for pose in cls.poses]

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def pf_eval(self, *words):
        output = io.StringIO()
        with contextlib.redirect_stdout(output):
            self.assertEqual(main([str(self.run_folder), "--json", *words]), 0)
        return json.loads(output.getvalue())

    def test_files_give_the_same_numbers(self):
        for align in ("sim3", "se3"):
            ours = planefold.eval.compare(self.run_folder, self.run_folder / "truth.tum", align=align).summary
            theirs = self.pf_eval("--align", align)
            for name in ours:
                self.assertEqual(ours[name], theirs[name], name)

    def test_poses_give_the_same_numbers(self):
        ours, theirs = planefold.eval.compare(self.poses, self.truth), self.pf_eval()
        for name in ("ate_rmse_m", "rpe_rmse_m", "rot_rmse_deg", "scale", "path_m"):
            self.assertAlmostEqual(ours.summary[name], theirs[name], delta=1e-5 * abs(theirs[name]), msg=name)
        self.assertEqual(ours.summary["pairs"], len(self.poses))
        self.assertEqual(ours.estimate.shape, (len(self.poses), 3))

    def test_covariances_are_judged_alike(self):
        folder = pathlib.Path(self.folder.name) / "target"
        script.run(script.BIN / "pf-capture", "--source", "sim:desk", "--start", "target", "--frames", 40, "--headless", "--no-film",
                   "--quiet", "--out", folder)
        theirs = planefold.eval.compare(folder, folder / "truth.tum").summary
        scene = planefold.Sim("desk")
        _, poses = python_package.track(planefold, scene, count=40, target=scene.target())
        ours = planefold.eval.compare(poses, [scene.pose_at(pose.t_ns) for pose in poses], align="none").summary
        for name in ("nees_pose", "nees_position", "nees_frames"):
            self.assertAlmostEqual(ours[name], theirs[name], delta=1e-4 * theirs[name], msg=name)

    def test_what_cannot_be_compared_is_refused_in_one_line(self):
        for run, truth, align, line in (([], self.truth, None, "run: there are no poses"),
                                        (self.poses, "/nowhere.tum", None, "no such file"),
                                        (self.poses, self.truth, "sim2", "sim2 is none of")):
            with self.assertRaisesRegex(planefold.Refused, line):
                planefold.eval.compare(run, truth, align)

    def test_plots(self):
        comparison = planefold.eval.compare(self.poses, self.truth)
        folder = pathlib.Path(self.folder.name)
        for picture in (planefold.plot.trajectory(folder / "way.png", self.poses, self.slam.features, planes=self.slam.planes, comparison=comparison, title="desk"),
                        planefold.plot.trajectory(folder / "alone.png", self.poses), planefold.plot.errors(folder / "errors.png", comparison)):
            self.assertEqual(picture.read_bytes()[1:4], b"PNG")
            self.assertGreater(picture.stat().st_size, 10_000)
        with self.assertRaisesRegex(planefold.Refused, "cannot be drawn"):
            planefold.plot.errors(folder / "nowhere" / "errors.png", comparison)


if __name__ == "__main__":
    unittest.main(verbosity=2)
