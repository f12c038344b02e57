"""What the user should know of an input that could be read."""

import sys


def note(line):
    print(f"pf-eval: note: {line}", file=sys.stderr)
