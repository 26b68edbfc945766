"""Real bags of ROS 1 and ROS 2 for the tests, written by rosbags."""

from __future__ import annotations

import struct
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

import naive

COLOR, DEPTH, INFO = "/camera/color/image_raw", "/camera/aligned_depth_to_color/image_raw", "/camera/color/camera_info"
KINDS = ("ros1.bag", "ros2-sqlite", "ros2-mcap")
STEP_NS = 33_000_000
START_NS = 1_700_000_000_000_000_000


class Bag:
    """Collects messages and writes them in the order of their times."""

    def __init__(self, kind: str) -> None:
        self.ros1 = kind.endswith(".bag")
        self.kind = kind
        self.store = get_typestore(Stores.ROS1_NOETIC if self.ros1 else Stores.ROS2_HUMBLE)
        self.messages: list[tuple[int, str, str, bytes]] = []

    def header(self, stamp_ns: int) -> Any:
        types = self.store.types
        stamp = types["builtin_interfaces/msg/Time"](sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
        given = {"stamp": stamp, "frame_id": "camera_color_optical_frame"}
        return types["std_msgs/msg/Header"](**given, **({"seq": 0} if self.ros1 else {}))

    def add(self, topic: str, kind: str, stamp_ns: int, cut: int | None = None, **fields: Any) -> None:
        """Add a message. cut: how many bytes of it are left, as of a corrupt one."""
        message = self.store.types[kind](header=self.header(stamp_ns), **fields)
        serialize = self.store.serialize_ros1 if self.ros1 else self.store.serialize_cdr
        self.messages.append((stamp_ns, topic, kind, bytes(serialize(message, kind))[:cut]))

    def add_image(
        self, topic: str, stamp_ns: int, image: np.ndarray, encoding: str, cut: int | None = None, pad: int = 0
    ) -> None:
        rows = np.ascontiguousarray(image).view(np.uint8).reshape(image.shape[0], -1)
        rows = np.pad(rows, ((0, 0), (0, pad)))
        self.add(
            topic, "sensor_msgs/msg/Image", stamp_ns, cut, height=image.shape[0], width=image.shape[1],
            encoding=encoding, is_bigendian=0, step=rows.shape[1], data=rows.ravel(),
        )  # fmt: skip

    def add_compressed(self, topic: str, stamp_ns: int, image: np.ndarray, told: str, suffix: str = ".png") -> None:
        if "rvl" in told:
            size = struct.pack("<2i", image.shape[1], image.shape[0])
            data = np.frombuffer(size + naive.pack_rvl(image.ravel()), np.uint8)
        else:
            data = cv2.imencode(suffix, image)[1].ravel()
        if "compressedDepth" in told:
            data = np.concatenate([np.frombuffer(struct.pack("<i2f", 0, 100, 0), np.uint8), data])
        self.add(topic, "sensor_msgs/msg/CompressedImage", stamp_ns, format=told, data=data)

    def add_info(self, topic: str, stamp_ns: int, K: Iterable[float], size: tuple[int, int], D: Any = ()) -> None:
        K = np.array(list(K), float)
        P = np.insert(K.reshape(3, 3), 3, 0, axis=1).ravel()
        roi = self.store.types["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
        fields = {"D": np.array(D, float), "K": K, "R": np.eye(3).ravel(), "P": P}
        fields = fields if self.ros1 else {name.lower(): value for name, value in fields.items()}
        self.add(
            topic, "sensor_msgs/msg/CameraInfo", stamp_ns, height=size[0], width=size[1],
            distortion_model="plumb_bob", binning_x=0, binning_y=0, roi=roi, **fields,
        )  # fmt: skip

    def write(self, folder: Path) -> Path:
        """Write the bag. Return the file, or the folder of a ROS 2 bag."""
        path = folder / self.kind
        plugin = StoragePlugin.MCAP if "mcap" in self.kind else StoragePlugin.SQLITE3
        with Writer1(path) if self.ros1 else Writer2(path, version=9, storage_plugin=plugin) as writer:
            connections: dict[str, Any] = {}
            for time_ns, topic, kind, data in sorted(self.messages, key=lambda m: m[0]):
                if topic not in connections:
                    connections[topic] = writer.add_connection(topic, kind, typestore=self.store)
                writer.write(connections[topic], time_ns, data)
        return path


def usual_bag(kind: str, frame: Any, pairs: int = 60, unmatched: int = 3, corrupt: int = 1, shift_px: int = 1) -> Bag:
    """A bag with pairs, colour images without depth, and depth messages of which half is missing.

    shift_px: how far the images of a pair are rolled to the right of those before.
    """
    bag = Bag(kind)
    k = frame.camera
    bag.add_info(INFO, START_NS, [k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1], frame.shape)
    millimetres = np.round(frame.depth * 1000).astype(np.uint16)
    for number in range(pairs):
        stamp = START_NS + number * STEP_NS
        bag.add_image(COLOR, stamp, np.roll(frame.color, shift_px * number, axis=1), "rgb8")
        bag.add_image(DEPTH, stamp + 4_000_000, np.roll(millimetres, shift_px * number, axis=1), "16UC1")
    for number in range(unmatched):
        bag.add_image(COLOR, START_NS + (pairs + 3 * number + 3) * STEP_NS, frame.color, "rgb8")
    for number in range(corrupt):
        late = START_NS + (pairs + 3 * unmatched + 3 + 3 * number) * STEP_NS
        bag.add_image(DEPTH, late, millimetres, "16UC1", cut=millimetres.nbytes // 2)
    return bag
