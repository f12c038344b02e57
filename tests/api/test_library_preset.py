"""The libraries alone: the preset that the README installs compiles nothing else and fetches nothing; Eigen 5 is taken and 3.3 refused."""

import pathlib
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

script.skip_unless_plain_native_build()
EIGEN = """
add_library(Eigen3::Eigen INTERFACE IMPORTED)
set_target_properties(Eigen3::Eigen PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "{include}")
"""
# As Eigen's own: another major version is not compatible.
EIGEN_VERSION = """
set(PACKAGE_VERSION {version})
if(PACKAGE_FIND_VERSION AND NOT PACKAGE_FIND_VERSION_MAJOR STREQUAL {major})
  set(PACKAGE_VERSION_COMPATIBLE FALSE)
else()
  set(PACKAGE_VERSION_COMPATIBLE TRUE)
endif()
"""


def configure(build, *arguments):
    return ["cmake", "--preset", "library", "-S", script.SOURCE, "-B", build, f"-DCMAKE_C_COMPILER={script.c_compiler()}", *arguments]


def eigen(folder, version):
    """A package of this version, with the headers that are there."""
    folder.mkdir()
    found = re.search(r"^Eigen3_DIR:\S*=(.*)$", (script.BUILD / "CMakeCache.txt").read_text(), re.M).group(1)
    include = next(path for path in (pathlib.Path(found).parents[3] / "include" / "eigen3", pathlib.Path("/usr/include/eigen3")) if path.exists())
    (folder / "Eigen3Config.cmake").write_text(EIGEN.format(include=include))
    (folder / "Eigen3ConfigVersion.cmake").write_text(EIGEN_VERSION.format(version=version, major=version.split(".")[0]))
    return f"-DEigen3_DIR={folder}"


with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    # Configured, it has the libraries' sources and no others.
    script.run(*configure(folder / "static", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON"), cwd=script.SOURCE)
    compiled = re.findall(r'"file": "(.*)"', (folder / "static" / "compile_commands.json").read_text())
    foreign = [path for path in compiled if "/lib/src/" not in path and "cmake_pch" not in path]
    if not compiled or foreign:
        script.fail(f"the preset compiles {foreign or 'nothing'}")
    script.run(*configure(folder / "eigen5", eigen(folder / "five", "5.0.0")), cwd=script.SOURCE)
    old = subprocess.run([str(word) for word in configure(folder / "eigen33", eigen(folder / "old", "3.3.9"))], text=True, capture_output=True,
                         check=False, cwd=script.SOURCE)
    if old.returncode == 0 or "3.3.9" not in old.stderr or "too old" not in old.stderr:
        script.fail(f"Eigen 3.3.9: {old.stderr}")
