"""pf-eval --relative: motions whose errors are drawn from their covariance have a NEES of one per degree of freedom, whatever the frame
of the run, and with a free scale whatever its unit; mistakes get one line."""

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

from pf_eval.main import main  # noqa: E402

FRAMES, WINDOW, SEED = 3001, 30, 7
BEGIN = 1403636579.0  # [s], as real clocks count


def write_run(folder, claimed=1.0, unit=1.0, start="target", drift=0.0):
    """A run whose motions are off by draws from their covariance, of which it says `claimed` times as much; lengths are times unit, which
    grows by drift over the run."""
    print(f"seed {SEED}")
    random = np.random.default_rng(SEED)
    t = BEGIN + np.arange(FRAMES) / 30
    R = Rotation.from_rotvec(np.cumsum(0.01 * random.normal(size=(FRAMES, 3)), axis=0))
    p = np.cumsum(0.02 * random.normal(size=(FRAMES, 3)), axis=0)
    with open(folder / "groundtruth.tum", "w") as file:
        file.writelines(f"{a:.9f} {b[0]:.9f} {b[1]:.9f} {b[2]:.9f} {q[0]:.9f} {q[1]:.9f} {q[2]:.9f} {q[3]:.9f}\n"
                        for a, b, q in zip(t, p, R.as_quat()))
    (folder / "trajectory.txt").write_text(f"{BEGIN:.9f} 0 0 0 0 0 0 1\n")
    (folder / "report.json").write_text(json.dumps({"start": start, "truth": str(folder / "groundtruth.tum")}))
    rows = ["mark_t_s,t_s,map,qw,qx,qy,qz,px,py,pz," + ",".join(f"c{i}{j}" for i in range(6) for j in range(6)) + ",nees,nees_dof\n"]
    for k in range(0, FRAMES - WINDOW, WINDOW):
        A = random.normal(size=(6, 8)) * 0.01
        C = A @ A.T
        e = np.linalg.cholesky(C) @ random.normal(size=6)
        q = (Rotation.from_rotvec(-e[:3]) * R[k].inv() * R[k + WINDOW]).as_quat()
        scale = unit * (1 + drift * k / FRAMES)
        size = np.diag([1, 1, 1, scale, scale, scale])
        p_KC = scale * (R[k].inv().apply(p[k + WINDOW] - p[k]) - e[3:])
        numbers = [q[3], q[0], q[1], q[2], *p_KC, *(claimed * size @ C @ size).flatten()]
        rows.append(f"{t[k]:.9f},{t[k + WINDOW]:.9f},1," + ",".join(f"{v:.9g}" for v in numbers) + ",,\n")
    (folder / "relative.csv").write_text("".join(rows))


def evaluate(*words):
    out, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors):
        code = main([str(word) for word in words])
    return code, out.getvalue(), errors.getvalue()


class Relative(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="planefold_")
        self.folder = pathlib.Path(self.temporary.name)
        self.addCleanup(self.temporary.cleanup)

    def numbers(self, *words):
        code, out, errors = evaluate(self.folder, "--relative", "--json", *words)
        self.assertEqual(code, 0, errors)
        return json.loads(out)

    def test_honest_motions_should_have_one_per_degree_of_freedom(self):
        write_run(self.folder)
        found = self.numbers()
        self.assertEqual(found["motions"], 100)
        self.assertTrue(0.85 < found["motion_nees_per_dof"] < 1.15, found)
        self.assertTrue(0.8 < found["motion_rotation_nees_per_dof"] < 1.2, found)

    def test_a_small_covariance_should_be_told(self):
        write_run(self.folder, claimed=0.25)
        self.assertTrue(3.4 < self.numbers()["motion_nees_per_dof"] < 4.6)

    def test_a_free_scale_should_not_matter(self):
        write_run(self.folder, unit=3.7, start="auto")
        found = self.numbers()
        self.assertTrue(0.85 < found["motion_nees_per_dof"] < 1.15, found)
        self.assertTrue(0.85 < found["motion_nees_per_dof_one_scale"] < 1.15, found)
        self.assertAlmostEqual(found["motion_scales"]["1"], 3.7, delta=0.2)
        self.assertGreater(self.numbers("--align", "none")["motion_nees_per_dof"], 5)

    def test_a_scale_that_drifts_should_show_with_one_scale_alone(self):
        write_run(self.folder, unit=1.0, start="auto", drift=1.0)
        found = self.numbers()
        self.assertTrue(0.85 < found["motion_nees_per_dof"] < 1.15, found)
        self.assertGreater(found["motion_nees_per_dof_one_scale"], 1.5)

    def test_mistakes_should_get_one_line(self):
        write_run(self.folder)
        (self.folder / "relative.csv").unlink()
        code, _, errors = evaluate(self.folder, "--relative")
        self.assertEqual(code, 1)
        self.assertIn("--relative 30", errors)
        self.assertEqual(len(errors.splitlines()), 1)
        with self.assertRaises(SystemExit):
            evaluate(self.folder, "--relative", "--there-and-back")


if __name__ == "__main__":
    unittest.main()
