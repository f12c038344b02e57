"""The tuned numbers of lib/src, and the headers of a build with PLANEFOLD_TUNABLE.

    tuned_numbers.py --write SOURCE OUT    writes OUT/FOLDER/tuning.h for each SOURCE/FOLDER/tuning.h

A number is `inline constexpr TYPE kName = VALUE;`. Those that the compiler has to know are `static constexpr` and stay as they are."""

import pathlib
import re
import sys

CONSTANT = re.compile(r"^inline constexpr (?P<type>\w+) (?P<name>k\w+) =\s*(?P<value>[^;]+);", re.MULTILINE)
SPACE = re.compile(r"^namespace (?:pf::)?(?:tuning(?:::)?)?(?P<name>\w*) \{", re.MULTILINE)


class Constant:
    """One number: where it is written, and its value."""

    def __init__(self, header, module, space, match):
        self.header = header
        self.name = f"{module}.{space}.{match['name']}"
        self.type, self.value, self.span = match["type"], match["value"].strip(), match.span("value")

    def number(self, factor):
        """The value times a factor."""
        text = re.sub(r"^(?:Scalar|float|double|int)\((.*)\)$", r"\1", self.value).rstrip("f")
        return max(1, round(int(text) * factor)) if self.type == "int" else float(text) * factor


def constants(source):
    """All numbers of all tuning headers, in their order."""
    found = []
    for header in sorted(source.glob("lib/src/**/tuning.h")):
        text = header.read_text()
        spaces = [(m.start(), m["name"]) for m in SPACE.finditer(text)]
        for match in CONSTANT.finditer(text):
            space = [name for start, name in spaces if start < match.start()][-1]
            found.append(Constant(header.relative_to(source), header.parent.relative_to(source / "lib/src").as_posix(), space, match))
    return found


def write(source, out):
    """Headers whose numbers are read from the table; one that is as it was is not written again."""
    numbers = constants(source.parents[1])
    for header in sorted(source.glob("**/tuning.h")):
        text = header.read_text()
        for one in reversed([n for n in numbers if source.parents[1] / n.header == header]):
            begin, end = one.span
            text = f'{text[:begin]}::pf::tunable<{one.type}>("{one.name}", {text[begin:end].strip()}){text[end:]}'
        text = text.replace("inline constexpr ", "inline const ").replace("#pragma once\n", '#pragma once\n\n#include "tunable.h"\n', 1)
        made = out / header.relative_to(source)
        if not made.is_file() or made.read_text() != text:
            made.parent.mkdir(parents=True, exist_ok=True)
            made.write_text(text)


if __name__ == "__main__":
    if len(sys.argv) != 4 or sys.argv[1] != "--write":
        sys.exit(__doc__)
    write(pathlib.Path(sys.argv[2]).resolve(), pathlib.Path(sys.argv[3]))
