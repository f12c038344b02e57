"""pf-capture with a camera of the kernel (vivid) in an arm64 guest: streaming, what comes out is what went in, recording and
replay, leaving and returning, interruption."""

import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import guest  # noqa: E402
import png  # noqa: E402
from guest import BIN, CACHE, fail, run, skip  # noqa: E402

WIDTH, HEIGHT = 640, 480
PICTURES = 60
# A small map: an emulated processor is thirty times slower than a real one.
SMALL = ("--headless --no-film --quiet --max-features 20 --features-in-view 12 --max-observations 16 --max-state-dim 90 "
         "--start rectangle:0.20x0.14")
RUN = f"""set -e
vivid="n_devs=2 node_types=0x1,0x101 num_inputs=1,1 input_types=0x0,0x3 num_outputs=1,1 output_types=0x1,0x1"
. /share/modules.sh
cp /share/pf-capture /share/feed /share/pictures.raw /tmp
capture() {{ # NAME SECONDS ARGUMENTS...: interrupted after some seconds, as a user ends a run
  name=$1; seconds=$2; shift 2
  mkdir -p /share/$name.log
  timeout -s INT $seconds /tmp/pf-capture {SMALL} --out /share/$name "$@" >/share/$name.log/stdout 2>/share/$name.log/stderr && code=0 || code=$?
  echo $code >/share/$name.log/code
  echo "$name: $(cut -d' ' -f1 /proc/uptime) s"
}}
streaming() {{ # waits until the camera streams: its driver then has a thread of that name
  for i in $(seq 100); do grep -qs '^vivid-000-vid' /proc/[0-9]*/comm && return; sleep 0.1; done
  echo "the camera did not begin to stream"
}}
/tmp/pf-capture --list >/share/list.txt
# The test picture. --delay leaves the processor to the camera. Where the host is busy the emulated camera itself comes late and
# skips a number, so there are several attempts, the last ones at half the rate.
CALM="--calib /share/small.yaml --delay 500"
for format in GREY YUYV; do
  for attempt in 30:6 30:6 15:10 15:10; do
    capture $format ${{attempt#*:}} --source v4l2:/dev/video0 $CALM --rate ${{attempt%:*}} --format $format
    grep -A 60 '"camera": {{' /share/$format/report.json | grep -q '"lost": 0,' && break
  done
done
capture dmabuf 3 --source v4l2:vivid $CALM --format GREY --dma-buf

# Rendered pictures from the output to the input.
/tmp/feed /dev/video2 /dev/video1 {WIDTH} {HEIGHT} {2 * PICTURES - 2} /tmp/pictures.raw >/share/feed.txt 2>&1 &
feed=$!
for i in 1 2 3 4 5 6 7 8 9 10; do grep -q ready /share/feed.txt && break; sleep 1; done
sleep 1
capture live 6 --source v4l2:/dev/video1 --calib /share/desk.yaml --delay 300 --record /tmp/loop
kill $feed
tar -c -f - -C /tmp/loop . | dd of=/share/loop.tar bs=262144 2>/dev/null
capture again 60 --source euroc:/tmp/loop --as-recorded
capture replay 120 --source euroc:/tmp/loop --frames {PICTURES}

# Unplugged after some seconds, and plugged in again.
(streaming; sleep 3; echo vivid.0 >/sys/bus/platform/drivers/vivid/unbind; echo "unbound" >/share/unbind.txt; sleep 2
 echo vivid.0 >/sys/bus/platform/drivers/vivid/bind) &
capture unplug 13 --source v4l2:/dev/video0 $CALM --format GREY
# Unplugged for good: an interruption still ends the run.
(streaming; sleep 2; echo vivid.0 >/sys/bus/platform/drivers/vivid/unbind) &
capture gone 7 --source v4l2:/dev/video0 $CALM --format GREY
"""


def calibration(width, height):
    return (f"camera_model: pinhole\nwidth: {width}\nheight: {height}\nfx: 500\nfy: 500\ncx: {width / 2}\ncy: {height / 2}\n"
            "distortion_model: none\ndistortion: []\nrate_hz: 30\n")


