"""sweep-tuning finds every number of every tuning header, each of which says what it means, and halves and doubles it."""

import pathlib
import re
import subprocess
import sys
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SRC = SOURCE / "lib" / "src"
HEADERS = sorted(SRC.glob("**/tuning.h"))


def sweep(*words):
    return subprocess.run([sys.executable, SOURCE / "tools" / "sweep-tuning", *words], text=True, capture_output=True, check=False)


class SweepTuning(unittest.TestCase):
    def test_list_should_hold_every_number_of_every_header_once(self):
        done = sweep("--list")
        self.assertEqual(0, done.returncode, done.stderr)
        names = [line.split()[0] for line in done.stdout.splitlines()]
        self.assertEqual(len(names), len(set(names)))
        for header in HEADERS:
            written = re.findall(r"^inline constexpr \w+ (k[A-Z]\w*)\s*=", header.read_text(), re.MULTILINE)  # the compiler has to know static ones
            listed = [n.split(".")[2] for n in names if n.split(".")[0] == header.parent.relative_to(SRC).as_posix()]
            self.assertEqual(written, listed, header)
            self.assertTrue(written, header)

    def test_numbers_should_say_what_they_mean(self):
        for header in HEADERS:
            for line in header.read_text().splitlines():
                if re.search(r"\bk[A-Z]\w*\s*=", line):
                    self.assertRegex(line, r"; +///< \S", f"{header}: meaning and unit belong on the line of the number")

    def test_half_and_double_should_be_those_of_the_number(self):
        for line in sweep("--list").stdout.splitlines():
            name, value, half, double = re.match(r"(\S+)\s+(\S+)\s+half (.*?)\s+double (.*)", line).groups()
            number, small, large = (eval(re.sub(r"Scalar|(?<=[0-9.])f\b", "", text)) for text in (value, half, double))  # noqa: S307
            self.assertEqual(2 * number, large, name)
            self.assertLessEqual(abs(number / 2 - small), 0.5 if isinstance(number, int) and isinstance(small, int) else 0, name)

    def test_a_name_that_nothing_has_should_get_one_line(self):
        done = sweep("kNoSuchNumber")
        self.assertEqual(2, done.returncode)
        self.assertEqual(1, len(done.stderr.splitlines()), done.stderr)
        self.assertIn("kNoSuchNumber", done.stderr)


if __name__ == "__main__":
    unittest.main()
