"""Import of the ROS 2 packages when a node starts."""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from typing import Any

from spigolo.errors import SpigoloError

MISSING = (
    "The node needs {module}, which is missing: run `source /opt/ros/DISTRO/setup.bash` and install spigolo for the"
    ' Python of ROS, or without a ROS installation (Linux, x86-64) run pip install "spigolo[ros]"'
)


@dataclass(frozen=True, slots=True)
class Kinds:
    """Python packages of ROS 2 that the node of spigolo uses. An optional package is None if it is not installed."""

    rclpy: Any
    """Package rclpy, the Python client library of ROS 2."""
    interfaces: Any
    """Module rcl_interfaces.msg with the message types for parameters."""
    sensor: Any
    """Module sensor_msgs.msg with the message types for images, camera information and point clouds."""
    geometry: Any
    """Module geometry_msgs.msg with the message type for clicked points."""
    services: Any | None
    """Module std_srvs.srv with the type of the service `segment`, which segments the newest images."""
    visualization: Any | None
    """Module visualization_msgs.msg with the message types for markers."""
    vision: Any | None
    """Module vision_msgs.msg with the message types for detections."""


def find_kinds() -> Kinds:
    """Import the ROS 2 packages. Raises SpigoloError with installation instructions if a required package is
    missing.
    """
    for module in ("rclpy", "rclpy.node", "rclpy.qos", "rclpy.executors", "rclpy.parameter"):
        _required(module)
    return Kinds(
        _required("rclpy"),
        _required("rcl_interfaces.msg"),
        _required("sensor_msgs.msg"),
        _required("geometry_msgs.msg"),
        _optional("std_srvs.srv"),
        _optional("visualization_msgs.msg"),
        _optional("vision_msgs.msg"),
    )


def _required(module: str) -> Any:
    found = _optional(module)
    if found is None:
        raise SpigoloError(MISSING.format(module=module.partition(".")[0]))
    return found


def _optional(module: str) -> Any | None:
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError:
        return None
