"""pf-eval: trajectories in the forms of other programs and data sets, times in other units, and how much of a sequence an error speaks of."""

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
from scipy.spatial.transform import Rotation  # noqa: E402

from pf_eval import Refused  # noqa: E402
from pf_eval.main import main  # noqa: E402
from pf_eval.trajectories import read_trajectory  # noqa: E402

COUNT, RATE, SINCE = 40, 20.0, 1600000000.0


def path_of(count=COUNT, rate=RATE):
    """(t, p, R) of a short curve."""
    t = np.arange(count) / rate
    p = np.stack([np.sin(t), 0.5 * np.cos(1.3 * t), 0.2 * t * t], axis=1)
    return t, p, Rotation.from_rotvec(np.stack([0.3 * np.sin(t), 0.2 * t, 0.1 * np.cos(t)], axis=1))


def rows_of(columns, separator=" "):
    return "".join(separator.join(f"{value:.9f}" for value in row) + "\n" for row in np.column_stack(columns))


class Forms(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)
        self.t, self.p, self.R = path_of()
        self.xyzw = self.R.as_quat()
        self.wxyz = self.xyzw[:, [3, 0, 1, 2]]

    def write(self, text, name="truth.txt"):
        file = self.path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        return file

    def require_read(self, file, since=0.0, body=False):
        read = read_trajectory(file)
        np.testing.assert_allclose(read.t, since + self.t, atol=1e-5)
        np.testing.assert_allclose(read.p, self.p, atol=1e-7)
        np.testing.assert_allclose(read.rotations(), self.R.as_matrix(), atol=1e-6)
        self.assertEqual(read.of_body, body)

    def require_refused(self, text, *parts):
        file = self.write(text)
        with self.assertRaises(Refused) as refused:
            read_trajectory(file)
        for part in (str(file), *parts):
            self.assertIn(part, str(refused.exception))
        self.assertNotIn("\n", str(refused.exception))

    def test_tum_should_be_read_with_marks_commas_and_line_ends(self):
        tum = rows_of([self.t, self.p, self.xyzw])
        commas = "timestamp,tx,ty,tz,qx,qy,qz,qw\n" + tum.replace(" ", ",")
        for text in (tum, "# T_WC: timestamp tx ty tz qx qy qz qw\n" + tum, tum.replace("\n", "\r\n"), b"\xef\xbb\xbf" + tum.encode(),
                     b"\xff\xfe" + commas.encode("utf-16-le"), commas, tum.replace(".", ",").replace(" ", ";"), tum.replace(".", ",")):
            self.require_read(self.write(text))

    def test_row_numbers_and_names_of_images_should_be_passed_over(self):
        rows = rows_of([self.t, self.p, self.xyzw]).splitlines()
        for first in (0, 1):
            self.require_read(self.write("".join(f"{k + first} {row}\n" for k, row in enumerate(rows))))
        self.require_read(self.write("".join(f"{k:06d}.png {row}\n" for k, row in enumerate(rows))))
        self.require_read(self.write("".join(f'{row.replace(" ", ",")},"rgb/{k:06d}.JPG"\n' for k, row in enumerate(rows))))
        head = "filename,timestamp,tx,ty,tz,qx,qy,qz,qw\n"
        self.require_read(self.write(head + "".join(f'{k:06d}.png,{row.replace(" ", ",")}\n' for k, row in enumerate(rows))))
        self.require_refused("".join(f"{row} good\n" for row in rows), "'good' in column 9, which is no number")

    def test_tables_of_ros_should_be_read_by_their_names(self):
        since = 1600000000
        stamps = [since + t for t in self.t]
        place, turn = ["x", "y", "z"], ["x", "y", "z", "w"]
        echo = ["%time", "field.header.seq", "field.header.stamp", "field.header.frame_id", *[f"field.pose.position.{a}" for a in place],
                *[f"field.pose.orientation.{a}" for a in turn]]
        numbers = [",".join(f"{v:.9f}" for v in row) for row in np.column_stack([self.p, self.xyzw])]
        rows = [f"{round(1e9 * (t + 0.4))},{k},{round(1e9 * t)},map,{row}\n" for k, (t, row) in enumerate(zip(stamps, numbers))]
        self.require_read(self.write(",".join(echo) + "\n" + "".join(rows)), since)
        bag = ["Time", "header.seq", "header.stamp.secs", "header.stamp.nsecs", "header.frame_id", "child_frame_id", *[f"pose.pose.position.{a}" for a in place],
               *[f"pose.pose.orientation.{a}" for a in turn], "twist.twist.linear.x"]
        rows = [f"{t + 0.4:.6f},{k},{int(t)},{round(1e9 * (t % 1))},odom,base,{row},0.5\n" for k, (t, row) in enumerate(zip(stamps, numbers))]
        self.require_read(self.write(",".join(bag) + "\n" + "".join(rows)), since)
        self.require_refused(",".join([*bag[:-1], "battery.level"]) + "\n" + "".join(rows), "'battery.level'")

    def test_matrices_should_be_read_with_a_time_or_number_before_them(self):
        T = np.concatenate([self.R.as_matrix(), self.p[:, :, None]], axis=2)
        self.require_read(self.write(rows_of([self.t, T.reshape(COUNT, 12)])))
        numbers = 3 * np.arange(COUNT)  # KITTI-360 has poses of some frames
        for rest in ((), (np.tile([0, 0, 0, 1], (COUNT, 1)),)):
            read = read_trajectory(self.write(rows_of([numbers, T.reshape(COUNT, 12), *rest])))
            self.assertTrue(read.counts)
            np.testing.assert_array_equal(read.t, numbers)
            np.testing.assert_allclose(read.p, self.p, atol=1e-7)

    def test_other_files_of_poses_should_be_refused_by_name(self):
        self.require_refused('{"frames": [{"file_path": "0.png"}]}', "is JSON")
        self.require_refused("# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n1 1 0 0 0 0 0 0 1 0.png\n12 7 -1 14 8 -1\n", "COLMAP's images.txt")

    def test_columns_should_be_taken_by_their_header(self):
        head = "q_w,q_x,q_y,q_z,x [mm],y [mm],z [mm],time [ms]\n"
        self.require_read(self.write(head + rows_of([self.wxyz, 1000 * self.p, 1000 * self.t], ",")))
        self.require_read(self.write("# timestamp tx ty tz qw qx qy qz\n" + rows_of([self.t, self.p, self.wxyz])))
        velocity = np.zeros((COUNT, 3))
        self.require_read(self.write("t,px,py,pz,vx,vy,vz,qx,qy,qz,qw\n" + rows_of([self.t, self.p, velocity, self.xyzw], ",")))
        self.require_refused("t,px,py,pz,qx,qy,qz,qw,score\n" + rows_of([self.t, self.p, self.xyzw, self.t], ","), "'score'")
        self.require_refused("t,px [ft],py,pz,qx,qy,qz,qw\n" + rows_of([self.t, self.p, self.xyzw], ","), "px [ft]", "mm")
        self.require_refused("t,lat,lon,alt,qx,qy,qz,qw\n" + rows_of([self.t, self.p, self.xyzw], ","), "lat")

    def test_csv_in_nanoseconds_should_be_poses_of_the_body(self):
        def rows(*more):
            numbers = np.column_stack([self.p, self.wxyz, *more])
            return "".join(f"{round(1e9 * (SINCE + t))}," + ",".join(f"{value:.9f}" for value in row) + "\n" for t, row in zip(self.t, numbers))
        self.require_read(self.write(rows()), SINCE, body=True)
        self.require_read(self.write(rows(np.zeros((COUNT, 9)))), SINCE, body=True)
        self.require_read(self.write(rows(np.zeros((COUNT, 3))).replace("\n", ",\n")), SINCE, body=True)  # VINS
        head = "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n"
        self.require_read(self.write(head + rows()), SINCE, body=True)

    def test_kittis_rows_of_twelve_should_get_their_times_beside_them(self):
        T = np.concatenate([self.R.as_matrix(), self.p[:, :, None]], axis=2)
        kitti = rows_of([T.reshape(COUNT, 12)])
        for name in ("00/times.txt", "sequences/07/times.txt"):
            self.write("".join(f"{t:.6e}\n" for t in self.t), name)
        self.require_read(self.write(kitti, "00/poses.txt"))
        self.require_read(self.write(kitti, "poses/07.txt"))
        alone = read_trajectory(self.write(kitti, "alone.txt"))
        self.assertTrue(alone.counts)
        np.testing.assert_array_equal(alone.t, np.arange(COUNT))
        whole = rows_of([T.reshape(COUNT, 12), np.tile([0, 0, 0, 1], (COUNT, 1))])
        np.testing.assert_allclose(read_trajectory(self.write(whole, "whole.txt")).p, self.p, atol=1e-7)
        self.write("0\n1\n", "00/times.txt")
        with self.assertRaisesRegex(Refused, "2 times for the 40 rows"):
            read_trajectory(self.path / "00/poses.txt")

    def test_what_is_not_known_should_be_refused_by_name(self):
        columns = [self.t, self.p, self.xyzw]
        self.require_refused(rows_of([*columns, self.t]), "line 1 has 9 columns", "known are 8 (TUM")
        self.require_refused(rows_of([*columns, self.p]), "line 1 has 11 columns")
        self.require_refused(rows_of([self.t, self.p]), "line 1 has 4 columns")
        self.require_refused(rows_of([np.ones((5, 12))]), "line 1 has 12 columns that are no rows of a rotation")
        self.require_refused(rows_of(columns) + "9 1 2 3 0 0 0\n", f"line {COUNT + 1} has 7 columns, the rows before have 8")
        self.require_refused(rows_of(columns) + "9 1 2 3 0 0 zero 1\n", f"line {COUNT + 1} has 'zero' in column 7")
        self.require_refused(rows_of(columns) + "9 1 2 nan 0 0 0 1\n", f"line {COUNT + 1}", "not finite")
        self.require_refused("0 0 0 0 1 1 0 0\n", "quaternion of length 1.414")


