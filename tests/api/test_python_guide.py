"""The guide to Python: its code runs from top to bottom, beside the files that it names."""

import os
import pathlib
import re
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import python_package  # noqa: E402
import script  # noqa: E402

planefold = python_package.enter()
import numpy as np  # noqa: E402
from PIL import Image  # noqa: E402
from rosbags.rosbag1 import Writer  # noqa: E402
from rosbags.typesys import Stores, get_typestore  # noqa: E402

FRAMES = 90
NOISE = "gyroscope_noise_density: 2.0e-4\ngyroscope_random_walk: 2.0e-5\naccelerometer_noise_density: 2.0e-3\naccelerometer_random_walk: 3.0e-3\n"


def write_files(folder):
    """A folder of frames with truth, samples and noise, and a recording with its first frames."""
    scene = planefold.Sim("desk")
    planefold.write_calibration(str(folder / "calib.yaml"), scene.camera, 30.0)
    (folder / "images").mkdir()
    times, truth, images = [], [], []
    for number, (image, t_ns) in zip(range(FRAMES), scene):
        Image.fromarray(image).save(folder / "images" / f"{number:04d}.png")
        images.append((image.copy(), t_ns))
        times.append(f"{1e-9 * t_ns:.9f}\n")
        w, x, y, z = scene.truth.q_WC
        truth.append(" ".join(f"{value:.9f}" for value in (1e-9 * t_ns, *scene.truth.p_WC, x, y, z, w)) + "\n")
    (folder / "times.txt").write_text("".join(times))
    (folder / "truth.tum").write_text("".join(truth))
    (folder / "imu.yaml").write_text(NOISE)
    (folder / "imu.csv").write_text("timestamp_ns,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\n" + "".join(
        f"{t},0.01,0,0,0,-9.8,0.1\n" for t in range(0, images[-1][1] + 5_000_000, 5_000_000)))
    return images


def write_bag(path, images):
    store = get_typestore(Stores.ROS1_NOETIC)
    kind = "sensor_msgs/msg/Image"
    with Writer(path) as writer:
        connection = writer.add_connection("/cam0/image_raw", kind, typestore=store)
        for image, t_ns in images[:10]:
            stamp = store.types["builtin_interfaces/msg/Time"](sec=t_ns // 10**9, nanosec=t_ns % 10**9)
            message = store.types[kind](header=store.types["std_msgs/msg/Header"](seq=0, stamp=stamp, frame_id="camera"), height=image.shape[0],
                                        width=image.shape[1], encoding="mono8", is_bigendian=0, step=image.shape[1], data=np.ravel(image))
            writer.write(connection, t_ns, store.serialize_ros1(message, kind))


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    (folder / "desk").mkdir()
    write_bag(folder / "desk.bag", write_files(folder / "desk"))
    os.chdir(folder)
    names = {}
    page = script.SOURCE / "lib/docs/guide/python.md"
    blocks = re.findall(r"^```python\n(.*?)^```", page.read_text(), re.S | re.M)
    for block in blocks:
        exec(compile(block, str(page), "exec"), names)
    if len(names["poses"]) < FRAMES / 2 or names["comparison"].summary["ate_rmse_m"] > 0.02:
        script.fail(f"{len(names['poses'])} poses, {names['comparison'].summary['ate_rmse_m']} m")
    if not (folder / "trajectory.png").stat().st_size:
        script.fail("no plot was drawn")
    print(len(blocks), "blocks,", names["comparison"].summary["ate_rmse_m"], "m")
