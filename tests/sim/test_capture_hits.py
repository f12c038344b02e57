"""pf-capture --tap and --gravity on a rendered scene: what a ray hits lies where the scene has it, and planes are called what they are."""

import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, skip  # noqa: E402

PROGRAM = BIN / "pf-capture"


def require(condition, message):
    if not condition:
        fail(message)


def main():
    if not PROGRAM.is_file():
        skip("pf-capture was not built")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        out = pathlib.Path(name) / "out"
        command = [PROGRAM, "--source", "sim:desk", "--start", "target", "--headless", "--quiet", "--no-film", "--frames", 150, "--gravity",
                   "0,9.81,0", "--tap", "120,150,215", "--tap", "140,150,25", "--tap", "140,1,1", "--tap", "140,150,2000", "--tap", "150,9,9", "--out", out]
        result = subprocess.run([str(word) for word in command], text=True, capture_output=True, check=False)
        print(result.stderr)
        require(result.returncode == 0, f"pf-capture ended with {result.returncode}")
        report = json.loads((out / "report.json").read_text())
        truth = json.loads((out / "truth_planes.json").read_text())["planes"]
        hits = report["hits"]
        require([hit["frame"] for hit in hits] == [120, 140], f"hits: {hits}")
        require("frame 140: no plane is there" in result.stderr, "a ray into a corner hit something")
        require("2000.0 of frame 140: lies outside of the picture" in result.stderr, "a place outside of the picture gets no note")
        require("before frame 150" in result.stderr and "before frame 140" not in result.stderr, "a frame after the last one gets no note")
        for hit in hits:
            off = min(abs(sum(n * p for n, p in zip(plane["normal"], hit["p_W"])) - plane["distance"]) for plane in truth)
            print(f"frame {hit['frame']}: {hit['range']:.3f} m away, sigma {1e3 * hit['sigma_range']:.1f} mm, {1e3 * off:.1f} mm off a true plane")
            require(0.2 < hit["range"] < 3, f"{hit['range']} m away")
            require(0 < hit["sigma_range"] <= hit["sigma"] * 1.000001, f"sigmas {hit['sigma']}, {hit['sigma_range']}")
            require(off < 0.01 * hit["range"] + 4 * hit["sigma"], f"{off} m off, with a sigma of {hit['sigma']}")
            require(hit["plane_now"] in [plane["id"] for plane in report["planes"]], f"plane {hit['plane_now']} is not in the report")
        kinds = {plane["id"]: plane["orientation"] for plane in report["planes"]}
        require(kinds[hits[0]["plane_now"]] == "horizontal_up" and kinds[hits[1]["plane_now"]] == "vertical", f"orientations {kinds}")


main()
