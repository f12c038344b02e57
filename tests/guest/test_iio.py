"""pf-capture with an inertial unit of the kernel (a HID sensor hub, made by imu_device.c) and a camera (vivid) in an arm64 guest:
samples arrive in order and unharmed, reach the library before their frames, are recorded and replayed; leaving and returning;
a user without the right to it."""

import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import guest  # noqa: E402
from guest import CACHE, fail, skip  # noqa: E402

RATE_HZ = 50
G, DEGREE = 9.80665, 0.017453293
# A small map, and --delay: an emulated processor is thirty times slower than a real one.
SMALL = ("--headless --no-film --quiet --max-features 20 --features-in-view 12 --max-observations 16 --max-state-dim 90 "
         "--source v4l2:/dev/video0 --calib /share/small.yaml --delay 200")
RUN = f"""set -e
vivid="n_devs=1 node_types=0x1 num_inputs=1 input_types=0x0"
. /share/modules.sh
cp /share/pf-capture /share/imu_device /tmp
chmod 1777 /tmp
mkdir -p /etc
echo nobody:x:65534:65534::/:/bin/sh >/etc/passwd
unit() {{
  /tmp/imu_device {RATE_HZ} >/tmp/unit.txt 2>&1 &
  unit=$!
  for i in 1 2 3 4 5 6 7 8 9 10; do ls /dev/iio:device1 >/dev/null 2>&1 && break; sleep 1; done
}}
capture() {{ # NAME SECONDS ARGUMENTS...: interrupted after some seconds, as a user ends a run
  name=$1; seconds=$2; shift 2
  mkdir -p /share/$name.log
  timeout -s INT $seconds /tmp/pf-capture --out /share/$name "$@" >/share/$name.log/stdout 2>/share/$name.log/stderr && code=0 || code=$?
  echo $code >/share/$name.log/code
  echo "$name: $(cut -d' ' -f1 /proc/uptime) s"
}}
streaming() {{ # waits until the camera streams (its driver then has a thread of that name) and both sensors are read
  for i in $(seq 150); do
    sleep 0.1
    grep -qs '^vivid-000-vid' /proc/[0-9]*/comm && [ $(cat /sys/bus/iio/devices/iio:device*/buffer0/enable | grep -c 1) -ge 2 ] && return
  done
  echo "the camera or the unit did not begin to stream"
}}
/tmp/pf-capture --list >/share/none.txt
unit
/tmp/pf-capture --list >/share/list.txt
su nobody -c "/tmp/pf-capture --list" >/share/refused.txt 2>&1
su nobody -c "/tmp/pf-capture --source sim:desk --frames 5 --headless --no-film --quiet --out /tmp/nobody --imu iio:" 2>/share/nobody.txt \\
  && fail=0 || fail=$?
echo $fail >/share/nobody.code
capture stream 8 {SMALL} --imu iio: --record /tmp/recording
cp -r /tmp/recording/mav0/imu0 /share/imu0
capture replay 60 --headless --no-film --quiet --source euroc:/tmp/recording --as-recorded --record /tmp/again
cp -r /tmp/again/mav0/imu0 /share/imu0_again
capture named 4 {SMALL} --imu iio:accel_3d+gyro_3d --imu-offset 0.5
capture nonesuch 4 {SMALL} --imu iio:nonesuch

# Unplugged after some seconds, and plugged in again.
(streaming; sleep 3; kill $unit; sleep 2; unit) &
capture unplug 15 {SMALL} --imu iio: --record /tmp/unplugged
cp -r /tmp/unplugged/mav0/imu0 /share/imu0_unplugged
# Unplugged for good: an interruption still ends the run.
(streaming; sleep 2; killall imu_device) &
capture gone 9 {SMALL} --imu iio:
"""
CALIBRATION = ("camera_model: pinhole\nwidth: 640\nheight: 360\nfx: 500\nfy: 500\ncx: 320\ncy: 180\ndistortion_model: none\n"
               "distortion: []\nrate_hz: 30\n")


class Results:
    def __init__(self, share):
        self.share, self.problems = share, []

    def require(self, condition, text):
        if not condition:
            self.problems.append(text)

    def text(self, name):
        return (self.share / name).read_text(errors="replace")

    def report(self, name):
        path = self.share / name / "report.json"
        if not path.is_file():
            fail(f"{name}: no report.json; {self.text(name + '.log/stderr')}")
        report = json.loads(path.read_text())
        print(f"{name}: code {self.text(name + '.log/code').strip()}, {report['frames']} frames, imu {json.dumps(report.get('imu'))}")
        return report

    def samples(self, name):
        rows = [line.split(",") for line in self.text(f"{name}/data.csv").splitlines() if line[0] != "#"]
        return [(int(row[0]), [float(word) for word in row[1:]]) for row in rows]


def check_list(results):
    results.require("no imu" in results.text("none.txt"), f"--list without a unit: {results.text('none.txt')}")
    names = results.text("list.txt")
    results.require("iio:accel_3d" in names and "accelerometer" in names and "iio:gyro_3d" in names and "gyroscope" in names,
                    f"--list does not name the unit: {names}")
    refused = results.text("refused.txt")
    results.require("may not open it" in refused and "udev rule" in refused, f"--list for a user without rights: {refused}")
    line = results.text("nobody.txt")
    results.require(results.text("nobody.code").strip() == "1" and "may not read it" in line and "udev rule" in line,
                    f"--imu for a user without rights: {line}")
    line = results.text("nonesuch.log/stderr")
    results.require(results.text("nonesuch.log/code").strip() == "1" and "nonesuch" in line and "--list" in line, f"no such unit: {line}")


