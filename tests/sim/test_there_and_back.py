"""pf-capture --there-and-back: each image comes twice, from a scene and from a folder, and pf-eval reads the run."""

import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import venv  # noqa: E402
from script import BIN, fail, run, skip, skip_in_cross_builds  # noqa: E402

FRAMES, SKIP = 120, 3


def times(path):
    return [float(line.split()[0]) for line in path.read_text().splitlines() if not line.startswith("#")]


def check(out, images):
    report = json.loads((out / "report.json").read_text())
    turn = report["there_and_back"]
    if turn["images"] != images or report["frames"] != 2 * images - 1:
        fail(f"{out.name}: {report['frames']} frames of {turn['images']} images, {images} images were asked for")
    t = [float(line.split(",")[0]) for line in (out / "frames.csv").read_text().splitlines()[1:]]
    mirrored = [2 * turn["turn_s"] - x for x in t[::-1]]
    if max(abs(a - b) for a, b in zip(t, mirrored)) > 1e-6:
        fail(f"{out.name}: the times of the way back are not those of the way there")
    evaluated = subprocess.run([BIN / "pf-eval", out, "--there-and-back", "--json"], text=True, stdout=subprocess.PIPE, check=False)
    if evaluated.returncode != 0:
        fail(f"{out.name}: pf-eval ended with {evaluated.returncode}")
    summary = json.loads(evaluated.stdout)
    # About 0.03; a way back that is paired with the wrong images is off by a third of the extent or more.
    if summary["pairs"] < images - 2 or not summary["back_distance_median"] < 0.1:
        fail(f"{out.name}: {summary}")
    return summary


def main():
    skip_in_cross_builds()
    if not (BIN / "pf-capture").is_file() or not (BIN / "pf-eval").is_file():
        skip("pf-capture or pf-eval was not built")
    venv.enter()
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        folder = pathlib.Path(name)
        words = ["--headless", "--quiet", "--no-film", "--start", "target", "--there-and-back"]
        run(BIN / "pf-capture", "--source", "sim:desk", "--frames", FRAMES, "--skip", SKIP, "--out", folder / "scene", *words)
        print(check(folder / "scene", FRAMES))
        # The same frames from a folder, which are read again instead of kept.
        run(BIN / "pf-capture", "--source", "sim:desk", "--frames", FRAMES, "--skip", SKIP, "--headless", "--quiet", "--no-film",
            "--start", "target", "--out", folder / "once", "--record", folder / "record")
        words[words.index("target")] = "rectangle:0.20x0.14"
        run(BIN / "pf-capture", "--source", f"euroc:{folder / 'record'}", "--out", folder / "folder", *words)
        print(check(folder / "folder", FRAMES))


main()
