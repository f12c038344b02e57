"""Planes in the film and on the map have the colours of their classes where gravity is known: in the picture they are those that
lib/docs/reference/files.md names, a legend says which is which, and people with red-green blindness can tell them apart. Where gravity is not
known, a plane has the colour of its number, and there is no legend."""

import itertools
import json
import pathlib
import re
import struct
import sys
import tempfile
import zlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import window_picture  # noqa: E402
from script import BIN, SOURCE, fail, run, skip  # noqa: E402

WIDTH, SWATCH, LEAST_APART, DOT = 640, 9, 20.0, 3  # of the frame in the picture, of a colour in the legend [px]; of two colours in CIELAB
# What eyes without one kind of cones see, in linear RGB (Machado, Oliveira and Fernandes 2009, severity 1).
EYES = {"all cones": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
        "no long cones": ((0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998)),
        "no medium cones": ((0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.011820, 0.042940, 0.968881))}
XYZ = ((0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505))


def read_png(path):
    """Rows of (r, g, b) of a PNG with 8 bits and without interlace."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", data[at + 8:at + 18])
        elif kind == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += 12 + length
    size = {2: 3, 6: 4}[colour]
    if depth != 8:
        fail(f"{path} has {depth} bits")
    raw, rows, above = zlib.decompress(packed), [], bytearray(size * width)
    for y in range(height):
        kind, *row = raw[y * (size * width + 1):(y + 1) * (size * width + 1)]
        for i in range(size * width):
            left, up, corner = row[i - size] if i >= size else 0, above[i], above[i - size] if i >= size else 0
            paeth = min((abs(up - corner), 0, left), (abs(left - corner), 1, up), (abs(left + up - 2 * corner), 2, corner))[2]
            row[i] = (row[i] + (0, left, up, (left + up) // 2, paeth)[kind]) & 255
        rows.append([tuple(row[i:i + 3]) for i in range(0, size * width, size)])
        above = row
    return rows


def lab(colour, eyes):
    light = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in (level / 255 for level in colour)]
    seen = [min(1.0, max(0.0, sum(a * b for a, b in zip(row, light)))) for row in eyes]
    parts = [sum(a * b for a, b in zip(row, seen)) / white for row, white in zip(XYZ, (0.9505, 1.0, 1.089))]
    x, y, z = (t ** (1 / 3) if t > 0.008856 else 7.787 * t + 16 / 116 for t in parts)
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


def is_there(rows, colour, left, right, size):
    """A square of this size and colour between two columns."""
    counts = [0] * (right - left)
    for row in rows:
        length = 0
        for x in range(left, right):
            length = length + 1 if row[x] == colour else 0
            counts[x - left] = counts[x - left] + 1 if length >= size else 0
            if counts[x - left] >= size:
                return True
    return False


def named_colours():
    """Of the table of classes in files.md: name in the files, colour."""
    page = (SOURCE / "lib/docs/reference/files.md").read_text()
    return {name: tuple(int(part, 16) for part in parts)
            for name, *parts in re.findall(r"^\| `(\w+)` \|.*`#(..)(..)(..)` \|$", page, re.MULTILINE)}


def picture(folder, *words):
    out = run(BIN / "pf-capture", "--source", "sim:desk", "--start", "target", "--frames", 150, "--headless", "--quiet", "--no-film", "--out", folder, *words)
    if not (folder / "overlay_last.png").exists():
        skip(f"pf-capture was built without drawing: {out}")
    return read_png(folder / "overlay_last.png"), json.loads((folder / "report.json").read_text())["planes"]


def main():
    if not (BIN / "pf-capture").is_file():
        skip("pf-capture was not built")
    colours = named_colours()
    if sorted(colours) != sorted(["vertical", "horizontal_up", "horizontal_down", "other", "unknown"]):
        fail(f"files.md names the colours of {sorted(colours)}")
    for eyes, matrix in EYES.items():
        apart, a, b = min((sum((p - q) ** 2 for p, q in zip(lab(colours[a], matrix), lab(colours[b], matrix))) ** 0.5, a, b)
                          for a, b in itertools.combinations(colours, 2))
        print(f"{eyes}: {apart:.1f} apart at least, {a} and {b}")
        if apart < LEAST_APART:
            fail(f"{eyes}: {a} and {b} are {apart:.1f} apart, {LEAST_APART} are asked for")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        rows, planes = picture(pathlib.Path(name) / "with", "--gravity", "0,1,0")
        classes = {plane["orientation"] for plane in planes}
        print("planes at the end:", sorted(plane["orientation"] for plane in planes))
        if not {"vertical", "horizontal_up"} <= classes:
            fail("the desk and its wall have no classes")
        for orientation, colour in colours.items():
            if not is_there(rows, colour, WIDTH, len(rows[0]), SWATCH):
                fail(f"no legend beside the frame has {orientation}, {colour}")
            drawn = is_there(rows, colour, 0, WIDTH, DOT)  # points on a plane are dots in its colour
            if drawn != (orientation in classes):
                fail(f"the frame {'has' if drawn else 'lacks'} points in the colour of {orientation}, {colour}")
        rows, planes = picture(pathlib.Path(name) / "without")
        for orientation, colour in colours.items():
            if is_there(rows, colour, 0, len(rows[0]), DOT):
                fail(f"gravity is not known, and the picture has the colour of {orientation}")
        for plane in planes:
            colour = tuple(round(level) for level in window_picture.levels(window_picture.plane_colour(plane["id"])))
            found = any(sum(abs(a - b) for a, b in zip(pixel, colour)) <= 3 for row in rows for pixel in row[:WIDTH])
            if not found and plane["points"] > 0:
                fail(f"plane {plane['id']} has no points in the colour of its number, {colour}")


main()
