"""What goes into the Python package: targets, walls, samples, observations, and files of each kind."""

import json
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import python_package  # noqa: E402

planefold = python_package.enter()
import numpy as np  # noqa: E402


class Scenes(unittest.TestCase):
    def test_target_planes_hits_and_projection(self):
        scene = planefold.Sim("desk")
        slam = planefold.Slam(python_package.desk(planefold), clock=True)
        slam.start_from_target(scene.target())
        for number, (image, t_ns) in enumerate(scene):
            slam.push_frame(image, t_ns)
            if number == 10:
                slam.mark_pose()
            if number == 150:
                break
        self.assertLess(np.linalg.norm(slam.pose.p_WC - scene.truth.p_WC), 0.02)
        self.assertGreater(len(slam.planes), 0)
        self.assertGreater(len(slam.features), 20)
        self.assertGreater(sum(match.status == planefold.MatchStatus.INLIER for match in slam.matches), 10)
        self.assertGreater(slam.report.stage_ns.sum(), 0)
        self.assertEqual(slam.motion_since_mark.covariance.shape, (6, 6))
        hits = [slam.hit_test((u, v)) for u in range(20, 320, 40) for v in range(20, 240, 40)]
        hit = next(hit for hit in hits if hit is not None)
        self.assertEqual(slam.find_plane(hit.plane), hit.plane)
        pixel, covariance = slam.project(hit.p_W)
        self.assertTrue(0 <= pixel[0] < 320 and covariance.shape == (2, 2))
        anchor = slam.anchor(slam.add_anchor_hit(hit))
        self.assertEqual(anchor.plane, hit.plane)
        np.testing.assert_allclose(anchor.p_WA, hit.p_W, atol=1e-6)
        beside = slam.add_anchor_pose(slam.pose)
        self.assertEqual([one.id for one in slam.anchors], [anchor.id, beside])
        slam.remove_anchor(anchor.id)
        self.assertIsNone(slam.anchor(anchor.id))
        ray = planefold.unproject(slam.camera, pixel)
        np.testing.assert_allclose(planefold.project(slam.camera, ray), pixel, atol=1e-6)
        ahead = slam.predict_pose(t_ns + 10_000_000)
        np.testing.assert_allclose(ahead.p_WC, slam.pose.p_WC + 0.01 * slam.pose.v_W, atol=1e-3)
        self.assertIsNone(slam.template(1))
        self.assertEqual(slam.patches, [])
        self.assertEqual(slam.camera_covariance.shape, (10, 10))
        with self.assertRaisesRegex(planefold.Error, "set_second_pose"):  # the filter takes none
            slam.set_second_pose(t_ns + 1, slam.pose)
        self.assertIsNone(slam.inertial)
        self.assertEqual(slam.gauge_information().shape, (7, 7))
        slam.withdraw_target()
        slam.reset()
        with self.assertRaises(planefold.Error):
            slam.pose

    def test_walls(self):
        scene = planefold.Sim("room")
        slam = planefold.Slam(planefold.Config(camera=scene.camera))
        slam.start_from_pose(planefold.Pose(covariance=1e-4 * np.eye(6)), 0.01 * np.eye(6))
        prior = planefold.WallPrior(R_WP=np.diag([1.0, -1.0, -1.0]), p_WP=[0, 0, 2], covariance=1e-4 * np.eye(3), outline_count=4,
                                     outline_P=[[-1, -1], [1, -1], [1, 1], [-1, 1]])
        with self.assertRaisesRegex(planefold.Error, "add_wall"):
            slam.add_wall(planefold.WallPrior())
        number = slam.add_wall(prior)
        self.assertEqual([(plane.id, plane.is_wall) for plane in slam.planes], [(number, 1)])
        self.assertEqual(slam.planes[0].outline_count, 4)
        slam.set_gravity([0, 9.81, 0])
        self.assertEqual(slam.planes[0].orientation, planefold.Orientation.VERTICAL)

    def test_research_goes_into_a_config_and_out_again(self):
        config = planefold.Config()
        self.assertEqual(planefold.get_research(config).keep_gauge, 1)
        planefold.set_research(config, planefold.Research(keep_gauge=0, fold=planefold.Fold.DROP))
        self.assertEqual((planefold.get_research(config).keep_gauge, planefold.get_research(config).fold), (0, planefold.Fold.DROP))
        self.assertEqual(planefold.get_research(config.copy()).keep_gauge, 0)
        planefold.set_research(config)
        self.assertEqual(planefold.get_research(config).keep_gauge, 1)

    def test_inertial_samples(self):
        scene = planefold.Sim("desk")
        unit = planefold.SimImu(scene)
        config = planefold.Config(camera=scene.camera, imu=unit.options.model)
        config.motion.model = planefold.MotionModel.INERTIAL
        config.capacity.max_imu_samples = 64
        slam = planefold.Slam(config)
        for number, (image, t_ns) in enumerate(scene):
            samples = unit.until(t_ns)
            if number % 2:
                slam.push_imu(samples)
            else:
                slam.push_imu([sample.t_ns for sample in samples], np.array([sample.gyro for sample in samples], np.float32),
                              [sample.accel for sample in samples])
            slam.push_frame(image, t_ns)
            if number == 30:
                break
        for times, rates, line in (([0.5], [[0, 0, 0]], "whole nanoseconds"),
                                   ([10**12], [[0, 0]], "gyro: takes three numbers for each of the 1"),
                                   (["10"], [[0, 0, 0]], "whole nanoseconds"),
                                   ([10**12, 2 * 10**12], [[0, 0, 0]], "for each of the 2")):
            with self.assertRaisesRegex((TypeError, ValueError), line):
                slam.push_imu(times, rates, rates)
        self.assertEqual(slam.imu_report.used, 1)
        self.assertGreater(slam.imu_report.samples, 150)
        self.assertEqual(len(slam.imu_samples), 64)
        self.assertEqual(slam.inertial.covariance.shape, (8, 8))

    def test_dates_are_counted_in_nanoseconds(self):
        config = planefold.Config(camera=planefold.Sim("desk").camera, imu=planefold.SimImu(planefold.Sim("desk")).options.model)
        config.motion.model = planefold.MotionModel.INERTIAL
        config.capacity.max_imu_samples = 64
        for unit in ("us", "ms", "ns"):
            slam = planefold.Slam(config)
            dates = np.datetime64("2026-11-29T12:00:00", unit) + np.arange(4) * np.timedelta64(5, "ms")
            slam.push_imu(dates, np.zeros((4, 3)), np.tile([0, 0, 9.81], (4, 1)))
            first = 1_795_953_600 * 10**9
            self.assertEqual([sample.t_ns for sample in slam.imu_samples], [first + 5_000_000 * number for number in range(4)])

    def test_rectangles_are_whole_pixels(self):
        config = python_package.desk(planefold)
        config.capacity.mask = config.camera.width * config.camera.height
        slam = planefold.Slam(config)
        for given in ([(0.1, 0.1, 0.5, 0.5)], np.zeros((1, 4)), [("0", "0", "9", "9")]):
            with self.assertRaisesRegex(TypeError, "whole pixels"):
                slam.set_mask(rectangles=given)
        slam.set_mask(rectangles=np.array([(0, 0, 9, 9)], np.uint8))

    def test_observations(self):
        slam = planefold.Slam(python_package.desk(planefold))
        slam.push_observations(0, [planefold.Observation(id=number, pixel=[20 + 10 * number, 50]) for number in range(20)])
        self.assertEqual(slam.report.new_features, 20)
        slam.push_control([0, 0, 0.1], [0, 0, 0])

    def test_memory_is_numpys(self):
        slam = planefold.Slam(python_package.desk(planefold))
        memory = planefold.query_memory(python_package.desk(planefold))
        self.assertEqual((slam.memory_bytes, slam.stack_bytes), (memory.bytes, memory.stack_bytes))


