"""A small arm64 Linux in QEMU without hardware help: Debian's kernel, a busybox, and a folder that both sides see.

Everything comes from Debian's packages, resolved when it is needed and kept in the build folder. Nothing is installed.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import cross  # noqa: E402
from script import BIN, BUILD, SOURCE, fail, run, skip  # noqa: E402, F401

CACHE = BUILD / "guest"
SYSROOT = SOURCE / "build" / "sysroot" / "aarch64"
FULL_SYSROOT = SYSROOT.with_name("aarch64-full")
# libcamera with the libraries of udev, which it asks for the devices; SDL2 with Mesa, which draws on the processor.
FULL_PACKAGES = ("libcamera-dev", "libcamera-ipa", "libkmod2", "libcap2", "libselinux1", "libblkid1", "libacl1", "libsdl2-dev",
                 "libegl1", "libegl-mesa0", "libgles2", "libgbm1", "libgl1-mesa-dri")
BOOT_SECONDS = 60  # until the guest's script begins, on a busy machine


def require_tools():
    for tool, package in (("qemu-system-aarch64", "qemu-system-arm"), ("aarch64-linux-gnu-g++", "g++-aarch64-linux-gnu"),
                          ("apt-get", "apt"), ("dpkg-deb", "dpkg"), ("readelf", "binutils"), ("cmake", "cmake")):
        if shutil.which(tool) is None:
            skip(f"there is no {tool} (Debian: {package})")


def isolated_apt(root):
    """An apt state of its own for arm64, from the machine's own Debian mirrors; gives the environment that selects it."""
    for folder in ("state/lists/partial", "cache/archives/partial", "sources"):
        (root / folder).mkdir(parents=True, exist_ok=True)
    (root / "status").touch()
    for path in [pathlib.Path("/etc/apt/sources.list"), *pathlib.Path("/etc/apt/sources.list.d").glob("*")]:
        if path.is_file():
            text = re.sub(r"(?m)^deb-src.*$|arch=[^\] ]*|^Architectures:.*\n", "", path.read_text())
            (root / "sources" / (path.stem + ".list" if path.suffix == ".list" else path.name)).write_text(text)
    (root / "apt.conf").write_text(f"""Dir::State "{root}/state";
Dir::State::status "{root}/status";
Dir::Cache "{root}/cache";
Dir::Etc::sourcelist "/dev/null";
Dir::Etc::sourceparts "{root}/sources";
APT::Architecture "arm64";
APT::Architectures {{ "arm64"; }};
APT::Sandbox::User "";
Acquire::Languages "none";
""")
    return dict(os.environ, APT_CONFIG=str(root / "apt.conf"))


def fetch_packages():
    """Kernel and busybox, unpacked; where they cannot be had the test is skipped."""
    unpacked = CACHE / "root"
    wanted = ["./boot/vmlinuz-*", "./bin/busybox", "./usr/bin/busybox"]
    wanted += [f"./lib/modules/*/kernel/{part}/*"
               for part in ("drivers/media", "drivers/virtio", "drivers/iio", "drivers/hid", "drivers/mfd", "drivers/gpu/drm/virtio",
                            "drivers/video/fbdev/core", "fs", "net/9p")]
    wanted.append("./lib/modules/*/kernel/drivers/gpu/drm/drm*.ko")
    complete = unpacked / "complete"
    if complete.is_file() and complete.read_text() == "\n".join(wanted):
        return unpacked
    work = CACHE / "apt"
    environment = isolated_apt(work)

    def apt(*words):
        result = subprocess.run(words, env=environment, cwd=work, text=True, capture_output=True, check=False)
        if result.returncode != 0:
            skip(f"Debian's packages for arm64 cannot be had here: {' '.join(words)}: {result.stderr.strip()[-300:]}")
        return result.stdout

    apt("apt-get", "-q", "update")
    kernel = re.search(r"Depends: (linux-image-\S+)", apt("apt-cache", "depends", "linux-image-arm64"))
    if kernel is None:
        skip("Debian's archive names no kernel for arm64")
    apt("apt-get", "-q", "download", kernel.group(1), "busybox-static")
    shutil.rmtree(unpacked, ignore_errors=True)
    unpacked.mkdir(parents=True)
    for package in work.glob("*.deb"):
        with subprocess.Popen(["dpkg-deb", "--fsys-tarfile", package], stdout=subprocess.PIPE) as archive:
            subprocess.run(["tar", "-x", "-C", unpacked, "--wildcards", *wanted], stdin=archive.stdout,
                           stderr=subprocess.DEVNULL, check=False)
        package.unlink()
    if not list(unpacked.glob("boot/vmlinuz-*")) or not list(unpacked.glob("**/busybox")):
        fail("the packages of kernel and busybox do not hold what they used to")
    complete.write_text("\n".join(wanted))
    return unpacked


