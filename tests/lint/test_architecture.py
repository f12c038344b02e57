"""The architecture page names what there is: the modules of rooms.py, the folders of platform/, the folders of tests."""

import re
import subprocess
import sys

import rooms
import source

PAGE = source.ROOT / "lib/docs/theory/architecture.md"
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
LIB = source.ROOT / "lib/src"
on_disk = {rooms.room_of(path.relative_to(LIB).as_posix()) for path in source.files("lib/src")}
compare("rooms.py", set(rooms.LIBRARY), on_disk)
compare("the table of modules", table("module"), set(rooms.LIBRARY) | {f"platform/{name}" for name in platform})

drawing = re.search(r"```\n(.*?)```", text, re.S).group(1)
library = re.sub(r"[|+/\\\\-]", " ", drawing[drawing.index("lib/src/api"):].replace("lib/src/", ""))
top = {name for name in rooms.LIBRARY if "/" not in name}
compare("the drawing", {name for name in top if re.search(rf"(?m)^ *(?:\w+ +)*{name}\b", library)}, top)
drawn = subprocess.run([sys.executable, source.ROOT / "tools/draw-rooms", "--print"], capture_output=True, text=True, check=True).stdout
if drawn != (source.ROOT / "lib/docs/images/rooms.dot").read_text():
    problems.append("lib/docs/images/rooms.dot is not what the includes say: run tools/draw-rooms")
line = re.search(r"> platform/ +([\w ]+)", drawing)
compare("the drawing's platform/", set(line.group(1).split()) if line else set(), platform)

groups = {path.parent.name for path in (source.ROOT / "tests").glob("*/*_*.*") if path.name.startswith(("test_", "fuzz_")) and path.suffix in (".c", ".cpp", ".py", ".sh")}
groups |= {path.parent.name for path in (source.ROOT / "tests").glob("*/fuzz_*.cpp")}
compare("the table of tests", table("folder and label"), groups)
source.report(problems)
