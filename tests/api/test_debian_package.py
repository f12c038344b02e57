"""cpack makes a Debian package of this build: what it holds, what it depends on, and that a C program builds against it."""

import os
import pathlib
import shutil
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

script.skip_unless_plain_native_build()
for tool in ("cpack", "dpkg-deb", "dpkg-shlibdeps", "file", "pkg-config"):
    if shutil.which(tool) is None:
        script.skip(f"there is no {tool}")
if script.cache("CMAKE_BUILD_TYPE") != "Release" or script.is_on("PLANEFOLD_FLOAT"):
    script.skip("only release builds ship")
if not (script.BIN / "pf-capture").exists():
    script.skip("pf-capture is not built")

VERSION = script.cache("CMAKE_PROJECT_VERSION")
with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    # From a copy of the configuration that installs what is there and builds nothing.
    config = (script.BUILD / "CPackConfig.cmake").read_text()
    (folder / "CPackConfig.cmake").write_text(
        config + '\nset(CPACK_CMAKE_GENERATOR "")\nset(CPACK_INSTALL_CMAKE_PROJECTS "")\n'
        f'set(CPACK_INSTALLED_DIRECTORIES "{folder}/tree;usr")\n')
    for component in ("development", "programs"):
        script.run("cmake", "--install", script.BUILD, "--prefix", folder / "tree", "--component", component)
    script.run("cpack", "-G", "DEB", "--config", folder / "CPackConfig.cmake", "-B", folder / "out", cwd=folder)
    package = next((folder / "out").glob("planefold_*.deb"))
    fields = script.run("dpkg-deb", "-f", package, "Package", "Version", "Depends", "Architecture")
    print(package.name, package.stat().st_size, "bytes\n" + fields)
    for expected in (f"Version: {VERSION}", "libc6", "libpng16"):
        if expected not in fields:
            script.fail(f"the package's fields lack {expected}")
    root = folder / "root"
    script.run("dpkg-deb", "-x", package, root)
    for expected in ("usr/include/planefold/planefold.h", "usr/lib/libplanefold.a", "usr/lib/libplanefoldf.a",
                     "usr/lib/pkgconfig/planefold.pc", "usr/lib/cmake/planefold/planefoldConfig.cmake", "usr/bin/pf-capture", "usr/share/doc/planefold/copyright"):
        if not (root / expected).exists():
            script.fail(f"the package lacks {expected}")
    script.run(root / "usr/bin/pf-capture", "--help")
    environment = dict(os.environ, PKG_CONFIG_LIBDIR=str(root / "usr/lib/pkgconfig"))
    flags = script.run("pkg-config", "--cflags", "--libs", "planefold", env=environment).split()
    script.run(script.c_compiler(), "-std=c99", script.SOURCE / "tests/api/outside/main.c", *flags, "-o", folder / "outside")
    print(script.run(folder / "outside"), end="")