class Files(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def write(self, name, text):
        (self.folder / name).write_text(text)
        return self.folder / name

    def test_calibration_comes_back_as_it_was(self):
        camera = planefold.Sim("desk").camera
        planefold.write_calibration(self.folder / "calib.yaml", camera, 25.0)
        found, rate_hz = planefold.read_calibration(self.folder / "calib.yaml")
        self.assertEqual((repr(found), rate_hz), (repr(camera), 25.0))

    def test_targets_walls_and_samples(self):
        target = planefold.read_target(self.write("target.yaml", "width: 0.2\nheight: 0.1\n"))
        self.assertEqual((target.kind, target.width), (planefold.TargetKind.RECTANGLE, 0.2))
        self.assertEqual(planefold.parse_rectangle("0.2x0.1").height, 0.1)
        samples = planefold.read_imu(self.write("imu.csv", "1000,0.1,0,0,0,0,9.8\n2000,0.2,0,0,0,0,9.8\n"))
        self.assertEqual([(sample.t_ns, sample.gyro[0]) for sample in samples], [(1000, 0.1), (2000, 0.2)])
        wall = {"name": "north", "from": [0, 0], "to": [4, 0], "base": 0, "height": 2.5, "seen_from": "left", "sigma_rotation_deg": 1,
                "sigma_vertical_deg": 1, "sigma_offset_m": 0.02}
        walls, up = planefold.read_walls(self.write("plan.json", json.dumps({"planefold_walls": 1, "up": [0, 0, 1], "walls": [wall]})))
        self.assertEqual([(name, prior.outline_count) for name, prior in walls], [("north", 4)])
        self.assertEqual(list(up), [0, 0, 1])

    def test_files_that_cannot_be_read_are_refused_in_one_line(self):
        broken = self.write("broken", "{")
        for read in (planefold.read_calibration, planefold.read_target, planefold.read_imu, planefold.read_walls, planefold.read_first_pose):
            with self.assertRaisesRegex(planefold.Refused, "broken") as raised:
                read(broken)
            self.assertNotIn("\n", str(raised.exception))

    def test_images_that_cannot_be_used_are_passed_over_with_a_warning(self):
        planefold.write_calibration(self.folder / "calib.yaml", planefold.Sim("desk").camera, 30.0)
        (self.folder / "images").mkdir()
        for number, (image, _) in zip(range(3), planefold.Sim("desk")):
            name = self.folder / "images" / f"{number}.pgm"
            name.write_bytes(b"P5 320 240 255\n" + (image.tobytes() if number != 1 else b"short"))
        with self.assertWarnsRegex(RuntimeWarning, "times.txt"):
            sequence = planefold.open_sequence(f"images:{self.folder}")
        with self.assertWarnsRegex(RuntimeWarning, "1.pgm"):
            times = [t_ns for _, t_ns in sequence]
        self.assertEqual((len(sequence), len(times)), (3, 2))
        self.assertEqual(sequence[-1][1], times[-1])
        with self.assertRaises(planefold.Refused):
            sequence[1]
        with self.assertRaises(IndexError):
            sequence[3]


if __name__ == "__main__":
    unittest.main(verbosity=2)
