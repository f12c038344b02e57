"""The window of pf-capture, on a screen that is not there (Xvfb): screenshots of a running scene say the same as its files.

Each screenshot is taken while the next frame is tracked; what is asked of it says tests/support/window_picture.py. Run by hand
with a path, the last screenshot is written there as PNG (see lib/docs/guide/capture.md)."""

import ctypes
import json
import os
import pathlib
import select
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import window_picture  # noqa: E402
from script import BIN, fail, skip  # noqa: E402

FRAMES, DELAY_MS = 70, 200


def start_server(folder):
    """Xvfb and the number of its display."""
    read, write = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x800x24", "-fbdir", folder, "-nolisten", "tcp",
                               "-br", "-noreset"], pass_fds=[write], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    os.close(write)
    number = ""
    while select.select([read], [], [], 30)[0]:
        part = os.read(read, 16).decode()  # a number, and the end of the line; it takes both to be written
        number += part.strip()
        if not part or part.endswith("\n"):
            break
    os.close(read)
    if not number:
        server.kill()
        fail(f"Xvfb does not begin: {server.stderr.read().decode()[-500:]}")
    return server, number


def watch(program, pixels):
    """Screenshots of all that the window showed for long enough to be seen twice alike."""
    shots, last = [], b""
    while program.poll() is None:
        time.sleep(0.04)
        one = pixels.read_bytes()
        time.sleep(0.02)
        if one != last and pixels.read_bytes() == one:
            last = one
            shots.append(one)
    return shots


def click(number, x, y):
    """A click on the screen, by the X server's test extension. false: its library is not there."""
    try:
        x11, xtest = ctypes.CDLL("libX11.so.6"), ctypes.CDLL("libXtst.so.6")
    except OSError:
        return False
    x11.XOpenDisplay.restype = ctypes.c_void_p
    display = ctypes.c_void_p(x11.XOpenDisplay(f":{number}".encode()))
    xtest.XTestFakeMotionEvent(display, -1, int(x), int(y), 0)
    for pressed in (1, 0):
        xtest.XTestFakeButtonEvent(display, 1, pressed, 0)
    x11.XSync(display, 0)
    x11.XCloseDisplay(display)
    return True


def check_click(program, number, folder, environment):
    """A click on the desk says which plane it is."""
    command = [program, "--source", "sim:desk", "--start", "target", "--frames", 170, "--delay", 60, "--no-film", "--quiet", "--out", folder / "click"]
    with subprocess.Popen([str(word) for word in command], env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        table, clicked = folder / "click" / "frames.csv", 0
        while running.poll() is None:
            time.sleep(0.1)
            if table.exists() and table.read_text().count("\n") > 125 + 8 * clicked and clicked < 3:
                screen = window_picture.Screen.from_xwd((folder / "Xvfb_screen0").read_bytes())
                if screen.find_window():
                    if not click(number, screen.left + window_picture.ZOOM * 150, screen.top + window_picture.ZOOM * 215):
                        print("no click: there is no libXtst")
                        running.terminate()
                        return
                    clicked += 1
        said = running.stderr.read()
    hits = json.loads((folder / "click" / "report.json").read_text())["hits"]
    print(said)
    if not hits or abs(hits[0]["pixel"][0] - 149.5) > 1 or abs(hits[0]["pixel"][1] - 214.5) > 1:
        fail(f"{clicked} clicks on the desk: {hits}")


def main():
    program = BIN / "pf-capture"
    if not program.is_file():
        skip("pf-capture was not built")
    if shutil.which("Xvfb") is None:
        skip("there is no Xvfb (Debian: xvfb)")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        folder = pathlib.Path(name)
        server, number = start_server(folder)
        try:
            environment = dict(os.environ, DISPLAY=f":{number}", SDL_VIDEODRIVER="x11")
            command = [program, "--source", "sim:desk", "--start", "target", "--frames", FRAMES, "--delay", DELAY_MS, "--tracks",
                       "--no-film", "--quiet", "--out", folder / "out"]
            with subprocess.Popen([str(word) for word in command], env=environment, text=True, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE) as running:
                shots = watch(running, folder / "Xvfb_screen0")
                said = running.stdout.read() + running.stderr.read()
            if "built without SDL2" not in said and "draws nothing" not in said:
                check_click(program, number, folder, environment)
        finally:
            server.terminate()
            server.wait()
        print(said, end="")
        if "built without SDL2" in said or "draws nothing" in said:
            skip("pf-capture was built without a window (Debian: libsdl2-dev libcairo2-dev)")
        if running.returncode != 0:
            fail(f"pf-capture ended with {running.returncode}")
        last = window_picture.check(map(window_picture.Screen.from_xwd, shots), folder / "out", FRAMES, FRAMES // 4)
        if len(sys.argv) > 1:
            last.write_png(pathlib.Path(sys.argv[1]))


main()
