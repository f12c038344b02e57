"""Tracks a film, a webcam or a folder of frames, and draws the way of the camera.

    python track_film.py film.mp4 calib.yaml        also: 0 for the first webcam (Ctrl-C ends it), images:DIR, sim:desk

Films and webcams need OpenCV (pip install opencv-python), the plot planefold[eval].
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Any

import planefold
import planefold.plot


def film(name: str) -> Iterator[tuple[Any, int]]:
    """Grey frames of a file or a webcam, with their times."""
    import cv2

    capture = cv2.VideoCapture(int(name) if name.isdigit() else name)
    while (frame := capture.read())[0]:
        yield cv2.cvtColor(frame[1], cv2.COLOR_BGR2GRAY), round(1e6 * capture.get(cv2.CAP_PROP_POS_MSEC))


def main(source: str, calibration: str | None = None) -> None:
    frames: Any
    if calibration is not None and ":" not in source:
        frames, camera = film(source), planefold.read_calibration(calibration)[0]
    else:
        frames = planefold.open_sequence(source, calibration)
        camera = frames.camera
    slam = planefold.Slam(planefold.Config(camera=camera), log=print)
    poses = []
    try:
        for image, t_ns in frames:
            if slam.push_frame(image, t_ns) == planefold.Status.OK:
                poses.append(slam.pose)
    except KeyboardInterrupt:
        pass
    print(f"tracked {len(poses)} of {slam.report.frames} frames; {len(slam.planes)} planes, {slam.memory_bytes / 2**20:.1f} MiB")
    print(planefold.plot.trajectory("trajectory.png", poses, slam.features, planes=slam.planes, title=source))


if __name__ == "__main__":
    main(*sys.argv[1:])
