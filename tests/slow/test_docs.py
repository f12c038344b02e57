"""Doxygen has no warning about the header, README.md and the pages."""

import pathlib
import shutil
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

if shutil.which("doxygen") is None:
    script.skip("Doxygen is not installed")
with tempfile.TemporaryDirectory() as folder:
    out = script.run(script.SOURCE / "tools/docs", "--out", folder)
    page = pathlib.Path(folder) / "html/planefold_8h.html"
    if "Track one frame" not in page.read_text():
        script.fail(f"the description of pf_push_frame is not in the HTML\n{out}")
