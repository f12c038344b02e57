"""adjust-run: what its command line may hold. Needs nothing but Python, so that --help does not either."""

import argparse
import pathlib

from .command_line import OneLineParser

DESCRIPTION = """Adjusts all tracked frames of a run together with all of its points, offline, from the matches that the run made itself
(pf-capture --tracks), and says how far the run's positions are from the adjusted ones after a similarity. What is left against the truth then
is due to the matches, the lens and the shutter; the rest is the estimator's. Takes about a minute for 300 frames."""

NOTES = "Exit code: 0 done, 1 something cannot be used (one line says what), 2 the command line is wrong."


def arguments(words):
    parser = OneLineParser(prog="adjust-run", description=DESCRIPTION, epilog=NOTES, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", metavar="RUN", type=pathlib.Path, help="output folder of pf-capture --tracks")
    parser.add_argument("--calib", metavar="FILE", type=pathlib.Path, help="calibration (default: the lens of the run)")
    parser.add_argument("--exact-lens", action="store_true", help="take the lens as exact (default: focal length and k1 are adjusted as well)")
    parser.add_argument("--truth", metavar="FILE", type=pathlib.Path, help="true poses (TUM), to which run and adjusted poses are compared")
    parser.add_argument("--out", metavar="FILE", type=pathlib.Path, help="write the adjusted poses (TUM)")
    parser.add_argument("--rounds", metavar="N", type=int, default=60, help="at most (default %(default)s)")
    options = parser.parse_args(words)
    if options.rounds < 1:
        parser.error(f"--rounds {options.rounds}: at least 1 is needed")
    return options
