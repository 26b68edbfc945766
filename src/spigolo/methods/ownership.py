"""Probability that an edge is the border of an object (Mishra et al., 2009 and 2012). The module also computes the
owner of an edge, which is the side of the edge on which the object lies.

The texts of the papers were not available, so constants and costs come from the code published by their authors. In
that code, the mean disparity is computed in a half-disc on each side of an edge, and the probability is a logistic
function of the difference of the two means. In this implementation, a line is fitted to the disparity in each
half-disc, and both lines are compared at the edge. With fitted lines, the slope of a table is not mistaken for a
depth step. If the two fitted lines form a valley, the edge is a contact boundary.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Camera, Color, DepthMap, Mask
from spigolo.kernels import contours
from spigolo.kernels import polar as kernel
from spigolo.methods.baseline import MethodConfig
from spigolo.settings.paper import EdgesConfig
from spigolo.settings.parameters import Length_px, Positive, Share
from spigolo.stages.edges import Gradient, scharr_canny

Floats = npt.NDArray[np.float32]

ORIENTATIONS = 8
NORMALS = np.array([(math.sin(a), math.cos(a)) for a in np.arange(ORIENTATIONS) * (math.pi / ORIENTATIONS)])
"""Unit normals (n_y, n_x) of the eight edge orientations, with y downwards."""
NOMINAL_FOCAL = 0.9
"""Focal length divided by the image width, which is assumed if the intrinsics are unknown."""
NEAR_LINE_WEIGHT = 0.01
"""Weight of pixels close to an edge, where the depth map is blurred. The value is from the code of the method's
authors.
"""
LEAST_WEIGHT = 20.0
"""Minimum total weight of the measured pixels in each half-disc of an edge. If the total weight in one half-disc is
lower, no lines are fitted at this edge. The value is our choice.
"""
LEVELS_PER_PX, SCHARR_UNIT, HIGH_PER_LOW = 10.0, 32.0, 2.0
"""Constants for Canny edges of the disparity map. A disparity of 1 px corresponds to LEVELS_PER_PX grey levels. The
Scharr filter returns SCHARR_UNIT for a slope of 1. The high threshold is HIGH_PER_LOW times the low threshold.
"""


class BoundaryConfig(MethodConfig):
    """Parameters of the boundary probability. Disparities are in pixels. Disparities are computed from depth for a
    virtual stereo pair with the focal length of the camera.

    The noise of triangulating depth cameras is constant in disparity, so that one threshold is valid at all distances.
    Example: the baseline is 0.075 m, and the focal length is 570 px. A disparity step of 0.3 px then corresponds to a
    depth step of 7 mm at a distance of 1 m.
    """

    depth: bool = True
    """Use depth. If false, the boundary value of an edge depends only on colour contrast, and the side on which the
    object lies stays unknown.
    """
    baseline_m: Positive = 0.075
    """Baseline of the virtual stereo pair, in metres. The default is the baseline of a Kinect, which is our
    choice.
    """
    half_disc: Positive = 0.015
    """Radius of the half-discs on both sides of an edge, as a fraction of the image diagonal. The default value is from
    the code of the method's authors.
    """
    near_line: Share = 0.4
    """Distance from an edge, divided by the radius of the half-discs. Pixels closer to the edge have a small weight.
    The default value is from the code of the method's authors.
    """
    steepness: Positive = 10.0
    """Steepness beta_1, in 1/px, of the logistic function that converts a disparity step to a border probability. The
    default value is from the code of the method's authors.
    """
    step_px: Positive = 0.3
    """Disparity step beta_2 in px at which the border probability is 0.5. The default value is from the code of the
    method's authors.
    """
    valley_px: Positive | None = 0.6
    """Depth of a valley at which the contact probability is 1/2, px of disparity. The disparity rises on both sides of
    a valley, and the depth of the valley is the sum of the two rises. Each rise is measured on the fitted line, from
    the edge to the end of the half-disc. With None, no contact boundaries are found.
    """
    texture: Share = 50 / 255
    """Minimum boundary value of every image edge, even without a depth difference. The default value is from the code
    of the method's authors.
    """
    max_shadow_px: Length_px = 60
    """Maximum width, in pixels, of a shadow that is filled with the depth of its farther side. The filling of shadows
    is our addition. With 0, shadows are not filled, as in the published method.
    """
    disparity_slope: Positive = 0.08
    """Minimum gradient of the disparity at an edge of the disparity map, px per px. Edges of the disparity map are
    added to the image edges, which is our addition.
    """


@dataclass(frozen=True, slots=True, eq=False)
class Boundary:
    """Edges of a frame. The owner of an edge is the side on which the object lies.

    - value: (H, W) float32, border probability of edge pixels, 0 elsewhere.
    - strong: mask (H, W) of edge pixels with a border probability above 1/2.
    - normal: (H, W, 2) float32, unit vectors (n_y, n_x) across the edge.
    - side: (H, W) int8, owner of the edge: 1 for the side to which the normal points, -1 for the other side, 0 if the
      owner is unknown.
    """

    value: Floats
    strong: Mask
    normal: Floats
    side: npt.NDArray[np.int8]


def find_boundary(image: Color, depth: DepthMap, camera: Camera | None, config: BoundaryConfig) -> Boundary:
    """Find the edges of an RGB image (H, W, 3) with a depth map (H, W) in metres, and the owner of each edge."""
    canny, gx, gy = scharr_canny(image, EdgesConfig())
    if not config.depth:
        return _by_contrast(canny, gx, gy)
    disparity = _disparity(depth, camera, config)
    steps, sx, sy = _disparity_edges(disparity, config.disparity_slope)
    both = canny | steps
    direction = _orientation(np.where(steps, sx, gx), np.where(steps, sy, gy))
    radius = round(config.half_disc * math.hypot(*depth.shape))
    sides = np.zeros((*depth.shape, 4), np.float32)
    kernel.fit_sides(
        both.view(np.uint8), direction, NORMALS, disparity, radius, config.near_line * radius, NEAR_LINE_WEIGHT,
        LEAST_WEIGHT, sides,
    )  # fmt: skip
    return _by_depth(canny, direction, sides, radius, config)


def _by_depth(
    canny: Mask, direction: npt.NDArray[np.uint8], sides: Floats, radius: int, config: BoundaryConfig
) -> Boundary:
    step = sides[..., 0] - sides[..., 2]
    by_step = _logistic(np.abs(step), config.steepness, config.step_px)
    probability = by_step
    if config.valley_px is not None:
        rise = (sides[..., 1] - sides[..., 3]) * np.float32(radius)  # both slopes are along the normal
        probability = np.maximum(probability, _logistic(rise, config.steepness, config.valley_px))
    probability = np.where(sides[..., 0] > 0, probability, np.float32(0))
    strong = probability > 0.5
    value = np.where(strong, probability, np.float32(0))
    value[canny] = np.maximum(probability[canny], np.float32(config.texture))
    side = np.where(strong & (by_step > 0.5), np.sign(step), 0).astype(np.int8)
    return Boundary(value, strong, NORMALS.astype(np.float32)[direction], side)


def _by_contrast(canny: Mask, gx: Gradient, gy: Gradient) -> Boundary:
    """Return the edges with boundary values from grey-level gradients. A gradient is divided by the 95th percentile of
    the gradients at all edges of the frame.
    """
    size = np.hypot(gx.astype(np.float32), gy.astype(np.float32))
    largest = float(np.percentile(size[canny], 95)) if canny.any() else 1.0
    value = np.where(canny, np.minimum(size / np.float32(largest), 1), np.float32(0))
    normal = NORMALS.astype(np.float32)[_orientation(gx, gy)]
    return Boundary(value, value > 0.5, normal, np.zeros(canny.shape, np.int8))


def _disparity(depth: DepthMap, camera: Camera | None, config: BoundaryConfig) -> Floats:
    """Return the disparity (H, W) in pixels, 0 where missing. Missing depth next to objects (shadows) gets the
    disparity of the background.
    """
    filled = np.empty_like(depth)
    contours.fill_shadows(depth, config.max_shadow_px, filled)
    focal = NOMINAL_FOCAL * depth.shape[1] if camera is None else camera.fx
    there = filled > 0
    return np.divide(np.float32(focal * config.baseline_m), filled, out=np.zeros_like(filled), where=there)


def _disparity_edges(disparity: Floats, slope: float) -> tuple[Mask, Gradient, Gradient]:
    """Return the Canny edges of a disparity map (H, W), and its gradients along x and y."""
    smooth = cv2.GaussianBlur(disparity, (5, 5), 0) * np.float32(LEVELS_PER_PX)
    largest = np.iinfo(np.int16).max
    gx, gy = (
        np.clip(cv2.Scharr(smooth, cv2.CV_32F, *along), -largest, largest).astype(np.int16)
        for along in ((1, 0), (0, 1))
    )
    low = slope * LEVELS_PER_PX * SCHARR_UNIT
    return cv2.Canny(gx, gy, low, HIGH_PER_LOW * low, L2gradient=True) > 0, gx, gy


def _orientation(gx: Gradient, gy: Gradient) -> npt.NDArray[np.uint8]:
    """Return, for each gradient, the index (H, W) of the nearest vector of NORMALS. Gradients in opposite directions
    have the same index.
    """
    angle = np.arctan2(gy.astype(np.float32), gx.astype(np.float32)) * np.float32(ORIENTATIONS / math.pi)
    return (np.rint(angle).astype(np.int32) % ORIENTATIONS).astype(np.uint8)


def _logistic(value: Floats, steepness: float, middle: float) -> Floats:
    exponent = np.clip(np.float32(steepness) * (np.float32(middle) - value), -50, 50)
    return np.asarray(1 / (1 + np.exp(exponent)), np.float32)
