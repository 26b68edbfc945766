"""Mishra et al., 2009, *Active Segmentation With Fixation*: segmentation of the object around a given point.

The boundary map is transformed to polar coordinates around the point. In these coordinates, the contours of small and
large objects have equal lengths. The contour of the object is the closed path of lowest cost in the polar map.

Costs follow the code published by the authors of the method, because the text of the paper was not available. In this
implementation, two details differ from the authors' code. The contour crosses each ray only once, so that dynamic
programming replaces a minimum cut. The polar map is computed from a boundary map with widened edges.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Frame, Mask, check_frame
from spigolo.frames.roi import pixel_of
from spigolo.kernels import polar as kernel
from spigolo.methods.baseline import Baseline, Division
from spigolo.methods.ownership import Boundary, BoundaryConfig, Floats, find_boundary
from spigolo.objects.segmentation import ObjectMask
from spigolo.settings.parameters import NotNegative, Positive, Share
from spigolo.stages.regions import Regions

Points = npt.NDArray[np.float64]

RAYS = 360
"""Number of rays of the polar map, one for each degree. The value is from the code of the method's authors."""
LEAST_RADIUS_PX = 4
"""Minimum distance between a contour and the given point inside the contour, in pixels."""


class FixationConfig(BoundaryConfig):
    """Parameters of the method `mishra2009`."""

    blur_px: Positive = 1.0
    """Standard deviation of the Gaussian that widens edges before the polar transform, in pixels."""
    frame_edge: Share = 20 / 255
    """Minimum boundary value at the image border, from 0 to 1. Larger values let contours follow the image border at a
    lower cost. The default value is from the code of the method's authors.
    """
    weakest: Share = 5 / 255
    """Minimum boundary value of an edge, from 0 to 1. Contour points with a smaller boundary value have the cost
    `gap_cost`. The default value is from the code of the method's authors.
    """
    gap_cost: NotNegative = 50.0
    """Cost of a contour point without an edge. Larger values lead to fewer contour points without an edge. The default
    value is from the code of the method's authors.
    """
    sharpness: NotNegative = 5.0
    """Factor in the cost of a contour point on an edge. The cost is exp(-sharpness p), where p is the boundary value of
    the edge. Larger values make strong edges cheaper. The default is that of a public re-implementation. The authors'
    code uses the value 20.
    """


def segment_around(frame: Frame, point: tuple[float, float], config: FixationConfig | None = None) -> ObjectMask:
    """Segment the object around a pixel (y, x) by the method `mishra2009`.

    The region around the pixel is returned even if a rule rejects it. Raises IndexError if the pixel lies outside the
    image.
    """
    check_frame(frame)
    pixel = pixel_of(point, frame.shape)
    return _Around(config or FixationConfig(), pixel)(frame).object_at(pixel)


@dataclass(frozen=True)
class _Around(Baseline[FixationConfig]):
    """Method that divides a frame into two regions: the object around a point, and the rest of the frame."""

    name = "mishra2009"
    point: tuple[int, int]

    def divide(self, frame: Frame) -> Division:
        """Return two regions: the object around the point, and the rest of the frame."""
        boundary = find_boundary(frame.color, frame.depth, frame.camera, self.config)
        contour = contour_around(edge_map(boundary, self.config), self.point, self.config)
        return Division(paint([inside(contour, frame.shape)], frame.shape), boundary.value)


def edge_map(boundary: Boundary, config: FixationConfig) -> Floats:
    """Return the boundary map (H, W) from 0 to 1 with widened edges, where the image border counts as an edge."""
    # the factor gain makes sure that smoothing keeps the boundary value of a straight line
    gain = np.float32(math.sqrt(2 * math.pi) * config.blur_px)
    edges = np.minimum(cv2.GaussianBlur(boundary.value, (0, 0), config.blur_px) * gain, np.float32(1))
    for border in (edges[0], edges[-1], edges[:, 0], edges[:, -1]):
        np.maximum(border, np.float32(config.frame_edge), out=border)
    return np.asarray(edges, np.float32)


def contour_around(edges: Floats, point: tuple[int, int], config: FixationConfig) -> Points:
    """Return the closed contour of lowest cost around a pixel (y, x), as one point (y, x) on each of 360 rays.

    edges: boundary map (H, W) of `edge_map`.
    """
    height, width = edges.shape
    y, x = point
    reach = math.ceil(math.hypot(max(y, height - 1 - y), max(x, width - 1 - x))) + 1
    reach = max(reach, LEAST_RADIUS_PX + 1)
    how = cv2.INTER_LINEAR | cv2.WARP_POLAR_LINEAR | cv2.WARP_FILL_OUTLIERS
    polar = np.asarray(cv2.warpPolar(edges, (reach, RAYS), (float(x), float(y)), float(reach), how), np.float32)
    inwards, onwards = np.roll(polar, 1, axis=1), np.roll(polar, -1, axis=0)
    radius = np.empty(RAYS, np.int32)
    radial, angular = _cost(polar, inwards, config), _cost(polar, onwards, config)
    kernel.closed_path(radial, angular, LEAST_RADIUS_PX, reach - 1, radius)
    angle = np.arange(RAYS) * (2 * math.pi / RAYS)
    return np.stack([y + (radius - 0.5) * np.sin(angle), x + (radius - 0.5) * np.cos(angle)], axis=1)


def _cost(a: Floats, b: Floats, config: FixationConfig) -> Floats:
    """Return the cost of a contour that passes between two neighbouring pixels with the boundary values a and b."""
    edge = np.float32(0.5) * (a + b)
    cost = np.exp(np.float32(-config.sharpness) * edge)
    cost[edge < config.weakest] = config.gap_cost
    return np.asarray(cost, np.float32)


def inside(contour: Points, shape: tuple[int, int]) -> Mask:
    """Return the mask (H, W) of the pixels on and inside a contour of points (y, x)."""
    mask = np.zeros(shape, np.uint8)
    cv2.fillPoly(mask, [np.rint(contour[:, ::-1]).astype(np.int32)], 1)
    return mask.view(bool)


def innermost(mask: Mask) -> tuple[int, int]:
    """Return the pixel (y, x) inside a mask (H, W) that is farthest from the outline of the mask."""
    depth = cv2.distanceTransform(np.pad(mask, 1).view(np.uint8), cv2.DIST_L2, 5)[1:-1, 1:-1]
    y, x = np.unravel_index(int(depth.argmax()), mask.shape)
    return int(y), int(x)


def paint(masks: list[Mask], shape: tuple[int, int]) -> Regions:
    """Return one region for each mask (H, W), and one region for all other pixels.

    A pixel in several masks belongs to the last of these masks. Regions are numbered in the order of their first
    pixels.
    """
    labels = np.zeros(shape, np.int32)
    for k, mask in enumerate(masks, start=1):
        labels[mask] = k
    values, first = np.unique(labels, return_index=True)
    number = np.zeros(len(masks) + 1, np.int32)
    number[values[np.argsort(first)]] = np.arange(values.size, dtype=np.int32)
    return Regions(number[labels], int(values.size))
