"""The examples of the Python package run: the script on a folder of frames, and the notebook's cells one after the other."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import types

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import python_package  # noqa: E402
import script  # noqa: E402

planefold = python_package.enter()
from PIL import Image  # noqa: E402

EXAMPLES = script.SOURCE / "tools/python/examples"
FRAMES = 70


def run_script(folder):
    scene = planefold.Sim("desk")
    planefold.write_calibration(str(folder / "calib.yaml"), scene.camera, 30.0)
    (folder / "images").mkdir()
    times = []
    for number, (image, t_ns) in zip(range(FRAMES), scene):
        Image.fromarray(image).save(folder / "images" / f"{number:04d}.png")
        times.append(f"{1e-9 * t_ns:.9f}\n")
    (folder / "times.txt").write_text("".join(times))
    environment = {**os.environ, "PYTHONPATH": str(python_package.PACKAGE), "PYTHONWARNINGS": "error"}
    output = script.run(sys.executable, EXAMPLES / "track_film.py", f"images:{folder}", cwd=folder, env=environment)
    print(output)
    if f"of {FRAMES} frames" not in output or not (folder / "trajectory.png").stat().st_size:
        script.fail("the script did not track the frames")


def run_notebook(folder):
    display = types.ModuleType("IPython.display")
    display.Image = lambda path: path
    shell = types.ModuleType("IPython")
    shell.get_ipython, shell.version_info = lambda: None, (9, 0)
    sys.modules.update({"IPython": shell, "IPython.display": display})
    os.chdir(folder)
    names = {}
    for cell in json.loads((EXAMPLES / "desk.ipynb").read_text())["cells"]:
        if cell["cell_type"] == "code":
            if cell["outputs"] or cell["execution_count"] is not None:
                script.fail("desk.ipynb: is kept without outputs")
            exec(cell["source"], names)
    summary = names["comparison"].summary
    print({name: summary[name] for name in ("ate_rmse_m", "nees_pose", "pairs")})
    if summary["ate_rmse_m"] > 0.02 or not (folder / "errors.png").stat().st_size:
        script.fail("the notebook's trajectory is wrong")


with tempfile.TemporaryDirectory() as folder:
    run_script(pathlib.Path(folder))
with tempfile.TemporaryDirectory() as folder:
    run_notebook(pathlib.Path(folder))
    os.chdir("/")
