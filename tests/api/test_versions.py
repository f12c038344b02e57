"""Every program says its version, and report.json says of which version, command and processor it is."""

import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

script.skip_in_cross_builds()
VERSION = script.cache("CMAKE_PROJECT_VERSION")
seen = 0
for name in ("pf-capture", "pf-sim", "pf-bench", "pf-calibrate", "pf-eval", "pf-replay", "pf-digest"):
    if (script.BIN / name).exists():
        seen += 1
        said = script.run(script.BIN / name, "--version").strip()
        if said != f"{name} {VERSION}":
            script.fail(f"{name} --version says {said}")
if seen == 0:
    script.skip("no program is part of this build")
if (script.BIN / "pf-capture").exists():
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        script.run(script.BIN / "pf-capture", "--source", "sim:desk", "--frames", 3, "--headless", "--no-film", "--start", "target", "--out", out)
        report = json.loads((out / "report.json").read_text())
    if report["version"] != VERSION or "--source sim:desk --frames 3" not in report["command"] or len(report["processor"]) < 4:
        script.fail(f"the report says {report['version']}, {report['command']}, {report['processor']}")
    print(report["processor"])
