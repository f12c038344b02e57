"""The Python package and its example pass mypy --strict, and a mistake in a field's name or type is found."""

import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import python_package  # noqa: E402
import script  # noqa: E402

python_package.enter()

WRONG = """
import planefold

config = planefold.Config()
config.capacity.max_fetures = 3
config.camera.fx = "wide"
slam = planefold.Slam(config)
slam.push_frame(3, 0)
slam.pose.p_WC.shape
slam.hit_test((1.0, 2.0)).plane
"""

package = python_package.PACKAGE / "planefold"
own = [path for path in sorted(package.iterdir()) if path.suffix in (".py", ".pyi")]
with tempfile.TemporaryDirectory() as folder:
    wrong = pathlib.Path(folder) / "wrong.py"
    wrong.write_text(WRONG)

    def mypy(*files):
        command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", folder, "--config-file", script.SOURCE / "pyproject.toml", *files]
        result = subprocess.run(command, env={**os.environ, "MYPYPATH": str(python_package.PACKAGE)}, text=True, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT)
        print(result.stdout)
        return result

    if mypy(*own, *sorted((script.SOURCE / "tools/python/examples").glob("*.py"))).returncode != 0:
        script.fail("mypy --strict found something")
    found = mypy(wrong).stdout
    expected = ['"ConfigCapacity" has no attribute "max_fetures"', 'variable has type "float"', 'Argument 1 to "push_frame"', '"Hit | None"']
    missing = [words for words in expected if words not in found]
    if missing or "Found 4 errors" not in found:
        script.fail(f"of the mistakes mypy does not find {missing}")
