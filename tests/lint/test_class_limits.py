"""A class has one job: limits of its size, and of that of functions, in the rooms of the back ends.

Plain records count as classes: what many fields are handed to sees all of them. carry(Archive&), which every class has that keeps something
between frames, and the carry.cpp of its room do not count: they are no job of the class, and to leave them out would be no merit. What stands above a limit is listed with its reason. A
number in the list may only fall: the test asks for the lower one as soon as there is one."""

import pathlib

import classes
import source

ROOMS = ("session", "inertial", "filter_slam", "keyframe_slam", "frame", "model", "observe", "bundle", "belief")
MAX_METHODS, MAX_MEMBERS, MAX_SOURCES, MAX_LINES = 25, 15, 2, 60

# (class or function, what is counted): (how many, why).
ABOVE = {
    ("Settings", "data members"): (46, "the config in the library's own units; a struct for each back end would show half of it to each"),
    ("Session", "methods"): (26, "one for each call of the API that begins or feeds a map"),
    ("FrameReport", "data members"): (17, "the counts of pf_report_t, each by itself"),
    ("RestDetector::Data", "data members"): (16, "running sums over the samples of a rest, which begin and end together"),
}

found = {}
problems = []


def count(name, what, number, most, file, line):
    if number > most and number > found.get((name, what), (0, ""))[0]:
        found[name, what] = number, f"{source.name(file)}:{line}"


read, functions = classes.read(*(f"lib/src/{room}" for room in ROOMS))
for one in read:
    count(one.name, "methods", sum(not method.startswith("void carry(Archive&") for method in one.methods), MAX_METHODS, one.file, one.line)
    count(one.name, "data members", len(one.members), MAX_MEMBERS, one.file, one.line)
    count(one.name, ".cpp files", sum(pathlib.Path(source_file).name != "carry.cpp" for source_file in one.sources), MAX_SOURCES, one.file, one.line)
for function in functions:
    count(function.name, "lines", function.lines, MAX_LINES, function.file, function.line)

LIMITS = {"methods": MAX_METHODS, "data members": MAX_MEMBERS, ".cpp files": MAX_SOURCES, "lines": MAX_LINES}
for (name, what), (number, where) in sorted(found.items()):
    allowed = ABOVE.get((name, what), (LIMITS[what], ""))[0]
    if number > allowed:
        problems.append(f"{where}: {name} has {number} {what}, {allowed} at most: one job each")
for (name, what), (allowed, _) in ABOVE.items():
    number = found.get((name, what), (None, ""))[0]
    if number is None:
        problems.append(f"tests/lint/test_class_limits.py: {name} is within the limit of {what}: take it off the list")
    elif number < allowed:
        problems.append(f"tests/lint/test_class_limits.py: {name} has {number} {what}: lower the {allowed} of the list")
if len(read) < 100 or len(functions) < 500:
    problems.append(f"tests/lint/classes.py: only {len(read)} classes and {len(functions)} functions found, so it no longer reads them")
source.report(problems)
