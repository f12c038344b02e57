"""pf-calibrate with a ChArUco board as OpenCV before 4.6 printed it, with mirrored pictures, and with a film of the board."""

import math
import pathlib
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from films import ffmpeg, skip_without_ffmpeg  # noqa: E402
from script import BIN, fail, run, skip, skip_in_cross_builds  # noqa: E402

PROGRAM = BIN / "pf-calibrate"
COLUMNS, ROWS, SQUARE_M = 7, 10, 0.025
SQUARE_PX = 250            # of what is printed
PAGE = (2100, 2970)        # [px] a4
WIDTH, HEIGHT = 640, 480   # of the pictures
FOCAL_PX = 600.0
SHRUNK = 400 / (ROWS * SQUARE_PX)  # of the board that the pictures are made from
failures = []


def require(condition, what):
    print("ok  " if condition else "FAIL", what)
    if not condition:
        failures.append(what)


def whites(first):
    """White squares row by row; first: whether the one at the top left is."""
    return [(x, y) for y in range(ROWS) for x in range(COLUMNS) if ((x + y) % 2 == 0) == first]


def printed_board(root):
    """Rows of grey levels of the board that pf-calibrate prints."""
    run(PROGRAM, "--print-target", root / "page.png", "--target", "charuco", "--board", f"{COLUMNS}x{ROWS}:{SQUARE_M}")
    ffmpeg("-i", root / "page.png", "-f", "rawvideo", "-pix_fmt", "gray", root / "page.raw")
    page = (root / "page.raw").read_bytes()
    left, top = (PAGE[0] - COLUMNS * SQUARE_PX) // 2, (PAGE[1] - ROWS * SQUARE_PX) // 2
    return [page[(top + y) * PAGE[0] + left:][:COLUMNS * SQUARE_PX] for y in range(ROWS * SQUARE_PX)]


def old_board(board):
    """The same markers on the other squares, in the same order."""
    old = [bytearray(len(row)) for row in board]
    for (x, y), (to_x, to_y) in zip(whites(False), whites(True)):
        for row in range(SQUARE_PX):
            old[to_y * SQUARE_PX + row][to_x * SQUARE_PX:(to_x + 1) * SQUARE_PX] = \
                board[y * SQUARE_PX + row][x * SQUARE_PX:(x + 1) * SQUARE_PX]
    return old


def seen_corners(about_x, about_y, distance, right, down):
    """Where a camera sees the corners of a flat picture of its own size that fills its view at distance 1, as ffmpeg wants them."""
    corners = []
    for v in (0, HEIGHT):
        for u in (0, WIDTH):
            x, y, z = (u - WIDTH / 2) / FOCAL_PX, (v - HEIGHT / 2) / FOCAL_PX, 0.0
            y, z = y * math.cos(about_x), y * math.sin(about_x)
            x, z = x * math.cos(about_y) + z * math.sin(about_y), z * math.cos(about_y) - x * math.sin(about_y)
            z += distance
            corners += [FOCAL_PX * (x + right) / z + WIDTH / 2, FOCAL_PX * (y + down) / z + HEIGHT / 2]
    return ":".join(f"{value:.3f}" for value in corners)


def film(root, name, board):
    """A folder of pictures of the board and a film of them."""
    header = f"P5\n{COLUMNS * SQUARE_PX} {ROWS * SQUARE_PX}\n255\n".encode()
    (root / f"{name}.pgm").write_bytes(header + b"".join(bytes(row) for row in board))
    flat = root / f"{name}_flat.png"
    ffmpeg("-i", root / f"{name}.pgm", "-vf", f"scale=iw*{SHRUNK}:ih*{SHRUNK}:flags=area,pad={WIDTH}:{HEIGHT}:-1:-1:white", flat)
    folder = root / name
    folder.mkdir()
    poses = [(a, b, 1.05 + 0.1 * (k % 3), 0.12 * (k % 3 - 1), 0.06 * (k // 3 % 3 - 1))
             for k, (a, b) in enumerate((a, b) for a in (-0.6, 0.0, 0.6) for b in (-0.6, -0.3, 0.0, 0.3, 0.6))]
    for k, pose in enumerate(poses):
        ffmpeg("-i", flat, "-vf", f"perspective={seen_corners(*pose)}:sense=destination:interpolation=cubic", folder / f"{k:02d}.png")
    made = root / f"{name}.mkv"
    ffmpeg("-framerate", 10, "-i", folder / "%02d.png", "-c:v", "ffv1", "-pix_fmt", "gray", made)
    return made, len(poses)


def calibrate(source, out):
    return subprocess.run([str(word) for word in (PROGRAM, "--quiet", "--target", "charuco", "--board", f"{COLUMNS}x{ROWS}:{SQUARE_M}",
                                                  "--source", source, "--out", out)],
                          text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120, check=False)


def check_fit(result, count, what):
    print(result.stdout, result.stderr)
    views, focal = re.search(r"(\d+) views of (\d+)", result.stdout), re.search(r"fx ([\d.]+)", result.stdout)
    if result.returncode != 0 or not views or not focal:
        fail(f"{what}: {result.returncode} {result.stderr}")
    require(int(views[2]) >= 0.8 * count, f"{what}: the board is found in {views[2]} of {count} pictures")
    require(abs(float(focal[1]) - FOCAL_PX) < 0.02 * FOCAL_PX, f"{what}: focal length {focal[1]} px of {FOCAL_PX}")


def main():
    skip_in_cross_builds()
    if not PROGRAM.exists():
        skip("pf-calibrate is not built: it needs OpenCV's calib3d")
    skip_without_ffmpeg()
    if "was made without" in run(PROGRAM, "--help"):
        skip("pf-calibrate knows no markers")
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        board = printed_board(root)
        for kind, pixels in (("new", board), ("old", old_board(board))):
            made, count = film(root, kind, pixels)
            result = calibrate(f"video:{made}", root / f"out_{kind}")
            check_fit(result, count, kind)
            require(("OpenCV before 4.6" in result.stdout) == (kind == "old"), f"{kind}: which kind of board it is")
            require("film the board where hardly a corner was" in result.stdout and "what to film next stands above" in result.stdout,
                    f"{kind}: it is said what to film next, since the board was never in some parts of the pictures")
        ffmpeg("-i", root / "new.mkv", "-vf", "hflip", "-c:v", "ffv1", root / "mirrored.mkv")
        result = calibrate(f"video:{root / 'mirrored.mkv'}", root / "out_mirrored")
        lines = result.stderr.strip().splitlines()
        require(result.returncode != 0 and len(lines) == 1 and "mirror" in lines[0], f"mirrored: {result.returncode} {lines}")
    if failures:
        fail(f"{len(failures)} of the above")


if __name__ == "__main__":
    main()
