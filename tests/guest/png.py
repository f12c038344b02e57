"""Pixels of the recordings that pf-capture makes: 8-bit grey PNG without filters."""

import struct
import zlib


def pixels(path):
    data = path.read_bytes()
    at, compressed, width, height = 8, b"", 0, 0
    while at < len(data):
        length, = struct.unpack(">I", data[at:at + 4])
        kind = data[at + 4:at + 8]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", data[at + 8:at + 18])
            assert depth == 8 and colour == 0, path
        elif kind == b"IDAT":
            compressed += data[at + 8:at + 8 + length]
        at += 12 + length
    rows = zlib.decompress(compressed)
    assert len(rows) == (width + 1) * height and not any(rows[::width + 1]), path
    return b"".join(rows[y * (width + 1) + 1:(y + 1) * (width + 1)] for y in range(height))


def recording(folder):
    """(time in ns, pixels) of each frame, in order."""
    table = (folder / "mav0/cam0/data.csv").read_text().splitlines()
    rows = [line.split(",") for line in table if not line.startswith("#")]
    return [(int(t), pixels(folder / "mav0/cam0/data" / name)) for t, name in rows]
