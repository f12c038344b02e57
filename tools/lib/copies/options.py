"""tools/copies: what its command line may hold, and the kinds by name. Needs nothing but Python, so that --help does not either."""

import argparse
import os
import pathlib

from pf_eval.command_line import OneLineParser

# Kind: (part of the short set, what it is).
KINDS = {
    "plain": (True, "nothing changed"),
    "noise-3": (False, "noise of 3 grey levels added"),
    "noise-5": (False, "of 5"),
    "noise-8": (True, "of 8"),
    "blur-1": (False, "blurred, sigma 1 px"),
    "blur-2": (True, "sigma 2 px"),
    "gamma-bright": (False, "gamma 0.6"),
    "gamma-dark": (False, "gamma 1.7"),
    "half-light": (False, "half of the light"),
    "low-contrast": (False, "a quarter of the contrast"),
    "flicker": (False, "light that flickers by a fifth from frame to frame"),
    "exposure": (False, "exposure that jumps by up to 1.6 each second"),
    "vignette": (False, "corners with 0.4 of the light"),
    "speckles": (False, "one pixel in 500 black or white, others in each frame"),
    "dust": (False, "dark spots on the lens, which stand still"),
    "compressed": (False, "JPEG of quality 15"),
    "smear": (False, "mean of each frame and the one before"),
    "backwards": (True, "from the last frame to the first"),
    "mirrored": (False, "left is right"),
    "turned": (False, "by 180 degrees about the axis of view"),
    "half-size": (False, "half of the pixels each way"),
    "crop-around": (False, "without 7.5 % on each side"),
    "crop-above": (False, "without the upper 15 %"),
    "dropped-20": (True, "a fifth of the frames never come"),
    "dropped-35": (False, "35 % of them"),
    "second": (False, "every second frame"),
    "third": (False, "every third frame"),
    "rate-10": (True, "10 frames a second"),
    "rate-5": (True, "5 frames a second"),
    "body": (True, "a dark textured shape fixed in the lower fifth, as the carrier's own body"),
    "date": (True, "a date and a clock drawn over the picture"),
    "zoom": (False, "a lens that is 1.18 times as long from frame 100 on, beside the calibration; from the middle on of less than 200"),
    "zoom-slow": (False, "the same, reached over 60 frames, or the second third of less than 180"),
    "frame": (True, "a recorder's frame and cross drawn over the picture"),
}
SHORT_SEQUENCES = 3
SHORT_FRAMES = 120
DESCRIPTION = """Writes copies of sequences as folders of images with their own calibration, times and truth, one folder for each sequence and kind:
OUT/SEQUENCE.KIND. tools/compare-runs --copies OUT makes a table of runs on them. Without --all, --kinds and --only: a short set of ten kinds of the
first three sequences, 120 frames each. The same command makes the same pixels. The kinds:

"""


def arguments(words):
    about = DESCRIPTION + "\n".join(f"  {name:13} {meaning}{' (short set)' if short else ''}" for name, (short, meaning) in KINDS.items())
    parser = OneLineParser(prog="copies", description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", metavar="DIR", type=pathlib.Path, help="folder of the sequences (default: $PLANEFOLD_DATA)")
    parser.add_argument("--out", metavar="DIR", type=pathlib.Path, help="folder for the copies")
    parser.add_argument("--all", action="store_true", help="all kinds of all sequences, all frames")
    parser.add_argument("--kinds", nargs="+", metavar="KIND", help="these kinds")
    parser.add_argument("--only", action="append", metavar="NAME", help="a sequence to copy, may be repeated")
    parser.add_argument("--frames", type=int, metavar="N", help=f"the first N of each sequence (short set {SHORT_FRAMES}, else all)")
    parser.add_argument("--list", action="store_true", help="print the kinds and do nothing else")
    parser.add_argument("--quiet", action="store_true", help="no progress")
    options = parser.parse_args(words)
    for kind in options.kinds or []:
        if kind not in KINDS:
            parser.error(f"--kinds {kind}: there is no such kind; --list names them")
    if options.list:
        return options
    if options.out is None:
        parser.error("give a folder for the copies with --out")
    if options.frames is not None and options.frames < 2:
        parser.error("--frames is 2 or more")
    options.data = options.data or (pathlib.Path(os.environ["PLANEFOLD_DATA"]) if os.environ.get("PLANEFOLD_DATA") else None)
    if options.data is None or not options.data.is_dir():
        parser.error("no sequences: give their folder with --data, or set PLANEFOLD_DATA")
    return options
