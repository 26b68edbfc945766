"""Probability that an edge is the border of an object, and the side that owns it, for the methods of Mishra et al.

Their probability is a logistic function of the difference in mean disparity between two half-discs. In our
implementation, a line is fitted to each half-disc, and both lines are compared at the edge (our reading). The slope of
a table is then not a step. If both lines form a valley, the edge is a contact boundary. Their texts name contact
boundaries, but the available parts do not define them.
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
"""Normals (n_y, n_x) of the quantised edge orientations. y points downwards."""
NOMINAL_FOCAL = 0.9
"""Assumed focal length as a share of the image width if the camera is not known."""
NEAR_LINE_WEIGHT = 0.01
"""Weight of pixels next to the edge line, where depth is smeared (their released code)."""
LEAST_WEIGHT = 20.0
"""Minimum weight of measured pixels in a valid half-disc (our choice)."""
LEVELS_PER_PX, SCHARR_UNIT, HIGH_PER_LOW = 10.0, 32.0, 2.0
"""Levels per pixel of disparity for Canny, response of the Scharr filter to a slope of 1, and ratio of Canny's
thresholds.
"""


class BoundaryConfig(MethodConfig):
    """Parameters of the boundary probability. Disparities are in pixels of a stereo pair with the camera's focal
    length.

    The depth noise of triangulating sensors is constant in disparity, so one threshold is valid at all distances: 0.3
    px are 7 mm at 1 m.
    """

    depth: bool = True
    """Use depth. If false, edges are weighted only by colour contrast and have no owner, to measure the benefit of
    depth.
    """
    baseline_m: Positive = 0.075
    """Baseline of the virtual stereo pair, m. The default is that of a Kinect (our choice)."""
    half_disc: Positive = 0.015
    """Radius of the half-discs as a share of the image diagonal (their released code)."""
    near_line: Share = 0.4
    """Distance from the edge line, as a share of the radius, below which pixels have a small weight (their released
    code).
    """
    steepness: Positive = 10.0
    """Steepness beta_1 of the logistic function, 1/px (their released code)."""
    step_px: Positive = 0.3
    """Disparity step beta_2 at which the border probability is 1/2, px (their released code)."""
    valley_px: Positive | None = 0.6
    """Depth of a valley at which the contact probability is 1/2, px: the sum of the rise of both lines over the radius.
    None: no contact boundaries.
    """
    texture: Share = 50 / 255
    """Minimum value of every edge, also without a depth difference (their released code)."""
    max_shadow_px: Length_px = 60
    """Maximum width of a shadow that gets the depth of its farther side, px, as in `DepthContours`."""
    disparity_slope: Positive = 0.08
    """Minimum disparity gradient of an edge in the disparity map, px per px. Such edges are added to the colour edges
    (our choice).
    """


@dataclass(frozen=True, slots=True, eq=False)
class Boundary:
    """Edges and their owners, all (H, W).

    value: float32 in [0, 1], the probability at edge pixels, else 0. strong: edges with a border probability above 1/2.
    normal: (H, W, 2) float32, unit vectors (n_y, n_x) across the edge. side: int8, the owner of the edge, which is the
    nearer side: 1 for the side that the normal points to, -1 for the other side, and 0 if the owner is not known
    (contact boundaries, no depth).
    """

    value: Floats
    strong: Mask
    normal: Floats
    side: npt.NDArray[np.int8]


def find_boundary(image: Color, depth: DepthMap, camera: Camera | None, config: BoundaryConfig) -> Boundary:
    """Return the boundary map of an image (H, W, 3) with depth (H, W) in metres."""
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
    """Return edges weighted only by their gradient, as a share of the 95th percentile of the frame's edges."""
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
    """Return the edges of a disparity map (H, W), and the gradients along x and y from which they were computed."""
    smooth = cv2.GaussianBlur(disparity, (5, 5), 0) * np.float32(LEVELS_PER_PX)
    largest = np.iinfo(np.int16).max
    gx, gy = (
        np.clip(cv2.Scharr(smooth, cv2.CV_32F, *along), -largest, largest).astype(np.int16)
        for along in ((1, 0), (0, 1))
    )
    low = slope * LEVELS_PER_PX * SCHARR_UNIT
    return cv2.Canny(gx, gy, low, HIGH_PER_LOW * low, L2gradient=True) > 0, gx, gy


def _orientation(gx: Gradient, gy: Gradient) -> npt.NDArray[np.uint8]:
    """Return the index in NORMALS that is nearest to each gradient, regardless of its sign."""
    angle = np.arctan2(gy.astype(np.float32), gx.astype(np.float32)) * np.float32(ORIENTATIONS / math.pi)
    return (np.rint(angle).astype(np.int32) % ORIENTATIONS).astype(np.uint8)


def _logistic(value: Floats, steepness: float, middle: float) -> Floats:
    exponent = np.clip(np.float32(steepness) * (np.float32(middle) - value), -50, 50)
    return np.asarray(1 / (1 + np.exp(exponent)), np.float32)
