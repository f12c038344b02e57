"""Numbers that decide something have a name. In the modules of the estimator no bare number stands in an expression, but for coefficients.

A coefficient is a whole number from 0 to 4, a half or a quarter: what formulas are made of. Every other number with a fraction or an
exponent, and every other Scalar(number), is the value of a constant (constexpr) or the default of a member of a struct. Tuned ones
stand in the module's tuning.h, one to a line, with a comment that says what it is and its unit."""

import re

import source

MODULES = ["session", "filter_slam", "keyframe_slam", "frame", "track", "bundle", "map", "filter", "model", "observe"]
COEFFICIENTS = {0, 1, 2, 3, 4, 0.5, 0.25}
NUMBER = r"\d+\.\d*(?:e[-+]?\d+)?|\.\d+(?:e[-+]?\d+)?|\d+e[-+]?\d+"
LITERAL = re.compile(rf"\bScalar\(\s*-?(?P<scalar>\d+|{NUMBER})f?\s*\)|(?<![\w.])(?P<plain>{NUMBER})f?(?![\w.])")
NAMED = re.compile(r"\bconstexpr\b[^=;]*=|^\s*(?:Scalar|float|double)\s+\w+ =", re.MULTILINE)
TUNED = re.compile(r"inline constexpr (?:Scalar|float|int) k\w+ = [^;]+; +///< \S.*")


def bare_numbers(path):
    """(line number, literal) of numbers without a name. A default of a member counts as one in headers alone."""
    text = source.code(path.read_text())
    named = [match for match in NAMED.finditer(text) if "constexpr" in match.group(0) or path.suffix == ".h"]
    spans = [(match.start(), text.find(";", match.end())) for match in named]
    for match in LITERAL.finditer(text):
        if float(match["scalar"] or match["plain"]) in COEFFICIENTS:
            continue
        if not any(start <= match.start() < end for start, end in spans):
            yield text.count("\n", 0, match.start()) + 1, match.group(0)


problems = []
for module in MODULES:
    for path in source.files(f"lib/src/{module}"):
        problems += [f"{source.name(path)}:{line}: {literal} has no name" for line, literal in bare_numbers(path)]
for path in source.files("lib/src"):
    if path.name != "tuning.h":
        continue
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if "constexpr" in line and not TUNED.fullmatch(line):
            problems.append(f"{source.name(path)}:{number}: one number to a line, and behind it what it is: {line.strip()}")
source.report(problems)
