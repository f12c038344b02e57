"""A C project outside of the tree builds against the install tree with the C compiler alone, and runs.

Through CMake with C as the only language, and through pkg-config with and without --static; for both libraries.
"""

import os
import pathlib
import shutil
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

script.skip_unless_plain_native_build()

OUTSIDE = script.SOURCE / "tests" / "api" / "outside"
VERSION = script.cache("CMAKE_PROJECT_VERSION")


def check(program, scalar):
    said = script.run(program)
    print(said, end="")
    if f"planefold {VERSION} scalar {scalar} " not in said:
        script.fail(f"{program} said something else than version {VERSION} and scalar {scalar}")


with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    first, prefix = folder / "first", folder / "moved"
    script.install_tree(first)
    first.rename(prefix)  # an install tree may be moved

    # No C++ compiler can be found: whoever asks for one fails.
    build = folder / "build"
    environment = dict(os.environ, CXX="/nonexistent/c++")
    script.run("cmake", "-S", OUTSIDE, "-B", build, f"-DCMAKE_PREFIX_PATH={prefix}",
               f"-DCMAKE_C_COMPILER={script.c_compiler()}", env=environment)
    script.run("cmake", "--build", build, env=environment)
    check(build / "outside", 8)
    check(build / "outsidef", 4)

    if shutil.which("pkg-config") is None:
        script.fail("pkg-config is not installed")
    packages = next(prefix.rglob("pkgconfig"))
    environment = dict(os.environ, PKG_CONFIG_PATH=str(packages))
    for package, scalar in (("planefold", 8), ("planefoldf", 4)):
        found = script.run("pkg-config", "--modversion", package, env=environment).strip()
        if found != VERSION:
            script.fail(f"{package}.pc says version {found}, the project {VERSION}")
        for static in ([], ["--static"]):
            flags = script.run("pkg-config", "--cflags", "--libs", *static, package, env=environment).split()
            program = folder / ("pc-" + package + "-".join(static))
            script.run(script.c_compiler(), "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror",
                       OUTSIDE / "main.c", *flags, "-o", program)
            check(program, scalar)

    # The archive and -lm are all that a program needs.
    archive = next(prefix.rglob("libplanefold.a"))
    script.run(script.c_compiler(), "-std=c99", OUTSIDE / "main.c", "-I", prefix / "include", archive, "-lm",
               "-o", folder / "plain")
    check(folder / "plain", 8)
