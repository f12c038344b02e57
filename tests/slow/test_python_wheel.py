"""pip makes a wheel of the project that is smaller than 3 MB, brings its types, and works in an environment of its own with NumPy alone."""

import pathlib
import subprocess
import sys
import tempfile
import zipfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

script.skip_unless_plain_native_build()
MOST_BYTES = 3_000_000
PROGRAM = """
import planefold, sys
scene = planefold.open_sequence("sim:desk")
slam = planefold.Slam(planefold.Config(camera=scene.camera))
slam.start_from_target(scene.target())
for (image, t_ns), _ in zip(scene, range(20)):
    status = slam.push_frame(image, t_ns)
assert status == planefold.Status.OK, status
assert "evo" not in sys.modules and "matplotlib" not in sys.modules
import planefold.eval, planefold.bags
for use in (lambda: planefold.eval.compare([slam.pose], [slam.pose]), lambda: planefold.bags.topics(__file__)):
    try:
        use()
    except ModuleNotFoundError as error:
        assert "pip install 'planefold[" in str(error), error
    else:
        raise AssertionError("the extras are there")
print("works", planefold.__version__)
"""

with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    python = folder / "venv" / "bin" / "python"
    script.run(sys.executable, "-m", "venv", folder / "venv")
    reached = subprocess.run([python, "-m", "pip", "download", "--quiet", "--no-deps", "--dest", folder / "reached", "scikit-build-core"])
    if reached.returncode != 0:
        script.skip("no package index can be reached, from which pip takes what builds the wheel")
    script.run(python, "-m", "pip", "wheel", "--no-deps", "--wheel-dir", folder, script.SOURCE, cwd=folder)
    wheel = next(folder.glob("planefold-*.whl"))
    names = zipfile.ZipFile(wheel).namelist()
    print(wheel.name, wheel.stat().st_size, "bytes")
    if wheel.stat().st_size > MOST_BYTES:
        script.fail(f"the wheel has {wheel.stat().st_size} bytes, {MOST_BYTES} at most")
    missing = [name for name in ("__init__.py", "_core.pyi", "py.typed", "eval.py", "pf_eval/errors.py") if f"planefold/{name}" not in names]
    foreign = [name for name in names if not name.startswith(("planefold/", "planefold-"))]
    if missing or foreign:
        script.fail(f"the wheel lacks {missing} and holds {foreign} beside the package")
    script.run(python, "-m", "pip", "install", "--quiet", wheel)
    (folder / "program.py").write_text(PROGRAM)
    print(script.run(python, folder / "program.py", cwd=folder))
