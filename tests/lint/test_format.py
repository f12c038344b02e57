"""Every C and C++ file is as clang-format leaves it, which breaks code at 120 columns and leaves comments alone; those have 140. Public headers have 100."""

import shutil
import subprocess

import source
from source import script

if shutil.which("clang-format") is None:
    script.skip("clang-format is not installed")

MAX_WIDTH = 140
MAX_WIDTH_PUBLIC = 100  # of the headers that users read

problems = []
for path in source.files("lib", "platform", "examples", "tools", "tests"):
    width = MAX_WIDTH_PUBLIC if source.name(path).startswith("lib/include/") else MAX_WIDTH
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if len(line) > width:
            problems.append(f"{source.name(path)}:{number}: {len(line)} columns, {width} at most")
if problems:
    source.report(problems)
for path in source.files("lib", "platform", "examples", "tools", "tests"):
    result = subprocess.run(["clang-format", "--style=file", str(path)], capture_output=True, cwd=source.ROOT)
    if result.returncode != 0:
        script.fail(result.stderr.decode())
    if result.stdout != path.read_bytes():
        problems.append(source.name(path))
if problems:
    print("mend with: clang-format -i", *problems)
source.report(problems)
