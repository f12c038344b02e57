"""pf-bench frame on a short rendered run: the rows have the agreed names, and mistakes get one line."""

import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

PROGRAM = script.BIN / "pf-bench"
if not PROGRAM.exists():
    script.skip("pf-bench is not part of this build")

with tempfile.TemporaryDirectory() as folder:
    file = pathlib.Path(folder) / "frame.json"
    said = script.run(PROGRAM, "frame", "--source", "sim:desk", "--start", "auto", "--frames", "60", "--passes", "1",
                      "--json", file)
    print(said)
    document = json.loads(file.read_text())
    if "sim:desk" not in document["notes"] or "peer" not in document["notes"]:
        script.fail("the notes do not name the sequence and the peer")
    rows = {row["name"]: row for row in document["rows"]}
    for name in ("median", "p95", "max", "pyramid", "predict", "search", "gate", "update", "map", "all stages"):
        row = rows.get(f"sim:desk {name}")
        if row is None:
            script.fail(f"there is no row for {name}")
        if sorted(row) != ["m", "n", "name", "peer", "ratio", "scalar", "suite", "us"]:
            script.fail(f"the row for {name} has the fields {sorted(row)}")
    median = rows["sim:desk median"]
    if not (median["n"] > 0 and median["m"] >= 16 and median["us"] > 0):
        script.fail(f"the median row is {median}")
    with_peer = "calcOpticalFlowPyrLK" in document["notes"]["peer"]
    if with_peer and not median["ratio"] > 0:
        script.fail("the peer was there and has no ratio")

script.run(PROGRAM, "frame", "--source", "sim:desk", "--start", "auto", "--frames", "20", "--passes", "1", "--no-planes")

for words in (["--source", "images:/nowhere"], ["--source", "desk"], ["--source", "sim:nowhere"],
              ["--source", "sim:desk", "--start", "somewhere", "--frames", "2"]):
    result = subprocess.run([PROGRAM, "frame", *words], text=True, capture_output=True)
    lines = result.stderr.strip().splitlines()
    if result.returncode == 0 or len(lines) != 1 or not lines[0].startswith("pf-bench: "):
        script.fail(f"{words} ended with {result.returncode} and said {result.stderr!r}")
