"""Conversion of NumPy arrays to ROS messages without cv_bridge.

This module does not import ROS. The caller therefore creates an empty message, and a function of this module fills the
message. The module `sources.ros_images` converts ROS messages to NumPy arrays.
"""

from __future__ import annotations

import array
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Color

POINT = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("rgb", "<u4"), ("label", "<u4")])
"""Data type of a point in a point cloud. RViz and PCL interpret the bytes of `rgb` as a float."""
UINT32, FLOAT32 = 6, 7
"""Numbers of the data types uint32 and float32 in sensor_msgs/PointField."""

Points = npt.NDArray[np.float32]


def fill_image(message: Any, header: Any, pixels: npt.NDArray[Any], encoding: str) -> Any:
    """Fill a message sensor_msgs/Image with pixels (H, W) or (H, W, channels) and return the message."""
    stored = np.ascontiguousarray(pixels, pixels.dtype.newbyteorder("<"))
    message.header = header
    message.height, message.width = stored.shape[:2]
    message.encoding = encoding
    message.is_bigendian = 0
    message.step = stored.nbytes // stored.shape[0]
    message.data = _bytes(stored)
    return message


def fill_cloud(message: Any, field: Any, header: Any, points: npt.NDArray[np.void]) -> Any:
    """Fill a message sensor_msgs/PointCloud2 with points of the data type `POINT` and return the message. field: the
    class PointField.
    """
    message.header = header
    message.height, message.width = 1, len(points)
    kinds = {"x": FLOAT32, "y": FLOAT32, "z": FLOAT32, "rgb": FLOAT32, "label": UINT32}
    message.fields = [_field(field(), name, 4 * k, kind) for k, (name, kind) in enumerate(kinds.items())]
    message.is_bigendian = False
    message.point_step, message.row_step = POINT.itemsize, POINT.itemsize * len(points)
    message.data = _bytes(points)
    message.is_dense = True
    return message


def point_records(points_m: Points, colors: Color, label: int) -> npt.NDArray[np.void]:
    """Combine points (N, 3) in metres, their RGB colours (N, 3) and an object number into an array (N,) of data type
    `POINT`.
    """
    records = np.empty(len(points_m), POINT)
    for k, name in enumerate("xyz"):
        records[name] = points_m[:, k]
    red, green, blue = colors.astype(np.uint32).T
    records["rgb"] = red << 16 | green << 8 | blue
    records["label"] = label
    return records


def fill_pose(message: Any, center_m: npt.NDArray[np.float64], R: npt.NDArray[np.float64]) -> Any:
    """Fill a message geometry_msgs/Pose with a position (3,) in metres and a rotation matrix (3, 3), and return the
    message.
    """
    message.position.x, message.position.y, message.position.z = map(float, center_m)
    q = message.orientation
    q.x, q.y, q.z, q.w = quaternion(R)
    return message


def quaternion(R: npt.NDArray[np.float64]) -> tuple[float, float, float, float]:
    """Convert a rotation matrix (3, 3) to a unit quaternion (x, y, z, w)."""
    # the quaternion is the eigenvector of the largest eigenvalue of K (Bar-Itzhack 2000), stable at every angle
    K = np.array(
        [
            [R[0, 0] - R[1, 1] - R[2, 2], R[1, 0] + R[0, 1], R[2, 0] + R[0, 2], R[2, 1] - R[1, 2]],
            [R[1, 0] + R[0, 1], R[1, 1] - R[0, 0] - R[2, 2], R[2, 1] + R[1, 2], R[0, 2] - R[2, 0]],
            [R[2, 0] + R[0, 2], R[2, 1] + R[1, 2], R[2, 2] - R[0, 0] - R[1, 1], R[1, 0] - R[0, 1]],
            [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], R[0, 0] + R[1, 1] + R[2, 2]],
        ]
    )
    x, y, z, w = np.linalg.eigh(K)[1][:, 3].tolist()
    return x, y, z, w


def _field(message: Any, name: str, offset: int, kind: int) -> Any:
    message.name, message.offset, message.datatype, message.count = name, offset, kind, 1
    return message


def _bytes(values: npt.NDArray[Any]) -> array.array[int]:
    """Return the bytes of an array as `array.array`, which rclpy accepts without a slow check of each byte."""
    out = array.array("B")
    out.frombytes(np.ascontiguousarray(values).tobytes())
    return out
