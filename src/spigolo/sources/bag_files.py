"""Functions that read messages and their time stamps from ROS 1 and ROS 2 bag files. ROS need not be installed."""

from __future__ import annotations

import importlib
import struct
from collections.abc import Sequence
from contextlib import closing, suppress
from pathlib import Path
from typing import Any, NamedTuple

from spigolo.errors import FileError, FrameError
from spigolo.sources.ros_images import is_depth
from spigolo.sources.topics import Topics

PIP = 'pip install "spigolo[bags]"'
REALSENSE = "/device_0/sensor_"
"""Prefix of the topic names in a recording of the RealSense SDK."""


class Stamped(NamedTuple):
    """Position of an image message in a bag, and the stamp of the image."""

    stamp_ns: int
    """Time stamp of the image, in nanoseconds."""
    number: int
    """Number of the message in its topic, from 0."""
    written_ns: int
    """Time at which the recorder wrote the message, in nanoseconds. The message is found in the bag by this time."""


class Decoder:
    """Deserialiser of ROS messages, which also works after the bag is closed."""

    def __init__(self, reader: Any) -> None:
        self._reader, store = reader, reader.typestore
        self._deserialize = store.deserialize_cdr if reader.is2 else store.deserialize_ros1

    def message(self, data: bytes, kind: str) -> Any:
        """Deserialise a message. Raises FrameError for a damaged message."""
        try:
            return self._deserialize(data, kind)
        except Exception as error:  # damaged bytes may raise any exception
            raise FrameError(f"the {kind.rpartition('/')[2]} message cannot be read ({_told(error)})") from None

    def first(self, connections: Sequence[Any]) -> Any:
        """Return the first readable message of the given connections, or None. A connection of the package rosbags is a
        topic with its message type.
        """
        with suppress(Exception):  # `read_stamps` reports errors in the file
            for connection, _, data in self._reader.messages(connections=connections) if connections else ():
                with suppress(FrameError):
                    return self.message(data, connection.msgtype)
        return None

    def holds_depth(self, connection: Any) -> bool:
        """Return True if the first readable image of a topic is a depth image. If no image is readable, return True if
        the topic name contains "depth".
        """
        message = self.first([connection])
        return "depth" in connection.topic if message is None else is_depth(message)


Stamps = dict[str, list[Stamped]]
"""Stamped messages, indexed by topic."""


def read_stamps(reader: Any, topics: Topics) -> tuple[Stamps, frozenset[tuple[str, int]], str]:
    """Return the stamps, the messages without a stamp, and the reason if reading stopped before the end of the file."""
    stamps: Stamps = {topics.color: [], topics.depth: []}
    numbers, headless = dict.fromkeys(stamps, 0), set()
    wanted = [c for c in reader.connections if c.topic in stamps]
    try:
        for connection, written_ns, data in reader.messages(connections=wanted):
            topic = connection.topic
            number, numbers[topic] = numbers[topic], numbers[topic] + 1
            stamp = _stamp_ns(data, reader.is2)
            if stamp is None:
                headless.add((topic, number))
            else:
                stamps[topic].append(Stamped(stamp, number, written_ns))
    except Exception as error:  # damaged files may raise any exception
        return stamps, frozenset(headless), _told(error)
    return stamps, frozenset(headless), ""


def find_message(reader: Any, topic: str, wanted: Stamped) -> bytes:
    """Find a message in a bag by the time at which it was written, and return its bytes. Raises FrameError."""
    connections = [c for c in reader.connections if c.topic == topic]
    at = wanted.written_ns
    try:
        for _, _, data in reader.messages(connections=connections, start=at, stop=at + 1):
            if _stamp_ns(data, reader.is2) == wanted.stamp_ns:
                return bytes(data)
    except Exception as error:  # damaged files may raise any exception
        raise FrameError(f"{topic}, message {wanted.number} cannot be read ({_told(error)})") from None
    raise FrameError(f"{topic}, message {wanted.number} is no longer in the recording")


def is_of_realsense(path: Path) -> bool:
    """Return True if a bag was recorded by the RealSense SDK, which does not register depth to colour in recordings."""
    with closing(open_bag(path)) as reader:
        return any(c.topic.startswith(REALSENSE) for c in reader.connections)


def open_bag(path: Path) -> Any:
    """Open a bag and return its reader. Raises FileError."""
    try:
        reading = importlib.import_module("rosbags.highlevel")
        typesys = importlib.import_module("rosbags.typesys")
    except ImportError:
        raise FileError(f"reading {path} needs rosbags, which is missing: {PIP}") from None
    try:
        usual = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
        reader = reading.AnyReader([path], default_typestore=usual)
        reader.open()
    except Exception as error:  # damaged files may raise any exception
        raise FileError(f"{path}: not a readable ROS bag ({_told(error)})") from None
    return reader


def _stamp_ns(data: bytes, is_ros2: bool) -> int | None:
    """Return the stamp of a serialised header, or None if the message is too short."""
    if len(data) < 12:
        return None
    if not is_ros2:
        sec, nanosec = struct.unpack_from("<II", data, 4)
    else:
        sec, nanosec = struct.unpack_from(">iI" if data[1] == 0 else "<iI", data, 4)
    return int(sec) * 1_000_000_000 + int(nanosec)


def _told(error: BaseException) -> str:
    return " ".join(str(error).split())[:200] or type(error).__name__
