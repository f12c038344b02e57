"""The numbered examples run, and say something."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, SOURCE, fail, run, skip, skip_in_cross_builds  # noqa: E402

skip_in_cross_builds()
sources = sorted((SOURCE / "examples").glob("[0-9][0-9]_*.c"))
if not sources:
    fail("there are no numbered examples")
for source in sources:
    program = BIN / f"example_{source.stem}"
    if not program.is_file():
        skip("the examples were not built")
    if not source.read_text().startswith("/* "):
        fail(f"{source.name} does not begin with a paragraph")
    output = run(program)
    print(output)
    if len(output.splitlines()) < 3:
        fail(f"{source.name} says too little")
