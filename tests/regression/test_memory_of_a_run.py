"""What pf-capture has allocated does not grow with the number of frames, with the filter and with the window.

Bytes that are allocated, not resident memory: the C library keeps pages for later, which hide 2 bytes a frame for long, and a picture takes
some for a moment. What the pictures remember (8,192 places of the path, 4,096 columns of the time line) is full before the first look, and
the picture of the middle frame, which loads fonts for good, is drawn before it too."""

import pathlib
import statistics
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, SOURCE, c_compiler, fail, run, skip, skip_unless_plain_native_build  # noqa: E402
from small_camera import CALIBRATION  # noqa: E402

PROGRAM = BIN / "pf-capture"
FRAMES = 60000
FIRST, LAST = (30500, 35000), (55500, 60000)  # four laps each: how many features are in view makes some kilobytes
BYTES_PER_FRAME = 0.4  # a megabyte in a day of 30 frames a second


def main():
    skip_unless_plain_native_build()
    if not PROGRAM.is_file():
        skip("pf-capture was not built")
    grows = []
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        root = pathlib.Path(name)
        (root / "small.yaml").write_text(CALIBRATION)
        run(c_compiler(), "-O1", "-Wall", "-Wextra", "-shared", "-fPIC", "-o", root / "live_bytes.so",
            SOURCE / "tests/support/live_bytes.c", "-ldl")
        small = ["--max-features", 30, "--features-in-view", 16, "--max-state-dim", 110]
        for backend, options in (("filter", small), ("window", ["--max-features", 60, "--features-in-view", 40])):
            table = root / f"{backend}.csv"
            run("env", f"LD_PRELOAD={root / 'live_bytes.so'}", f"PLANEFOLD_LIVE_BYTES={table}", PROGRAM, "--source", "sim:desk",
                "--calib", root / "small.yaml", "--start", "target", "--loop", 570, "--frames", FRAMES, "--headless", "--no-film",
                "--quiet", "--report-every", 1, "--backend", backend, "--out", root / backend, *options)
            rows = [tuple(map(int, line.split(","))) for line in table.read_text().splitlines()]
            if len(rows) < FRAMES // 10:
                fail(f"{backend}: {len(rows)} looks in {FRAMES} frames")
            first, last = (statistics.mean(size for row, size in rows if low <= row < high) for low, high in (FIRST, LAST))
            per_frame = (last - first) / (LAST[0] - FIRST[0])
            print(f"{backend}: {first / 1e6:.3f} MB allocated, {per_frame:+.3f} bytes a frame", flush=True)
            if per_frame > BYTES_PER_FRAME:
                grows.append(f"{backend}: {per_frame:.2f} bytes a frame")
    if grows:
        fail("what pf-capture has allocated grows: " + "; ".join(grows))


main()
