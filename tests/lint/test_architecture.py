"""The architecture page names what there is: the modules of rooms.py, the folders of platform/, the folders of tests."""

import re

import rooms
import source

PAGE = source.ROOT / "lib/docs/architecture.md"
text = PAGE.read_text()
problems = []


def compare(what, page, disk):
    problems.extend(f"architecture.md: {what} lacks {name}" for name in sorted(disk - page))
    problems.extend(f"architecture.md: {what} names {name}, which does not exist" for name in sorted(page - disk))


def table(heading):
    """Names in the first column of the table whose head has this word."""
    match = re.search(rf"^\| [^|\n]*\b{heading}\b[^|\n]*\|[^\n]*\n\|[-|]+\|\n((?:\|[^\n]*\n)+)", text, re.M)
    if match is None:
        source.script.fail(f"architecture.md has no table of '{heading}'")
    return {name for line in match.group(1).splitlines() for name in re.findall(r"`([\w/-]+)`", line.split("|")[1])}


platform = {path.parent.name for path in (source.ROOT / "platform").glob("*/CMakeLists.txt")}
on_disk = {path.name for path in (source.ROOT / "lib/src").iterdir() if path.is_dir()}
compare("rooms.py", set(rooms.LIBRARY), on_disk)
compare("the table of modules", table("module"), set(rooms.LIBRARY) | {f"platform/{name}" for name in platform})

drawing = re.search(r"```\n(.*?)```", text, re.S).group(1)
library = drawing[drawing.index("lib/src/api"):]
drawn = set(re.findall(r"\blib/src/(\w+)", library)) | {name for name in rooms.LIBRARY if re.search(rf"(?m)^[ |]*(?:\w+ +)*{name}\b", library)}
compare("the drawing", drawn, set(rooms.LIBRARY))
line = re.search(r"> platform/ +([\w ]+)", drawing)
compare("the drawing's platform/", set(line.group(1).split()) if line else set(), platform)

groups = {path.parent.name for path in (source.ROOT / "tests").glob("*/*_*.*") if path.name.startswith(("test_", "fuzz_")) and path.suffix in (".c", ".cpp", ".py", ".sh")}
groups |= {path.parent.name for path in (source.ROOT / "tests").glob("*/fuzz_*.cpp")}
compare("the table of tests", table("folder and label"), groups)
source.report(problems)