def modules(root, *names):
    """Files of kernel modules and of what they need, in the order of loading. What is built in has no file."""
    files = {path.name[:-3].replace("-", "_"): path for path in root.glob("lib/modules/*/kernel/**/*.ko")}
    order = []

    def visit(name):
        path = files.get(name.replace("-", "_"))
        if path is None or path in order:
            return
        found = re.search(rb"depends=([^\0]*)\0", path.read_bytes())
        for other in (found.group(1).decode() if found else "").split(","):
            if other:
                visit(other)
        order.append(path)

    for name in names:
        visit(name)
    return order


def libraries(program, sysroot):
    """Shared libraries that a program for the guest needs, with its loader."""
    folders = [sysroot / "lib/aarch64-linux-gnu", sysroot / "usr/lib/aarch64-linux-gnu", sysroot / "lib"]
    folders.append(folders[1] / "pulseaudio")
    found, queue = {}, [program]
    while queue:
        text = subprocess.run(["readelf", "-dl", queue.pop()], text=True, capture_output=True, check=True).stdout
        for name in re.findall(r"\(NEEDED\).*\[(.*)\]", text) + re.findall(r"interpreter: \S*/(\S+)\]", text):
            if name not in found:
                path = next((folder / name for folder in folders if (folder / name).exists()), None)
                if path is None:
                    fail(f"{name}, which {program.name} needs, is not in {sysroot}")
                found[name] = path.resolve()
                queue.append(found[name])
    return found


def cross_build(*targets):
    """The project's programs for arm64, without what the guest lacks. Gives the folder of the programs."""
    return cross.build("aarch64", *targets, programs=True) / "bin"


