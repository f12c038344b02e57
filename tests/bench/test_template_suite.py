"""pf-bench template: every masked template of its two images is found where it is, and the rows have the agreed names."""

import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

PROGRAM = script.BIN / "pf-bench"
if not PROGRAM.exists():
    script.skip("pf-bench is not part of this build")

with tempfile.TemporaryDirectory() as folder:
    file = pathlib.Path(folder) / "template.json"
    print(script.run(PROGRAM, "template", "--repetitions", "5", "--json", file))
    document = json.loads(file.read_text())
if not document["notes"]["found"].startswith("200 of 200 "):
    script.fail(f"found: {document['notes']['found']}")
rows = {row["name"]: row for row in document["rows"]}
if not rows["search"]["us"] > 0 or rows["search"]["n"] != 200:
    script.fail(f"the row is {rows['search']}")
if "matchTemplate" in document["notes"]["peer"] and not rows["search"]["ratio"] > 0:
    script.fail("the peer was there and has no ratio")
