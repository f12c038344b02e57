"""pf-capture with a tracker that takes three frame periods per frame: frames are passed over, the tracker gets fresh ones, and it
still tracks."""

import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run, skip  # noqa: E402

FRAMES, DELAY_MS = 120, 100


def main():
    program = BIN / "pf-capture"
    if not program.is_file():
        skip("pf-capture was not built")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        root = pathlib.Path(name)
        start = ["--headless", "--no-film", "--quiet", "--start", "rectangle:0.20x0.14"]
        run(program, *start, "--source", "sim:desk", "--frames", FRAMES, "--record", root / "scene", "--out", root / "out")
        run(program, *start, "--source", f"euroc:{root}/scene", "--realtime", "--delay", DELAY_MS, "--out", root / "late")
        report = json.loads((root / "late/report.json").read_text())
    live = report["live"]
    print(json.dumps(live))
    # A frame waits until the one before it is done, and then the newest is taken: less than two periods, however slow tracking is.
    if live["wait_ms"]["p95"] > 2 * live["frame_ms"]:
        fail(f"frames wait {live['wait_ms']} ms, with a period of {live['frame_ms']:.1f} ms")
    if live["latency_ms"]["median"] > DELAY_MS + 2 * live["frame_ms"]:
        fail(f"from arrival to the pose: {live['latency_ms']} ms, of which tracking takes {DELAY_MS}")
    if live["passed_over"] < FRAMES // 2 or report["tracked"] < 0.9 * report["frames"]:
        fail(f"passed over {live['passed_over']}, tracked {report['tracked']} of {report['frames']}")


main()
