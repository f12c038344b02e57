"""The C program in README.md compiles as it stands against the install tree, is at most 25 lines long, and runs."""

import pathlib
import re
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

script.skip_unless_plain_native_build()

LIMIT = 25
blocks = re.findall(r"^```c\n(.*?)^```$", (script.SOURCE / "README.md").read_text(), re.S | re.M)
if len(blocks) != 1:
    script.fail(f"README.md has {len(blocks)} blocks of C, not one")
lines = [line for line in blocks[0].splitlines() if line.strip()]
if len(lines) > LIMIT:
    script.fail(f"the program in README.md has {len(lines)} lines, more than {LIMIT}")

with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    prefix = folder / "prefix"
    script.install_tree(prefix)
    source = folder / "readme.c"
    source.write_text(blocks[0])
    script.run(script.c_compiler(), "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", source,
               "-I", prefix / "include", next(prefix.rglob("libplanefold.a")), "-lm", "-o", folder / "readme")
    said = script.run(folder / "readme", cwd=folder)
    print(said, end="")
    if not said.strip():
        script.fail("the program in README.md ran and said nothing")
