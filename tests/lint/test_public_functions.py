"""Every public function of the headers is called by at least one test, and by at least one program or example."""

import re

import source

functions = [name for path in source.files("lib/include") for name in re.findall(r"\bPF_API\b[^;(]*?\b(pf_\w+)\s*\(", source.code(path.read_text()))]
if len(functions) < 20:
    source.script.fail(f"the headers declare {len(functions)} functions: this test no longer reads it")


def called(paths):
    names = set()
    for path in paths:
        names |= set(re.findall(r"\b(pf_\w+)\s*\(", source.code(path.read_text())))
        names |= set(re.findall(r"[(,]\s*&?(pf_get_\w+)\s*[,)]", source.code(path.read_text())))  # handed over to be called
    return names


tests = called(path for path in source.files("tests", suffixes=(".c", ".cpp", ".h")) if path.parts[-2] not in ("fuzz", "guest"))
# pf-digest calls everything, for comparison, and so do the bindings of Python: nobody learns from them what a function is for.
programs = called(path for path in source.files("examples", "tools") if path.parent.name not in ("pf-digest", "bindings"))
problems = [f"{name} is called by no test" for name in functions if name not in tests]
problems += [f"{name} is called by no program and no example" for name in functions if name not in programs]
source.report(problems)
