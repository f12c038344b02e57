"""Renders light with POV-Ray: frames are means of sub-frames over the exposure, and may be put together from strips of rows."""

import concurrent.futures
import pathlib
import shutil
import subprocess
import tempfile

import numpy as np
from PIL import Image
from scipy.spatial.transform import Rotation

from . import Refused
from .camera import MARGIN, pov_vectors, rows_of_strip

QUARTERS = [(-0.25, -0.25), (0.25, 0.25), (0.25, -0.25), (-0.25, 0.25)]  # [px] of sub-frames, so that edges are smooth
CHUNK = 60  # renderings of one call of POV-Ray
HEAD = """#version 3.7;
global_settings { assumed_gamma 1.0 max_trace_level 3 }
camera { perspective location Places[frame_number - 1] direction Directions[frame_number - 1]
         right Rights[frame_number - 1] up Ups[frame_number - 1] }
#declare Now = Times[frame_number - 1];
"""


def program():
    found = shutil.which("povray")
    if found is None:
        raise Refused("needs povray; install it (Debian: apt-get install povray)")
    return found


def _array(name, values):
    words = [f"<{v[0]:.9f},{v[1]:.9f},{v[2]:.9f}>" if np.ndim(v) else f"{v:.9f}" for v in values]
    return f"#declare {name} = array[{len(words)}] {{ {','.join(words)} }}\n"


def _run(folder, views, scene, size):
    text = "".join(_array(name, column) for name, column in zip(("Times", "Places", "Directions", "Rights", "Ups"), zip(*views)))
    (folder / "scene.pov").write_text(text + HEAD + scene)
    result = subprocess.run([program(), "+Iscene.pov", "+Olight.png", f"+W{size[0]}", f"+H{size[1]}", f"+KFF{len(views)}", "+KFI1", "+FN",
                             "Bits_Per_Color=16", "Grayscale_Output=on", "File_Gamma=1.0", "-D", "+A0.05", "+AM2", "+R2", "+WT1", "-GA", "+GF"],
                            cwd=folder, text=True, capture_output=True, check=False)
    files = sorted(folder.glob("light*.png"))
    if result.returncode != 0 or len(files) != len(views):
        lines = [line for line in result.stderr.splitlines() if "rror" in line] or result.stderr.splitlines()[-1:] or [""]
        raise Refused(f"povray ended with {result.returncode}: {lines[0].strip()[:120]}")
    images = [np.asarray(Image.open(file), dtype=np.float32) / 65535 for file in files]
    for file in files:
        file.unlink()
    return images


def _views(camera, path, t, strips, subframes):
    """Of one frame: rows of time, place, direction, right, up, and the rotation of each strip."""
    views, turns = [], []
    margin = MARGIN if camera.readout_s > 0 else 0
    for first, rows in strips:
        middle = t + camera.row_delay(first + (rows - 1) / 2)
        turns.append(path.poses([middle])[1][0])
        for k in range(subframes):
            at = middle + camera.exposure_s * ((k + 0.5) / subframes - 0.5)
            p, R = path.poses([at])
            views.append((at, p[0], *pov_vectors(camera, R[0], first, rows, margin, QUARTERS[k % 4] if subframes > 1 else (0, 0))))
    return views, turns


def _assemble(camera, path, t, strips, turns, images, subframes):
    light = np.empty((camera.height, camera.width), dtype=np.float32)
    for k, (first, rows) in enumerate(strips):
        part = np.mean(images[k * subframes:(k + 1) * subframes], axis=0)
        if camera.readout_s > 0:
            R_rows = path.poses(t + camera.row_delay(np.arange(first, first + rows)))[1]
            part = rows_of_strip(camera, part, first, rows, turns[k], Rotation.from_quat(R_rows.as_quat()))
        light[first:first + rows] = part
    return light


def _call(camera, path, scene, times, folder, subframes, strips):
    """The light of a few frames, by one call of POV-Ray in a folder of its own."""
    margin = 2 * MARGIN if camera.readout_s > 0 else 0
    parts = [_views(camera, path, t, strips, subframes) for t in times]
    with tempfile.TemporaryDirectory(dir=folder) as own:
        images = _run(pathlib.Path(own), sum((views for views, _ in parts), []), scene, (camera.width + margin, strips[0][1] + margin))
    return [_assemble(camera, path, t, strips, turns, images[k * len(views):(k + 1) * len(views)], subframes)
            for k, (t, (views, turns)) in enumerate(zip(times, parts))]


def frames(camera, path, scene, times, folder, subframes=4, strips=8, jobs=4):
    """Yields the light of the frames at these times [height, width], 1 being white."""
    strips = camera.strips(strips if camera.readout_s > 0 else 1)
    if len({rows for _, rows in strips}) > 1:
        raise Refused(f"{camera.height} rows cannot be cut into {len(strips)} equal strips")
    per_call = max(1, CHUNK // (len(strips) * subframes))
    some = [times[begin:begin + per_call] for begin in range(0, len(times), per_call)]
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        calls = [pool.submit(_call, camera, path, scene, part, folder, subframes, strips) for part in some]
        try:
            for call in calls:
                yield from call.result()
        finally:
            for call in calls:
                call.cancel()