class Results:
    def __init__(self, share):
        self.share, self.problems = share, []

    def require(self, condition, text):
        if not condition:
            self.problems.append(text)

    def read(self, name):
        path = self.share / name / "report.json"
        if not path.is_file():
            stderr = self.share / f"{name}.log" / "stderr"
            fail(f"{name}: no report.json; {stderr.read_text() if stderr.is_file() else ''}")
        return json.loads(path.read_text())

    def report(self, name):
        report = self.read(name)
        live = report.get("live", {})
        print(f"{name}: code {(self.share / (name + '.log') / 'code').read_text().strip()}, {report['frames']} frames, tracked "
              f"{report['tracked']}, live {json.dumps(live)}")
        return report

    def stderr(self, name):
        return (self.share / f"{name}.log" / "stderr").read_text()


def check_streams(results):
    names = (results.share / "list.txt").read_text()
    results.require("v4l2:/dev/video0" in names and "vivid" in names and "GREY" in names and "YUYV" in names,
                    f"--list does not name the camera: {names}")
    results.require("video2" not in names, f"--list names an output: {names}")
    for name, direct in (("GREY", True), ("YUYV", False)):
        live = results.report(name)["live"]
        camera, interval = live["camera"], live["interval_ms"]
        results.require(camera["format"] == name and camera["direct"] == direct, f"{name}: {camera}")
        results.require(camera["timestamps"] == "end of exposure", f"{name}: timestamps of {camera['timestamps']}")
        results.require(live["captured"] >= 120, f"{name}: only {live['captured']} frames")
        results.require(camera["lost"] == 0 and camera["damaged"] == 0, f"{name}: {camera['lost']} frames lost, "
                        f"{camera['damaged']} damaged")
        results.require(interval["min"] > 0 and 0.9 < 1e-3 * camera["rate_hz"] * interval["median"] < 1.1, f"{name}: intervals {interval} ms")
    dmabuf = results.report("dmabuf")["live"]
    results.require(dmabuf["captured"] >= 30 and dmabuf["camera"]["damaged"] == 0, f"dma-buf: {dmabuf}")


def check_loop(results, pictures):
    (results.share / "loop").mkdir()
    run("tar", "-x", "-f", results.share / "loop.tar", "-C", results.share / "loop")
    numbers = {data: i for i, data in enumerate(pictures)}
    frames = png.recording(results.share / "loop")
    seen = [numbers.get(data, -1) for _, data in frames]
    results.require(len(frames) > PICTURES, f"only {len(frames)} frames came out of the loop")
    results.require(-1 not in seen, f"{seen.count(-1)} of {len(seen)} frames came out changed")
    results.require(len(set(seen)) >= 0.9 * PICTURES, f"only {len(set(seen))} of {PICTURES} pictures came out")
    live = results.report("live")
    results.require(live["tracked"] > 0, "nothing was tracked while it was recorded")
    results.report("again")
    for name in ("trajectory.txt", "covariance.csv", "map.ply"):
        first, second = ((results.share / folder / name).read_bytes() for folder in ("live", "again"))
        results.require(first == second, f"{name} of the recording, replayed as recorded, differs")


def check_replay(results, root):
    """The recording, replayed there and here."""
    results.report("replay")
    run(BIN / "pf-capture", *SMALL.split(), "--source", f"euroc:{results.share}/loop", "--frames", PICTURES, "--out", root / "here")
    tables = [[line.split() for line in (folder / "trajectory_all.txt").read_text().splitlines() if line[0] != "#"]
              for folder in (results.share / "replay", root / "here")]
    there, here = tables
    results.require([row[0] for row in there] == [row[0] for row in here] and len(here) >= 0.8 * PICTURES,
                    f"{len(there)} poses there, {len(here)} here, or at other times")
    worst = max((abs(float(a) - float(b)) for r, s in zip(there, here) for a, b in zip(r[1:4], s[1:4])), default=1.0)
    print(f"replayed there and here: {len(here)} poses, at most {worst:.3g} m apart")
    results.require(worst <= 1e-6, f"positions there and here differ by {worst:.3g} m")


