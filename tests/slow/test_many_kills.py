"""tests/regression/test_killed_runs.py with 300 runs: a hundred each by SIGHUP, SIGKILL and SIGTERM."""

import os
import pathlib
import runpy

os.environ.setdefault("PLANEFOLD_KILLS", "300")
runpy.run_path(str(pathlib.Path(__file__).resolve().parents[1] / "regression" / "test_killed_runs.py"), run_name="__main__")
