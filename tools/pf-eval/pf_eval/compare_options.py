"""compare-runs: what its command line may hold. Needs nothing but Python, so that --help does not either."""

import argparse

from .command_line import OneLineParser

DESCRIPTION = """Runs one or several builds or sets of options of pf-capture on sequences from several starts (--skip 0, 1, ...),
interleaved, and prints a table per sequence: the median over the starts, and the worst in brackets.

  tools/compare-runs --out DIR [VARIANT ...] [--starts N] [--data DIR] [--only NAME]
  tools/compare-runs --show DIR [DIR]
  tools/compare-runs --copies COPIES --out DIR [VARIANT ...]
  tools/compare-runs --films FILMS --out DIR [VARIANT ...]

VARIANT is "NAME=PROGRAM [options]" in one word, for example
  now=build/release/bin/pf-capture  "no planes=build/release/bin/pf-capture --no-planes"
Without any: now=build/release/bin/pf-capture."""

NOTES = """A sequence is a folder with calib.yaml, times.txt and images/. With target.yaml it starts from that target, else with
nothing known. groundtruth.tum gives the position error after Sim(3) alignment, target_corners.csv that of the target's corners;
with --there-and-back among a variant's options the distance of each image's two poses is shown as well. The largest value counts
as the worst, but for tracked frames, planes and folding the smallest; "share folded", "frames with a plane" and "rows saved" are
means over tracked frames from frame 60 on; a run that failed is worse than any, and shows as
"none". With --copies: runs on the copies of tools/copies, with both back ends (so no --backend among the options; a
VARIANT may be "NAME=FOLDER" that holds pf-capture), one table by kind: share of frames tracked, runs below 90 %, maps a run,
frames lost, and, where there is truth, frames of the largest map that have turned since its first by more than 5 degrees and
5 of their own sigmas from it, and the rotation error after alignment, median (largest). With --films: each sequence as a lossless
film without its calibration (FILMS keeps the films), with both back ends: share of frames tracked, median (least), and the focal
length that is found against that of calib.yaml, in percent and in its own standard deviations, median (largest). Runs that are already in DIR, made by the same program, are not made again.

Exit code: 0 done, 1 something cannot be used (one line says what), 2 the command line is wrong."""


def arguments(words):
    parser = OneLineParser(prog="compare-runs", description=DESCRIPTION, epilog=NOTES,
                           formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("variants", metavar="VARIANT", nargs="*")
    parser.add_argument("--out", metavar="DIR", help="folder for the runs")
    parser.add_argument("--show", metavar="DIR", nargs="+", help="print the tables of one or two such folders; runs nothing")
    parser.add_argument("--copies", metavar="DIR", help="folder that tools/copies made")
    parser.add_argument("--films", metavar="DIR", help="folder for films of the sequences; ffmpeg makes those that are missing")
    parser.add_argument("--starts", metavar="N", type=int,
                        help="starts per sequence (default 5; with --copies 1; with --copies and --films each 10 frames after the other)")
    parser.add_argument("--data", metavar="DIR", help="folder of the sequences (default: $PLANEFOLD_DATA)")
    parser.add_argument("--only", metavar="NAME", action="append", help="a sequence to run, may be repeated (default: all)")
    parser.add_argument("--jobs", metavar="N", type=int, default=1, help="runs at a time (default 1; more make times worthless)")
    options = parser.parse_args(words)
    if (options.out is None) == (options.show is None):
        parser.error("give either --out or --show")
    if options.show and (options.variants or len(options.show) > 2):
        parser.error("--show takes one or two folders and no variants")
    if (options.copies or options.films) and options.show:
        parser.error("--copies and --films run, and --show runs nothing")
    if options.copies and options.films:
        parser.error("give one of --copies and --films")
    options.starts = options.starts if options.starts is not None else 1 if options.copies else 5
    if options.starts < 1 or options.jobs < 1:
        parser.error("--starts and --jobs must be at least 1")
    return options
