"""Check that the intrinsics are plausible for the camera of a frame.

With a wrong focal length, planes stay planar, but the angles between planes change. Most objects on a table have
upright sides. The check therefore tries many focal lengths and selects the focal length with which most surfaces are
upright.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from spigolo.additions.plane import Plane, support_mask
from spigolo.additions.support import find_support
from spigolo.doctor.findings import INTRINSICS, Finding, fine, note, warning
from spigolo.doctor.local_planes import LocalPlanes, fit_local_planes
from spigolo.frames.frame import Camera, DepthMap
from spigolo.settings.support import Support

FOCAL_LENGTH = "focal length"

MAX_ASPECT = 0.05
MUCH_OFF, SWAPPED = 0.05, 0.25
"""Conditions for swapped cx and cy. MUCH_OFF: minimum distance of the principal point from the image centre, as a share
of the image width. SWAPPED: maximum of this distance with swapped cx and cy, divided by the distance as given.
"""
USUAL_SHARE = (0.7, 1.15)
"""Minimum and maximum of focal length / image width for most RGB-D cameras. Examples of this quotient: Kinect v1 and
Xtion 0.82 to 0.9, RealSense D415, D435 and SR300 0.96 (4:3) and 0.72 (16:9), Zivid 0.92.
"""
KNOWN_WIDE = (
    (16 / 9, 0.473, "Azure Kinect"),
    (16 / 9, 0.50, "RealSense D455 or depth of D435"),
    (16 / 10, 0.50, "RealSense D455 or depth of D435"),
    (16 / 9, 0.563, "Kinect v2"),
    (4 / 3, 0.60, "RealSense D405, D455 or depth of D435"),
    (16 / 9, 0.585, "Orbbec Femto Bolt"),
)
"""Cameras whose focal length is outside of `USUAL_SHARE`. Each tuple contains image width / height, focal length /
image width, and the names of the cameras.
"""
KNOWN_WITHIN = 0.03
POSSIBLE_SHARE = (0.42, 1.3)
"""Minimum and maximum of focal length / image width for all RGB-D cameras. An estimated focal length is ignored if the
quotient is outside of these limits.
"""

TRIED = np.exp(np.linspace(np.log(0.4), np.log(2.5), 45))
"""Factors by which the given focal length is multiplied in the search for the best focal length."""
RIGHT_WITHIN = 1.25
"""The given focal length is accepted if it differs from the estimated focal length by at most this factor, in either
direction. The estimated focal length is inaccurate because some surfaces are slightly slanted.
"""
MIN_TILT_DEG = 20.0
"""Minimum angle between the viewing direction and the normal of the support plane, in degrees. At smaller angles the
camera looks straight down, and upright sides look upright with any focal length.
"""
UPRIGHT_COS = 0.07
"""A surface is upright if the absolute cosine of the angle between its normal and the normal of the support plane is at
most this value. The value 0.07 allows surfaces that are tilted by up to 4 degrees.
"""
MIN_UPRIGHT = 0.05
"""Minimum share of upright surfaces among the sampled surfaces, counted with the best factor of `TRIED`. With fewer
upright surfaces, the focal length cannot be judged.
"""
CLEAR = 2.0
"""One focal length is clearly better than another if it makes at least `CLEAR` times as many surfaces upright."""
SURFACES, MIN_SURFACES, SEED = 15000, 2000, 7
FLAT_M, FLAT_PER_M = 0.002, 0.003
"""A surface is smooth if its depth differs from a local plane by at most max(FLAT_M, FLAT_PER_M * depth^2) metres."""

Points = npt.NDArray[np.float64]


def check_intrinsics(camera: Camera) -> Finding:
    """Check that the principal point is near the image centre and that pixels are square."""
    x, y = camera.cx / camera.width, camera.cy / camera.height
    off = np.hypot(camera.cx - camera.width / 2, camera.cy - camera.height / 2)
    off_if_swapped = np.hypot(camera.cy - camera.width / 2, camera.cx - camera.height / 2)
    if off > MUCH_OFF * camera.width and off_if_swapped < SWAPPED * off:
        return warning(
            INTRINSICS,
            f"expected the principal point near the middle of {camera.width}x{camera.height}, found cx {camera.cx:.0f}"
            f" and cy {camera.cy:.0f}: swap cx and cy, and fx and fy",
        )
    if not (1 / 3 <= x <= 2 / 3 and 1 / 3 <= y <= 2 / 3):
        return warning(
            INTRINSICS,
            f"expected the principal point in the middle third of {camera.width}x{camera.height}, found"
            f" ({camera.cx:.0f}, {camera.cy:.0f}): unless the image is cropped, use the intrinsics of this image size",
        )
    if abs(camera.fx / camera.fy - 1) > MAX_ASPECT:
        return warning(
            INTRINSICS,
            f"expected fx and fy within {MAX_ASPECT:.0%} of each other, found {camera.fx:.0f} and {camera.fy:.0f}:"
            " unless the image was stretched, use the intrinsics of this image size",
        )
    return fine(INTRINSICS, "principal point near the middle, square pixels")


def check_focal_length(filled: DepthMap, camera: Camera) -> Finding:
    """Check the focal length by the right angles between the support plane and the sides of objects. If the scene has
    too few right angles, compare the focal length with those of known cameras.

    filled: depth map (H, W) in metres, in which small gaps are in-painted.
    """
    share, view_deg = camera.fx / camera.width, float(np.degrees(2 * np.arctan(camera.width / (2 * camera.fx))))
    stated = f"fx {camera.fx:.0f} px, field of view {view_deg:.0f} degrees"
    factor = upright_factor(filled, camera)
    wrong = factor is not None and abs(np.log(factor)) > np.log(RIGHT_WITHIN)
    if factor is not None and wrong and not POSSIBLE_SHARE[0] <= share * factor <= POSSIBLE_SHARE[1]:
        factor = None  # no camera has this focal length: the surfaces are slanted, such as the walls of a bin
    if factor is not None and wrong:
        return warning(
            FOCAL_LENGTH,
            f"expected upright sides of objects at right angles to the support, found right angles with about"
            f" {factor:.2f} times the given focal length ({stated}): use the intrinsics of the stream that depth is"
            " aligned to, at this image size",
        )
    if factor is not None:
        return fine(FOCAL_LENGTH, f"{stated}: upright sides of objects are at right angles to the support")
    if USUAL_SHARE[0] <= share <= USUAL_SHARE[1]:
        return fine(FOCAL_LENGTH, f"{stated}: usual for RGB-D cameras")
    known = [name for aspect, of_width, name in KNOWN_WIDE if _is_known(camera, aspect, of_width)]
    if known:
        return note(FOCAL_LENGTH, f"{stated}: unusual, but correct for {' or '.join(known)}")
    return warning(
        FOCAL_LENGTH,
        f"expected a focal length of {USUAL_SHARE[0]} to {USUAL_SHARE[1]} image widths, found {share:.2f} ({stated}):"
        " use the intrinsics of the stream that depth is aligned to, at this image size",
    )


def upright_factor(filled: DepthMap, camera: Camera) -> float | None:
    """Return the factor by which the focal length must be multiplied so that most surfaces are upright.

    The factor is 1 if focal lengths near the given focal length make at least `CLEAR` times as many surfaces upright as
    very different focal lengths.

    Returns None if the scene has no support plane, is seen straight from above, or has too few upright surfaces. Also
    returns None if very different focal lengths make similar numbers of surfaces upright.
    """
    support = find_support(filled, camera, Support())
    if support is None or np.degrees(np.arccos(min(abs(support.normal[2]), 1.0))) < MIN_TILT_DEG:
        return None
    normals = _normals_beside(support, filled, camera)
    if len(normals) < MIN_SURFACES:
        return None
    upright = count_upright(normals, support.normal)
    off = np.abs(np.log(TRIED))
    best, given = upright.max(), upright[off <= np.log(RIGHT_WITHIN)].max()
    if best < MIN_UPRIGHT * len(normals):
        return None
    if best >= CLEAR * given:
        return float(TRIED[upright.argmax()])
    others = upright[off > 2 * np.log(RIGHT_WITHIN)].max()
    return 1.0 if given >= CLEAR * others else None


def count_upright(normals: Points, support: Points) -> npt.NDArray[np.intp]:
    """For each factor in `TRIED`, count the normals (N, 3) that are perpendicular to the normal (3,) of the support
    plane.

    If the focal length is multiplied by t, the normal (a, b, c) of a plane becomes (t a, t b, c).
    """
    level = normals[:, :2] @ support[:2]
    inward = normals[:, 2] * support[2]
    flat2, deep2 = (normals[:, :2] ** 2).sum(1), normals[:, 2] ** 2
    t2 = (TRIED**2)[:, None]
    length2 = (t2 * flat2 + deep2) * (t2 * (support[:2] ** 2).sum() + support[2] ** 2)
    return np.asarray(((t2 * level + inward) ** 2 < UPRIGHT_COS**2 * length2).sum(1))


def _normals_beside(support: Plane, filled: DepthMap, camera: Camera) -> Points:
    """Return the normals (N, 3) of a sample of smooth surfaces that are not on the support plane."""
    planes = fit_local_planes(filled)
    smooth = _is_smooth(planes, filled) & ~support_mask(support, filled, camera, Support())
    y, x = np.nonzero(smooth)
    chosen = np.random.default_rng(SEED).permutation(len(y))[:SURFACES]
    return planes.normals(y[chosen], x[chosen], camera)


def _is_smooth(planes: LocalPlanes, depth: DepthMap) -> npt.NDArray[np.bool_]:
    off_m = planes.residual * depth * depth
    return np.asarray(planes.whole & (off_m < np.maximum(FLAT_M, FLAT_PER_M * depth * depth)))


def _is_known(camera: Camera, aspect: float, of_width: float) -> bool:
    same_shape = abs(camera.width / camera.height / aspect - 1) < KNOWN_WITHIN
    return same_shape and abs(camera.fx / camera.width / of_width - 1) < KNOWN_WITHIN
