"""The build takes Eigen 5, whose version file refuses those who ask for 3.4, and yaml-cpp by the name that it has since 0.8; an Eigen that
is too old is refused in words. Stand-ins for their CMake packages; nothing is compiled with them."""

import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

script.skip_unless_plain_native_build()
VERSION_FILE = """set(PACKAGE_VERSION {version})
if(NOT PACKAGE_FIND_VERSION OR PACKAGE_FIND_VERSION_MAJOR EQUAL {major})
  set(PACKAGE_VERSION_COMPATIBLE TRUE)
endif()
"""


def stand_in(folder, name, version, target, include):
    """A CMake package of one imported target, in the way of config files that accept their own major version only."""
    folder.mkdir()
    (folder / f"{name}-config.cmake").write_text(
        f"add_library({target} INTERFACE IMPORTED)\nset_target_properties({target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES {include} "
        f"INTERFACE_COMPILE_DEFINITIONS STAND_IN_{version.replace('.', '_')})\n")
    (folder / f"{name}-config-version.cmake").write_text(VERSION_FILE.format(version=version, major=version.split(".", maxsplit=1)[0]))
    return folder


def configure(build, *settings):
    result = subprocess.run(["cmake", "-S", script.SOURCE, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                             f"-DCMAKE_C_COMPILER={script.cache('CMAKE_C_COMPILER')}", f"-DCMAKE_CXX_COMPILER={script.cache('CMAKE_CXX_COMPILER')}",
                             "-DPLANEFOLD_BUILD_TESTS=OFF", *settings], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    said = " ".join(result.stdout.split())
    commands = (build / "build.ninja").read_text() if result.returncode == 0 else ""
    return result.returncode, said, commands


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    include = folder / "include"
    include.mkdir()
    new, old = (stand_in(folder / version, "eigen3", version, "Eigen3::Eigen", include) for version in ("5.0.0", "3.3.9"))
    status, said, commands = configure(folder / "a", f"-DEigen3_DIR={new}", "-DPLANEFOLD_BUILD_PROGRAMS=OFF")
    if status != 0:
        script.fail(f"Eigen 5.0.0 is not taken: {said[-600:]}")
    if str(include) not in commands:
        script.fail("Eigen 5.0.0 was found, and the library is compiled without it")
    status, said, _ = configure(folder / "b", f"-DEigen3_DIR={old}", "-DPLANEFOLD_BUILD_PROGRAMS=OFF")
    if status == 0 or "Eigen 3.3.9" not in said or "3.4 or later" not in said:
        script.fail(f"Eigen 3.3.9 is taken, or refused in other words: {said[-600:]}")
    print("Eigen 5.0.0 is taken, 3.3.9 refused")

    if script.cache("yaml-cpp_DIR").endswith("NOTFOUND"):
        print("yaml-cpp is not part of this build")
        sys.exit(0)
    yaml = stand_in(folder / "yaml", "yaml-cpp", "0.8.0", "yaml-cpp::yaml-cpp", include)
    status, said, commands = configure(folder / "c", f"-Dyaml-cpp_DIR={yaml}")
    if status != 0 or "STAND_IN_0_8_0" not in commands:
        script.fail(f"yaml-cpp 0.8, whose target is yaml-cpp::yaml-cpp, is not taken: {said[-600:]}")
    print("yaml-cpp::yaml-cpp is taken")
