"""pf-eval: known transforms are recovered, honest errors have an honest NEES, and mistakes get one line."""

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
import venv  # noqa: E402

venv.enter()
import numpy as np  # noqa: E402
from scipy.spatial.transform import Rotation  # noqa: E402

from pf_eval import Refused  # noqa: E402
from pf_eval.association import associate  # noqa: E402
from pf_eval.errors import compare, default_alignment, nees  # noqa: E402
from pf_eval.files import read_run  # noqa: E402
from pf_eval.main import main  # noqa: E402
from pf_eval.trajectories import Trajectory, read_trajectory  # noqa: E402

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

    def test_rotation_should_be_judged_by_itself_when_the_path_is_nearly_straight(self):
        """A millimetre of noise across a straight path turned the whole run by tens of degrees about it."""
        truth = curve()
        truth.p = np.stack([0.5 * truth.t, 1e-4 * np.sin(truth.t), 0 * truth.t], axis=1)
        run = moved(truth, 1.0, Rotation.identity(), [0, 0, 0])
        run.p = run.p + self.generator.normal(0, 0.002, run.p.shape)
        run.q = wxyz(Rotation.from_rotvec(self.generator.normal(0, np.radians(0.2), (200, 3))) * Rotation.from_quat(run.q[:, [1, 2, 3, 0]]))
        result = compare(run, truth, "sim3").summary
        self.assertTrue(result["alignment_degenerate"])
        self.assertAlmostEqual(result["rot_rmse_deg"], 0.2 * np.sqrt(3), delta=0.03)
        self.assertGreater(result["rot_by_positions_rmse_deg"], 3 * result["rot_rmse_deg"])
        self.assertFalse(compare(moved(curve(), 1.0, self.turn, [0, 0, 1]), curve(), "sim3").summary["alignment_degenerate"])

    def test_alignment_should_be_refused_when_the_path_stands_still(self):
        still = curve()
        still.p = np.zeros_like(still.p)
        with self.assertRaises(Refused):
            compare(curve(), still, "sim3")

    def test_default_should_follow_the_start_of_the_report(self):
        self.assertEqual(default_alignment({"start": "target:a.yaml"}), "none")
        self.assertEqual(default_alignment({"start": "rectangle:0.2x0.1"}), "none")
        self.assertEqual(default_alignment({"start": "auto"}), "sim3")
        self.assertEqual(default_alignment({"start": "auto", "imu": {"used": True, "metric": False}}), "sim3")
        self.assertEqual(default_alignment({"start": "auto", "imu": {"used": True, "metric": True}}), "se3")
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

    def test_truth_should_be_taken_where_frames_are_every_other_one_of_a_slow_camera(self):
        truth = curve(30, 15.0)
        kept, matched, how = associate(truth.select(np.arange(0, 30, 2)), truth)
        self.assertEqual((len(kept), how), (15, "nearest"))
        np.testing.assert_array_equal(matched.t, kept.t)

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
            try:
                code = main([str(word) for word in words])
            except SystemExit as ended:  # of the command line
                code = ended.code
        return code, out.getvalue(), err.getvalue()

    def test_json_should_have_the_agreed_names(self):
        code, out, err = self.pf_eval(self.path, "--truth", self.path / "truth.tum", "--json")
        self.assertEqual(code, 0, err)
        result = json.loads(out)
        for name in ("ate_rmse_m", "ate_max_m", "rpe_rmse_m", "rot_rmse_deg", "pairs", "scale", "path_m",
                     "nees_position", "nees_pose"):
            self.assertIn(name, result)
        self.assertAlmostEqual(result["scale"], 2.0, places=6)

    def test_json_should_go_to_the_output_when_only_the_run_follows_it(self):
        code, out, err = self.pf_eval("--truth", self.path / "truth.tum", "--json", self.path)
        self.assertEqual(code, 0, err)
        self.assertEqual(json.loads(out)["pairs"], 200)

    def test_table_should_be_printed_when_json_goes_to_a_file(self):
        _, out, _ = self.pf_eval(self.path, "--truth", self.path / "truth.tum", "--json", self.path / "eval.json")
        self.assertIn("position error, RMS", out)
        self.assertIn("ate_rmse_m", json.loads((self.path / "eval.json").read_text()))

    def test_files_should_be_replaced_when_pf_eval_wrote_them_and_never_otherwise(self):
        for option, name in (("--json", "own.json"), ("--per-frame", "own.csv")):
            words = (self.path, "--truth", self.path / "truth.tum", option, self.path / name)
            self.assertEqual(self.pf_eval(*words)[0], 0)
            self.assertEqual(self.pf_eval(*words)[0], 0)
            (self.path / name).write_text('{"years": "of work"}\n')
            code, _, err = self.pf_eval(*words)
            self.assertEqual(code, 1)
            self.assertIn(f"{name}: is there and was not written by pf-eval; name another file", err)
            self.assertEqual((self.path / name).read_text(), '{"years": "of work"}\n')

    def test_truth_should_be_read_as_other_systems_write_it(self):
        rows = (self.path / "truth.tum").read_text().splitlines()
        expected = self.pf_eval(self.path, "--truth", self.path / "truth.tum", "--json")[1]
        other = self.path / "other.tum"
        other.write_bytes(b"\xef\xbb\xbf" + "\r\n".join(["# t x y z", "", *reversed(rows)]).encode())
        code, out, err = self.pf_eval(self.path, "--truth", other, "--json")
        self.assertEqual(code, 0, err)
        self.assertEqual(json.loads(out) | {"truth": ""}, json.loads(expected) | {"truth": ""})

    def test_truth_should_be_found_when_the_report_names_it(self):
        code, _, err = self.pf_eval(self.path)  # truth.tum of a scene
        self.assertEqual(code, 0, err)
        (self.path / "truth.tum").rename(self.path / "elsewhere.tum")
        (self.path / "report.json").write_text(json.dumps({"truth": str(self.path / "elsewhere.tum"), "start": "auto"}))
        code, out, err = self.pf_eval(self.path, "--json")
        self.assertEqual(code, 0, err)
        self.assertEqual(json.loads(out)["pairs"], 200)
        for truth, part in (("", "names no truth"), (str(self.path / "gone.tum"), "gone.tum")):
            (self.path / "report.json").write_text(json.dumps({"truth": truth}))
            code, _, err = self.pf_eval(self.path)
            self.assertEqual(code, 1)
            self.assertIn(part, err)

    def test_each_map_should_be_aligned_by_itself_and_only_the_largest_count_as_tracked(self):
        turn = Rotation.from_euler("xyz", [30, 40, 50], degrees=True)
        rows = []
        for number, first, last, scale in ((1, 0, 60, 0.5), (2, 70, 180, 3.0), (3, 190, 192, 1.0)):
            name = "trajectory.txt" if number == 1 else f"trajectory_{number}.txt"
            part = curve().select(np.arange(first, last))
            write_tum(self.path / name, moved(part, scale, turn if number == 2 else Rotation.identity(), [number, 0.0, 0.0]))
            rows.append({"map": number, "trajectory": name, "start_frame": first, "tracked": last - first})
        (self.path / "report.json").write_text(json.dumps({"truth": str(self.path / "truth.tum"), "start": "auto", "maps": rows}))
        write_tum(self.path / "truth.tum", curve())
        code, out, err = self.pf_eval(self.path, "--json")
        self.assertEqual(code, 0, err)
        result = json.loads(out)
        self.assertEqual((result["poses"], result["frames_in_other_maps"]), (110, 62))
        self.assertLess(result["ate_rmse_m"], 1e-6)
        self.assertAlmostEqual(result["scale"], 1 / 3, places=6)
        self.assertEqual([entry["map"] for entry in result["maps"]], [1, 2, 3])
        for entry, scale in zip(result["maps"][:2], (2.0, 1 / 3)):
            self.assertLess(entry["ate_rmse_m"], 1e-6)
            self.assertAlmostEqual(entry["scale"], scale, places=6)
        self.assertIn("needs at least 3", result["maps"][2]["not_compared"])

    def test_body_poses_should_become_camera_poses_when_truth_is_eurocs(self):
        R_BC = Rotation.from_euler("xyz", [80, 10, -30], degrees=True)
        T_BC = np.eye(4)
        T_BC[:3, :3], T_BC[:3, 3] = R_BC.as_matrix(), [0.3, -0.4, 0.5]
        camera = curve()
        R_WC = Rotation.from_quat(camera.q[:, [1, 2, 3, 0]])
        R_WB = R_WC * R_BC.inv()
        p_WB = camera.p - R_WB.apply(T_BC[:3, 3])
        mav0 = self.path / "mav0"
        (mav0 / "state_groundtruth_estimate0").mkdir(parents=True)
        (mav0 / "cam0").mkdir()
        table = mav0 / "state_groundtruth_estimate0" / "data.csv"
        rows = [f"{round(1e9 * t)},{','.join(f'{x:.12f}' for x in [*p, *q])},0,0,0" for t, p, q in zip(camera.t, p_WB, wxyz(R_WB))]
        table.write_text("#timestamp [ns],p_RS_R_x,p_RS_R_y,p_RS_R_z,q_RS_w,q_RS_x,q_RS_y,q_RS_z,v,v,v\n" + "\n".join(rows) + "\n")
        code, _, err = self.pf_eval(self.path, "--truth", table)
        self.assertEqual(code, 1)
        self.assertIn("poses of the body", err)
        data = ", ".join(f"{x:.12f}" for x in T_BC.ravel())
        (mav0 / "cam0" / "sensor.yaml").write_text(f"sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [{data}]\n")
        kalibr = self.path / "camchain.yaml"
        kalibr.write_text("cam0:\n  T_cam_imu:\n" + "".join(f"  - {list(map(float, row))}\n" for row in np.linalg.inv(T_BC)))
        for words in ([], ["--calib", kalibr]):
            code, out, err = self.pf_eval(self.path, "--truth", table, "--align", "none", "--json", *words)
            self.assertEqual(code, 0, err)
            result = json.loads(out)
            self.assertLess(result["ate_rmse_m"], 1e-6)
            self.assertLess(result["rot_rmse_deg"], 1e-4)
            self.assertIn("camera, from the body's poses", result["frame"])
        (mav0 / "cam0" / "sensor.yaml").write_text("sensor_type: camera\n")
        code, _, err = self.pf_eval(self.path, "--truth", table)
        self.assertEqual(code, 1)
        self.assertIn("T_BS", err)

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
        for words in ([], [self.path, "--nonsense"], [self.path, "--align", "se2"], [self.path, "--corners", "x.csv"], [self.path, "--skip-frames", "x"]):
            code, out, err = self.pf_eval(*words)
            self.assertEqual((code, out, len(err.splitlines())), (2, "", 1), f"{words}: {out}{err}")
            self.assertTrue(err.startswith("pf-eval: ") and "see pf-eval --help" in err, err)

    def test_output_that_nobody_reads_should_end_it_without_a_traceback(self):
        program = pathlib.Path(os.environ["PLANEFOLD_BIN"]) / "pf-eval"
        if not program.is_file():
            self.skipTest("pf-eval was not built")
        end, begin = os.pipe()
        os.close(end)
        with os.fdopen(begin, "w") as closed:
            ended = subprocess.run([program, self.path, "--truth", self.path / "truth.tum"], text=True, stdout=closed, stderr=subprocess.PIPE, check=False)
        self.assertNotEqual(ended.returncode, 0)
        self.assertNotIn("Traceback", ended.stderr)

    def test_truth_should_be_asked_for_without_naming_a_report_that_is_not_there(self):
        with tempfile.TemporaryDirectory() as empty:
            trajectory = pathlib.Path(empty) / "alone.tum"
            trajectory.write_text("0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 1 1 0 0 0 0 1\n")
            code, out, err = self.pf_eval(trajectory)
        self.assertEqual((code, out), (1, ""), err)
        self.assertIn("--truth FILE", err)
        self.assertIn("no report.json was read", err)

    def test_covariance_should_be_matched_by_time(self):
        times = curve().t[::-1]
        rows = np.column_stack([times, np.tile(np.eye(6).ravel(), (200, 1)) * (1 + times[:, None])])
        np.savetxt(self.path / "covariance.csv", rows, delimiter=",", fmt="%.9f")
        run, _, _ = read_run(self.path)
        np.testing.assert_allclose(run.covariance[:, 0, 0], 1 + run.t, atol=1e-8)

    def test_trajectory_should_be_read_as_written(self):
        np.testing.assert_allclose(read_trajectory(self.path / "trajectory.txt").p, curve().p, atol=1e-8)


if __name__ == "__main__":
    unittest.main()
