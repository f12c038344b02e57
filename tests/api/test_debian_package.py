"""cpack makes a Debian package of this build: what it holds, what it depends on, and that a C program builds against it."""

import gzip
import json
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
ENVIRONMENT = script.SOURCE / "build" / "venv"


def check_manual(root):
    """Every program has a page, with its options."""
    if shutil.which("help2man") is None:
        print("there is no help2man: the package has no man pages")
        return
    for program in sorted((root / "usr/bin").iterdir()):
        page = root / "usr/share/man/man1" / f"{program.name}.1.gz"
        if not page.exists():
            script.fail(f"the package lacks a man page of {program.name}; is the target man built?")
        text = gzip.decompress(page.read_bytes()).decode()
        if ".SH NAME" not in text or "\\-\\-version" not in text:
            script.fail(f"{page.name} does not describe {program.name}:\n{text[:400]}")


def check_pf_eval(program, folder):
    """Says its version and its options by itself, and compares trajectories with nothing of the sources but the environment."""
    bare = dict(os.environ, HOME=str(folder), XDG_CACHE_HOME=str(folder / "cache"))
    if script.run(program, "--version", env=bare).strip() != f"pf-eval {VERSION}" or "--there-and-back" not in script.run(program, "--help", env=bare):
        script.fail("pf-eval of the package does not say its version and options")
    if (folder / "cache").exists():
        script.fail("pf-eval --help makes an environment")
    if not list(ENVIRONMENT.glob("installed-*")):
        print("there is no build/venv: pf-eval of the package compares nothing here")
        return
    (folder / "cache/planefold").mkdir(parents=True)
    (folder / "cache/planefold/venv").symlink_to(ENVIRONMENT)
    rows = "".join(f"{0.1 * i:.1f} {0.1 * i:.3f} {0.01 * i * i:.4f} {0.002 * i ** 3:.5f} 0 0 0 1\n" for i in range(20))
    (folder / "run.tum").write_text(rows)
    said = json.loads(script.run(program, folder / "run.tum", "--truth", folder / "run.tum", "--align", "none", "--json", env=bare, cwd=folder))
    if said["pairs"] != 20 or said["ate_rmse_m"] > 1e-9:
        script.fail(f"pf-eval of the package compares a trajectory with itself: {said}")


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
                     "usr/lib/pkgconfig/planefold.pc", "usr/lib/cmake/planefold/planefoldConfig.cmake", "usr/bin/pf-capture", "usr/bin/pf-eval", "usr/share/doc/planefold/copyright"):
        if not (root / expected).exists():
            script.fail(f"the package lacks {expected}")
    if list(root.rglob("__pycache__")):
        script.fail("the package holds folders of Python's caches")
    script.run(root / "usr/bin/pf-capture", "--help")
    check_manual(root)
    check_pf_eval(root / "usr/bin/pf-eval", folder)
    environment = dict(os.environ, PKG_CONFIG_LIBDIR=str(root / "usr/lib/pkgconfig"))
    flags = script.run("pkg-config", "--cflags", "--libs", "planefold", env=environment).split()
    script.run(script.c_compiler(), "-std=c99", script.SOURCE / "tests/api/outside/main.c", *flags, "-o", folder / "outside")
    print(script.run(folder / "outside"), end="")
