"""Numbers that decide something have a name. In the modules of the estimator no bare number stands in an expression, but for coefficients.

A coefficient is a whole number from 0 to 4, a half or a quarter: what formulas are made of. Every other number with a fraction or an
exponent, and every other Scalar(number), is the value of a constant (constexpr) or the default of a member of a struct. Tuned ones
stand in the module's tuning.h, one to a line, with a comment that says what it is and its unit. Static are those that the compiler has to
know, such as the size of an array: a build with PLANEFOLD_TUNABLE cannot set them."""

import re

import source

MODULES = ["session", "filter_slam", "keyframe_slam", "frame", "track", "bundle", "map", "filter", "model", "observe"]
COEFFICIENTS = {0, 1, 2, 3, 4, 0.5, 0.25}
NUMBER = r"\d+\.\d*(?:e[-+]?\d+)?|\.\d+(?:e[-+]?\d+)?|\d+e[-+]?\d+"
LITERAL = re.compile(rf"\bScalar\(\s*-?(?P<scalar>\d+|{NUMBER})f?\s*\)|(?<![\w.])(?P<plain>{NUMBER})f?(?![\w.])")
NAMED = re.compile(r"\bconstexpr\b[^=;]*=|^\s*(?:Scalar|float|double)\s+\w+ =", re.MULTILINE)
# Of counts and lengths: `2 * agree >= searched` says that half is enough, which is a number that decides.
RATIO = re.compile(r"(?<![\w.)])(?:[2-9]|\d\d+) \* [a-z][\w.>()-]* (?:<|>|<=|>=) |(?:<|>|<=|>=) (?:[2-9]|\d\d+) \* (?!k[A-Z])[a-z]")
TUNED = re.compile(r"(?:inline|static) constexpr (?:Scalar|float|double|int) k\w+ = [^;]+; +///< \S.*")


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


def bare_ratios(path):
    """(line number, text) of comparisons with so many times something."""
    for number, line in enumerate(source.code(path.read_text()).splitlines(), 1):
        if (match := RATIO.search(line)) and not re.match(r"\s*(?:for \(|PF_ASSERT)", line):
            yield number, match.group(0).strip()


problems = []
for module in MODULES:
    for path in source.files(f"lib/src/{module}"):
        problems += [f"{source.name(path)}:{line}: the ratio in '{text}' has no name" for line, text in bare_ratios(path)]
        problems += [f"{source.name(path)}:{line}: {literal} has no name" for line, literal in bare_numbers(path)]
for path in source.files("lib/src"):
    if path.name != "tuning.h":
        continue
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if "constexpr" in line and not TUNED.fullmatch(line):
            problems.append(f"{source.name(path)}:{number}: one number to a line, and behind it what it is: {line.strip()}")
source.report(problems)
