"""Start spigolo for a RealSense camera: ros2 launch examples/ros2/spigolo.launch.py camera:=/camera/camera."""

from __future__ import annotations

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.substitutions import LaunchConfiguration


def generate_launch_description() -> LaunchDescription:
    """Run `spigolo ros` on the topics of a camera. The driver must align depth to colour (align_depth.enable:=true)."""
    camera, preset = LaunchConfiguration("camera"), LaunchConfiguration("preset")
    command = [
        "spigolo",
        "ros",
        *("--preset", preset),
        *("--color", [camera, "/color/image_raw"]),
        *("--depth", [camera, "/aligned_depth_to_color/image_raw"]),
        *("--camera-info", [camera, "/color/camera_info"]),
    ]
    return LaunchDescription(
        [
            DeclareLaunchArgument("camera", default_value="/camera/camera", description="Namespace of the camera."),
            DeclareLaunchArgument("preset", default_value="OBJECTS", description="Preset or TOML file."),
            ExecuteProcess(cmd=command, output="screen"),
        ]
    )
