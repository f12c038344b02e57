"""tools/remake-results: every table that it remakes has its block on a page and every block a recipe; a program's numbers replace what is between
the marks and nothing else; a program that fails changes nothing."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

TOOL = script.SOURCE / "tools/remake-results"
PAGES = script.SOURCE / "lib/docs/results"
PROGRAM = """#!/usr/bin/env python3
import json, sys
rows = [{"name": "search", "us": 1234.0, "peer": "another", "ratio": 0.5}, {"name": "another", "us": 2468.0, "peer": None, "ratio": None}]
with open(sys.argv[sys.argv.index("--json") + 1], "w") as file:
    json.dump({"rows": rows}, file)
"""

SIMULATION = """#!/usr/bin/env python3
import json, sys
words = sys.argv
seed, seconds = (int(words[words.index(name) + 1]) for name in ("--first-seed", "--seconds"))
two = {"median": 0.01, "p95": 0.02}
starts = {"accepted": 0 if seed == 301 else seconds, "good": 90, "accepted_poor": 0, "wrong": 1, "scale_error": two, "scale_nees": 1.5, "tilt_deg": two, "at_s": two}
with open(words[words.index("--json") + 1], "w") as file:
    json.dump({"settings": {"first_seed": seed, "seconds": seconds}, "starts": starts}, file)
"""


def remake(*words):
    return subprocess.run([sys.executable, TOOL, *map(str, words)], text=True, capture_output=True, check=False)


class RemakeResults(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.bin = pathlib.Path(self.folder.name) / "bin"
        self.bin.mkdir()
        self.pages = pathlib.Path(self.folder.name) / "pages"
        shutil.copytree(PAGES, self.pages)

    def program(self, text, name="pf-bench"):
        (self.bin / name).write_text(text)
        (self.bin / name).chmod(0o755)

    def test_each_recipe_has_its_block_and_each_block_a_recipe(self):
        listed = remake("--list").stdout.split("not remade yet")[0]
        recipes = {tuple(line.split()[0::2][:2]) for line in listed.splitlines()[1:]}
        blocks = {(name, path.name) for path in PAGES.glob("*.md") for name in re.findall(r"<!-- remake (\w+) -->\n.*?<!-- end -->", path.read_text(), re.S)}
        self.assertEqual(recipes, blocks)

    def test_numbers_replace_what_is_between_the_marks(self):
        self.program(PROGRAM)
        done = remake("template", "--bin", self.bin, "--pages", self.pages)
        self.assertEqual(done.returncode, 0, done.stderr)
        was, now = ((folder / "templates.md").read_text() for folder in (PAGES, self.pages))
        self.assertIn("| search | 1.23 ms | another | 0.50 |", now)
        outside = re.compile(r"<!-- remake template -->.*?<!-- end -->", re.S)
        self.assertEqual(outside.sub("", was), outside.sub("", now))
        for path in PAGES.glob("*.md"):
            if path.name != "templates.md":
                self.assertEqual(path.read_text(), (self.pages / path.name).read_text())

    def test_a_table_of_several_commands_has_a_column_for_each(self):
        self.program(SIMULATION, "pf-sim")
        done = remake("starts", "--bin", self.bin, "--pages", self.pages)
        self.assertEqual(done.returncode, 0, done.stderr)
        now = (self.pages / "inertial.md").read_text()
        self.assertIn("| 3 s, seeds from 101 | 5 s, seeds from 101 | 3 s, seeds from 201 | 3 s, seeds from 301 |", now)
        self.assertIn("| 80 of 90 | 3 of 90 | 5 of 90 | 3 of 90 | 0 of 90 |", now)
        self.assertIn("| 1.0 %, 2.0 % | 1.0 %, 2.0 % | 1.0 %, 2.0 % | none |", now)

    def test_sequences_are_asked_for_where_a_command_needs_them(self):
        self.program("#!/bin/sh\nexit 0\n", "pf-sim")
        done = subprocess.run([sys.executable, TOOL, "kidnap", "--bin", self.bin, "--pages", self.pages], text=True, capture_output=True, check=False,
                              env={name: value for name, value in os.environ.items() if name != "PLANEFOLD_DATA"})
        self.assertEqual((done.returncode, len(done.stderr.strip().splitlines())), (1, 1), done.stderr)
        self.assertIn("PLANEFOLD_DATA", done.stderr)

    def test_a_program_that_fails_changes_nothing(self):
        self.program("#!/bin/sh\necho broken\nexit 2\n")
        done = remake("template", "--bin", self.bin, "--pages", self.pages)
        self.assertEqual(done.returncode, 1)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        self.assertIn("template", done.stderr)
        self.assertEqual((PAGES / "templates.md").read_text(), (self.pages / "templates.md").read_text())

    def test_an_unknown_name_is_a_wrong_command_line(self):
        done = remake("nothing")
        self.assertEqual(done.returncode, 2)
        self.assertIn("nothing", done.stderr)


if __name__ == "__main__":
    unittest.main()
