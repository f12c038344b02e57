"""A wall of the plan that is seen over a desk: what stands before it does not move it. Before, each point that began at the wall's distance
and was found nearer took the wall along, by 0.77 m in 30 frames, at a standard deviation of 7 cm."""

import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run, skip, skip_in_cross_builds  # noqa: E402

FRAMES = 30
SIGMA = 0.1  # of the plan [m]
TOO_FAR = 0.05  # that the plan has the wall [m]
MOST_SIGMAS = 3
SHEET = "width: 0.21\nheight: 0.1485\np_WT: [2.5, 4.0, 1.4]\nq_WT: [0.70711, -0.70711, 0, 0]\n"
BEHIND = 0.95  # of the sheet is the wall [m]


def main():
    skip_in_cross_builds()
    if not (BIN / "pf-capture").is_file():
        skip("pf-capture was not built")
    y = 4 + BEHIND + TOO_FAR
    wall = {"name": "north", "from": [0, y], "to": [6, y], "base": 0, "height": 3, "seen_from": "right", "sigma_rotation_deg": 2, "sigma_vertical_deg": 1, "sigma_offset_m": SIGMA}
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        root = pathlib.Path(name)
        plan, sheet, out = root / "plan.json", root / "sheet.yaml", root / "out"
        plan.write_text(json.dumps({"planefold_walls": 1, "up": [0, 0, 1], "walls": [wall]}))
        sheet.write_text(SHEET)
        for seed in (1, 3):
            run(BIN / "pf-capture", "--headless", "--no-film", "--source", "sim:desk", "--seed", seed, "--walls", plan, "--start", f"target:{sheet}", "--frames", FRAMES, "--out", out)
            report = json.loads((out / "report.json").read_text())
            now = report["walls"][0]
            print(f"seed {seed}: {now}")
            if report["tracked"] < FRAMES:
                fail(f"{report['tracked']} of {FRAMES} frames tracked")
            if abs(now["offset_m"] - TOO_FAR) > MOST_SIGMAS * now["sigma_m"] or now["sigma_m"] < SIGMA / 2 and now["points"] == 0:
                fail(f"moved by {now['offset_m']:.3f} m, sigma {now['sigma_m']:.3f} m, with {now['points']} points on it; the plan is {TOO_FAR} m off")


main()
