"""Modules of the kernel's own source that Debian's kernel leaves out, built for the guest's kernel with Debian's headers."""

import pathlib
import re
import shutil
import subprocess

import guest
from guest import CACHE, fail, run, skip


def fetch(environment, folder, *packages):
    """Unpacks packages of Debian into a folder."""
    work = CACHE / "apt" / "modules"
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    for package in packages:
        # The tools that headers are used with run here, everything else belongs to the guest.
        here = package.startswith("linux-kbuild")
        words = ["apt-get", "-q", *(("-o", "APT::Sandbox::User=") if here else ()), "download", package]
        result = subprocess.run(words, env=None if here else environment, cwd=work, text=True, capture_output=True, check=False)
        if result.returncode != 0:
            skip(f"{package} cannot be had here: {result.stderr.strip()[-300:]}")
    for package in work.glob("*.deb"):
        run("dpkg-deb", "-x", package, folder)
    shutil.rmtree(work)


def unpack_source(folder, part):
    """One folder of the kernel's source out of Debian's package of all of it; the package goes."""
    archive = next(folder.glob("usr/src/linux-source-*.tar.xz"), None)
    if archive is None:
        fail("linux-source does not hold what it used to")
    run("tar", "-x", "-J", "--strip-components=1", "-C", folder, "-f", archive, f"{archive.name[:-len('.tar.xz')]}/{part}")
    archive.unlink()


def build(root, part, name, **settings):
    """Path of NAME.ko, built from the folder part of the kernel's source; kept in the build folder. Skips what cannot be had.

    root      what guest.fetch_packages gave: its kernel is the one that the module is for
    settings  what Kconfig would say: CONFIG_VIDEO_VIMC="m"
    """
    abi = next(root.glob("boot/vmlinuz-*")).name[len("vmlinuz-"):]
    version = re.match(r"\d+\.\d+", abi)
    module = CACHE / "modules" / abi / f"{name}.ko"
    if module.is_file():
        return module
    if version is None or shutil.which("make") is None or shutil.which("xz") is None:
        skip("no make or xz, or a kernel without a version")
    folder = CACHE / "kernel_source"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    environment = guest.isolated_apt(CACHE / "apt")
    subprocess.run(["apt-get", "-q", "update"], env=environment, capture_output=True, check=False)
    common = abi.rsplit("-", 1)[0] + "-common"
    fetch(environment, folder, f"linux-headers-{abi}", f"linux-headers-{common}", f"linux-kbuild-{version.group(0)}",
          f"linux-source-{version.group(0)}")
    unpack_source(folder, part)
    headers = folder / "usr" / "src" / f"linux-headers-{abi}"
    makefile = headers / "Makefile"
    makefile.write_text(makefile.read_text().replace("/usr/src/", f"{folder}/usr/src/"))
    run("make", "-C", headers, f"M={folder / part}", "CC=aarch64-linux-gnu-gcc", "CROSS_COMPILE=aarch64-linux-gnu-", "-j2",
        *(f"{key}={value}" for key, value in settings.items()), "modules")
    built = folder / part / f"{name}.ko"
    run("aarch64-linux-gnu-strip", "--strip-debug", built)
    module.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(built, module)
    shutil.rmtree(folder)
    return module


def with_module(root, module):
    """Lays a module beside those of Debian, where guest.boot finds it with what it needs."""
    kernel = next(root.glob("lib/modules/*"))
    target = kernel / "kernel" / "extra" / pathlib.Path(module).name
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(module, target)
