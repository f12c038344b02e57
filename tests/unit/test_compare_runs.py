"""compare-runs: medians and worst values are those of the runs, a failed run counts as worst, and mistakes get one line."""

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

from pf_eval.compare_runs import main  # noqa: E402

# Stands in for pf-capture: tracks 100, 90, 80 ... of 100 frames with the start, and fails where --fail names the start.
PROGRAM = """#!{python}
import json, pathlib, sys
words = sys.argv[1:]
value = lambda name: words[words.index(name) + 1]
skip = int(value("--skip"))
with open(pathlib.Path({log!r}), "a") as file:
    file.write(" ".join(words) + "\\n")
if "--fail" in words and int(value("--fail")) == skip:
    sys.exit("pf-capture: none of the frames was tracked")
if "--nonsense" in words:
    print("pf-capture: --nonsense is not known", file=sys.stderr)
    sys.exit(2)
out = pathlib.Path(value("--out"))
if set(path.name for path in out.glob("*")) - {{"trajectory.txt", "report.json"}}:
    sys.exit(f"pf-capture: {{out}}: has files that are none of pf-capture's")
out.mkdir(exist_ok=True)
(out / "trajectory.txt").write_text("".join(f"{{k}} {{k * k}} {{k}} 0 0 0 0 1\\n" for k in range(9)))
(out / "report.json").write_text(json.dumps({{
    "frames": 100, "tracked": 100 - 10 * skip, "lost": skip, "start_frame": 1, "nis_per_dof": 1.5, "planes": [1, 2],
    "features_in_map": {{"folded": 5, "fixed": 1}},
    "folding": {{"share_folded": 0.1 * (5 - skip), "frames_with_plane": 1.0, "share_rows_saved": 0.05}}, "ms_per_frame": {{"median": 0.5}}}}))
"""


def compare_runs(*words):
    out, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors):
        code = main([str(word) for word in words])
    return code, out.getvalue(), errors.getvalue()


