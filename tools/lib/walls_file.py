"""What tools/walls-from-obj and tools/walls-from-geojson share: options, names, and the file that pf-capture --walls reads
(platform/include/planefold_platform/walls.h)."""

import argparse
import json
import math
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "pf-eval"))

from pf_eval.command_line import OneLineParser  # noqa: E402

MAX_WALLS, MAX_NAME = 64, 63  # of a file; bytes


class Refused(Exception):
    """One line that says what is wrong with a file."""


def positive(text):
    value = float(text)
    if not (math.isfinite(value) and value > 0):
        raise argparse.ArgumentTypeError(f"{text} is not above zero")
    return value


def parser(about, kind):
    options = OneLineParser(description=about)
    options.add_argument("file", type=pathlib.Path, metavar="FILE", help=f"{kind} to read")
    options.add_argument("--out", type=pathlib.Path, metavar="WALLS.json", help="file to write, which must not be there yet; default: print")
    options.add_argument("--metres", action="store_true", help="the coordinates are metres; such files do not say it, so it is asked for")
    options.add_argument("--sigma-rotation", type=positive, default=2.0, metavar="DEG", help="how far a wall may be turned about up (2)")
    options.add_argument("--sigma-vertical", type=positive, default=1.0, metavar="DEG", help="how far out of the vertical (1)")
    options.add_argument("--sigma-offset", type=positive, default=0.05, metavar="M", help="how far along its normal (0.05)")
    options.add_argument("--roughness", type=positive, metavar="M", help="how far its points are off it; default: as the library's config says")
    return options


class Names:
    """Gives every wall a name that no other has."""

    def __init__(self):
        self.given = set()

    def of(self, name, fallback):
        text = "".join(c for c in str(name or "") if c.isprintable()).strip() or fallback
        for number in range(1, MAX_WALLS + 2):
            tail = "" if number == 1 else f" {number}"
            short = text.encode()[:MAX_NAME - len(tail)].decode(errors="ignore") + tail
            if short not in self.given:
                self.given.add(short)
                return short
        raise Refused(f"has more than {MAX_WALLS} walls called '{text}'")


def sigmas(options):
    fields = {"sigma_rotation_deg": options.sigma_rotation, "sigma_vertical_deg": options.sigma_vertical, "sigma_offset_m": options.sigma_offset}
    if options.roughness is not None:
        fields["roughness_m"] = options.roughness
    return fields


def write(options, up, walls, faces):
    count = len(walls) + len(faces)
    if count == 0:
        raise Refused("has no walls")
    if count > MAX_WALLS:
        raise Refused(f"has {count} walls; a file may have {MAX_WALLS}")
    text = json.dumps({"planefold_walls": 1, "up": up, "walls": walls, "faces": faces}, indent=1) + "\n"
    if options.out is None:
        print(text, end="")
        return
    with options.out.open("x") as file:
        file.write(text)
    print(f"{count} walls written to {options.out}")


def run(program, options, convert):
    """convert(text) -> (up, walls, faces). Returns the exit code: 2 where the command line or the file is wrong."""
    if not options.metres:
        print(f"{program}: nothing in {options.file} says how long its unit is; add --metres if its coordinates are metres", file=sys.stderr)
        return 2
    try:
        write(options, *convert(options.file.read_text(encoding="utf-8")))
    except FileExistsError:
        print(f"{program}: {options.out} is there already, and is left as it is; choose another name", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"{program}: {error.filename}: {error.strerror}", file=sys.stderr)
        return 2
    except (Refused, UnicodeDecodeError) as error:
        what = "is no text" if isinstance(error, UnicodeDecodeError) else error
        print(f"{program}: {options.file} {what}", file=sys.stderr)
        return 2
    return 0
