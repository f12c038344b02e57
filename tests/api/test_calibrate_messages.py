"""What pf-calibrate says when something is not as it should be: one line each, with what to do. Its pictures are the targets that it
prints itself."""

import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, cache, fail, run, skip  # noqa: E402

PROGRAM = BIN / "pf-calibrate"
PAGE = ["--page", "130x100"]
COMMAND_LINE = [
    (["--sorce", "images:grey"], "'--sorce' is no option that is known here"),
    (["--source", "cloud:7"], "write video:FILE, images:DIR, euroc:DIR, tum:DIR, v4l2:/dev/videoN or libcamera:0"),
    (["--source", "grey"], "write video:FILE, images:DIR"),
    (["--print-target", "target.pdf", "--page", "a5"], "50 to 5000"),
    (["--print-target", "target.pdf", "--page", "20x20"], "50 to 5000"),
]
ALWAYS = [
    (["--source", "images:chessboard", "--target", "chessboard"], "only 1 usable views; at least 6"),
    (["--source", "images:chessboard", "--target", "chessboard", "--board", "9x7:0.01"], "but a chessboard of 10 x 7 squares is"),
    (["--source", "images:grey", "--target", "chessboard"], "is in none of 2 frames; all of it must be seen"),
    (["--source", "images:nothing"], "nothing: no such folder"),
    (["--source", "images:mixed"], "use images of one size"),
    (["--source", "v4l2:/dev/none"], "/dev/none"),
    (["--source", "libcamera:none"], "libcamera"),
    (["--source", "images:grey", "--board", "10x7"], "COLUMNSxROWS:SQUARE_METRES"),
    (["--source", "images:grey", "--target", "dots"], "'dots' is none of charuco, chessboard"),
    (["--print-target", "target.jpg"], "ends in .pdf or .png"),
    (["--print-target", "nowhere/target.pdf"], "nowhere/target.pdf: cannot be written"),
    (["--print-target", "target.pdf", "--board", "40x40:0.02"], "does not fit on"),
    ([], "give either --source or --print-target"),
]
WITH_MARKERS = [
    (["--source", "images:charuco"], "only 1 usable views; at least 6"),
    (["--source", "images:chessboard"], "but a chessboard of 10 x 7 squares is; use --target chessboard --board 10x7"),
    (["--source", "images:charuco", "--board", "8x6:0.01"], "markers up to number 34"),
    (["--source", "images:charuco", "--board", "12x9:0.01"], "but markers in another order are"),
    (["--source", "images:grey"], "A plain chessboard needs --target chessboard"),
    (["--print-target", "target.pdf", "--board", "60x60:0.001"], "1800 markers"),
]
WITHOUT_MARKERS = [(["--print-target", "target.pdf", "--target", "charuco"], "libopencv-contrib-dev")]


def complaint(root, arguments, codes=(1, 2)):
    result = subprocess.run([str(PROGRAM), "--quiet", *arguments], cwd=root, text=True, capture_output=True, check=False)
    print("$ pf-calibrate", *arguments, "\n ", result.stderr.strip())
    if result.returncode not in codes or result.stdout or result.stderr.count("\n") != 1:
        fail(f"exit status {result.returncode}, {result.stdout}{result.stderr}")
    return result.stderr


def main():
    if not PROGRAM.is_file():
        skip("pf-calibrate is not built: it needs OpenCV's calib3d")
    if cache("CMAKE_TOOLCHAIN_FILE"):
        skip("programs are run in native builds")
    knows_markers = "was made without" not in run(PROGRAM, "--help")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        root = pathlib.Path(name)
        for folder in ("chessboard", "charuco", "grey", "mixed"):
            (root / folder).mkdir()
        for kind in ("chessboard", "charuco") if knows_markers else ("chessboard",):
            run(PROGRAM, "--print-target", root / kind / "0.png", "--target", kind, "--board", "10x7:0.01", *PAGE)
        for i, (width, height) in enumerate(((320, 240), (320, 200))):
            pixels = bytes([90]) * (width * height)
            (root / f"mixed/{i}.pgm").write_bytes(f"P5 {width} {height} 255\n".encode() + pixels)
            (root / f"grey/{i}.pgm").write_bytes(b"P5 320 240 255\n" + bytes([90]) * (320 * 240))
        (root / "mine.pdf").write_text("mine\n")
        for path in ("mine.pdf", "chessboard/0.png"):
            before = (root / path).read_bytes()
            if f"'{path}' exists and is left as it is" not in complaint(root, ["--print-target", path, "--target", "chessboard"], (1,)):
                fail(f"{path} is there already")
            if (root / path).read_bytes() != before:
                fail(f"{path} was written over")
        for arguments, part in COMMAND_LINE:
            if part not in complaint(root, arguments, (2,)):
                fail(f"expected: {part}")
        for arguments, part in ALWAYS + (WITH_MARKERS if knows_markers else WITHOUT_MARKERS):
            if part not in complaint(root, arguments):
                fail(f"expected: {part}")


main()
