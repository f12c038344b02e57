"""tools/ray-sequence: what its command line may hold. Needs nothing but Python, so that --help does not either."""

import argparse
import pathlib

from pf_eval.command_line import OneLineParser

SCENES = {
    "corridor": "a walk along 24 m of corridor with doors and posters, round its corner, and 12 m on",
    "outdoor": "along house fronts with windows, lawn and trees; the sky is half of the picture",
    "desk": "things on a desk under lamps that flicker, a rolling shutter of 30 ms, exposure that jumps as the window comes into view",
    "lift": "in a lift whose doors open after 4 s, then out into the hall",
    "shelf": "along a shop's shelf from 1 m: rows of the same packets",
    "turns": "a furnished room with turns of up to 120 degrees a second",
    "white": "a white room with few pictures, a lens of 50 degrees, 10 frames a second",
}
BOUNDS = {"frames": (1, 1e6), "width": (16, 4096), "height": (16, 4096), "fov_deg": (5, 150), "rate_hz": (0.1, 1000),
          "exposure_s": (0, 1),
          "readout_s": (0, 0.2), "flicker": (0, 1), "subframes": (1, 64), "jobs": (1, 64), "seed": (0, 2**31)}


def arguments(words):
    about = "Renders a sequence with exact poses by POV-Ray, for pf-capture --source images:OUT and tools/compare-runs. The scenes:\n\n"
    about += "\n".join(f"  {name:9} {text}" for name, text in SCENES.items())
    parser = OneLineParser(prog="ray-sequence", description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", choices=list(SCENES), metavar="SCENE")
    parser.add_argument("out", type=pathlib.Path, metavar="OUT", help="folder for images, times.txt, calib.yaml and groundtruth.tum")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of everything that is drawn at random (1)")
    parser.add_argument("--frames", type=int, metavar="N", help="only the first N")
    parser.add_argument("--width", type=int, metavar="PX", help="of the images; what is not given is as the scene has it")
    parser.add_argument("--height", type=int, metavar="PX", help="of the images; a multiple of 8 with a rolling shutter")
    parser.add_argument("--fov", type=float, dest="fov_deg", metavar="DEG", help="field of view of the width")
    parser.add_argument("--rate", type=float, dest="rate_hz", metavar="HZ", help="frames a second")
    parser.add_argument("--exposure", type=float, dest="exposure_s", metavar="S", help="which smears what moves")
    parser.add_argument("--readout", type=float, dest="readout_s", metavar="S",
                        help="of a rolling shutter, from the first row to the last")
    parser.add_argument("--flicker", type=float, metavar="SHARE", help="of the light that goes with mains of 50 Hz")
    parser.add_argument("--auto-exposure", action=argparse.BooleanOptionalAction, default=None, help="that jumps when the light changes")
    parser.add_argument("--subframes", type=int, default=4, metavar="N", help="renderings that are averaged per frame (4)")
    parser.add_argument("--jobs", type=int, default=4, metavar="N",
                        help="calls of POV-Ray at a time, each of which waits half of its time (4)")
    options = parser.parse_args(words)
    for name, (low, high) in BOUNDS.items():
        value = getattr(options, name)
        if value is not None and not low <= value <= high:
            parser.error(f"--{name.split('_')[0]} {value:g} is not from {low:g} to {high:g}")
    return options