def check_interrupted(results):
    """Files of runs that an interruption ended are complete: whole lines, as many frames as the report says, whole pictures."""
    for name in ("GREY", "YUYV", "live", "unplug", "gone"):
        folder = results.share / name
        report = results.read(name)
        code = (results.share / f"{name}.log" / "code").read_text().strip()
        # A busy host makes the guest so slow that the camera may be lost between its frames; the run then says so and ends with 1.
        failed = report["tracked"] == 0 or "the camera was lost" in results.stderr(name)
        results.require(code == ("1" if failed else "0"), f"{name}: the interrupted run ended with {code}: {results.stderr(name)}")
        text = (folder / "frames.csv").read_text()
        rows = text.splitlines()
        results.require(text.endswith("\n") and len(rows) == report["frames"] + 1
                        and len({row.count(",") for row in rows}) == 1, f"{name}: frames.csv has {len(rows)} lines, the last {rows[-1:]}")
        poses = (folder / "trajectory_all.txt").read_text()
        results.require(poses.endswith("\n") and all(len(line.split()) == 8 for line in poses.splitlines() if line[0] != "#"),
                        f"{name}: trajectory_all.txt ends with {poses[-80:]}")
    recorded = (results.share / "loop/mav0/cam0/data.csv").read_text()
    files = sorted((results.share / "loop/mav0/cam0/data").iterdir())
    names = sorted(line.split(",")[1] for line in recorded.splitlines() if line[0] != "#")
    results.require(recorded.endswith("\n") and names == [path.name for path in files], "the recording's table and pictures differ")
    results.require(all(path.read_bytes().endswith(b"IEND\xaeB`\x82") for path in files), "a picture of the recording is cut off")


def check_unplug(results):
    live = results.report("unplug")["live"]
    text = results.stderr("unplug")
    results.require(live["camera"]["departures"] == 1, f"{live['camera']['departures']} departures")
    results.require("is gone" in text and "is back after" in text, f"unplugged, and the user reads: {text}")
    before_and_after = [line.split(",")[0] for line in (results.share / "unplug/frames.csv").read_text().splitlines()[1:]]
    gaps = [float(b) - float(a) for a, b in zip(before_and_after, before_and_after[1:])]
    results.require(max(gaps, default=0.0) > 1.9 and gaps.index(max(gaps)) + 1 < len(gaps),
                    f"no frames after the camera came back: gaps {gaps}")
    gone = results.report("gone")
    results.require(gone["live"]["camera"]["departures"] == 1 and "is gone" in results.stderr("gone"), "gone for good: not noticed")


def main():
    if not (BIN / "pf-capture").is_file():
        skip("pf-capture was not built")
    guest.require_tools()
    CACHE.mkdir(parents=True, exist_ok=True)
    root = guest.fetch_packages()
    programs = guest.cross_build("pf-capture")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        work = pathlib.Path(name)
        share = work / "share"
        share.mkdir()
        (share / "desk.yaml").write_text(calibration(WIDTH, HEIGHT))
        (share / "small.yaml").write_text(calibration(640, 360))
        run(BIN / "pf-capture", *SMALL.split(), "--source", "sim:desk", "--calib", share / "desk.yaml", "--frames", PICTURES,
            "--record", work / "rendered", "--out", work / "out")
        pictures = [data for _, data in png.recording(work / "rendered")]
        # There and back again, so that the loop has no jump.
        (share / "pictures.raw").write_bytes(b"".join(pictures + pictures[-2:0:-1]))
        guest.compile_helper(guest.SOURCE / "tests/guest/feed.c", share / "feed")
        program = share / "pf-capture"
        program.write_bytes((programs / "pf-capture").read_bytes())
        program.chmod(0o755)
        files = {f"lib/{name}": path for name, path in guest.libraries(program, guest.SYSROOT).items()}
        print(guest.boot(root, share, RUN, load=("vivid",), files=files, seconds=240))
        results = Results(share)
        check_streams(results)
        check_loop(results, pictures)
        check_replay(results, work)
        check_interrupted(results)
        check_unplug(results)
        if results.problems:
            fail("\n  ".join([f"{len(results.problems)} found:", *results.problems]))


main()
