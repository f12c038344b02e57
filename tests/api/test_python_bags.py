"""planefold.bags: from rosbag 1, rosbag 2 and MCAP comes the trajectory that the folder of the same frames gives; what is not known is
refused by name."""

import io
import pathlib
import sys
import tempfile
import unittest
import warnings

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import python_package  # noqa: E402

planefold = python_package.enter()
import numpy as np  # noqa: E402
import planefold.bags  # noqa: E402
from PIL import Image  # noqa: E402
from rosbags.rosbag1 import Writer as Writer1  # noqa: E402
from rosbags.rosbag2 import StoragePlugin, Writer as Writer2  # noqa: E402
from rosbags.typesys import Stores, get_typestore  # noqa: E402

FRAMES = 12
SECOND = 1_000_000_000


def encoded(picture, kind, **options):
    file = io.BytesIO()
    picture.save(file, kind, **options)
    return np.frombuffer(file.getvalue(), np.uint8)


class Bag:
    """A recording being written, in one of the three forms."""

    def __init__(self, form, path):
        self.store = get_typestore(Stores.ROS1_NOETIC if form == "rosbag1" else Stores.ROS2_HUMBLE)
        self.form, self.types, self.connections = form, self.store.types, {}
        plugin = StoragePlugin.MCAP if form == "mcap" else StoragePlugin.SQLITE3
        self.writer = Writer1(path) if form == "rosbag1" else Writer2(path, version=9, storage_plugin=plugin)

    def __enter__(self):
        self.writer.open()
        return self

    def __exit__(self, *_):
        self.writer.close()

    def header(self, t_ns):
        time = self.types["builtin_interfaces/msg/Time"](sec=t_ns // SECOND, nanosec=t_ns % SECOND)
        extra = {"seq": 0} if self.form == "rosbag1" else {}
        return self.types["std_msgs/msg/Header"](stamp=time, frame_id="camera", **extra)

    def add(self, topic, kind, t_ns, stamp=None, **fields):
        if topic not in self.connections:
            self.connections[topic] = self.writer.add_connection(topic, kind, typestore=self.store)
        message = self.types[kind](header=self.header(t_ns if stamp is None else stamp), **fields)
        data = self.store.serialize_ros1(message, kind) if self.form == "rosbag1" else self.store.serialize_cdr(message, kind)
        self.writer.write(self.connections[topic], t_ns + 5_000_000, data)

    def image(self, topic, pixels, t_ns, encoding="mono8", step=None, **options):
        self.add(topic, "sensor_msgs/msg/Image", t_ns, height=pixels.shape[0], width=pixels.shape[1], encoding=encoding, is_bigendian=0,
                 step=step or pixels[0].size, data=np.ascontiguousarray(pixels).reshape(-1), **options)

    def compressed(self, topic, data, t_ns, kind):
        self.add(topic, "sensor_msgs/msg/CompressedImage", t_ns, format=kind, data=data)

    def imu(self, topic, sample):
        vector = self.types["geometry_msgs/msg/Vector3"]
        gyro, accel = (vector(*(float(value) for value in values)) for values in (sample.gyro, sample.accel))
        self.add(topic, "sensor_msgs/msg/Imu", sample.t_ns, orientation=self.types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0),
                 orientation_covariance=np.zeros(9), angular_velocity=gyro, angular_velocity_covariance=np.zeros(9),
                 linear_acceleration=accel, linear_acceleration_covariance=np.zeros(9))


def bag_path(folder, form):
    return folder / ("run.bag" if form == "rosbag1" else form)


