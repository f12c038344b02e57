"""lib/src holds nothing that allocates, throws, prints, locks, reads a clock, depends on a locale or keeps global state."""

import re

import source

FORBIDDEN = [
    (r"(?<!<)\bnew\b(?!\s*\()", "new allocates (placement new is fine)"),
    (r"(?<!=)(?<!= )\bdelete\b", "delete"),
    (r"\b(malloc|calloc|realloc|free|alloca|aligned_alloc|posix_memalign)\s*\(", "the heap, or unbounded stack"),
    (r"\b(throw|try|catch)\b", "exceptions"),
    (r"\b(dynamic_cast|typeid)\b", "run-time types"),
    (r"\b(printf|fprintf|sprintf|snprintf|puts|fputs|fopen|getenv|setlocale|exit|abort)\s*\(", "the C library's outside world"),
    (r"\b(clock|time|clock_gettime|gettimeofday)\s*\(", "a clock"),
    (r"\b(strtod|strtof|atof|sscanf)\s*\(", "text that depends on the locale"),
    (r"\bstd::(vector|string|map|set|unordered_\w+|list|deque|function|shared_ptr|unique_ptr|make_\w+|mutex|thread|"
     r"ostream|cout|cerr|chrono|stable_sort|inplace_merge)\b(?!_)", "a part of the C++ library that allocates, locks or reads a clock"),
    (r"\b(rand|srand|drand48)\s*\(", "a shared random generator"),
    (r"\bthread_local\b", "state per thread"),
    (r"\bMatrixX\w*|\bEigen::Dynamic\b|\bVectorX\w*", "Eigen of dynamic size"),
    (r"\bvirtual\b", "virtual functions, whose destructors need operator delete"),
    (r"#\s*include\s*<(iostream|string|vector|map|functional|memory|thread|mutex|chrono|sstream|iomanip|random)>", "a header that is not for the library"),
    (r"\b(TODO|FIXME|XXX|HACK)\b", "an unfinished thought"),
]
# A static that is not a function and not constant is global state. Statics inside a class body are of the class's own kind.
STATIC = re.compile(r"^\s*static\s+(?!constexpr\b|const\b|inline\b|_Static|assert)[^()=;{]*(=|;|\{)")

problems = []
for path in source.files("lib/src"):
    text = path.read_text()
    stripped = source.code(text)
    for number, (line, raw) in enumerate(zip(stripped.splitlines(), text.splitlines()), 1):
        for pattern, why in FORBIDDEN:
            if re.search(pattern, raw if "TODO" in pattern or "include" in pattern else line):
                problems.append(f"{source.name(path)}:{number}: {why}: {raw.strip()}")
        if STATIC.search(line):
            problems.append(f"{source.name(path)}:{number}: mutable static: {raw.strip()}")
source.report(problems)
