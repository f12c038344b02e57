"""With BUILD_SHARED_LIBS the library is a shared one that exports pf_* only, needs libc and libm alone, and has a SONAME."""

import os
import pathlib
import re
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

script.skip_unless_plain_native_build()
VERSION = script.cache("CMAKE_PROJECT_VERSION")
MAIN = script.SOURCE / "tests" / "api" / "outside" / "main.c"

with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    script.run("cmake", "--preset", "library", "-S", script.SOURCE, "-B", folder / "shared", f"-DCMAKE_C_COMPILER={script.c_compiler()}",
               "-DBUILD_SHARED_LIBS=ON", "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG", cwd=script.SOURCE)
    script.run("cmake", "--build", folder / "shared", "--parallel", "2", "--target", "planefold")
    library = folder / "shared" / "lib" / "libplanefold.so"
    short = ".".join(VERSION.split(".")[:2])
    said = script.run("readelf", "-d", library)
    if f"libplanefold.so.{short}" not in said or not library.with_name(f"libplanefold.so.{VERSION}").exists():
        script.fail(f"the SONAME is not libplanefold.so.{short}:\n{said}")
    needed = set(re.findall(r"NEEDED.*\[(.*)\]", said))
    if not needed <= {"libm.so.6", "libc.so.6", "ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1"}:
        script.fail(f"the shared library needs {needed}")
    exported = [line.split()[-1] for line in script.run("nm", "-D", "--defined-only", library).splitlines()]
    wrong = [name for name in exported if not name.startswith("pf_")]
    if wrong or "pf_create" not in exported:
        script.fail(f"the shared library exports {wrong or exported}")
    environment = dict(os.environ, LD_LIBRARY_PATH=str(library.parent))
    script.run(script.c_compiler(), "-std=c99", "-I", script.SOURCE / "lib" / "include", MAIN, "-L", library.parent, "-lplanefold", "-o",
               folder / "program")
    said = script.run(folder / "program", env=environment)
    print(said, end="")
    if f"planefold {VERSION} scalar 8 " not in said or "libplanefold.so" not in script.run("readelf", "-d", folder / "program"):
        script.fail(f"a program with the shared library says {said}")
