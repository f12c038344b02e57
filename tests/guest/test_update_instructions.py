"""Instructions of one update of the covariance on 64-bit ARM, n = 300, m = 20, within 5 % of tests/golden/instructions.txt.

The emulator tells of every instruction, one by one; the difference between three updates and one is two updates. With
PLANEFOLD_UPDATE_GOLDEN=1 in the environment the golden numbers are rewritten instead.
"""

import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import cross  # noqa: E402
import script  # noqa: E402

GOLDEN = script.SOURCE / "tests" / "golden" / "instructions.txt"
BAND = 0.05
HEAD = "# Instructions of one update on aarch64, n = 300, m = 20, by library; within 5 % both ways.\n"

cross.skip_without("aarch64")


def instructions(program, updates):
    """Executed by the program from its first to its last, as the emulator's log has them."""
    command = [cross.emulator("aarch64"), "-singlestep", "-d", "exec,nochain", "-L", cross.root_of("aarch64"), program, updates]
    with subprocess.Popen([str(word) for word in command], stderr=subprocess.PIPE) as emulator:
        count = sum(line.startswith(b"Trace") for line in emulator.stderr)
    if emulator.returncode != 0:
        script.fail(f"{program.name} ended with {emulator.returncode} under emulation")
    return count


built = cross.build("aarch64", "planefold", "planefoldf")
found = {}
with tempfile.TemporaryDirectory() as folder:
    for library, scalar in (("planefold", []), ("planefoldf", ["-DPLANEFOLD_SCALAR_FLOAT=1"])):
        kernels = sorted((built / "lib" / "CMakeFiles" / f"{library}_fast_objects.dir" / "src" / "covariance" / "tuned").rglob("*.o"))
        others = sorted(path for path in (script.SOURCE / "lib" / "src" / "covariance").rglob("*.cpp") if path.parent.name != "tuned")
        program = pathlib.Path(folder) / f"updates_{library}"
        bench = script.SOURCE / "tools" / "pf-bench"
        script.run(cross.compiler("aarch64", "g++"), "-O2", "-std=c++17", *scalar, "-I", script.SOURCE / "lib" / "src", "-I", bench,
                   script.SOURCE / "tests" / "guest" / "counted_updates.cpp", bench / "covariance_problem.cpp", *others, *kernels,
                   "-o", program)
        found[library] = (instructions(program, 3) - instructions(program, 1)) // 2

if os.environ.get("PLANEFOLD_UPDATE_GOLDEN") == "1":
    GOLDEN.write_text(HEAD + "".join(f"{library} {count}\n" for library, count in found.items()))
golden = dict(line.split() for line in GOLDEN.read_text().splitlines() if not line.startswith("#"))
problems = []
for library, count in found.items():
    expected = int(golden[library])
    print(f"{library}: {count} instructions, golden {expected}")
    if abs(count - expected) > BAND * expected:
        problems.append(f"{library}: {count} instructions, golden {expected}; where this is meant, say why in the commit")
if problems:
    script.fail("\n  ".join(problems))
