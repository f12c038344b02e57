"""For Python programs of the project that need evo or matplotlib: go on inside the environment of venv.sh."""

import os
import pathlib
import subprocess
import sys


def folder_of(source):
    """Where the environment of the project at source lies: in its build folder, or in the user's cache where it is installed."""
    if (source / "CMakeLists.txt").exists():
        return source / "build" / "venv"
    cache = os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache"
    return pathlib.Path(cache) / "planefold" / "venv"


def enter(source):
    """Returns inside the environment; makes it where it is missing, with a progress line."""
    source = pathlib.Path(source)
    venv = folder_of(source)
    inside = venv.exists() and os.path.samefile(sys.prefix, venv)
    if inside or os.environ.get("PLANEFOLD_VENV_ENTERED"):
        os.environ.pop("PLANEFOLD_VENV_ENTERED", None)
        return
    made = subprocess.run(["bash", "-c", '. tools/lib/venv.sh && venv_python "$1"', "bash", venv], cwd=source, stdout=subprocess.PIPE,
                          text=True)
    if made.returncode != 0:
        sys.exit(f"{pathlib.Path(sys.argv[0]).name}: needs evo and matplotlib, and their Python environment could not be made: it takes "
                 "python3-venv (Debian: sudo apt-get install python3-venv), and a connection for the download")
    python = made.stdout.strip()
    os.environ["PLANEFOLD_VENV_ENTERED"] = "1"
    os.execv(python, [python, *sys.argv])