class CompareRuns(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="planefold_")
        self.folder = pathlib.Path(self.temporary.name)
        self.addCleanup(self.temporary.cleanup)
        self.log = self.folder / "commands.txt"
        self.program = self.folder / "capture"
        self.program.write_text(PROGRAM.format(python=sys.executable, log=str(self.log)))
        self.program.chmod(0o755)
        for name in ("desk", "hall"):
            sequence = self.folder / "data" / name
            sequence.mkdir(parents=True)
            (sequence / "calib.yaml").write_text("")
            (sequence / "times.txt").write_text("")
            (sequence / "groundtruth.tum").write_text("".join(f"{k} {2 * k * k} {2 * k} 0 0 0 0 1\n" for k in range(9)))

    def test_table_should_show_the_median_and_the_worst(self):
        code, out, _ = compare_runs("--data", self.folder / "data", "--out", self.folder / "out", f"a={self.program}")
        self.assertEqual(code, 0)
        self.assertIn("80.0 (60.0)", out)  # tracked: the smallest is the worst
        self.assertIn("2 (4)", out)        # lost: the largest
        self.assertIn("6 (6)", out)        # folded and fixed
        self.assertIn("30.0 (10.0)", out)  # share folded: the smallest is the worst
        self.assertIn("0.0 (0.0)", out)    # ATE: twice as large a world is the same one
        self.assertIn("desk, 5 starts", out)

    def test_failed_run_should_count_as_the_worst_and_be_named(self):
        _, out, _ = compare_runs("--data", self.folder / "data", "--out", self.folder / "out", "--only", "desk",
                                 f"a={self.program} --fail 1")
        self.assertIn("70.0 (none)", out)
        self.assertIn("a, desk, start 1: pf-capture: none of the frames was tracked", out)
        self.assertNotIn("hall", out)

    def test_variants_should_take_turns(self):
        compare_runs("--data", self.folder / "data", "--out", self.folder / "out", "--only", "desk", "--starts", "2",
                     f"a={self.program}", f"b={self.program} --no-planes")
        with_planes = ["--no-planes" not in line for line in self.log.read_text().splitlines()]
        self.assertEqual(with_planes, [True, False, True, False])

    def test_runs_that_are_there_should_be_kept_while_the_program_is_the_same(self):
        words = ["--data", self.folder / "data", "--out", self.folder / "out", "--starts", "1", f"a={self.program}"]
        _, before, _ = compare_runs(*words)
        _, after, _ = compare_runs(*words)
        self.assertEqual(before, after)
        self.assertEqual(len(self.log.read_text().splitlines()), 2)
        self.program.write_text(self.program.read_text() + "\n")
        compare_runs(*words)
        self.assertEqual(len(self.log.read_text().splitlines()), 4)

    def test_films_should_be_compared_with_the_focal_length_of_the_calibration(self):
        (self.folder / "films").mkdir()
        (self.folder / "films" / "desk.mkv").write_text("made before")
        (self.folder / "data" / "desk" / "calib.yaml").write_text("width: 320\nheight: 240\nfx: 200\nfy: 200\ncx: 160\ncy: 120\ndistortion_model: none\n")
        self.program.write_text(self.program.read_text() + "print(f'focal length {203 + skip / 5} px, standard deviation 1.0 px (0.5 %): well known')\n")
        code, out, errors = compare_runs("--data", self.folder / "data", "--films", self.folder / "films", "--out", self.folder / "out", "--only", "desk",
                                         "--starts", "2", f"a={self.program}")
        self.assertEqual((code, errors), (0, ""))
        self.assertEqual(out.count("| +2.0 (+2.5) "), 2, out)     # 203 and 205 px for 200, with both back ends
        self.assertEqual(out.count("| +4.0 (+5.0) "), 2, out)     # of their own standard deviations
        self.assertEqual(out.count("| 2 of 2     | 2 of 2 "), 2, out)
        self.assertIn(f"--source video:{self.folder}/films/desk.mkv --skip 10 --backend filter", self.log.read_text())
        code, _, errors = compare_runs("--data", self.folder / "data", "--films", self.folder / "new", "--out", self.folder / "out", f"a={self.program}")
        self.assertEqual((code, errors.count("\n")), (1, 1))      # the other sequence lists no frames
        self.assertIn("make a film", errors)

    def test_show_should_put_two_folders_beside_each_other(self):
        for name in ("old", "new"):
            compare_runs("--data", self.folder / "data", "--out", self.folder / name, "--starts", "1", f"a={self.program}")
        code, out, _ = compare_runs("--show", self.folder / "old", self.folder / "new")
        self.assertEqual(code, 0)
        self.assertIn("| old: a", out)
        self.assertIn("| new: a", out)

    def test_runs_json_of_another_program_should_stay(self):
        (self.folder / "out").mkdir()
        for text in ("{}", "[1]", "by hand", '[{"variant": "a"}]'):
            (self.folder / "out" / "runs.json").write_text(text)
            for words in (["--data", self.folder / "data", "--out", self.folder / "out", f"a={self.program}"], ["--show", self.folder / "out"]):
                code, out, err = compare_runs(*words)
                self.assertEqual((code, out, len(err.splitlines())), (1, "", 1), f"{words}: {out}{err}")
                self.assertIn("is no result of compare-runs", err)
            self.assertEqual((self.folder / "out" / "runs.json").read_text(), text)
        self.assertFalse(self.log.exists())

    def test_mistakes_should_get_one_line(self):
        data = ["--data", self.folder / "data", "--out", self.folder / "out"]
        for words, part in ((data + ["a=/no/such/program"], "is no program"), (data + [str(self.program)], "write NAME=PROGRAM"),
                            (data + [f"a={self.program}", "--only", "attic"], "there are desk, hall"),
                            (data + [f"a={self.program}", f"a={self.program}"], "is there twice"),
                            (data + [f"a={self.program} --nonsense"], "--nonsense is not known"),
                            (["--show", self.folder / "nothing"], "is no result of compare-runs"),
                            (["--data", self.folder, "--out", self.folder / "out", f"a={self.program}"], "has no sequence")):
            code, _, errors = compare_runs(*words)
            self.assertEqual(code, 1, words)
            self.assertEqual(errors.count("\n"), 1, errors)
            self.assertIn(part, errors)


if __name__ == "__main__":
    unittest.main()
