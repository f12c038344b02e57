"""tools/ray-sequence: the command."""

import sys
import tempfile

import numpy as np
from PIL import Image

from pf_eval import Refused as RefusedFolder
from pf_eval.output_folder import add_output_files, open_output_folder

from . import Refused, render
from .path import Path, tum_rows
from .scenes import make
from .sensor import Exposure, expose, lamp_light


def write(options):
    scene = make(options.scene, options.seed)
    camera = scene.camera
    for name in ("width", "height", "fov_deg", "rate_hz", "exposure_s", "readout_s"):
        if getattr(options, name) is not None:
            setattr(camera, name, getattr(options, name))
    if options.auto_exposure is not None:
        scene.sensor.auto_exposure = options.auto_exposure
    if options.flicker is not None:
        scene.sensor.flicker = options.flicker
    path = Path(scene.keys, options.seed, scene.shake_deg, scene.shake_m)
    count = int((scene.keys[-1][0] - scene.keys[0][0]) * camera.rate_hz) + 1
    times = np.arange(count if options.frames is None else min(count, options.frames)) / camera.rate_hz
    render.program()
    out = open_output_folder(options.out, "OUT")
    names = [f"images/{k:06d}.png" for k in range(len(times))]
    add_output_files(out, *names, "times.txt", "calib.yaml", "groundtruth.tum")
    (out / "images").mkdir(exist_ok=True)
    (out / "calib.yaml").write_text(camera.yaml(f"tools/ray-sequence {options.scene}, seed {options.seed}"))
    (out / "groundtruth.tum").write_text(tum_rows(times, *path.poses(times)))
    (out / "times.txt").write_text("".join(f"{k} {t:.9f} {k:06d}.png\n" for k, t in enumerate(times)))
    random, exposure = np.random.default_rng(options.seed + 1), Exposure(scene.sensor)
    with tempfile.TemporaryDirectory(prefix="planefold_") as folder:
        for k, light in enumerate(render.frames(camera, path, scene.text, times, folder, options.subframes, jobs=options.jobs)):
            rows = times[k] + camera.row_delay(np.arange(camera.height))
            light = light * lamp_light(rows, camera.exposure_s, scene.sensor.flicker)[:, None]
            Image.fromarray(expose(light, exposure.next(light), scene.sensor, random)).save(out / names[k])
            if sys.stderr.isatty() or k % 50 == 0:
                print(f"\r{k + 1} of {len(times)} frames", end="" if sys.stderr.isatty() else "\n", file=sys.stderr, flush=True)
    print(f"{len(times)} frames of {camera.width}x{camera.height} written to {out}")


def main(options):
    try:
        write(options)
    except (Refused, RefusedFolder, OSError) as error:
        print(f"ray-sequence: {error}", file=sys.stderr)
        return 1
    return 0
