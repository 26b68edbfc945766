"""Check that planes in the scene are flat, and that one plane faces up. Planes look curved if the depth map contains
distances along the rays, or raw disparity, instead of Z coordinates.
"""

from __future__ import annotations

import numpy as np

from spigolo.additions.support import find_support
from spigolo.doctor.findings import Finding, fine, note, warning
from spigolo.frames.frame import Camera, DepthMap
from spigolo.settings.presets import OBJECTS
from spigolo.settings.support import Support

PLANARITY, SUPPORT = "depth along Z", "support plane"

NEAR_M, NEAR_PER_M = 0.004, 0.003
"""A pixel lies on a plane if its point is at most max(NEAR_M, NEAR_PER_M * depth^2) metres from the plane."""
DOWN = 0.5
"""A plane faces down, and gives a warning, if the Y component of its normal is larger than this value. A plane that
faces sideways may be a wall and gives a note.
"""
MORE = 1.15
"""Limit for a warning that depth is the distance along the ray. The warning is given if the largest plane has more than
`MORE` times as many pixels with depth read as distance as with depth read as Z.
"""
MORE_RAW, MIN_RAW = 1.5, 0.3
"""Limits for a warning that depth is raw disparity. MORE_RAW: factor by which the largest plane must have more pixels
with depth read as disparity than with depth read as Z. MIN_RAW: minimum share of the measured pixels that lie on the
largest plane if depth is read as disparity.
"""
MIN_SHARE = 0.12
"""Minimum share of the measured pixels that lie on the largest plane. If fewer pixels lie on the plane, the frame has
no large plane, and the check cannot judge the depth.
"""
RAW_KINECT = (-0.0030711016, 3.3309495161)
"""Slope and offset of the linear function that converts the raw disparity of a Kinect v1 to inverse depth in 1/m."""
LARGEST_RAW_M = 2.047
"""Largest raw disparity of a Kinect v1. The largest raw disparity is 2047, and reads as 2.047 m if disparity is
mistaken for millimetres.
"""


def check_planarity(filled: DepthMap, camera: Camera) -> Finding:
    """Check if depth is really the distance along the ray, or the raw disparity of a Kinect v1. Planes in such a depth
    map become flat only after depth is converted to Z coordinates.

    filled: depth map (H, W) in metres, in which small gaps are in-painted.
    """
    as_z = _on_plane(filled, camera)
    as_ray = _on_plane(along_z(filled, camera), camera)
    as_raw = _as_raw(filled, camera)
    if max(as_z, as_ray, as_raw) < MIN_SHARE:
        return note(PLANARITY, "depth along Z cannot be judged: the frame has no large plane", judged=False)
    if as_ray > MORE * as_z and as_ray >= as_raw:
        return warning(
            PLANARITY,
            f"expected depth as the Z coordinate, found that planes are flat if depth is the distance along the ray"
            f" ({as_ray:.0%} of the pixels on one plane, as Z {as_z:.0%}): multiply depth by the cosine of the angle"
            " to the optical axis",
        )
    if as_raw > MORE_RAW * as_z and as_raw >= MIN_RAW:
        return warning(
            PLANARITY,
            f"expected depth in metres, found that planes are flat if depth is disparity ({as_raw:.0%} of the pixels on"
            f" one plane, as metres {as_z:.0%}): for raw values of a Kinect v1, store 1 / (3.331 - 0.00307 * raw)"
            " metres, and for the disparity of a stereo camera, fx * baseline / disparity",
        )
    return fine(PLANARITY, f"the largest plane is flat: {as_z:.0%} of the pixels lie on it")


def check_support(depth: DepthMap, camera: Camera) -> Finding:
    """Check that a plane on which objects can stand is found, and that the camera is not mounted on its side or upside
    down.

    depth: measured depth map (H, W) in metres.
    """
    ours = OBJECTS.additions
    assert ours is not None and ours.support is not None
    reach_m = OBJECTS.rejection.max_distance_m
    if find_support(depth, camera, ours.support, reach_m) is not None:
        return fine(SUPPORT, "a support plane is found")
    plane = find_support(depth, camera, ours.support.model_copy(update={"facing": None}), reach_m)
    if plane is None:
        return note(
            SUPPORT, f"no support plane is found within {reach_m:g} m: the table or floor may be returned as an object"
        )
    up = ",".join(f"{value:.2f}" for value in plane.normal)
    sentence = (
        f"expected a plane that faces up in the image, found only a plane with the normal {up}: if the camera is"
        " mounted upside down or on its side, set additions.support.facing.up to this normal"
    )
    return (warning if plane.normal[1] > DOWN else note)(SUPPORT, sentence)


def along_z(distance: DepthMap, camera: Camera) -> DepthMap:
    """Convert distances along the ray (H, W) to Z coordinates (H, W), in metres."""
    y, x = np.ogrid[: distance.shape[0], : distance.shape[1]]
    lengths = np.sqrt(1 + ((x - camera.cx) / camera.fx) ** 2 + ((y - camera.cy) / camera.fy) ** 2)
    return np.asarray(distance / lengths, np.float32)


def from_raw_disparity(depth: DepthMap) -> DepthMap:
    """Convert raw disparity of a Kinect v1, which was read as millimetres, to Z coordinates (H, W), in metres. Invalid
    disparities give 0.
    """
    slope, offset = RAW_KINECT
    inverse = slope * 1000 * depth + offset
    return np.where((depth > 0) & (inverse > 0.1), 1 / np.maximum(inverse, 0.1), 0).astype(np.float32)


def _as_raw(depth: DepthMap, camera: Camera) -> float:
    """Return the share of the measured pixels on the largest plane if depth is read as raw disparity."""
    if not 0 < depth.max() <= LARGEST_RAW_M:
        return 0.0
    converted = from_raw_disparity(depth)
    return _on_plane(converted, camera) * float((converted > 0).sum() / (depth > 0).sum())


def _on_plane(depth: DepthMap, camera: Camera) -> float:
    """Return the share of the measured pixels on the largest plane."""
    valid = depth > 0
    plane = find_support(depth, camera, Support()) if valid.any() else None
    if plane is None:
        return 0.0
    height = np.abs(plane.height_map_m(depth, camera))
    near = np.maximum(NEAR_M, NEAR_PER_M * depth * depth)
    return float((valid & (height <= near)).sum() / valid.sum())
