"""pf-capture with a camera of libcamera in an arm64 guest: vimc, a pipeline of sensor, debayer and scaler in the kernel, which
Debian's kernel leaves out and which is therefore built here. Frames come with rising times, and show the sensor's bars. The camera
leaves while it streams, and comes back."""

import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import guest  # noqa: E402
import kernel_modules  # noqa: E402
import png  # noqa: E402
from guest import CACHE, fail  # noqa: E402

SYSROOT = guest.FULL_SYSROOT
TRIPLE = "aarch64-linux-gnu"
WIDTH, HEIGHT, FRAMES = 318, 240, 60  # libcamera makes the width of this pipeline a multiple of six
# White, yellow, cyan, green, magenta, red, blue and black of three quarters of full brightness, as a weighted sum.
BARS = [round(191 * (77 * red + 150 * green + 29 * blue) / 256)
        for red, green, blue in ((1, 1, 1), (1, 1, 0), (0, 1, 1), (0, 1, 0), (1, 0, 1), (1, 0, 0), (0, 0, 1), (0, 0, 0))]
SMALL = "--headless --no-film --quiet --max-features 20 --features-in-view 12 --max-observations 16 --max-state-dim 90"
RUN = f"""set -e
mkdir -p /run /etc/udev/rules.d
/lib/systemd/systemd-udevd --daemon
. /share/modules.sh
udevadm trigger
udevadm settle --timeout=60
cp /share/pf-capture /tmp
capture() {{ # NAME SECONDS ARGUMENTS...: interrupted after some seconds where it has not ended by itself
  name=$1; seconds=$2; shift 2
  mkdir -p /share/$name.log
  timeout -s INT $seconds /tmp/pf-capture {SMALL} --calib /share/small.yaml --out /share/$name "$@" \\
    >/share/$name.log/stdout 2>/share/$name.log/stderr && code=0 || code=$?
  echo $code >/share/$name.log/code
  echo "$name: $(cut -d' ' -f1 /proc/uptime) s"
}}
LIBCAMERA_LOG_LEVELS=*:INFO /tmp/pf-capture --list >/share/list.txt 2>/share/list.stderr
capture first 90 --source libcamera:0 --frames {FRAMES} --record /share/first.recording
capture named 60 --source "libcamera:Sensor B" --format BGR888 --frames 10 --record /share/named.recording
capture ended 8 --source libcamera:0
capture absent 8 --source libcamera:9
capture format 8 --source libcamera:0 --format YUYV

# Unplugged after some frames, and plugged in again, twice.
plug=/sys/bus/platform/drivers/vimc
unplug() {{ # once so many pictures were recorded in a folder
  for i in $(seq 60); do [ $(ls $1/mav0/cam0/data 2>/dev/null | wc -l) -ge $2 ] && break; sleep 1; done
  echo vimc.0 >$plug/unbind
}}
(for pictures in 5 40; do unplug /tmp/unplugged $pictures; sleep 4; echo vimc.0 >$plug/bind; done) &
capture unplug 60 --source libcamera:0 --frames 90 --record /tmp/unplugged
# Unplugged for good: an interruption still ends the run.
(unplug /tmp/gone 3) &
capture gone 20 --source libcamera:0 --record /tmp/gone
"""


def calibration():
    return (f"camera_model: pinhole\nwidth: {WIDTH}\nheight: {HEIGHT}\nfx: 250\nfy: 250\ncx: {WIDTH / 2}\ncy: {HEIGHT / 2}\n"
            "distortion_model: none\ndistortion: []\nrate_hz: 30\n")


def udev_program(environment):
    """udevadm, which is also the daemon, by the name that it is called with."""
    folder = CACHE / "udev"
    program = folder / "bin" / "udevadm"
    if not program.is_file():
        kernel_modules.fetch(environment, folder, "udev")
    if not program.is_file():
        fail("Debian's package udev does not hold bin/udevadm")
    return program


def files_for_guest(programs):
    udev = udev_program(guest.isolated_apt(CACHE / "apt"))
    modules = SYSROOT / "usr" / "lib" / TRIPLE / "libcamera"
    inside = {"lib/systemd/systemd-udevd": udev, "bin/udevadm": udev,
              "usr/share/libcamera/ipa/vimc/vimc.conf": SYSROOT / "usr/share/libcamera/ipa/vimc/vimc.conf"}
    for name in ("ipa_vimc.so", "ipa_vimc.so.sign", "vimc_ipa_proxy"):
        inside[f"usr/lib/{TRIPLE}/libcamera/{name}"] = modules / name
    for program in (programs / "pf-capture", udev, modules / "ipa_vimc.so", modules / "vimc_ipa_proxy"):
        inside.update({f"lib/{name}": path for name, path in guest.libraries(program, SYSROOT).items()})
    return inside