class Trajectories(unittest.TestCase):
    """Frames in colour, so that both ways to grey are the same one."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        scene = planefold.Sim("desk")
        planefold.write_calibration(str(cls.folder / "calib.yaml"), scene.camera, 30.0)
        tint = np.array([1.0, 0.9, 0.7])
        cls.frames = []
        for number, (image, t_ns) in enumerate(scene):
            if number == FRAMES:
                break
            cls.frames.append(((image[..., None] * tint).astype(np.uint8), 1_700_000_000 * SECOND + t_ns))
        cls.samples = planefold.SimImu(scene).until(300_000_000)
        for kind in ("png", "jpg"):
            (cls.folder / kind / "images").mkdir(parents=True)
            (cls.folder / kind / "calib.yaml").write_text((cls.folder / "calib.yaml").read_text())
            times = ""
            for number, (colour, t_ns) in enumerate(cls.frames):
                Image.fromarray(colour).save(cls.folder / kind / "images" / f"{number:04d}.{kind}")
                times += f"{number} {t_ns // SECOND}.{t_ns % SECOND:09d} {number:04d}.{kind}\n"
            (cls.folder / kind / "times.txt").write_text(times)
        for form in ("rosbag1", "rosbag2", "mcap"):
            with Bag(form, bag_path(cls.folder, form)) as bag:
                for colour, t_ns in cls.frames:
                    grey = next(iter(planefold.bags._grey(colour[None], (0, 1, 2))))
                    padded = np.zeros((grey.shape[0], grey.shape[1] + 9), np.uint8)
                    padded[:, :-9] = grey
                    bag.add("/mono", "sensor_msgs/msg/Image", t_ns, height=grey.shape[0], width=grey.shape[1], encoding="mono8",
                            is_bigendian=0, step=padded.shape[1], data=padded.reshape(-1))
                    bag.image("/bgr", colour[..., ::-1], t_ns, "bgr8")
                    bag.image("/rgb", colour, t_ns, "rgb8")
                    bag.compressed("/png", encoded(Image.fromarray(colour), "PNG"), t_ns, "rgb8; png compressed bgr8")
                    bag.compressed("/jpg", encoded(Image.fromarray(colour), "JPEG"), t_ns, "jpeg")
                for sample in cls.samples:
                    bag.imu("/imu", sample)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def trajectory(self, frames):
        scene, found = planefold.Sim("desk"), []
        slam = planefold.Slam(planefold.Config(camera=scene.camera))
        slam.start_from_target(scene.target())
        for image, t_ns in frames:
            if slam.push_frame(image, t_ns) == planefold.Status.OK:
                found.append(python_package.tum(slam.pose))
        return found

    def test_trajectory_is_that_of_the_folder(self):
        folders = {kind: self.trajectory(planefold.open_sequence(f"images:{self.folder / kind}")) for kind in ("png", "jpg")}
        self.assertGreater(len(folders["png"]), FRAMES // 2)
        for form in ("rosbag1", "rosbag2", "mcap"):
            for topic in ("/mono", "/bgr", "/rgb", "/png", "/jpg"):
                found = self.trajectory(planefold.bags.images(bag_path(self.folder, form), topic))
                self.assertEqual(found, folders["jpg" if topic == "/jpg" else "png"], f"{form} {topic}")

    def test_inertial_samples_come_out_as_they_were(self):
        for form in ("rosbag1", "rosbag2", "mcap"):
            found = list(planefold.bags.imu(bag_path(self.folder, form)))
            self.assertEqual([repr(sample) for sample in found], [repr(sample) for sample in self.samples])

    def test_a_single_mcap_file_is_a_recording(self):
        file = next(bag_path(self.folder, "mcap").glob("*.mcap"))
        self.assertEqual(sum(1 for _ in planefold.bags.images(file, "/mono")), FRAMES)

    def test_topics(self):
        found = planefold.bags.topics(bag_path(self.folder, "rosbag2"))
        self.assertEqual(found["/imu"], "sensor_msgs/msg/Imu")

    def refused(self, path, topic, line):
        with self.assertRaisesRegex(planefold.Refused, line) as raised:
            list(planefold.bags.images(path, topic))
        self.assertNotIn("\n", str(raised.exception))

    def test_what_is_not_known_is_refused_by_name(self):
        bag = bag_path(self.folder, "rosbag1")
        self.refused(bag, None, "these topics have images: /bgr, /jpg, /mono, /png, /rgb; name one")
        self.refused(bag, "/depth", "has no topic /depth; of images it has /bgr, /jpg")
        self.refused(bag, "/imu", "/imu is of type sensor_msgs/msg/Imu")
        self.refused(self.folder / "nothing.bag", None, "there is no such file")
        (self.folder / "text.bag").write_text("no recording")
        self.refused(self.folder / "text.bag", None, "is no recording")
        other = self.folder / "other.bag"
        pixels = np.zeros((240, 320), np.uint8)
        with Bag("rosbag1", other) as writer:
            writer.image("/bayer", pixels, SECOND, "bayer_rggb8")
            writer.image("/deep", np.zeros((240, 640), np.uint8), SECOND, "mono16")
            writer.image("/short", pixels, SECOND, "rgb8")
            writer.compressed("/broken", np.arange(50, dtype=np.uint8), SECOND, "jpeg")
            writer.compressed("/webp", encoded(Image.fromarray(pixels), "GIF"), SECOND, "gif")
        self.refused(other, "/bayer", "bayer_rggb8; known are .*image_proc")
        self.refused(other, "/deep", "mono16; known are")
        self.refused(other, "/short", "fewer than")
        self.refused(other, "/broken", "cannot be decoded")
        self.refused(other, "/webp", "are GIF; known are PNG and JPEG")

    def test_headers_without_times_are_noted(self):
        path = self.folder / "unstamped.bag"
        with Bag("rosbag1", path) as writer:
            for number in range(3):
                writer.image("/mono", np.zeros((240, 320), np.uint8), SECOND + number, stamp=0)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            times = [t_ns for _, t_ns in planefold.bags.images(path)]
        self.assertEqual(times, [SECOND + number + 5_000_000 for number in range(3)])
        self.assertIn("has no times in its headers", str(caught[0].message))


if __name__ == "__main__":
    unittest.main(verbosity=2)
