"""Probability that an edge is the border of an object, and the side that owns it, for the methods of Mishra et al.

Their probability is a logistic function of the difference of mean disparities of two half-discs. Here, a line is fitted
to each half-disc and compared at the edge (our reading). So the texture of a slanted table shows no step. If both lines
form a valley there is a contact boundary. Their texts name contact boundaries, but the available parts do not define
them.
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
"""Normals (n_y, n_x) of the orientations that edges are rounded to. Rows are counted downwards."""
NOMINAL_FOCAL = 0.9
"""Focal length as a share of the image width where the camera is not known."""
NEAR_LINE_WEIGHT = 0.01
"""Weight of pixels next to the edge line, whose depth is smeared (their released code)."""
LEAST_WEIGHT = 20.0
"""A half-disc with fewer measured pixels says nothing (our choice)."""
LEVELS_PER_PX, SCHARR_UNIT, HIGH_PER_LOW = 10.0, 32.0, 2.0
"""Steps per pixel of disparity for Canny, the response of the Scharr mask to a slope of 1, and the ratio of Canny's
thresholds.
"""


class BoundaryConfig(MethodConfig):
    """Parameters of the boundary probability. Disparities are pixels of a stereo pair with the camera's focal length.

    Disparity grows with nearness as the depth noise of triangulating sensors does, so that one threshold holds at all
    distances: 0.3 px are 7 mm at 1 m.
    """

    depth: bool = True
    """False weighs edges by their colour contrast alone and knows no owner: what depth is worth."""
    baseline_m: Positive = 0.075
    """Baseline of the stereo pair that depth is expressed for, a Kinect's (our choice)."""
    half_disc: Positive = 0.015
    """Radius of the half-discs as a share of the image diagonal (their released code)."""
    near_line: Share = 0.4
    """Pixels nearer to the edge line than this share of the radius hardly count (their released code)."""
    steepness: Positive = 10.0
    """beta_1 of the logistic function, 1/px (their released code)."""
    step_px: Positive = 0.3
    """beta_2: the disparity step that is a border with probability 1/2 (their released code)."""
    valley_px: Positive | None = 0.6
    """The same for the depth of a valley: what both lines rise by over the radius, together. None: no contact."""
    texture: Share = 50 / 255
    """Least value of every edge, also where depth shows nothing (their released code)."""
    max_shadow_px: Length_px = 60
    """Widest shadow that takes the depth of its farther side, as in `DepthContours`."""
    disparity_slope: Positive = 0.08
    """Least disparity gradient, in px per px, of an edge of the disparity map, where colour shows none (our choice)."""


@dataclass(frozen=True, slots=True, eq=False)
class Boundary:
    """Edges and their owners, all (H, W).

    value: float32 in [0, 1], the probability at edge pixels, else 0. strong: edges that are borders with a probability
    above one half. normal: (H, W, 2) float32, unit vectors (n_y, n_x) across the edge. side: int8. It is 1 if the side
    that the normal points to owns the edge because it is nearer, and -1 if the other one does. It is 0 if no side is
    known to own it: at contact boundaries, and without depth.
    """

    value: Floats
    strong: Mask
    normal: Floats
    side: npt.NDArray[np.int8]


def find_boundary(image: Color, depth: DepthMap, camera: Camera | None, config: BoundaryConfig) -> Boundary:
    """The boundary map of an image (H, W, 3) with its depth (H, W) in metres."""
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
        rise = (sides[..., 1] - sides[..., 3]) * np.float32(radius)  # slopes are along the normal, on both sides
        probability = np.maximum(probability, _logistic(rise, config.steepness, config.valley_px))
    probability = np.where(sides[..., 0] > 0, probability, np.float32(0))
    strong = probability > 0.5
    value = np.where(strong, probability, np.float32(0))
    value[canny] = np.maximum(probability[canny], np.float32(config.texture))
    side = np.where(strong & (by_step > 0.5), np.sign(step), 0).astype(np.int8)
    return Boundary(value, strong, NORMALS.astype(np.float32)[direction], side)


def _by_contrast(canny: Mask, gx: Gradient, gy: Gradient) -> Boundary:
    """Edges by their gradient alone, as a share of the 95th percentile of the frame's edges."""
    size = np.hypot(gx.astype(np.float32), gy.astype(np.float32))
    largest = float(np.percentile(size[canny], 95)) if canny.any() else 1.0
    value = np.where(canny, np.minimum(size / np.float32(largest), 1), np.float32(0))
    normal = NORMALS.astype(np.float32)[_orientation(gx, gy)]
    return Boundary(value, value > 0.5, normal, np.zeros(canny.shape, np.int8))


def _disparity(depth: DepthMap, camera: Camera | None, config: BoundaryConfig) -> Floats:
    """Return disparity (H, W) in pixels, 0 if missing. Shadows get the disparity of the background."""
    filled = np.empty_like(depth)
    contours.fill_shadows(depth, config.max_shadow_px, filled)
    focal = NOMINAL_FOCAL * depth.shape[1] if camera is None else camera.fx
    there = filled > 0
    return np.divide(np.float32(focal * config.baseline_m), filled, out=np.zeros_like(filled), where=there)


def _disparity_edges(disparity: Floats, slope: float) -> tuple[Mask, Gradient, Gradient]:
    """Edges of a disparity map (H, W) and the gradients along x and y that they were found on."""
    smooth = cv2.GaussianBlur(disparity, (5, 5), 0) * np.float32(LEVELS_PER_PX)
    largest = np.iinfo(np.int16).max
    gx, gy = (
        np.clip(cv2.Scharr(smooth, cv2.CV_32F, *along), -largest, largest).astype(np.int16)
        for along in ((1, 0), (0, 1))
    )
    low = slope * LEVELS_PER_PX * SCHARR_UNIT
    return cv2.Canny(gx, gy, low, HIGH_PER_LOW * low, L2gradient=True) > 0, gx, gy


def _orientation(gx: Gradient, gy: Gradient) -> npt.NDArray[np.uint8]:
    """Row of NORMALS that is nearest to each gradient, whatever its polarity."""
    angle = np.arctan2(gy.astype(np.float32), gx.astype(np.float32)) * np.float32(ORIENTATIONS / math.pi)
    return (np.rint(angle).astype(np.int32) % ORIENTATIONS).astype(np.uint8)


def _logistic(value: Floats, steepness: float, middle: float) -> Floats:
    exponent = np.clip(np.float32(steepness) * (np.float32(middle) - value), -50, 50)
    return np.asarray(1 / (1 + np.exp(exponent)), np.float32)
