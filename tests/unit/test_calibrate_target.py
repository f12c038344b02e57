"""pf-calibrate --print-target: a PDF whose page and squares have the size that was asked for, to a thousandth of a
millimetre."""

import pathlib
import re
import subprocess
import sys
import tempfile
import zlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

PROGRAM = script.BIN / "pf-calibrate"
if not PROGRAM.exists():
    script.skip("pf-calibrate is not built: it needs OpenCV's calib3d")
script.skip_in_cross_builds()

MM = 25.4 / 72
KNOWS_MARKERS = "was made without" not in script.run(PROGRAM, "--help")


def page_and_squares(path):
    """Page size, and x, y, width and height of the quadrangles of a PDF [mm]."""
    data = path.read_bytes()
    box = re.search(rb"/MediaBox \[\s*0 0 ([\d.]+) ([\d.]+)", data)
    streams = []
    for start in re.finditer(rb"stream\r?\n", data):
        try:
            streams.append(zlib.decompressobj().decompress(data[start.end():]).decode("latin-1"))
        except zlib.error:
            pass
    number = r"(-?[\d.]+)"
    corner = rf"{number}\s+{number}"
    squares = []
    for text in streams:
        for match in re.findall(rf"{corner}\s+m\s+{corner}\s+l\s+{corner}\s+l\s+{corner}\s+l\s+h", text):
            x, y = [float(v) * MM for v in match[0::2]], [float(v) * MM for v in match[1::2]]
            squares.append((min(x), min(y), max(x) - min(x), max(y) - min(y)))
    return [float(side) * MM for side in box.groups()], squares


def near(name, actual, expected, tolerance=0.001):
    print(f"{name}: {actual:.4f} mm, asked for {expected} mm")
    if abs(actual - expected) > tolerance:
        script.fail(f"{name} is {actual} mm and not {expected} mm")


with tempfile.TemporaryDirectory() as folder:
    target = pathlib.Path(folder) / "target.pdf"
    for kind, board, page, size, squares, side in (("chessboard", "10x7:0.025", "a4", (297.0, 210.0), 35, 25.0),
                                                   ("charuco", "10x7:0.025", "a4", (297.0, 210.0), 35, 25.0),
                                                   ("chessboard", "7x10:0.025", "a4", (210.0, 297.0), 35, 25.0),
                                                   ("charuco", "9x6:0.04", "420x297", (420.0, 297.0), 27, 40.0)):
        if kind == "charuco" and not KNOWS_MARKERS:
            continue
        print(kind, board)
        target.unlink(missing_ok=True)  # what is there is left as it is
        script.run(PROGRAM, "--print-target", target, "--target", kind, "--board", board, "--page", page)
        found_size, rectangles = page_and_squares(target)
        near("page width", found_size[0], size[0], 0.01)
        near("page height", found_size[1], size[1], 0.01)
        dark = [r for r in rectangles if abs(r[2] - side) < 1]
        if len(dark) != squares:
            script.fail(f"{len(dark)} dark squares, not {squares}")
        for name, index in (("square width", 2), ("square height", 3)):
            near(name, max((r[index] for r in dark), key=lambda v: abs(v - side)), side)
        # The dark rows of a marker's border are six modules wide: as wide as the marker.
        borders = [r for r in rectangles if abs(r[2] - 0.7 * side) < 0.01]
        if len(borders) < (2 * squares if kind == "charuco" else 0) or (kind == "chessboard" and borders):
            script.fail(f"{len(borders)} borders of markers on a {kind}")
        columns = sorted({round(r[0], 3) for r in dark})
        near("columns apart", max(columns) - min(columns), (int(board.split("x")[0]) - 1) * side, 0.002)

    too_large = subprocess.run([PROGRAM, "--print-target", target, "--board", "20x7:0.025"], text=True, capture_output=True)
    if too_large.returncode == 0 or "does not fit" not in too_large.stderr:
        script.fail(f"a board larger than the page was not refused: {too_large.stderr}")
