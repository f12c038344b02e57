"""The archives export pf_* and nothing else, need only the symbols of allowed_symbols.txt, hold no mutable globals and
no static constructors, and the files for one processor feature define no symbol that the linker could share."""

import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

if script.cache("PLANEFOLD_SANITIZE") or script.is_on("PLANEFOLD_COVERAGE"):
    script.skip("instrumentation adds symbols of its own")
if script.cache("CMAKE_BUILD_TYPE") != "Release":
    script.skip("only release builds ship")

NM = script.cache("CMAKE_NM", "nm")
READELF = script.cache("CMAKE_READELF", "readelf")

allowed = set()
for line in pathlib.Path(__file__).with_name("allowed_symbols.txt").read_text().splitlines():
    allowed.update(line.split("#")[0].split())
# Helpers of the compiler's own run-time library for arithmetic that the ARM core has no instruction for.
compiler_helper = re.compile(r"__aeabi_\w+") if "arm-" in NM else re.compile(r"(?!)")

problems = []


def symbols(path):
    for line in script.run(NM, path).splitlines():
        match = re.match(r"^([0-9a-f]*)\s+(\S)\s+(\S+)$", line)
        if match:
            yield match.group(2), match.group(3)


declared = set(re.findall(r"PF_API[^;{]*?\b(pf_\w+)\(", "".join(path.read_text() for path in sorted((script.SOURCE / "lib/include/planefold").glob("*.h")))))
for archive in ("libplanefold.a", "libplanefoldf.a"):
    path = script.BUILD / "lib" / archive
    if archive == "libplanefoldf.a" and not path.exists():
        print("libplanefoldf.a is not part of this build")
        continue
    found = list(symbols(path))
    undefined = sorted({name for kind, name in found if kind in "Uwv"})
    exported = sorted({name for kind, name in found if kind.isupper() and kind != "U"})
    print(f"{archive} exports {len(exported)} symbols and needs: {' '.join(undefined)}")
    problems += [f"{archive} needs {name}" for name in undefined
                 if name not in allowed and not compiler_helper.fullmatch(name)]
    problems += [f"{archive} exports {name}" for name in exported if not name.startswith("pf_")]
    problems += [f"{archive} exports {name}, which the header does not declare"
                 for name in exported if name.startswith("pf_") and name not in declared]
    problems += [f"{archive} lacks {name}, which the header declares" for name in sorted(declared - set(exported))]

    for line in script.run(READELF, "-SW", path).splitlines():
        match = re.match(r"\s*\[\s*\d+\]\s+(\S+)\s+(PROGBITS|NOBITS|INIT_ARRAY|FINI_ARRAY)\s+\S+\s+\S+\s+([0-9a-f]+)", line)
        if not match or int(match.group(3), 16) == 0:
            continue
        section = match.group(1)
        if re.match(r"\.(data|bss|tdata|tbss)(\.(?!rel\.ro)|$)", section) or section.startswith(".init_array"):
            problems.append(f"{archive} has a mutable or constructed global: section {section}")

# An inline function compiled for one processor must never stand in for the one that every processor runs.
for objects in script.BUILD.glob("lib/CMakeFiles/planefold*_objects.dir/**/*.o"):
    if re.search(r"_(avx2|avx512|neon)\.cpp\.o$", objects.name):
        problems += [f"{objects.name} defines the shared symbol {name}" for kind, name in symbols(objects) if kind in "WVu"]

if problems:
    script.fail("\n  ".join(["what must not be:"] + problems))
