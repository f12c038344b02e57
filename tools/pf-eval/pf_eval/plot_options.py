"""plot-run: what its command line may hold. Needs nothing but Python, so that --help does not either."""

import argparse

from .command_line import OneLineParser

DESCRIPTION = """Draws a run of pf-capture into RUN/plots: trajectory.png (from above and from the side, with points and planes of the map), frames.png
(matches, size of the state, milliseconds and innovations over time) and, where truth is known, errors.png: with 3-sigma
bounds where the run is in the truth's own frame, after alignment otherwise."""


def arguments(words):
    parser = OneLineParser(prog="plot-run", description=DESCRIPTION,
                           formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", metavar="RUN", help="output folder of pf-capture")
    parser.add_argument("--truth", metavar="FILE.tum", help="default: truth.tum in RUN, if it is there")
    parser.add_argument("--align", choices=["none", "se3", "sim3"], help="as in pf-eval")
    parser.add_argument("--out", metavar="DIR", help="default: RUN/plots")
    return parser.parse_args(words)
