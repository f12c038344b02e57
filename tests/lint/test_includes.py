"""Every #include goes down the arrows of lib/docs/theory/architecture.md."""

import fnmatch
import re

import rooms
import source

LIB = source.ROOT / "lib" / "src"
problems = []


def complain(path, number, why):
    problems.append(f"{source.name(path)}:{number}: {why}")


def library(path):
    inside = path.relative_to(LIB).as_posix()
    room = rooms.room_of(inside)
    if not room:
        complain(path, 1, f"{inside} lies in no room of the house; see tests/lint/rooms.py")
        return
    for number, bracket, what in source.includes(path):
        other = rooms.room_of(what)
        if what.startswith("planefold/"):
            if room not in rooms.SEE_PUBLIC_HEADER:
                complain(path, number, f"{room} may not see the public header")
        elif what.split("/")[0] == "Eigen":
            if source.name(path) != "lib/src/base/eigen.h" and not (LIB / "base/eigen.h") in closure(path):
                complain(path, number, "Eigen is included without base/eigen.h, which sets it up")
        elif bracket == '"':
            if not (LIB / what).is_file():
                complain(path, number, f'"{what}" is not a path from lib/src')
            elif other != room and other not in rooms.LIBRARY[room]:
                complain(path, number, f"{room} may not include {other}")
            elif what in rooms.ONLY_FOR and not any(fnmatch.fnmatch(inside, allowed) for allowed in rooms.ONLY_FOR[what]):
                complain(path, number, f"{inside} may not include {what}; see ONLY_FOR in tests/lint/rooms.py")
        elif what not in rooms.STANDARD and what not in rooms.FOR_ONE_PROCESSOR and what not in rooms.PLATFORM_PROBES \
                and what not in rooms.SANITIZERS:
            complain(path, number, f"<{what}> is not among the standard headers that the library may use")


def closure(path, seen=None):
    """The project's own files that a file includes, itself included, however deep."""
    seen = set() if seen is None else seen
    if path not in seen:
        seen.add(path)
        for _, bracket, what in source.includes(path):
            if bracket == '"' and (LIB / what).is_file():
                closure(LIB / what, seen)
    return seen


for what in rooms.ONLY_FOR:
    if not (LIB / what).is_file():
        problems.append(f"tests/lint/rooms.py: ONLY_FOR names {what}, which does not exist")

for room, allowed in rooms.LIBRARY.items():
    for other in allowed:
        if room == other or room in rooms.LIBRARY[other]:
            problems.append(f"tests/lint/rooms.py: {room} and {other} may not include each other")

for folder in sorted({path.parent for path in source.files("lib/src")}):
    count = sum(path.suffix in source.CODE for path in folder.iterdir())
    if folder.relative_to(LIB).parts[0] in rooms.LIMITED and count > rooms.MAX_FILES:
        problems.append(f"{source.name(folder)} has {count} files, {rooms.MAX_FILES} at most: a room in it for those that belong together")

for path in source.files("lib/src"):
    library(path)
    room = rooms.room_of(path.relative_to(LIB).as_posix())
    lines = path.read_text().count("\n")
    if lines > rooms.MAX_LINES.get(room, lines):
        complain(path, lines, f"a file of {room} has at most {rooms.MAX_LINES[room]} lines: one job each")
    if re.search(r"_(avx2|avx512|neon)\.cpp$", path.name):
        for reached in sorted(closure(path)):
            for number, bracket, what in source.includes(reached):
                if bracket == "<" and what not in rooms.FOR_ONE_PROCESSOR:
                    complain(path, number, f"code for one processor reaches <{what}> through {source.name(reached)}")

for path in source.files("lib/include"):
    for number, bracket, what in source.includes(path):
        if what not in ("stddef.h", "stdint.h") and (path.name, what) != ("planefold_research.h", "planefold/planefold.h"):
            complain(path, number, "the public header includes stddef.h and stdint.h only")

# Above the public header nobody looks into the library, and the platform layer knows no program.
for path in source.files("platform", "examples", "tools"):
    top = source.name(path).split("/")[0]
    if "/".join(source.name(path).split("/")[:2]) in rooms.LOOK_INSIDE:
        continue
    for number, bracket, what in source.includes(path):
        first = what.split("/")[0]
        if bracket == '"' and (LIB / what).is_file() and not (path.parent / what).is_file():
            complain(path, number, f"{top} may not look into lib/src")
        if "lib/src" in what or (first == ".." and "/src/" in what):
            complain(path, number, f"{top} may not look into lib/src")
        if top == "platform" and re.search(r"(^|/)(tools|examples|tests)/", what):
            complain(path, number, f"platform may not include {what}")

source.report(problems)
