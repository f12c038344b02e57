"""The Python package gives what pf-capture gives, to the last digit; its words are the header's; what it refuses, it refuses in one line;
and a context that two threads use at once raises."""

import json
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import python_package  # noqa: E402
import script  # noqa: E402

planefold = python_package.enter()
import numpy as np  # noqa: E402

FRAMES = 60


def lines(path):
    return [line for line in path.read_text().splitlines() if not line.startswith("#")]


def words(text):
    """Without stars, breaks and differences of blanks."""
    return re.sub(r"\s+", " ", re.sub(r"\n\s*\* ?", " ", text)).strip()


def desk(**fields):
    config = planefold.Config(camera=planefold.Sim("desk").camera)
    for name, value in fields.items():
        setattr(config, name, value)
    return config


class SameAsPfCapture(unittest.TestCase):
    def same(self, source):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "run"
            script.run(script.BIN / "pf-capture", "--source", source, "--frames", FRAMES, "--headless", "--no-film", "--quiet", "--out", out)
            _, poses = python_package.track(planefold, planefold.open_sequence(source), count=FRAMES)
            self.assertGreater(len(poses), FRAMES // 2)
            self.assertEqual([python_package.tum(pose) for pose in poses], lines(out / "trajectory.txt"))
            self.assertEqual([python_package.covariance(pose) for pose in poses], lines(out / "covariance.csv"))

    def test_scene(self):
        self.same("sim:desk")

    def test_recorded_sequence(self):
        data = os.environ.get("PLANEFOLD_DATA")
        if not data or not (pathlib.Path(data) / "monoslam_desk_a").is_dir():
            self.skipTest("PLANEFOLD_DATA has no monoslam_desk_a")
        self.same(f"images:{data}/monoslam_desk_a")


class Words(unittest.TestCase):
    """Nothing of the headers is missing, and every docstring is a comment of theirs."""

    library = [path.read_text() for path in sorted((script.SOURCE / "lib/include/planefold").glob("*.h"))]
    platform = [(script.SOURCE / f"platform/include/planefold_platform/{name}.h").read_text() for name in ("sim", "sequence", "walls")]
    headers = words("\n".join(library + platform))

    def test_docstrings_of_structures_are_the_headers_comments(self):
        seen = 0
        for name, kind in vars(planefold).items():
            if not isinstance(kind, type) or not hasattr(kind, "copy") or name in ("Slam",):
                continue
            for field, attribute in [*vars(kind).items(), (name, kind)]:
                if field.startswith("_") or field == "copy" or not attribute.__doc__:
                    continue
                for part in attribute.__doc__.split("\n\n"):
                    self.assertIn(words(part), self.headers, f"{name}.{field}")
                    seen += 1
        self.assertGreater(seen, 150)

    def test_docstring_of_a_function_is_its_comment(self):
        for function, comment in ((planefold.Slam.hit_test, "pf_hit_test"), (planefold.Slam.push_imu, "pf_push_imu"),
                                  (planefold.read_target, "pf_read_target"), (planefold.Slam.add_plane_prior, "pf_add_plane_prior")):
            text = "\n".join(self.library + self.platform)
            end = re.search(rf"\*/\n[^*\n]*\b{comment}\(", text).start()
            self.assertIn(words(text[text.rindex("/*", 0, end) + 2:end]), words(function.__doc__), comment)

    def test_every_function_of_the_library_is_offered(self):
        bindings = "\n".join(path.read_text() for path in (script.SOURCE / "tools/python/bindings").glob("*.cpp"))
        declared = re.findall(r"PF_API[^;(]*?\b(pf_\w+)\s*\(", "\n".join(self.library))
        self.assertGreater(len(declared), 30)
        self.assertEqual([name for name in declared if not re.search(rf"\b{name}\b", bindings)], [])

    def test_every_field_and_value_is_offered(self):
        text = re.sub(r"/\*.*?\*/", "", "\n".join(self.library), flags=re.S)
        for body, name in re.findall(r"typedef struct \w+ \{(.*?)\n\} (\w+);", text, re.S):
            if name == "pf_image_t":
                continue
            kind = getattr(planefold, "".join(word.capitalize() for word in name[3:-2].split("_")))
            declared = re.findall(r"^  (?:int32_t|uint32_t|int64_t|double|uint8_t|size_t|pf_\w+) ([^;(]*);", body, re.M)
            for field in ",".join(declared).split(","):
                self.assertTrue(hasattr(kind, re.match(r"\s*(\w*)", field).group(1)), f"{name}: {field}")
        values = {str(value) for kind in vars(planefold).values() if isinstance(kind, type) and issubclass(kind, int) for value in kind}
        for value in re.findall(r"^\s*PF_(ERROR|NOTE)_(\w+) = ", text, re.M):
            self.assertIn("Status." + "_".join(value), values)

    def test_version_is_that_of_the_project(self):
        project = re.search(r"project\(planefold VERSION (\S+)", (script.SOURCE / "CMakeLists.txt").read_text()).group(1)
        self.assertEqual(planefold.__version__, project)


class Structures(unittest.TestCase):
    def test_arrays_are_views_and_matrices_have_their_shape(self):
        config = planefold.Config()
        config.camera.distortion[1] = 0.25
        self.assertEqual(config.camera.distortion[1], 0.25)
        self.assertEqual(config.copy().camera.distortion[1], 0.25)
        self.assertEqual(planefold.Pose().covariance.shape, (6, 6))
        self.assertEqual(planefold.Plane().R_WP.shape, (3, 3))
        view = planefold.Pose(p_WC=[1, 2, 3]).p_WC  # keeps its structure alive
        self.assertEqual(list(view), [1, 2, 3])

    def test_a_part_of_a_structure_is_no_copy(self):
        config = planefold.Config()
        capacity = config.capacity
        capacity.max_features = 50
        self.assertEqual(config.capacity.max_features, 50)
        self.assertIn("max_features=50", repr(config.capacity))

    def test_short_lists_leave_zeros_where_the_header_does(self):
        camera = planefold.Camera(distortion=[0.1, 0.2])
        self.assertEqual(list(camera.distortion), [0.1, 0.2, 0, 0, 0, 0, 0, 0])

    def test_kinds_are_enums(self):
        config = planefold.Config()
        self.assertIs(config.motion.model, planefold.MotionModel.CONSTANT_VELOCITY)
        config.motion.model = planefold.MotionModel.INERTIAL
        self.assertEqual(config.motion.model, 4)

    def test_what_does_not_fit_is_refused_in_one_line(self):
        config = planefold.Config()
        for wrong, line in ((lambda: setattr(config.capacity, "max_features", 2.5), "ConfigCapacity.max_features: takes a whole number"),
                            (lambda: setattr(config.camera, "distortion", np.ones(9)), "takes at most 8 numbers, and was given 9"),
                            (lambda: planefold.Pose(p_WC=[1, 2]), "Pose.p_WC: takes 3 numbers, and was given 2"),
                            (lambda: planefold.Pose(p_CW=[1, 2, 3]), "Pose has no field p_CW"),
                            (lambda: setattr(config, "camera", planefold.Pose()), "Config.camera: takes a planefold.Camera, and not a Pose"),
                            (lambda: setattr(config, "camra", 1), "no attribute 'camra'")):
            with self.assertRaises((TypeError, ValueError, AttributeError)) as raised:
                wrong()
            self.assertIn(line, str(raised.exception))
            self.assertNotIn("\n", str(raised.exception))


class Images(unittest.TestCase):
    def test_rows_may_lie_apart(self):
        whole, cut = planefold.Slam(desk()), planefold.Slam(desk())
        for number, (image, t_ns) in enumerate(planefold.Sim("desk")):
            if number == 12:
                break
            wide = np.full((image.shape[0], image.shape[1] + 50), 77, np.uint8)
            wide[:, 20:-30] = image
            self.assertEqual(whole.push_frame(image, t_ns), cut.push_frame(wide[:, 20:-30], np.int64(t_ns)))
        self.assertEqual(list(whole.pose.p_WC), list(cut.pose.p_WC))

    def test_images_that_do_not_fit_are_refused_in_one_line(self):
        slam = planefold.Slam(desk())
        grey = np.zeros((240, 320), np.uint8)
        for image, line in ((grey.astype(float), "not uint8"), (np.zeros((240, 320, 3), np.uint8), "(240, 320, 3)"),
                            (np.zeros((240, 640), np.uint8)[:, ::2], "do not lie side by side"), (grey[::-1], "run backwards"),
                            (grey[:, ::-1], "do not lie side by side"), ([1, 2], "is a list"), (grey[:100], "the size of the calibration")):
            with self.assertRaises((TypeError, ValueError, planefold.Error)) as raised:
                slam.push_frame(image, 0)
            self.assertIn(line, str(raised.exception))
            self.assertNotIn("\n", str(raised.exception))
        with self.assertRaisesRegex(TypeError, "whole nanoseconds"):
            slam.push_frame(grey, 0.5)
        read_only = grey.copy()
        read_only.flags.writeable = False
        slam.push_frame(read_only, 0)


class Errors(unittest.TestCase):
    def test_error_has_status_text_and_field(self):
        config = desk()
        config.capacity.max_state_dim = 5
        with self.assertRaises(planefold.Error) as raised:
            planefold.Slam(config)
        self.assertIs(raised.exception.status, planefold.Status.ERROR_CONFIG)
        self.assertEqual(raised.exception.field, "capacity.max_state_dim")
        self.assertIn("capacity.max_state_dim", raised.exception.text)

    def test_error_of_time(self):
        slam = planefold.Slam(desk())
        image, t_ns = next(planefold.Sim("desk"))
        slam.push_frame(image, t_ns)
        with self.assertRaises(planefold.Error) as raised:
            slam.push_frame(image, t_ns)
        self.assertIs(raised.exception.status, planefold.Status.ERROR_TIME)
        self.assertIsNone(raised.exception.field)

    def test_sources_that_are_not_there(self):
        for source, line in (("images:/nowhere", "/nowhere"), ("sim:nowhere", "there are desk, room")):
            with self.assertRaisesRegex(planefold.Refused, line):
                planefold.open_sequence(source)

    def test_log_raises_where_it_was_written(self):
        def log(line):
            raise KeyError(line)

        slam = planefold.Slam(desk(), log=log)
        with self.assertRaises(KeyError):
            for image, t_ns in planefold.Sim("desk"):
                slam.push_frame(image, t_ns)
        self.assertEqual(slam.state, planefold.State.TRACKING)

    def test_log_may_ask_and_change_nothing(self):
        seen = []

        def log(line):
            seen.append((line, slam.report.frames))
            with self.assertRaises(planefold.Error):
                slam.reset()

        slam = planefold.Slam(desk(), log=log)
        for image, t_ns in planefold.Sim("desk"):
            slam.push_frame(image, t_ns)
            if seen:
                break
        self.assertTrue(seen)


class Threads(unittest.TestCase):
    def test_python_goes_on_during_a_frame_and_a_second_user_is_refused(self):
        slam, refused, done = planefold.Slam(desk()), [], threading.Event()

        def ask():
            while not done.is_set():
                try:
                    slam.state
                except planefold.Error as error:
                    refused.append(error)
                time.sleep(1e-5)

        other = threading.Thread(target=ask)
        other.start()
        try:
            for number, (image, t_ns) in enumerate(planefold.Sim("desk")):
                while True:
                    try:
                        slam.push_frame(image, t_ns)
                        break
                    except planefold.Error as error:
                        self.assertIn("another thread is using this Slam", str(error))
                if number > 100 or (refused and number > 10):
                    break
        finally:
            done.set()
            other.join()
        self.assertTrue(refused, "no call met the other one")
        self.assertIn("another thread is using this Slam", str(refused[0]))
        self.assertIs(refused[0].status, planefold.Status.ERROR_STATE)


class Scenes(unittest.TestCase):
    def test_target_planes_hits_and_projection(self):
        scene = planefold.Sim("desk")
        slam = planefold.Slam(desk(), clock=True)
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
        prior = planefold.PlanePrior(R_WP=np.diag([1.0, -1.0, -1.0]), p_WP=[0, 0, 2], covariance=1e-4 * np.eye(3), outline_count=4,
                                     outline_P=[[-1, -1], [1, -1], [1, 1], [-1, 1]])
        with self.assertRaisesRegex(planefold.Error, "add_plane_prior"):
            slam.add_plane_prior(planefold.PlanePrior())
        number = slam.add_plane_prior(prior)
        self.assertEqual([(plane.id, plane.known) for plane in slam.planes], [(number, 1)])
        self.assertEqual(slam.planes[0].outline_count, 4)
        slam.set_gravity([0, 9.81, 0])
        self.assertEqual(slam.planes[0].orientation, planefold.Orientation.VERTICAL)

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
        for times, rates, line in (([0.5], [[0, 0, 0]], "whole nanoseconds"), ([10**12], [[0, 0]], "gyro: takes three numbers for each of the 1"),
                                   ([10**12, 2 * 10**12], [[0, 0, 0]], "for each of the 2")):
            with self.assertRaisesRegex((TypeError, ValueError), line):
                slam.push_imu(times, rates, rates)
        self.assertEqual(slam.imu_report.used, 1)
        self.assertGreater(slam.imu_report.samples, 150)
        self.assertEqual(len(slam.imu_samples), 64)
        self.assertEqual(slam.inertial.covariance.shape, (8, 8))

    def test_observations(self):
        slam = planefold.Slam(desk())
        slam.push_observations(0, [planefold.Observation(id=number, pixel=[20 + 10 * number, 50]) for number in range(20)])
        self.assertEqual(slam.report.new_features, 20)
        slam.push_control([0, 0, 0.1], [0, 0, 0])

    def test_memory_is_numpys(self):
        slam = planefold.Slam(desk())
        memory = planefold.query_memory(desk())
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


class Importing(unittest.TestCase):
    def test_import_takes_at_most_half_again_as_long_as_numpy(self):
        def seconds(module):
            began = time.perf_counter()
            subprocess.run([sys.executable, "-c", f"import {module}"], check=True, env={**os.environ, "PYTHONPATH": str(python_package.PACKAGE)})
            return time.perf_counter() - began

        pairs = [(seconds("planefold"), seconds("numpy")) for _ in range(7)][2:]
        ours, theirs = (statistics.median(column) for column in zip(*pairs))
        print(f"import planefold {1000 * ours:.0f} ms, import numpy {1000 * theirs:.0f} ms")
        self.assertLessEqual(ours, 1.5 * theirs)


if __name__ == "__main__":
    unittest.main(verbosity=2)
