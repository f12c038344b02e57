"""The C program in README.md compiles as it stands against the install tree, is at most 25 lines long, and runs."""

import pathlib
import random
import re
import subprocess
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

    # Frames of random blocks that move to the left, as grey bytes on the standard input.
    width, height, frames, seed = 320, 240, 10, 1
    print(f"seed {seed}")
    random.seed(seed)
    rows = [[random.randrange(40, 216) for _ in range((width + 64) // 8)] for _ in range(height // 8)]
    film = b"".join(bytes(rows[y // 8][(x + 2 * frame) // 8] for y in range(height) for x in range(width))
                    for frame in range(frames))
    result = subprocess.run([folder / "readme"], input=film, capture_output=True)
    said = result.stdout.decode()
    print(said, end="")
    if result.returncode != 0:
        script.fail(f"the program in README.md ended with {result.returncode}")
    if len(said.splitlines()) != frames:
        script.fail(f"the program in README.md gave {len(said.splitlines())} poses for {frames} frames")
