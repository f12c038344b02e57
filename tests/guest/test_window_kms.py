"""The window of pf-capture in an arm64 guest that has a screen and no desktop (virtio-gpu, SDL's KMS/DRM driver, Mesa on the
processor): what the emulated screen shows says the same as the files of the run.

What is asked of the screen says tests/support/window_picture.py. Run by hand with a path, the last picture is written there."""

import json
import pathlib
import socket
import sys
import tempfile
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import guest  # noqa: E402
import kernel_modules  # noqa: E402
import window_picture  # noqa: E402
from guest import CACHE  # noqa: E402

TRIPLE = "aarch64-linux-gnu"
SYSROOT = guest.FULL_SYSROOT
# What SDL and Mesa open at run time: nobody's NEEDED names it.
OPENED = ("libgbm.so.1", "libdrm.so.2", "libEGL.so.1", "libGLESv2.so.2", "libEGL_mesa.so.0", "libudev.so.1")
WIDTH, HEIGHT = 948, window_picture.HEIGHT + window_picture.STRIP
FRAMES, DELAY_MS, LEAST = 12, 1500, 4
FONTS = """<?xml version="1.0"?><!DOCTYPE fontconfig SYSTEM "fonts.dtd">
<fontconfig><dir>/usr/share/fonts</dir><cachedir>/tmp/fonts</cachedir></fontconfig>
"""
RUN = f"""set -e
. /share/modules.sh
ls -l /dev/dri
cp /share/pf-capture /tmp
export SDL_VIDEODRIVER=kmsdrm XDG_RUNTIME_DIR=/tmp
/tmp/pf-capture --source sim:desk --start target --frames {FRAMES} --delay {DELAY_MS} --tracks --no-film --quiet --out /share/out
"""


class Watch(threading.Thread):
    """Pictures of the emulated screen, taken through QEMU's monitor: all that was seen twice alike."""

    def __init__(self, folder):
        super().__init__(daemon=True)
        self.folder, self.shots, self.stop = folder, [], threading.Event()

    def arguments(self):
        return ["-qmp", f"unix:{self.folder}/monitor,server=on,wait=off"]

    def say(self, stream, command, **arguments):
        stream.write(json.dumps({"execute": command, "arguments": arguments}) + "\n")
        stream.flush()
        while True:
            line = stream.readline()
            if not line:
                raise OSError("the monitor is gone")
            answer = json.loads(line)
            if "return" in answer or "error" in answer:
                return answer

    def picture(self, stream):
        path = self.folder / "screen.ppm"
        path.unlink(missing_ok=True)
        answer = self.say(stream, "screendump", filename=str(path))
        return path.read_bytes() if "return" in answer and path.is_file() else b""

    def run(self):
        last = b""
        monitor = socket.socket(socket.AF_UNIX)
        while not self.stop.wait(0.1):
            try:
                monitor.connect(f"{self.folder}/monitor")
                break
            except OSError:
                continue
        try:
            stream = monitor.makefile("rw", encoding="utf-8")
            stream.readline()
            self.say(stream, "qmp_capabilities")
            while not self.stop.wait(0.1):
                one = self.picture(stream)
                time.sleep(0.05)
                if one and one != last and self.picture(stream) == one:
                    last = one
                    self.shots.append(one)
        except OSError:
            return  # the guest is off


def files_for_guest(program):
    folder = SYSROOT / "usr" / "lib" / TRIPLE
    driver = folder / "dri" / "kms_swrast_dri.so"
    inside = {"usr/share/glvnd/egl_vendor.d/50_mesa.json": SYSROOT / "usr/share/glvnd/egl_vendor.d/50_mesa.json",
              f"usr/lib/{TRIPLE}/dri/kms_swrast_dri.so": driver, f"usr/lib/{TRIPLE}/dri/virtio_gpu_dri.so": driver}
    fonts = CACHE / "fonts"
    if not fonts.is_dir():
        kernel_modules.fetch(guest.isolated_apt(CACHE / "apt"), fonts, "fonts-dejavu-core")
    (CACHE / "fonts.conf").write_text(FONTS)
    inside["etc/fonts/fonts.conf"] = CACHE / "fonts.conf"
    inside.update({f"usr/share/fonts/{path.name}": path for path in fonts.rglob("DejaVuSans*.ttf")})
    inside.update({f"lib/{name}": folder / name for name in OPENED if (folder / name).exists()})
    for binary in (program, driver, *(folder / name for name in OPENED if (folder / name).exists())):
        inside.update({f"lib/{name}": path for name, path in guest.libraries(binary, SYSROOT).items()})
    return inside


def main():
    guest.require_tools()
    CACHE.mkdir(parents=True, exist_ok=True)
    root = guest.fetch_packages()
    programs = guest.cross_build_full("pf-capture")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        work = pathlib.Path(name)
        share = work / "share"
        share.mkdir()
        program = share / "pf-capture"
        program.write_bytes((programs / "pf-capture").read_bytes())
        program.chmod(0o755)
        watch = Watch(work)
        watch.start()
        screen = ["-device", f"virtio-gpu-pci,xres={WIDTH},yres={HEIGHT}", *watch.arguments()]
        try:
            print(guest.boot(root, share, RUN, load=("virtio_gpu",), files=files_for_guest(program), seconds=300, devices=screen,
                             memory=2048))
        finally:
            watch.stop.set()
            watch.join()
        print(f"{len(watch.shots)} pictures of the screen")
        last = window_picture.check(map(window_picture.Screen.from_ppm, watch.shots), share / "out", FRAMES, LEAST)
        if len(sys.argv) > 1:
            last.write_png(pathlib.Path(sys.argv[1]))


main()
