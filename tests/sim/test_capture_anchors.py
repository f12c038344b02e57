"""pf-capture --anchor on a rendered room: anchors.csv follows what was set, on the true plane; a saved map brings it back in another run;
corrections.csv has a row where poses have moved: of the filter as soon as there is an anchor."""

import csv
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


def run(out, *words):
    command = [PROGRAM, "--source", "sim:room", "--headless", "--quiet", "--no-film", "--out", out, *words]
    result = subprocess.run([str(word) for word in command], text=True, capture_output=True, check=False)
    print(result.stderr)
    require(result.returncode == 0, f"pf-capture ended with {result.returncode}")
    path = out / "anchors.csv"
    return result.stderr, list(csv.DictReader(path.open())) if path.is_file() else []


def position(row):
    return [float(row[key]) for key in ("px", "py", "pz")]


def check_corrections(out, backend):
    rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader((out / "corrections.csv").open())]
    require(rows, "nothing is corrected")
    for row in rows:
        require(row["from_map"] == row["map"] == 1 and row["scale"] == 1, f"a map with a target is renamed or scaled: {row}")
        require(abs(sum(row[key] ** 2 for key in ("qw", "qx", "qy", "qz")) - 1) < 1e-9, f"no rotation: {row}")
    if backend == "filter":
        first = [line.split(",")[0] for line in (out / "frames.csv").read_text().splitlines()[1:]][60]
        require(rows[0]["t_s"] > float(first) and len(rows) > 50, f"{len(rows)} corrections from {rows[0]['t_s']} s on, the anchor is of {first} s")


def check_run(folder, backend):
    out, room = folder / backend, folder / "room.pfmap"
    more = ["--save-map", room] if backend == "window" else []
    messages, rows = run(out, "--backend", backend, "--frames", 120, "--start", "target", "--anchor", "60,160,120", "--anchor", "61,9000,1",
                         "--anchor", "90,200,120", "--anchor", "500,9,9", *more)
    require("frame 60: anchor 1 on plane" in messages and "frame 90: anchor 2 on plane" in messages, "an anchor gets no note")
    require("1.0 of frame 61: lies outside of the picture" in messages, "a place outside of the picture gets no note")
    require("--anchor: the run ended before frame 500" in messages, "a frame after the last one gets no note")
    require([(row["frame"], row["id"]) for row in rows[:2]] == [("60", "1"), ("61", "1")] and len(rows) == 60 + 30, f"{len(rows)} rows")
    truth = json.loads((out / "truth_planes.json").read_text())["planes"]
    for row in rows:
        off = min(abs(sum(n * p for n, p in zip(plane["normal"], position(row))) - plane["distance"]) for plane in truth)
        sigma = max(float(row[key]) for key in ("c33", "c44", "c55")) ** 0.5
        require(0 < sigma < 0.05 and off < 0.002 + 4 * sigma, f"frame {row['frame']}: {off} m off, sigma {sigma}")
    check_corrections(out, backend)
    if backend != "window":
        return
    _, again = run(folder / "again", "--backend", backend, "--frames", 60, "--map", room)
    require({row["id"] for row in again} == {"1", "2"}, "anchors do not come back with their map")
    last = {row["id"]: position(row) for row in rows}
    for row in again:
        off = sum((a - b) ** 2 for a, b in zip(position(row), last[row["id"]])) ** 0.5
        require(off < 0.02, f"anchor {row['id']} is {off} m from where it was")
    _, none = run(folder / "none", "--backend", backend, "--frames", 10, "--start", "target")
    require(not none, "a run without anchors writes some")


def main():
    if not PROGRAM.is_file():
        skip("pf-capture was not built")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        for backend in ("filter", "window"):
            check_run(pathlib.Path(name), backend)


main()
