"""pf-sim kidnap on rendered frames: every gap is played and judged, a black picture costs no feature, and what is wrong with an
option is said in one line."""

import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run  # noqa: E402

FRAMES, EVERY, RANDOM_FRAMES = 110, 50, 30


def require(condition, message):
    if not condition:
        fail(message)


with tempfile.TemporaryDirectory() as folder:
    film, report = pathlib.Path(folder) / "film", pathlib.Path(folder) / "report.json"
    run(BIN / "pf-sim", "render", "desk", "--out", film, "--frames", FRAMES, "--width", 320)
    run(BIN / "pf-sim", "kidnap", "--source", f"images:{film}", "--start", f"target:{film / 'target.yaml'}", "--every", EVERY,
        "--random-frames", RANDOM_FRAMES, "--random-runs", 2, "--jobs", 2, "--json", report)
    numbers = json.loads(report.read_text())
    bad = subprocess.run([BIN / "pf-sim", "kidnap", "--source", f"images:{film}", "--start", "anywhere"], capture_output=True,
                         text=True, check=False)

every = numbers["all"]
print(f"{every['trials']} trials, {every['tracking_again']} tracking again, {every['wrong']} wrong")
require(numbers["reference"]["frames"] == FRAMES and numbers["reference"]["tracked"] >= 0.9 * FRAMES, "the film is not tracked")
require(numbers["reference"]["starts"] >= 2, "no frames to begin trials at")
require(every["trials"] == sum(case["trials"] for case in numbers["cases"].values()) > 10, "trials are missing")
require(numbers["cases"]["black_0.3s_back"]["tracking_again"] == numbers["cases"]["black_0.3s_back"]["trials"] > 0,
        "nothing was tracked after a third of a second")
require(numbers["ids_kept_without_pictures"] == 1, "features were lost in the dark")
require(numbers["random_order"]["frames"] == 2 * RANDOM_FRAMES, "frames in random order are missing")
require(every["wrong_beyond_5_sigma"] <= min(every["wrong"], every["beyond_5_sigma"]), "counts contradict each other")
require(bad.returncode == 2 and "--start anywhere: write auto or target:FILE" in bad.stderr and bad.stderr.count("\n") == 1,
        f"a bad option: {bad.returncode}, {bad.stderr}")