def cross_build_full(*targets):
    """The same with all that a guest may have: libcamera, drawing and a window. Gives the folder of the programs."""
    build = CACHE / FULL_SYSROOT.name
    result = subprocess.run(["bash", SOURCE / "toolchains/make_sysroot.sh", "arm64", FULL_SYSROOT, *FULL_PACKAGES], text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if result.returncode != 0:
        skip(f"libraries for arm64 cannot be had here: {result.stdout.strip()[-300:]}")
    run("cmake", "-S", SOURCE, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DPLANEFOLD_BUILD_TESTS=OFF",
        f"-DCMAKE_TOOLCHAIN_FILE={SOURCE}/toolchains/aarch64.cmake", f"-DPLANEFOLD_SYSROOT={FULL_SYSROOT}")
    run("cmake", "--build", build, "--parallel", str(os.cpu_count()), "--target", *targets)
    for have in ("PLANEFOLD_HAVE_LIBCAMERA", "PLANEFOLD_HAVE_SDL2"):
        if have not in (build / "build.ninja").read_text():
            fail(f"the cross build against {FULL_SYSROOT} has no {have}")
    return build / "bin"


def compile_helper(source, target):
    """A C program of this folder for the guest, without shared libraries."""
    run("aarch64-linux-gnu-gcc", "-std=gnu99", "-O2", "-Wall", "-Wextra", "-Werror", "-static", "-o", target, source)


class Archive:
    """A cpio archive of the kind that the kernel unpacks at boot."""

    def __init__(self):
        self.parts, self.folders, self.number = [], set(), 0

    def _put(self, name, mode, data):
        self.number += 1
        fields = [self.number, mode, 0, 0, 1, 0, len(data), 0, 0, 0, 0, len(name) + 1, 0]
        head = b"070701" + b"".join(b"%08X" % field for field in fields) + name.encode() + b"\0"
        self.parts += [head, b"\0" * (-len(head) % 4), data, b"\0" * (-len(data) % 4)]

    def add(self, name, data, mode=0o100755):
        folder = ""
        for part in name.split("/")[:-1]:
            folder = f"{folder}/{part}".lstrip("/")
            if folder not in self.folders:
                self.folders.add(folder)
                self._put(folder, 0o040755, b"")
        self._put(name, mode, data)

    def write(self, path):
        self._put("TRAILER!!!", 0, b"")
        path.write_bytes(b"".join(self.parts))


INIT = """#!/bin/busybox sh
/bin/busybox mkdir -p /proc /sys /dev /tmp /share
/bin/busybox --install -s /bin
mount -t proc proc /proc
mount -t sysfs sys /sys
mount -t devtmpfs dev /dev
mount -t tmpfs tmp /tmp
for module in $(cat /modules.list); do insmod /modules/$module; done
mount -t 9p -o trans=virtio,version=9p2000.L,msize=262144 share /share || echo "no share"
cd /share
echo "guest: begins after $(cut -d' ' -f1 /proc/uptime) s"
sh -u /share/run.sh >/share/run.log 2>&1
echo $? >/share/run.status
sync
umount /share
poweroff -f
"""


def boot(root, share, script, load=(), files=None, seconds=150, devices=(), memory=1024):
    """Runs a shell script in the guest, which sees the folder share as /share. Gives what it wrote; ends the test where it fails.

    load   kernel modules to bring along; those before a "/" entry are loaded at boot, all lie in /modules in order
    files  more files for the guest: {path without leading slash: path here}
    devices  more arguments for QEMU
    memory   of the guest [MB]
    """
    archive = Archive()
    busybox = next(root.glob("**/busybox"))
    archive.add("bin/busybox", busybox.read_bytes())
    archive.add("init", INIT.encode())
    transport = modules(root, "virtio_pci", "9pnet_virtio", "9p")
    later = [path for path in modules(root, *load) if path not in transport]
    for path in transport + later:
        archive.add(f"modules/{path.name}", path.read_bytes())
    archive.add("modules.list", "\n".join(path.name for path in transport).encode())
    for name, path in (files or {}).items():
        archive.add(name, pathlib.Path(path).read_bytes())
    initramfs = CACHE / f"initramfs.{os.getpid()}"
    archive.write(initramfs)
    insert = "\n".join(f"insmod /modules/{path.name} $(eval echo \"\\${{{path.stem.replace('-', '_')}:-}}\")" for path in later)
    (share / "modules.sh").write_text(insert + "\n")
    (share / "run.sh").write_text(script)
    for name in ("run.status", "run.log"):
        (share / name).unlink(missing_ok=True)
    kernel = next(root.glob("boot/vmlinuz-*"))
    words = ["qemu-system-aarch64", "-M", "virt", "-cpu", "cortex-a72", "-smp", "2", "-m", memory, "-nographic", "-no-reboot",
             "-accel", "tcg,thread=multi", "-net", "none", "-kernel", kernel, "-initrd", initramfs,
             "-append", "console=ttyAMA0 quiet panic=-1",
             "-virtfs", f"local,path={share},mount_tag=share,security_model=none,multidevs=remap", *devices]
    begin = time.monotonic()
    try:
        result = subprocess.run([str(word) for word in words], text=True, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, timeout=BOOT_SECONDS + seconds, check=False, errors="replace")
        console = result.stdout
    except subprocess.TimeoutExpired as expired:
        console = (expired.stdout or b"").decode(errors="replace") + f"\nguest: stopped after {BOOT_SECONDS + seconds} s"
    finally:
        initramfs.unlink(missing_ok=True)
    log = (share / "run.log").read_text(errors="replace") if (share / "run.log").is_file() else ""
    status = (share / "run.status").read_text().strip() if (share / "run.status").is_file() else "none"
    print(f"guest: {time.monotonic() - begin:.1f} s, status {status}", flush=True)
    if status != "0":
        print(console[-4000:])
        print(log[-8000:])
        fail(f"the guest's script ended with {status}")
    return log
