"""pf-eval --there-and-back: the distance of an image's two poses is measured against the extent, and mistakes get one line."""

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

from pf_eval.main import main  # noqa: E402

IMAGES = 40
RATE = 30.0
BEGIN = 1403636579.0  # [s], as real clocks count


def write_run(folder, shift, scale=1.0, starting=0, report=True):
    """A run along x, 2 m long times scale, whose way back is off by shift (also times scale)."""
    turn = BEGIN + (IMAGES - 1) / RATE
    there = np.linspace(0.0, 2.0, IMAGES)
    x = np.concatenate([there, there[-2::-1]])
    t = np.concatenate([BEGIN + np.arange(IMAGES) / RATE, turn + np.arange(1, IMAGES) / RATE])
    y = np.concatenate([np.zeros(IMAGES), np.full(IMAGES - 1, shift)])
    with open(folder / "trajectory.txt", "w") as file:
        file.writelines(f"{a:.9f} {scale * b:.9f} {scale * c:.9f} 0 0 0 0 1\n" for a, b, c in zip(t, x, y))
    with open(folder / "frames.csv", "w") as file:
        file.write("t_s,state\n")
        file.writelines(f"{a:.9f},{'starting' if k < starting else 'tracking'}\n" for k, a in enumerate(t))
    written = {"start": "auto"}
    if report:
        written["there_and_back"] = {"turn_s": turn, "images": IMAGES}
    (folder / "report.json").write_text(json.dumps(written))


def evaluate(*words):
    out, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors):
        code = main([str(word) for word in words])
    return code, out.getvalue(), errors.getvalue()


class ThereAndBack(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="planefold_")
        self.folder = pathlib.Path(self.temporary.name)
        self.addCleanup(self.temporary.cleanup)

    def test_distance_should_be_a_share_of_the_extent_whatever_the_scale(self):
        for scale in (1.0, 7.0):
            write_run(self.folder, 0.05, scale)
            code, out, _ = evaluate(self.folder, "--there-and-back", "--json")
            summary = json.loads(out)
            self.assertEqual(code, 0)
            self.assertAlmostEqual(summary["back_distance_median"], 0.05 / 2.0, places=6)
            self.assertEqual(summary["pairs"], IMAGES - 1)
            self.assertLess(summary["back_rotation_max_deg"], 1e-6)

    def test_poses_should_not_count_while_the_run_is_starting(self):
        write_run(self.folder, 0.05, starting=10)
        _, out, _ = evaluate(self.folder, "--there-and-back", "--json")
        self.assertEqual(json.loads(out)["pairs"], IMAGES - 1 - 10)

    def test_truth_should_be_compared_with_the_way_there_only(self):
        write_run(self.folder, 0.5)
        truth = self.folder / "groundtruth.tum"
        with open(truth, "w") as file:  # goes on along x after the turn
            file.writelines(f"{BEGIN + k / RATE:.9f} {2.0 * k / (IMAGES - 1):.9f} {0.01 * (k % 2)} 0 0 0 0 1\n"
                            for k in range(2 * IMAGES))
        _, out, _ = evaluate(self.folder, "--truth", truth, "--align", "none", "--json")
        summary = json.loads(out)
        self.assertEqual(summary["pairs"], IMAGES)
        self.assertLess(summary["ate_rmse_m"], 0.01)

    def test_run_without_a_way_back_should_be_refused_in_one_line(self):
        write_run(self.folder, 0.05, report=False)
        code, _, errors = evaluate(self.folder, "--there-and-back")
        self.assertEqual(code, 1)
        self.assertEqual(errors.count("\n"), 1)
        self.assertIn("run pf-capture with --there-and-back", errors)

    def test_run_that_tracked_nothing_should_be_refused_in_one_line(self):
        write_run(self.folder, 0.05, starting=2 * IMAGES)
        code, _, errors = evaluate(self.folder, "--there-and-back")
        self.assertEqual(code, 1)
        self.assertIn("no frame was tracked", errors)


if __name__ == "__main__":
    unittest.main()
