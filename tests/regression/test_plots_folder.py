"""Plots into a new folder inside of a run's folder: the list that the plots' folder has just got is its own, and no file of others."""

import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

sys.path.insert(0, str(script.SOURCE / "tools" / "pf-eval"))
from pf_eval import Refused  # noqa: E402
from pf_eval.output_folder import LIST, add_output_files, open_output_folder  # noqa: E402

with tempfile.TemporaryDirectory() as folder:
    run = open_output_folder(pathlib.Path(folder) / "run", "--out")
    for _ in range(2):  # the second time over what the first wrote
        plots = open_output_folder(run / "plots", "--out")
        add_output_files(plots, "frames.png")
        add_output_files(run, "plots/", "plots/frames.png", f"plots/{LIST}")
        (plots / "frames.png").write_text("picture")
    before = (run / LIST).read_text()
    try:
        open_output_folder(f"{run}/plots/..", "--out", reads=run)
        script.fail("the run itself was emptied for its plots")
    except Refused:
        pass
    if (run / LIST).read_text() != before or not (plots / "frames.png").is_file():
        script.fail("the refusal changed the run")
    (run / "notes.txt").write_text("the user's")
    try:
        add_output_files(run, "notes.txt")
        script.fail("a file of the user's was put on the list")
    except Refused:
        pass
