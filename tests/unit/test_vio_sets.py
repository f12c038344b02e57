"""vio-sets: each set is its own command line with its own first seed, reports of the same program are kept, and mistakes get one line."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import SOURCE  # noqa: E402

TOOL = SOURCE / "tools/vio-sets"
# Stands in for pf-sim: its drift is the first seed, in thousandths.
PROGRAM = """#!{python}
import json, pathlib, sys
words = sys.argv[1:]
value = lambda name: words[words.index(name) + 1]
with open(pathlib.Path({log!r}), "a") as file:
    file.write(" ".join(words) + "\\n")
if "--rendered" in words and {broken}:
    sys.exit("pf-sim vio: the library refused the config")
pathlib.Path(value("--json")).write_text(json.dumps({{"nees_pose": {{"mean": 6.1}}, "drift_share": {{"median": int(value("--first-seed")) / 1000}},
                                                      "scale_error_5s": {{"p95": -1}}, "starts": {{"accepted": int(value("--seeds"))}}}}))
"""


def vio_sets(*words):
    return subprocess.run([sys.executable, str(TOOL), *map(str, words)], capture_output=True, text=True, check=False)


class VioSets(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="planefold_")
        self.folder = pathlib.Path(self.temporary.name)
        self.addCleanup(self.temporary.cleanup)
        self.log = self.folder / "commands.txt"
        self.make(broken=False)

    def make(self, broken):
        program = self.folder / "pf-sim"
        program.write_text(PROGRAM.format(python=sys.executable, log=str(self.log), broken=broken))
        program.chmod(0o755)

    def test_five_sets_should_run_once_with_seeds_of_their_own(self):
        for _ in range(2):  # the second time nothing is run again
            done = vio_sets("--out", self.folder / "out", f"old={self.folder}")
            self.assertEqual(done.returncode, 0, done.stderr)
            commands = self.log.read_text().splitlines()
            self.assertEqual(len(commands), 5)
        seeds = [line.split("--first-seed ")[1].split()[0] for line in commands]
        self.assertEqual(len(set(seeds)), 5)
        self.assertIn("| rest ", done.stdout)
        self.assertIn("10.100", done.stdout)  # drift of the set that begins with seed 101
        self.assertNotIn("scale after", done.stdout)  # which no report knows

    def test_fewer_seeds_and_one_set_should_be_what_is_run(self):
        done = vio_sets("--out", self.folder / "out", "--set", "moving", "--seeds", 3, f"old={self.folder / 'pf-sim'}")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(self.log.read_text().splitlines()), 1)
        self.assertIn("--start moving --seeds 3 --first-seed 101", self.log.read_text())

    def test_mistakes_should_get_one_line(self):
        self.make(broken=True)
        for code, part, words in ((2, "--set sleeping", ["--out", self.folder, "--set", "sleeping"]), (2, "--out", []),
                                  (1, "NAME=PROGRAM", ["--out", self.folder, "pf-sim"]), (1, "is no program", ["--out", self.folder, "a=/nowhere"]),
                                  (1, "refused the config", ["--out", self.folder, "--set", "rendered", f"a={self.folder}"])):
            done = vio_sets(*words)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertIn(part, done.stderr)


if __name__ == "__main__":
    unittest.main()
