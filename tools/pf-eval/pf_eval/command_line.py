"""Command lines of pf-eval, compare-runs and plot-run."""

import argparse
import sys


class OneLineParser(argparse.ArgumentParser):
    """Says in one line what is wrong, as the other programs do, and not the usage before it."""

    def error(self, message):
        print(f"{self.prog}: {message}; see {self.prog} --help", file=sys.stderr)
        sys.exit(2)