class Evaluation(unittest.TestCase):
    """A run of 38 of 40 frames, which begins 0.1 s late, against truth in several forms."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)
        self.run = self.path / "run"
        self.run.mkdir()
        self.t, self.p, self.R = path_of()
        self.T = np.concatenate([self.R.as_matrix(), self.p[:, :, None]], axis=2)
        tracked = np.arange(COUNT) >= 2
        (self.run / "trajectory.txt").write_text(rows_of([self.t, 0.5 * self.p, self.R.as_quat()][:3]).split("\n", 2)[2])
        (self.run / "frames.csv").write_text("t_s,tracked\n" + "".join(f"{t:.9f},{int(k)}\n" for t, k in zip(self.t, tracked)))
        (self.run / "report.json").write_text(json.dumps({"start": "auto"}))

    def evaluate(self, truth, run=None):
        with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as err:
            code = main([str(run or self.run), "--truth", str(truth), "--json"])
        self.assertEqual(code, 0, err.getvalue())
        return json.loads(out.getvalue()), err.getvalue()

    def require_same_path(self, text, name, note):
        truth = self.path / name
        truth.write_text(text)
        result, said = self.evaluate(truth)
        self.assertEqual(result["pairs"], COUNT - 2)
        self.assertLess(result["ate_rmse_m"], 1e-5)
        self.assertIn(note, said)
        return result

    def test_coverage_and_first_pose_should_stand_beside_the_error(self):
        result = self.require_same_path(rows_of([self.t, self.p, self.R.as_quat()]), "truth.tum", "")
        self.assertAlmostEqual(result["coverage"], 38 / 40)
        self.assertAlmostEqual(result["first_pose_s"], 0.1)
        (self.run / "report.json").write_text(json.dumps({"start": "auto", "unreadable_frames": 10}))
        self.assertAlmostEqual(self.evaluate(self.path / "truth.tum")[0]["coverage"], 38 / 50)
        alone, _ = self.evaluate(self.path / "truth.tum", self.run / "trajectory.txt")
        self.assertIsNone(alone["coverage"])
        with contextlib.redirect_stdout(io.StringIO()) as out:
            main([str(self.run), "--truth", str(self.path / "truth.tum")])
        self.assertRegex(out.getvalue(), r"position error, RMS .*\n.*frames tracked .* 0.76\n.*first pose .* 0.1 s")

    def test_truth_without_times_should_be_taken_by_frame_numbers_with_a_note(self):
        self.require_same_path(rows_of([self.T.reshape(COUNT, 12)]), "truth.txt", "frames of the run by their numbers")
        poses = self.path / "poses"
        poses.mkdir()
        for k in range(COUNT):
            (poses / f"frame-{k:06d}.pose.txt").write_text(rows_of([np.vstack([self.T[k], [0, 0, 0, 1]])], "\t"))
        self.assertLess(self.evaluate(poses)[0]["ate_rmse_m"], 1e-5)
        skipped = json.dumps({"start": "auto", "skip": 5})
        (self.run / "report.json").write_text(skipped)
        shifted = np.concatenate([np.tile(np.eye(3, 4), (5, 1, 1)), self.T])
        self.require_same_path(rows_of([shifted.reshape(-1, 12)]), "shifted.txt", "by their numbers")

    def test_truth_in_another_unit_should_be_recognised_with_a_note(self):
        for factor, name in ((1e3, "milliseconds"), (1e6, "microseconds"), (1e9, "nanoseconds")):
            self.require_same_path(rows_of([factor * self.t, self.p, self.R.as_quat()]), "truth.tum", f"as {name}")
        self.require_same_path(rows_of([np.arange(COUNT), self.p, self.R.as_quat()]), "truth.tum", "has frame numbers and no times; they are taken at 20 Hz")

    def test_truth_in_millimetres_should_get_a_note_that_can_be_typed(self):
        truth = self.path / "truth.tum"
        rows = rows_of([self.t, 500 * self.p, self.R.as_quat()])
        truth.write_text(rows)
        (self.run / "report.json").write_text(json.dumps({"start": "target:desk.yaml"}))
        _, said = self.evaluate(truth)
        line = said.split("say the unit: ")[1].splitlines()[0]
        truth.write_text(line + "\n" + rows)
        result, said = self.evaluate(truth)
        self.assertLess(result["ate_rmse_m"], 1e-5)
        self.assertEqual(said, "")

    def test_quaternions_with_w_first_should_get_a_note_that_can_be_typed(self):
        truth = self.path / "truth.tum"
        rows = rows_of([self.t, self.p, self.R.as_quat()[:, [3, 0, 1, 2]]])
        truth.write_text(rows)
        result, said = self.evaluate(truth)
        self.assertGreater(result["rot_by_positions_rmse_deg"], 20)
        truth.write_text(said.split("say the order: ")[1].splitlines()[0] + "\n" + rows)
        result, said = self.evaluate(truth)
        self.assertLess(result["rot_rmse_deg"], 1e-3)
        self.assertEqual(said, "")

    def test_a_run_without_times_should_be_refused_unless_it_has_the_rows_of_the_truth(self):
        truth = self.path / "truth.tum"
        truth.write_text(rows_of([self.t, self.p, self.R.as_quat()]))
        run = self.path / "other.txt"
        run.write_text(rows_of([self.T.reshape(COUNT, 12)]))
        self.assertEqual(self.evaluate(truth, run)[0]["pairs"], COUNT)
        run.write_text(rows_of([self.T[:30].reshape(30, 12)]))
        with contextlib.redirect_stderr(io.StringIO()) as err:
            self.assertEqual(main([str(run), "--truth", str(truth)]), 1)
        self.assertIn("30 rows where", err.getvalue())


if __name__ == "__main__":
    unittest.main()