def bars(data):
    """Grey levels in the middle of the sensor's eight bars, from left to right, below the text that lies on them."""
    row = data[(HEIGHT - 12) * WIDTH:(HEIGHT - 11) * WIDTH]
    return [row[(2 * i + 1) * WIDTH // 16] for i in range(8)]


def check(share):
    problems = []

    def require(condition, text):
        if not condition:
            problems.append(text)

    def report(name):
        path = share / name / "report.json"
        if not path.is_file():
            problems.append(f"{name}: no report.json; {(share / f'{name}.log' / 'stderr').read_text()}")
            return {"captured": 0, "camera": {}, "interval_ms": {}}
        live = json.loads(path.read_text())["live"]
        print(f"{name}: code {(share / f'{name}.log' / 'code').read_text().strip()}, live {json.dumps(live)}")
        return live

    names = (share / "list.txt").read_text()
    print(names, end="")
    require("libcamera:0" in names and "Sensor B" in names and "RGB888" in names, f"--list does not name the camera: {names} "
            f"{(share / 'list.stderr').read_text()}")
    for name, format_name, count in (("first", "RGB888", FRAMES), ("named", "BGR888", 10)):
        live = report(name)
        camera, interval = live["camera"], live["interval_ms"]
        require(live["captured"] >= count, f"{name}: only {live['captured']} frames")
        require(camera.get("format") == format_name and camera.get("damaged") == 0, f"{name}: {camera}")
        require(camera.get("timestamps") == "sensor" and interval.get("min", 0) > 0, f"{name}: times: {camera}, {interval}")
        recording = share / f"{name}.recording"
        frames = png.recording(recording) if recording.is_dir() else []
        require(len(frames) >= count, f"{name}: only {len(frames)} frames were recorded")
        times = [stamp for stamp, _ in frames]
        require(all(a < b for a, b in zip(times, times[1:])), f"{name}: recorded times do not rise")
        levels = [bars(data) for _, data in frames]
        if levels:
            print(f"{name}: bars {levels[0]}")
        require(all(abs(a - b) <= 2 for one in levels for a, b in zip(one, BARS)), f"{name}: bars {levels[:1]}, not {BARS}")
    require(report("ended")["captured"] > 0, "ended: no frame before the interruption")
    live = report("unplug")
    text = (share / "unplug.log" / "stderr").read_text()
    print(text, end="")
    require((share / "unplug.log" / "code").read_text().strip() == "0", "unplugged, and the run does not end well")
    require(live["camera"].get("departures") == 2 and text.count("is gone") == 2 and text.count("is back after") == 2 and
            live["captured"] >= 90, f"unplugged twice, and the user reads: {text}; {live}")
    live = report("gone")
    text = (share / "gone.log" / "stderr").read_text()
    require(live["camera"].get("departures") == 1 and "is gone" in text and (share / "gone.log" / "code").read_text().strip() in ("0", "1"),
            f"gone for good, and the user reads: {text}; {live}")
    for name, words in (("absent", "no such camera"), ("format", "YUYV")):
        text = (share / f"{name}.log" / "stderr").read_text().strip()
        print(f"{name}: {text}")
        require((share / f"{name}.log" / "code").read_text().strip() == "1" and words in text and "\n" not in text, f"{name}: {text}")
    return problems


def main():
    guest.require_tools()
    CACHE.mkdir(parents=True, exist_ok=True)
    root = guest.fetch_packages()
    kernel_modules.with_module(root, kernel_modules.build(root, "drivers/media/test-drivers/vimc", "vimc", CONFIG_VIDEO_VIMC="m"))
    programs = guest.cross_build_full("pf-capture")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        share = pathlib.Path(name) / "share"
        share.mkdir()
        (share / "small.yaml").write_text(calibration())
        program = share / "pf-capture"
        program.write_bytes((programs / "pf-capture").read_bytes())
        program.chmod(0o755)
        print(guest.boot(root, share, RUN, load=("vimc",), files=files_for_guest(programs), seconds=420))
        problems = check(share)
        if problems:
            fail("\n  ".join([f"{len(problems)} found:", *problems]))


main()
