"""For tests of the Python programs: go on inside the environment that these programs make on first use, or be skipped."""

import os
import subprocess
import sys

import script

VENV = script.SOURCE / "build" / "venv"


def enter():
    """Returns inside build/venv, with the modules of pf-eval on the path."""
    if not (VENV / "bin" / "python").exists() or not list(VENV.glob("installed-*")):
        script.skip("build/venv is not there; the first run of pf-eval or tools/plot-run makes it")
    if not os.path.samefile(sys.prefix, VENV):
        sys.exit(subprocess.run([VENV / "bin" / "python", *sys.argv]).returncode)
    sys.path.insert(0, str(script.SOURCE / "tools" / "pf-eval"))
