"""tools/copies: the command."""

import pathlib
import shutil
import sys
import zlib

from .options import KINDS, SHORT_FRAMES, SHORT_SEQUENCES


class Refused(Exception):
    """One line for the user."""


def sequences_of(options):
    found = {path.parent.name: path.parent for path in sorted(options.data.glob("*/calib.yaml")) if (path.parent / "times.txt").is_file()}
    if not found:
        raise Refused(f"{options.data}: has no sequence (a folder with calib.yaml, times.txt and images/)")
    for name in options.only or []:
        if name not in found:
            raise Refused(f"{options.data / name}: is no sequence; there are {', '.join(found)}")
    names = options.only or (list(found) if options.all or options.kinds else list(found)[:SHORT_SEQUENCES])
    return {name: found[name] for name in names}


def rows_of(path):
    """(seconds, name) of times.txt."""
    rows = [line.split() for line in path.read_text().splitlines() if line and not line.startswith("#")]
    if any(len(row) != 3 for row in rows):
        raise Refused(f"{path}: has rows that are not index, seconds, name")
    return [(float(row[1]), row[2]) for row in rows]


def write_truth(source, target, turn, times, backwards):
    """The truth's rows as the copy's camera has them; backwards, times are those of the same frame in the copy."""
    rows = [[float(word) for word in line.split()] for line in source.read_text().splitlines() if line and not line.startswith("#")]
    rows = [turn(row) if turn else row for row in rows]
    if backwards:
        rows = [[times[0] + times[-1] - row[0], *row[1:]] for row in rows][::-1]
    target.write_text("".join(f"{row[0]:.9f} " + " ".join(f"{value:.12g}" for value in row[1:]) + "\n" for row in rows))


def write_calibration(camera, target):
    lines = [f"{name}: {value}" for name, value in camera.items() if not isinstance(value, (dict, list))]
    lines += [f"{name}: [{', '.join(f'{v!r}' for v in value)}]" for name, value in camera.items() if isinstance(value, list)]
    target.write_text("\n".join(lines) + "\n")


def make_copy(sequence, kind, target, frames):
    import numpy as np
    import yaml
    from PIL import Image

    from .frames import CHOSEN, rate_of
    from .geometry import PLACES
    from .pictures import CHANGES, CHANGES_OF_LENGTH

    rows = rows_of(sequence / "times.txt")[:frames]
    seed = zlib.crc32(f"{sequence.name} {kind}".encode())
    draw = np.random.default_rng(seed)
    times = [t for t, _ in rows]
    chosen = CHOSEN[kind](times, draw) if kind in CHOSEN else list(range(len(rows)))
    move, adapt, turn = PLACES.get(kind, (None, None, None))
    camera = yaml.safe_load((sequence / "calib.yaml").read_text())
    if "fx" not in camera:
        raise Refused(f"{sequence / 'calib.yaml'}: is not of the plain form (fx, fy, cx, cy)")
    camera = {name: value for name, value in camera.items() if not name.startswith(("T_", "imu", "gyro", "accel", "gravity"))}
    if adapt:
        adapt(camera)
    if camera.get("rate_hz"):
        camera["rate_hz"] = rate_of(kind, camera["rate_hz"], len(rows), len(chosen))
    backwards = kind == "backwards"
    change = CHANGES_OF_LENGTH[kind](len(chosen)) if kind in CHANGES_OF_LENGTH else CHANGES.get(kind)
    (target / "images").mkdir(parents=True)
    lines, before = [], None
    for number, index in enumerate(chosen):
        t, name = rows[index]
        t = times[0] + times[-1] - t if backwards else t
        image = np.asarray(Image.open(sequence / "images" / name).convert("L"))
        if kind == "smear":
            image, before = (image if before is None else ((image.astype(np.uint16) + before + 1) // 2).astype(np.uint8)), image
        image = move(image) if move else image
        image = change(image, index, draw) if change else image
        Image.fromarray(np.ascontiguousarray(image)).save(target / "images" / f"{number:06d}.png", compress_level=1)
        lines.append(f"{number} {t:.9f} {number:06d}.png\n")
    (target / "times.txt").write_text("".join(lines))
    write_calibration(camera, target / "calib.yaml")
    if (sequence / "groundtruth.tum").is_file():
        write_truth(sequence / "groundtruth.tum", target / "groundtruth.tum", turn, times, backwards)
    if (sequence / "target.yaml").is_file() and not move and chosen[0] == 0:
        shutil.copy(sequence / "target.yaml", target / "target.yaml")
    (target / "copy.txt").write_text(f"{kind} of {sequence.name}: {KINDS[kind][1]}\n")


def run(options):
    kinds = options.kinds or [name for name, (short, _) in KINDS.items() if short or options.all]
    short = not (options.all or options.kinds or options.only)
    frames = options.frames or (SHORT_FRAMES if short else None)
    jobs = [(path, kind) for path in sequences_of(options).values() for kind in kinds]
    for done, (path, kind) in enumerate(jobs, 1):
        target = options.out / f"{path.name}.{kind}"
        if target.exists() and not (target / "copy.txt").is_file():
            if any(target.iterdir()) and not (target / "images").is_dir():
                raise Refused(f"{target}: holds files that are no copy; name another --out")
            shutil.rmtree(target)  # one that was not finished
        if not target.exists():
            target.mkdir(parents=True)
            make_copy(path, kind, target, frames)
        if not options.quiet and sys.stderr.isatty():
            print(f"\r{done} of {len(jobs)} copies", end="\n" if done == len(jobs) else "", file=sys.stderr, flush=True)
    print(f"{len(jobs)} copies in {options.out}")


def main(options):
    if options.list:
        for name, (short, meaning) in KINDS.items():
            print(f"{name:13} {meaning}{' (short set)' if short else ''}")
        return 0
    try:
        run(options)
    except Refused as refused:
        print(f"copies: {refused}", file=sys.stderr)
        return 1
    except OSError as error:
        print(f"copies: {error.filename or options.out}: {error.strerror}", file=sys.stderr)
        return 1
    return 0
