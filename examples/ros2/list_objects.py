"""Print the objects in the point clouds of the ROS 2 node.

For each frame, print the label, the number of points and the centre of all objects in the topic `spigolo/cloud`.

    source /opt/ros/jazzy/setup.bash
    spigolo ros --color /camera/camera/color/image_raw ...     # in another terminal
    python3 examples/ros2/list_objects.py
"""

from __future__ import annotations

import argparse

import numpy as np
import rclpy
from sensor_msgs.msg import PointCloud2

POINT = np.dtype([("xyz", "<f4", 3), ("rgb", "<u4"), ("label", "<u4")])


def show(cloud: PointCloud2) -> None:
    """Print the label, the number of points and the centre of each object in a point cloud."""
    points = np.frombuffer(cloud.data, POINT)
    labels, first, count = np.unique(points["label"], return_index=True, return_counts=True)
    stamp = cloud.header.stamp
    print(f"{len(labels)} objects at {stamp.sec}.{stamp.nanosec:09d} in {cloud.header.frame_id}", flush=True)
    for label, start, number in zip(labels, first, count, strict=True):
        x, y, z = np.median(points["xyz"][start : start + number], axis=0)
        print(f"  {label:3d}  {number:6d} points around {x:+.3f} {y:+.3f} {z:.3f} m")


def main() -> None:
    """Print the objects in the given number of point clouds, then stop."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=10, help="clouds to wait for, default: %(default)s")
    given = parser.parse_args()
    rclpy.init()
    node = rclpy.create_node("list_objects")
    received: list[PointCloud2] = []
    node.create_subscription(PointCloud2, "spigolo/cloud", received.append, 5)
    for k in range(given.count):
        while len(received) <= k:
            rclpy.spin_once(node)
        show(received[k])
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
