"""What is on disk and what runs are the same: every test file is registered with ctest under its folder's label, and every
test function is run and named for behaviour."""

import json
import re

import source
from source import script

TESTS = source.ROOT / "tests"
GROUPS = ["unit", "jacobian", "property", "api", "memory", "sim", "real", "replay", "regression", "guest", "bench", "lint", "slow"]
NOT_GROUPS = ["support", "golden", "fuzz"]
problems = []

registered = {}
for test in json.loads(script.run("ctest", "--show-only=json-v1", "--test-dir", script.BUILD))["tests"]:
    labels = [value for entry in test.get("properties", []) if entry["name"] == "LABELS" for value in entry["value"]]
    registered[test["name"]] = labels

for folder in sorted(path for path in TESTS.iterdir() if path.is_dir() and path.name != "__pycache__"):
    if folder.name not in GROUPS + NOT_GROUPS:
        problems.append(f"tests/{folder.name}/ is no group that is registered")

expected = set()
for group in GROUPS:
    for path in sorted((TESTS / group).glob("test_*")):
        if path.suffix not in (".c", ".cpp", ".py", ".sh"):
            problems.append(f"{source.name(path)} looks like a test and is of no kind that is registered")
            continue
        test = f"{group}_{path.stem[len('test_'):]}"
        if test in expected:
            problems.append(f"{source.name(path)}: a second file with the name {test}")
        expected.add(test)
        if test not in registered:
            problems.append(f"{source.name(path)} is not registered")
        elif group not in registered[test]:
            problems.append(f"{source.name(path)} does not have the label {group}")
    for path in sorted((TESTS / group).rglob("*")):
        if path.suffix in (".c", ".cpp") and not path.name.startswith("test_") and "UNITY_BEGIN" in path.read_text():
            problems.append(f"{source.name(path)} runs tests and is not named test_*")
for test in sorted(set(registered) - expected):
    if not (test.endswith("_float") and test[: -len("_float")] in expected):
        problems.append(f"{test} is registered and has no file")

for path in source.files("tests", suffixes=(".c", ".cpp")):
    if not path.name.startswith("test_"):
        continue
    text = source.code(path.read_text())
    defined = re.findall(r"^\s*(?:static\s+)?void\s+(test_\w+)\s*\((?:void)?\)\s*\{", text, re.M)
    for function in defined:
        if not re.search(rf"\bRUN_TEST\(\s*{function}\s*[,)]", text):
            problems.append(f"{source.name(path)}: {function} is never run")
        if not re.fullmatch(r"test_\w+_should_\w+", function):
            problems.append(f"{source.name(path)}: {function} is not named test_subject_should_behaviour[_when_condition]")
    if not defined:
        problems.append(f"{source.name(path)} defines no test")

floats = re.findall(r"\S+\.(?:cpp|c)\b", (TESTS / "float_tests.cmake").read_text())
problems += [f"tests/float_tests.cmake names {entry}, which does not exist" for entry in floats if not (TESTS / entry).is_file()]
source.report(problems)
