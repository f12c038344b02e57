"""What the library takes on a target: code, static data and the block of the three profiles; held against
tests/golden/sizes.txt.

With PLANEFOLD_UPDATE_GOLDEN=1 in the environment the golden numbers are rewritten instead; tools/update-golden does that.
"""

import os
import re

import script

GOLDEN = script.SOURCE / "tests" / "golden" / "sizes.txt"
PAGE = script.SOURCE / "lib" / "docs" / "results" / "devices.md"
# Rows of the page's table, by what they are called there, and its columns.
PAGE_TARGETS = {"x86_64": "x86_64", "64-bit ARM": "aarch64", "ARMv7": "armhf", "Cortex-M7": "cortex-m7"}
PAGE_COLUMNS = ("text", "block_tiny", "block_handheld", "block_room")
BAND, SLACK = 0.05, 256
KIB = 1024
# What each profile may take, in the library that it is meant for. [bytes]
LIMITS = {("planefoldf", "tiny"): 256 * KIB, ("planefoldf", "handheld"): 1024 * KIB, ("planefold", "handheld"): 1024 * KIB,
          ("planefoldf", "room"): 4096 * KIB, ("planefold", "room"): 4096 * KIB}


def of_archive(size_program, archive):
    """Code with constants, and static data, of an archive [bytes]."""
    rows = script.run(size_program, archive).splitlines()[1:]
    numbers = [[int(word) for word in row.split()[:3]] for row in rows]
    return {"text": sum(row[0] for row in numbers), "data": sum(row[1] + row[2] for row in numbers)}


def of_profiles(compiler, archive, folder, *emulator):
    """Block of each profile, and the bound on the stack, as the example program tells them [bytes]."""
    program = folder / ("profiles_" + archive.stem)
    script.run(compiler, "-std=c99", "-I", script.SOURCE / "lib" / "include", script.SOURCE / "examples" / "05_profiles.c",
               archive, "-lm", "-o", program)
    said = script.run(*emulator, program)
    print(said, end="")
    found = {"block_" + name: int(size) for name, size in re.findall(r"^(\w+) .* block (\d+) bytes", said, re.M)}
    found["stack"] = int(re.search(r"stack at most (\d+) bytes", said).group(1))
    return found


def read_golden():
    rows = [line.split() for line in GOLDEN.read_text().splitlines() if line and not line.startswith("#")]
    return {(target, library, what): int(value) for target, library, what, value in rows}


def page_of(golden):
    """The page with the golden numbers in its table."""
    def row(found):
        values = [golden.get((PAGE_TARGETS[found[1]], found[2], what)) for what in PAGE_COLUMNS]
        cells = [f" {value:,} " if value is not None else " " for value in values]
        return f"| {found[1]} | `{found[2]}` |" + "|".join(cells) + "|"

    names = "|".join(PAGE_TARGETS)
    return re.sub(rf"^\| ({names}) \| `(planefoldf?)` \|.*$", row, PAGE.read_text(), flags=re.M)


def check(target, sizes):
    """sizes: by library and what, bytes. Ends the test where one is outside of its band or limit."""
    golden = read_golden() if GOLDEN.exists() else {}
    if os.environ.get("PLANEFOLD_UPDATE_GOLDEN") == "1":
        golden = {key: value for key, value in golden.items() if key[0] != target}
        golden.update({(target, *key): value for key, value in sizes.items()})
        lines = [" ".join([*key, str(value)]) for key, value in sorted(golden.items())]
        head = "# target library what bytes; within 5 % or 256 bytes both ways. tools/update-golden rewrites this.\n"
        GOLDEN.write_text(head + "\n".join(lines) + "\n")
        PAGE.write_text(page_of(golden))
    problems = []
    for (library, what), value in sorted(sizes.items()):
        expected = golden.get((target, library, what))
        print(f"{target} {library} {what}: {value} bytes, golden {expected}")
        if os.environ.get("PLANEFOLD_UPDATE_GOLDEN") != "1" and (expected is None or abs(value - expected) > max(BAND * expected, SLACK)):
            problems.append(f"{target} {library} {what} is {value} bytes, golden {expected}")
        limit = LIMITS.get((library, what.removeprefix("block_")))
        if limit is not None and value > limit:
            problems.append(f"{library} {what} is {value} bytes, allowed are {limit}")
    if problems:
        script.fail("\n  ".join([*problems, "where this is meant, run tools/update-golden and say why in the commit"]))
