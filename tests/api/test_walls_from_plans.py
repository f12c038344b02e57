"""tools/walls-from-geojson and tools/walls-from-obj: what they write is read, and what is wrong is said in one line."""

import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, SOURCE, fail, run, skip, skip_in_cross_builds  # noqa: E402

skip_in_cross_builds()
if not (BIN / "pf-capture").is_file():
    skip("pf-capture was not built")

PLAN = {"type": "FeatureCollection", "features": [
    {"type": "Feature", "properties": {"name": "hall", "height": 3},
     "geometry": {"type": "Polygon", "coordinates": [[[0, 0], [6, 0], [6, 4], [0, 4], [0, 0]]]}},
    {"type": "Feature", "properties": {"seen_from": "left"}, "geometry": {"type": "LineString", "coordinates": [[1, 1], [1, 2]]}},
    {"type": "Feature", "properties": {"name": "a lamp"}, "geometry": {"type": "Point", "coordinates": [3, 2]}}]}
MODEL = "# a box without a lid\no front\nv 0 0 0\nv 1 0 0\nv 1 0 2\nv 0 0 2\nf 1 2 3 4\ng side\nv 0 1 0\nv 0 1 2\nf 1/1/1 -3 -1 -2\nf 4 6 5\n"
POSE = "0 2 2 1.5 -0.7071 0 0 0.7071\n"


def refused(command, part):
    result = subprocess.run([str(word) for word in command], text=True, capture_output=True, check=False)
    if result.returncode != 2 or len(result.stderr.splitlines()) != 1 or part not in result.stderr:
        fail(f"{command}: {result.returncode}, {result.stderr!r}")


def check_read(walls, start):
    run(BIN / "pf-capture", "--source", "sim:box", "--frames", 2, "--walls", walls, "--start", f"pose:{start}", "--headless", "--quiet",
        "--no-film", "--out", walls.with_suffix(""))


with tempfile.TemporaryDirectory(prefix="planefold_") as name:
    folder = pathlib.Path(name)
    plan, model, start, walls, faces = (folder / n for n in ("plan.geojson", "model.obj", "pose.tum", "walls.json", "faces.json"))
    plan.write_text(json.dumps(PLAN))
    model.write_text(MODEL)
    start.write_text(POSE)
    geojson, obj = SOURCE / "tools" / "walls-from-geojson", SOURCE / "tools" / "walls-from-obj"

    run(sys.executable, geojson, plan, "--metres", "--height", 2.5, "--out", walls)
    written = json.loads(walls.read_text())["walls"]
    if [w["name"] for w in written] != ["hall", "hall 2", "hall 3", "hall 4", "wall 2"] or written[1]["from"] != [6, 0]:
        fail(f"wrong walls: {written}")
    if [w["height"] for w in written] != [3] * 4 + [2.5] or written[0]["seen_from"] != "both" or written[4]["seen_from"] != "left":
        fail(f"wrong fields: {written}")
    run(sys.executable, obj, model, "--metres", "--seen-from", "both", "--out", faces)
    written = json.loads(faces.read_text())["faces"]
    if [w["name"] for w in written] != ["front", "side", "side 2"] or written[1]["corners"] != [[0, 0, 0], [0, 0, 2], [0, 1, 2], [0, 1, 0]]:
        fail(f"wrong faces: {written}")
    check_read(walls, start)
    check_read(faces, start)

    before = walls.read_bytes()
    refused([sys.executable, geojson, plan, "--metres", "--height", 3, "--out", walls], "is there already")
    if walls.read_bytes() != before:
        fail("a file that was there was written over")
    refused([sys.executable, geojson, plan, "--height", 3], "--metres")
    refused([sys.executable, geojson, plan, "--metres"], "height of 'wall 2'")
    refused([sys.executable, geojson, model, "--metres"], "no JSON")
    refused([sys.executable, geojson, folder / "none", "--metres"], "No such file")
    model.write_text(MODEL + "f 1 2 99\n")
    refused([sys.executable, obj, model, "--metres"], "line 13 ")
