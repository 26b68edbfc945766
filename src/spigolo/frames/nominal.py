"""Nominal intrinsics of common camera models, and the sources of these values.

The intrinsics of an individual camera differ from nominal intrinsics by one or two per cent. Use nominal intrinsics for
a first test, and calibrate the camera for accurate positions.
"""

from __future__ import annotations

Mode = tuple[float, float, float, float, int, int]

NOMINAL: dict[str, tuple[Mode, ...]] = {
    "kinect-v1": ((525.0, 525.0, 319.5, 239.5, 640, 480),),
    "kinect-v2": ((1081.4, 1081.4, 959.5, 539.5, 1920, 1080),),
    "xtion": ((570.3, 570.3, 319.5, 239.5, 640, 480),),
    "orbbec-astra": ((570.3, 570.3, 319.5, 239.5, 640, 480),),
    "realsense-d405": ((643.0, 643.0, 639.5, 359.5, 1280, 720), (386.0, 386.0, 319.5, 239.5, 640, 480)),
    "realsense-d415": ((615.0, 615.0, 319.5, 239.5, 640, 480), (922.5, 922.5, 639.5, 359.5, 1280, 720)),
    "realsense-d435": ((615.0, 615.0, 319.5, 239.5, 640, 480), (922.5, 922.5, 639.5, 359.5, 1280, 720)),
    "realsense-d455": ((640.0, 640.0, 639.5, 359.5, 1280, 720), (384.0, 384.0, 319.5, 239.5, 640, 480)),
    "realsense-l515": ((914.0, 914.0, 639.5, 359.5, 1280, 720),),
    "azure-kinect": ((605.0, 605.0, 639.5, 359.5, 1280, 720), (968.0, 968.0, 1023.5, 767.5, 2048, 1536)),
    "femto-bolt": ((749.0, 749.0, 639.5, 359.5, 1280, 720),),
    "oak-d": ((1475.0, 1475.0, 959.5, 539.5, 1920, 1080), (465.7, 465.7, 319.5, 239.5, 640, 480)),
}
"""Intrinsics (fx, fy, cx, cy, width, height) in pixels of each camera model, one tuple for each aspect ratio of its
colour image. The intrinsics for the default aspect ratio come first.
"""

SOURCES = {
    "kinect-v1": "default of OpenNI and of the TUM RGB-D benchmark",
    "kinect-v2": "default of libfreenect2",
    "xtion": "default of OpenNI for PrimeSense; UW RGB-D Scenes",
    "orbbec-astra": "default of OpenNI for PrimeSense",
    "realsense-d405": "426.6 px at 848x480 as reported in realsense-ros#3289; 4:3 is the same imager cropped",
    "realsense-d415": "data sheet, 69 degrees at 16:9; 925.8 px at 1280x720 as reported in librealsense#5658",
    "realsense-d435": "data sheet, 69 degrees at 16:9; 612.4 px at 640x480 as reported in librealsense#4050",
    "realsense-d455": "data sheet, 90 degrees at 16:9; 4:3 is the same imager cropped",
    "realsense-l515": "data sheet, 70 degrees at 16:9",
    "azure-kinect": "data sheet, 90 degrees, and the 605 px at 1280x720 of calibrated cameras",
    "femto-bolt": "373.9 px at 640x360 as reported in OrbbecSDK#56",
    "oak-d": "data sheet, 69 degrees of all 4056 columns; 16:9 uses 3840 of them",
}
"""Source of the nominal intrinsics of each camera model."""
