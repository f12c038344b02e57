"""Images and inertial samples from recordings of ROS: rosbag 1, rosbag 2 and MCAP, read by the package rosbags (extra [bags]).

    for image, t_ns in planefold.bags.images("run.bag", "/cam0/image_raw"):
        slam.push_frame(image, t_ns)
"""

from __future__ import annotations

import contextlib
import io
import itertools
import os
import pathlib
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from ._core import ImuSample
from ._errors import Refused
from ._extras import load

__all__ = ["images", "imu", "topics"]

Grey = npt.NDArray[np.uint8]

_IMAGE, _COMPRESSED, _IMU = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/Imu"
_GREY = {"mono8", "8UC1"}
_COLOUR = {"rgb8": (0, 1, 2), "bgr8": (2, 1, 0), "rgba8": (0, 1, 2), "bgra8": (2, 1, 0), "8UC3": (2, 1, 0)}


@contextlib.contextmanager
def _reader(path: str | os.PathLike[str]) -> Iterator[Any]:
    file = pathlib.Path(path)
    if not file.exists():
        raise Refused(f"{file}: there is no such file or folder")
    highlevel, typesys = load("rosbags.highlevel", "bags"), load("rosbags.typesys", "bags")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)  # of recordings that do not say what their messages hold
    try:
        with highlevel.AnyReader([file], default_typestore=store) as reader:
            yield reader
    except highlevel.AnyReaderError as error:
        raise Refused(f"{file}: is no recording that can be read: {error}") from error


def topics(path: str | os.PathLike[str]) -> dict[str, str]:
    """Type of each topic, as "sensor_msgs/msg/Image"."""
    with _reader(path) as reader:
        return {connection.topic: connection.msgtype for connection in reader.connections}


def _connections(reader: Any, path: str | os.PathLike[str], topic: str | None, types: tuple[str, ...], what: str) -> list[Any]:
    """Those of the topic, or of the only one that has such messages."""
    known = {connection.topic: connection.msgtype for connection in reader.connections}
    fitting = sorted(name for name, kind in known.items() if kind in types)
    if topic is None and len(fitting) == 1:
        topic = fitting[0]
    if topic is None:
        met = f"these topics have {what}: {', '.join(fitting)}; name one" if fitting else f"no topic has {what}"
        raise Refused(f"{os.fspath(path)}: {met}")
    if topic not in known:
        raise Refused(f"{os.fspath(path)}: has no topic {topic}; of {what} it has {', '.join(fitting) or 'none'}")
    if known[topic] not in types:
        raise Refused(f"{os.fspath(path)}: {topic} is of type {known[topic]}, and has no {what}; such topics: {', '.join(fitting) or 'none'}")
    return [connection for connection in reader.connections if connection.topic == topic]


def _stored(path: str | os.PathLike[str], topic: str | None, types: tuple[str, ...], what: str) -> Iterator[tuple[str, Any, int, int]]:
    """(topic, message, time in its header, time of recording)"""
    with _reader(path) as reader:
        for connection, recorded_ns, data in reader.messages(_connections(reader, path, topic, types, what)):
            message = reader.deserialize(data, connection.msgtype)
            stamp = message.header.stamp
            yield connection.topic, message, stamp.sec * 1_000_000_000 + stamp.nanosec, recorded_ns


def _messages(path: str | os.PathLike[str], topic: str | None, types: tuple[str, ...], what: str) -> Iterator[tuple[str, Any, int]]:
    """(topic, message, t_ns). Times are those of the headers, unless the first two have none (a simulation may begin at 0)."""
    stored = _stored(path, topic, types, what)
    first = list(itertools.islice(stored, 2))
    stamped = any(stamp_ns != 0 for _, _, stamp_ns, _ in first)
    if first and not stamped:
        warnings.warn(f"{os.fspath(path)}: {first[0][0]} has no times in its headers; the times of recording are taken", RuntimeWarning,
                      stacklevel=3)
    for name, message, stamp_ns, recorded_ns in itertools.chain(first, stored):
        yield name, message, stamp_ns if stamped else recorded_ns


def _grey(colour: npt.NDArray[np.uint8], order: tuple[int, int, int]) -> Grey:
    """As images from folders become grey: 0.299 R + 0.587 G + 0.114 B, no gamma (Rec. 601)."""
    red, green, blue = (colour[..., channel].astype(np.uint32) for channel in order)
    return ((299 * red + 587 * green + 114 * blue + 500) // 1000).astype(np.uint8)


def _raw(topic: str, message: Any) -> Grey:
    encoding = message.encoding
    channels = 1 if encoding in _GREY else 4 if encoding in ("rgba8", "bgra8") else 3
    if encoding not in _GREY and encoding not in _COLOUR:
        hint = "; image_proc makes grey of it" if encoding.startswith("bayer") else ""
        raise Refused(f"{topic}: its images are {encoding}; known are {', '.join(sorted(_GREY | set(_COLOUR)))}{hint}")
    if message.step < channels * message.width or message.data.size < message.step * message.height:
        raise Refused(f"{topic}: an image has {message.data.size} bytes, fewer than {message.width} x {message.height} of {encoding} take")
    rows: npt.NDArray[np.uint8] = message.data[:message.step * message.height].reshape(message.height, message.step)
    rows = rows[:, :channels * message.width]
    return rows if channels == 1 else _grey(rows.reshape(message.height, message.width, channels), _COLOUR[encoding])


def _compressed(topic: str, message: Any) -> Grey:
    if "compressedDepth" in message.format or "bayer" in message.format:
        raise Refused(f"{topic}: its images are {message.format}; known are PNG and JPEG of grey or colour")
    picture = load("PIL.Image", "bags")
    try:
        image = picture.open(io.BytesIO(message.data.tobytes()))
        if image.format not in ("PNG", "JPEG"):
            raise Refused(f"{topic}: its images are {image.format}; known are PNG and JPEG of grey or colour")
        image.draft("L", None)  # of a JPEG the brightness, as it is stored
        if image.mode == "L":
            return np.asarray(image)
        return _grey(np.asarray(image.convert("RGB")), (0, 1, 2))
    except (OSError, SyntaxError) as error:
        raise Refused(f"{topic}: an image cannot be decoded: {error}") from error


def images(path: str | os.PathLike[str], topic: str | None = None) -> Iterator[tuple[Grey, int]]:
    """(image, t_ns), grey, of a topic of Image or CompressedImage; without a topic, of the only one.

    Encodings: mono8, 8UC1, and rgb8, bgr8 and their like, which become grey. PNG and JPEG where they are compressed.
    """
    for name, message, t_ns in _messages(path, topic, (_IMAGE, _COMPRESSED), "images"):
        yield (_raw if hasattr(message, "encoding") else _compressed)(name, message), t_ns


def imu(path: str | os.PathLike[str], topic: str | None = None) -> Iterator[ImuSample]:
    """Samples of a topic of Imu, for Slam.push_imu; without a topic, of the only one."""
    for _, message, t_ns in _messages(path, topic, (_IMU,), "inertial samples"):
        gyro, accel = message.angular_velocity, message.linear_acceleration
        yield ImuSample(t_ns=t_ns, gyro=(gyro.x, gyro.y, gyro.z), accel=(accel.x, accel.y, accel.z))
