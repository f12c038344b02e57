"""Runs of pf-capture on a folder of images, by the share of frames that they tracked."""

import json
import os
import pathlib
import subprocess

from script import BIN, fail, skip


def sequence(name):
    """A folder of real images; skips the test where there is none."""
    data = os.environ.get("PLANEFOLD_DATA", "")
    folder = pathlib.Path(data) / name
    if not data or not folder.is_dir():
        skip(f"PLANEFOLD_DATA names no folder with {name}")
    return folder


def tracked_share(folder, start, out, *options):
    """Of the frames from `start` on."""
    command = [BIN / "pf-capture", "--source", f"images:{folder}", "--skip", str(start), "--headless", "--no-film", "--quiet", "--out", out, *options]
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if result.returncode not in (0, 1):  # 1: lost at the end
        fail(f"{folder.name} from frame {start}: exit code {result.returncode}\n{result.stdout}")
    frames = json.loads((out / "report.json").read_text())["frames_by_state"]
    return frames["tracked"] / sum(frames.values())


def require_tracked(shares, least, runs):
    """At least the share `runs` of all runs has tracked at least the share `least` of its frames."""
    good = sum(share >= least for share in shares)
    print(f"{good} of {len(shares)} runs tracked at least {least:.0%} of their frames, the worst {min(shares):.0%}")
    if good < runs * len(shares):
        fail(f"at least {runs:.0%} of the runs should")
