"""Sums up ctest runs from their JUnit files:  summary.py NAME=FILE...

One line per run, then what failed and what was skipped, each with its reason. Exit status 1 where anything failed.
"""

import re
import sys
import xml.etree.ElementTree


def reason(output):
    """What a skipped test said: its line SKIP: ..., or its last line."""
    lines = [line.strip() for line in (output or "").splitlines() if line.strip()]
    for line in lines:
        if line.startswith("SKIP:"):
            return line[len("SKIP:"):].strip()
    return lines[-1] if lines else "no reason given"


def ignored(output):
    """Cases that Unity was told to ignore, with their messages."""
    return re.findall(r":\d+:(\w+):IGNORE(?:: (.*))?", output or "")


def main():
    bad = False
    skipped, failed = [], []
    for argument in sys.argv[1:]:
        name, path = argument.split("=", 1)
        try:
            cases = xml.etree.ElementTree.parse(path).getroot().findall("testcase")
        except (OSError, xml.etree.ElementTree.ParseError) as error:
            print(f"  {name}: did not run ({error})")
            bad = True
            continue
        counts = {"passed": 0, "failed": 0, "skipped": 0}
        for case in cases:
            output = case.findtext("system-out")
            if case.get("status") == "run":
                counts["passed"] += 1
                skipped += [(name, f"{case.get('name')}: {test}", why or "no reason given")
                            for test, why in ignored(output)]
            elif case.find("skipped") is not None and case.find("skipped").get("message", "").startswith("SKIP_RETURN_CODE"):
                counts["skipped"] += 1
                skipped.append((name, case.get("name"), reason(output)))
            else:
                counts["failed"] += 1
                failed.append((name, case.get("name")))
        seconds = sum(float(case.get("time", 0)) for case in cases)
        print(f"  {name}: {counts['passed']} passed, {counts['failed']} failed, "
              f"{counts['skipped']} skipped ({seconds:.0f} s of tests)")
        bad = bad or counts["failed"] > 0 or not cases
    if skipped:
        print("\n  Skipped:")
        for run, test, why in skipped:
            print(f"    {run} {test}: {why}")
    if failed:
        print("\n  FAILED:")
        for run, test in failed:
            print(f"    {run} {test}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
