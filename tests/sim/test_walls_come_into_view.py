"""A start from a pose that sees no wall of its plan: the map is one of points, gets its size from the first wall that comes into view, and
that wall is refined. Before, nothing told depths, and the camera was lost after 22 frames."""

import json
import math
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run, skip, skip_in_cross_builds  # noqa: E402

FRONT, HIGH, EYE, FAR = 12, 6, 1.6, 5  # of the street [m], which the camera begins in the middle of a front of; y down
YAW = 0.3  # of the first pose [rad]
MOST_OF_WAY = 0.05  # of the position's error once the size is known
MOST_SIGMAS = 3  # likewise, of its own standard deviation


def face(name, middle, far, to_camera):
    """An upright rectangle across z; to_camera: its front looks along -z."""
    corners = [[middle + x, EYE - y, far] for x, y in ((-FRONT / 2, 0), (FRONT / 2, 0), (FRONT / 2, HIGH), (-FRONT / 2, HIGH))]
    return {"name": name, "corners": corners if to_camera else corners[::-1], "sigma_rotation_deg": 1, "sigma_vertical_deg": 0.3, "sigma_offset_m": 0.05}


def capture(root, faces, frames, backend):
    """Report of a run with this plan."""
    plan, first, out = root / "plan.json", root / "first.tum", root / "out"
    plan.write_text(json.dumps({"planefold_walls": 1, "up": [0, -1, 0], "faces": faces}))
    first.write_text(f"0 0 0 0 0 {math.sin(YAW / 2)} 0 {math.cos(YAW / 2)} 0.003 0.1\n")
    run(BIN / "pf-capture", "--headless", "--source", "sim:street", "--walls", plan, "--start", f"pose:{first}", "--frames", frames, "--backend", backend, "--out", out)
    return json.loads((out / "report.json").read_text())


def positions(path):
    """Of a trajectory: time to place."""
    rows = [line.split() for line in path.read_text().splitlines() if not line.startswith("#")]
    return {round(float(row[0]), 4): [float(x) for x in row[1:4]] for row in rows}


def sigmas(path):
    """Standard deviation of the position, from a file of covariances: time to [m]."""
    rows = [[float(x) for x in line.split(",")] for line in path.read_text().splitlines() if not line.startswith("#")]
    return {round(row[0], 4): math.sqrt(row[1 + 21] + row[1 + 28] + row[1 + 35]) for row in rows}


def look(backend):
    """A plan behind the camera, and one that comes into view."""
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        root = pathlib.Path(name)
        behind = capture(root, [face("behind", 0, -42, False)], 60, backend)
        if behind["tracked"] < 57 or behind["lost"] > 0:
            fail(f"{backend}, a wall behind the camera: {behind['tracked']} of 60 frames tracked, {behind['lost']} lost")
        # Wrong by 1 degree and 5 cm.
        lean = math.tan(math.radians(1))
        later = [face(f"front {k}", FRONT * k, FAR, True) for k in (1, 2)]
        for wall in later:
            for corner in wall["corners"]:
                corner[2] += 0.05 + lean * (corner[0] - wall["corners"][0][0] - FRONT / 2)
        report = capture(root, later, 250, backend)
        if report["tracked"] < 247 or len(report["maps"]) != 2:
            fail(f"{backend}, fronts that come into view: {report['tracked']} of 250 frames tracked, maps {report['maps']}")
        truth = positions(root / "out" / "truth.tum")
        estimate, sigma = positions(root / "out" / report["maps"][1]["trajectory"]), sigmas(root / "out" / "covariance_2.csv")
        times = [t for t in estimate if t in truth and t in sigma]
        errors = [math.dist(estimate[t], truth[t]) for t in times]
        in_sigmas = max(math.dist(estimate[t], truth[t]) / sigma[t] for t in times)
        way = max(math.dist(p, (0, 0, 0)) for p in truth.values())
        wall = report["walls"][0]
        print(f"{backend}: size from frame {report['maps'][1]['start_frame']}, then at most {max(errors):.3f} m and {in_sigmas:.1f} sigma off in {len(errors)} frames; {wall}")
        if len(errors) < 100 or max(errors) > MOST_OF_WAY * way or in_sigmas > MOST_SIGMAS:
            fail(f"{backend}, position {max(errors):.3f} m, {in_sigmas:.1f} sigma off in {len(errors)} frames with a known size, after {way:.1f} m")
        if wall["doubted"] or wall["points"] < 8 or wall["sigma_deg"] > 0.5:
            fail(f"{backend}, the first front is not refined: {wall}")


def main():
    skip_in_cross_builds()
    if not (BIN / "pf-capture").is_file():
        skip("pf-capture was not built")
    for backend in ("filter", "window"):
        look(backend)


if __name__ == "__main__":
    main()
