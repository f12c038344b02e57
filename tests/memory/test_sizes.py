"""Code, static data, stack and the block of three profiles on this machine are what tests/golden/sizes.txt says."""

import pathlib
import platform
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402
import sizes  # noqa: E402

script.skip_unless_plain_native_build()
if script.cache("CMAKE_BUILD_TYPE") != "Release":
    script.skip("golden sizes are those of the release build")
if platform.machine() != "x86_64":
    script.skip("the golden sizes of native builds are those of x86_64")

found = {}
with tempfile.TemporaryDirectory() as folder:
    for library in ("planefold", "planefoldf"):
        archive = script.BUILD / "lib" / f"lib{library}.a"
        numbers = sizes.of_archive("size", archive) | sizes.of_profiles(script.c_compiler(), archive, pathlib.Path(folder))
        found.update({(library, what): value for what, value in numbers.items()})
sizes.check("x86_64", found)