def check_values(results, name, samples):
    """Each sample holds the number that the unit gave it. Gives the numbers."""
    numbers = []
    for _, (wx, wy, wz, ax, ay, az) in samples:
        k = wx / (0.01 * DEGREE)
        numbers.append(round(k))
        results.require(abs(k - round(k)) < 0.2 and abs(wy + wx) < 1e-9 and abs(wz / (0.01 * DEGREE) - 1) < 0.01,
                        f"{name}: rates {wx} {wy} {wz}")
        # Accelerations are interpolated at the times of the rates, so they lie between those of neighbours.
        results.require(abs(ay - G) < 1e-3 and abs(az + ax) < 1e-9 and abs(ax / (1e-3 * G) - k) < 1.2, f"{name}: accelerations {ax} {ay} {az}")
    return numbers


def check_stream(results):
    report = results.report("stream")
    imu, device = report["imu"], report["imu"]["device"]
    samples = results.samples("imu0")
    times = [t for t, _ in samples]
    numbers = check_values(results, "stream", samples)
    results.require(len(samples) == imu["samples"] and len(samples) > RATE_HZ, f"{len(samples)} samples recorded")
    results.require(all(a < b for a, b in zip(times, times[1:])), "times do not rise")
    results.require(all(b == a + 1 for a, b in zip(numbers, numbers[1:])), "samples are missing or out of order")
    results.require(device["timestamps"] == "monotonic" and device["dropped"] <= 2, f"device: {device}")
    for name in ("stream", "named"):
        others = [line for line in results.text(f"{name}.log/stderr").splitlines() if not line.startswith("pf-capture: ")]
        results.require(not others, f"{name}: {others}")
    results.require(0.4 < imu["rate_hz"] / RATE_HZ < 1.1 and device["gyro_rate_hz"] == RATE_HZ, f"rate: {imu}")
    results.require(imu["saturated"] == 0 and imu["refused"] == 0 and not imu["used"], f"imu: {imu}")
    results.require(imu["late"] <= 0.05 * imu["samples"], f"{imu['late']} of {imu['samples']} samples came after their frame")
    frames = [round(1e9 * float(line.split(",")[0])) for line in results.text("stream/frames.csv").splitlines()[1:]]
    results.require(times[-1] <= frames[-1] + 1 and frames[-1] - times[-1] < 1e9, "the last samples are not those before the last frame")
    replayed = results.report("replay")["imu"]
    results.require(replayed["samples"] == imu["samples"] and results.text("imu0_again/data.csv") == results.text("imu0/data.csv"),
                    f"{replayed['samples']} samples were replayed, or others")
    results.require(results.report("named")["imu"]["offset_s"] == 0.5, "--imu-offset")


def check_unplug(results):
    imu, text = results.report("unplug")["imu"], results.text("unplug.log/stderr")
    times = [t for t, _ in results.samples("imu0_unplugged")]
    gaps = [b - a for a, b in zip(times, times[1:])]
    results.require(imu["device"]["departures"] == 1 and "is gone" in text and "is back after" in text,
                    f"unplugged, and the user reads: {text}")
    results.require(max(gaps, default=0) > 1.9e9 and gaps.index(max(gaps)) + 10 < len(gaps), f"no samples after the unit came back: {gaps}")
    results.require(min(gaps, default=0) > 0 and imu["gaps"] >= 1 and imu["interval_ms"]["max"] > 1900, f"gaps: {imu}")
    gone = results.report("gone")
    results.require(gone["imu"]["device"]["departures"] == 1 and "is gone" in results.text("gone.log/stderr"), "gone for good: not noticed")
    results.require(gone["frames"] > 10, f"gone for good: {gone['frames']} frames only")


def main():
    guest.require_tools()
    CACHE.mkdir(parents=True, exist_ok=True)
    root = guest.fetch_packages()
    if not guest.modules(root, "hid_sensor_gyro_3d"):
        skip("Debian's kernel has no driver for HID sensors")
    programs = guest.cross_build("pf-capture")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        share = pathlib.Path(name) / "share"
        share.mkdir()
        (share / "small.yaml").write_text(CALIBRATION)
        guest.compile_helper(guest.SOURCE / "tests/guest/imu_device.c", share / "imu_device")
        program = share / "pf-capture"
        program.write_bytes((programs / "pf-capture").read_bytes())
        program.chmod(0o755)
        files = {f"lib/{name}": path for name, path in guest.libraries(program, guest.SYSROOT).items()}
        if not any("libiio" in name for name in files):
            skip("pf-capture for the guest has no libiio")
        print(guest.boot(root, share, RUN, load=("vivid", "uhid", "hid_sensor_accel_3d", "hid_sensor_gyro_3d"), files=files, seconds=240))
        results = Results(share)
        check_list(results)
        check_stream(results)
        check_unplug(results)
        if results.problems:
            problems = sorted(set(results.problems))
            fail("\n  ".join([f"{len(problems)} found:", *problems[:20]]))


main()
