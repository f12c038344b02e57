"""The Python package gives what pf-capture gives, to the last digit; what it refuses, it refuses in one line; a context that two threads
use at once raises."""

import gc
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import weakref

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import python_package  # noqa: E402
import script  # noqa: E402

planefold = python_package.enter()
import numpy as np  # noqa: E402

FRAMES = 60


def lines(path):
    return [line for line in path.read_text().splitlines() if not line.startswith("#")]


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


class Masks(unittest.TestCase):
    def matches_below(self, row, **mask):
        config = python_package.desk(planefold)
        config.capacity.mask = config.camera.width * config.camera.height
        slam = planefold.Slam(config)
        if mask:
            self.assertEqual(slam.set_mask(**mask), planefold.Status.OK)
        count = 0
        for number, (image, t_ns) in enumerate(planefold.Sim("desk")):
            if number == 12:
                break
            slam.push_frame(image, t_ns)
            count += sum(match.status != planefold.MatchStatus.MISSED and match.measured_px[1] >= row - 1 for match in slam.matches)
        return count

    def test_what_is_masked_should_not_be_measured(self):
        camera = python_package.desk(planefold).camera
        row = camera.height // 2
        pixels = np.full((camera.height, camera.width), 255, np.uint8)
        pixels[row:] = 0
        self.assertGreater(self.matches_below(row), 0)
        self.assertEqual(self.matches_below(row, pixels=pixels), 0)
        self.assertEqual(self.matches_below(row, rectangles=[(0, row, camera.width, camera.height)]), 0)

    def test_a_wrong_mask_should_raise(self):
        config = python_package.desk(planefold)
        config.capacity.mask = config.camera.width * config.camera.height
        slam = planefold.Slam(config)
        for mask in ({}, {"pixels": np.zeros((3, 3), np.uint8)}, {"rectangles": [(0, 0, 10000, 10000)]}):
            with self.assertRaises(planefold.Error):
                slam.set_mask(**mask)


class Images(unittest.TestCase):
    def test_rows_may_lie_apart(self):
        whole, cut = planefold.Slam(python_package.desk(planefold)), planefold.Slam(python_package.desk(planefold))
        for number, (image, t_ns) in enumerate(planefold.Sim("desk")):
            if number == 12:
                break
            wide = np.full((image.shape[0], image.shape[1] + 50), 77, np.uint8)
            wide[:, 20:-30] = image
            self.assertEqual(whole.push_frame(image, t_ns), cut.push_frame(wide[:, 20:-30], np.int64(t_ns)))
        self.assertEqual(list(whole.pose.p_WC), list(cut.pose.p_WC))

    def test_images_that_do_not_fit_are_refused_in_one_line(self):
        slam = planefold.Slam(python_package.desk(planefold))
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
        config = python_package.desk(planefold)
        config.capacity.max_state_dim = 5
        with self.assertRaises(planefold.Error) as raised:
            planefold.Slam(config)
        self.assertIs(raised.exception.status, planefold.Status.ERROR_CONFIG)
        self.assertEqual(raised.exception.field, "capacity.max_state_dim")
        self.assertIn("capacity.max_state_dim", raised.exception.text)

    def test_error_of_time(self):
        slam = planefold.Slam(python_package.desk(planefold))
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

        slam = planefold.Slam(python_package.desk(planefold), log=log)
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

        slam = planefold.Slam(python_package.desk(planefold), log=log)
        for image, t_ns in planefold.Sim("desk"):
            slam.push_frame(image, t_ns)
            if seen:
                break
        self.assertTrue(seen)


class Memory(unittest.TestCase):
    def test_a_slam_whose_log_leads_back_to_it_is_collected(self):
        class Keeper:
            def log(self, line):
                self.line = line

        def make():
            keeper = Keeper()
            keeper.slam = planefold.Slam(python_package.desk(planefold), log=keeper.log)
            return weakref.ref(keeper)

        kept = make()
        gc.collect()
        self.assertIsNone(kept())

    def test_asking_takes_no_memory(self):
        scene, slam = planefold.Sim("desk"), planefold.Slam(python_package.desk(planefold))
        for _, (image, t_ns) in zip(range(30), scene):
            slam.push_frame(image, t_ns)

        def ask():
            for _ in range(300):
                slam.pose.q_WC, slam.features, slam.matches, slam.report.stage_ns, slam.config.camera.distortion, slam.hit_test((10, 10))

        ask()
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        ask()
        self.assertLess(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before, 2000, "KiB more than before")


class Threads(unittest.TestCase):
    def test_python_goes_on_during_a_frame_and_a_second_user_is_refused(self):
        slam, refused, done = planefold.Slam(python_package.desk(planefold)), [], threading.Event()

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
                if refused and number > 10:
                    break
        finally:
            done.set()
            other.join()
        self.assertTrue(refused, "no call met the other one")
        self.assertIn("another thread is using this Slam", str(refused[0]))
        self.assertIs(refused[0].status, planefold.Status.ERROR_STATE)


class Importing(unittest.TestCase):
    def test_import_takes_at_most_half_again_as_long_as_numpy(self):
        def seconds(module):
            began = time.perf_counter()
            subprocess.run([sys.executable, "-c", f"import {module}"], check=True,
                           env={**os.environ, "PYTHONPATH": str(python_package.PACKAGE)})
            return time.perf_counter() - began

        pairs = [(seconds("planefold"), seconds("numpy")) for _ in range(7)][2:]
        ours, theirs = (statistics.median(column) for column in zip(*pairs))
        print(f"import planefold {1000 * ours:.0f} ms, import numpy {1000 * theirs:.0f} ms")
        self.assertLessEqual(ours, 1.5 * theirs)


if __name__ == "__main__":
    unittest.main(verbosity=2)
