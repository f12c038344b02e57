"""Nothing in lib/src but the kernels and BlockFilter can write the covariance: all others see it as const Triangle&, and leave its memory
alone."""

import re

import source

OWNERS = re.compile(r"lib/src/(covariance/|filter/block_filter\.|filter/block_update\.|filter/block_inflate\.|filter/located\.h)")
RULES = [
    (re.compile(r"\bTriangle\b(?!::)"), re.compile(r"\bconst Triangle&"), "a Triangle that is not const Triangle&"),
    (re.compile(r"\.data\b(?!\()"), None, "memory of a matrix"),
    (re.compile(r"\bopen_gap\b"), None, "open_gap"),
    (re.compile(r"const_cast<[^>]*(Triangle|BlockFilter)"), None, "const_cast of the covariance or its owner"),
    (re.compile(r"(->|\.)(downdate|transform_many|gather_many|replace)\s*\("), re.compile(r"\bblocks_?\.downdate\("), "a kernel of the covariance"),
]


def breaks(line):
    for pattern, allowed, why in RULES:
        if pattern.search(allowed.sub("", line) if allowed else line):
            yield why


# The rules see what they are for.
for bad in ("Triangle P = filter.covariance();", "P.data[0] = 1;", "open_gap(P, 0, 1, g, 1);", "kernels.downdate(P, W, m, U, G, 0, ld, 0, 0);"):
    if not list(breaks(bad)):
        raise SystemExit(f"the rule does not see: {bad}")

problems = []
for path in source.files("lib/src"):
    name = source.name(path)
    if OWNERS.match(str(name)):
        continue
    for number, line in enumerate(source.code(path.read_text()).splitlines(), 1):
        problems += [f"{name}:{number}: {why}: {line.strip()}" for why in breaks(line)]
source.report(problems)
