"""Mishra et al., 2012, *Segmenting "Simple" Objects Using RGB-D*: segmentation around automatically chosen points.

A depth border belongs to the surface on its nearer side, called the owner of the border. A point on the nearer side of
a border probably lies inside an object. The method `mishra2009` finds the region around each point. A region is
accepted as an object if its contour consists mostly of contact boundaries and of depth borders whose nearer side is the
region.

Only a short description of the paper was available. The choice of points, the acceptance of objects and the default
parameters are our interpretation. The paper detects contact with the table from the camera's pose. In this
implementation, a contact is a valley in the depth map.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Annotated, NamedTuple

import cv2
import numpy as np
from pydantic import Field

from spigolo.frames.frame import Frame, Mask
from spigolo.methods.baseline import Baseline, Division
from spigolo.methods.mishra2009 import FixationConfig, Points, contour_around, edge_map, innermost, inside, paint
from spigolo.methods.ownership import Boundary, Floats, find_boundary
from spigolo.settings.parameters import Area_px2, NotNegative, Positive, Share

HARDLY = 0.5
"""Factor of `min_strong`. A region is dropped at once if strong edges form less than HARDLY times `min_strong` of its
contour. All other regions can be segmented again, around their innermost point.
"""
BESIDE_PX = 3.0
"""Maximum distance between a contour point and the edge that the contour follows, in pixels."""
VOTES_PX = 9
"""Side length of the square around a point in which the votes for the point are summed, in pixels. Border pixels vote
for points inside objects (`count_votes`).
"""


class SimpleConfig(FixationConfig):
    """Parameters of the method `mishra2012`: the parameters of `mishra2009`, the choice of points, and the acceptance
    of objects.
    """

    min_length_px: Annotated[int, Field(ge=1, le=10_000)] = 20
    """Minimum length of an edge, in pixels. Shorter edges are not used to find points inside objects."""
    shift_px: Positive = 18.0
    """Distance, in pixels, between a border pixel and the point inside an object for which this border pixel votes."""
    max_fixations: Annotated[int, Field(ge=0, le=10_000)] = 40
    """Maximum number of points around which an object is searched."""
    min_votes: NotNegative = 8.0
    """Minimum number of votes for a point around which an object is searched. Each border pixel has one vote. A point
    next to a single straight border has 9 votes.
    """
    refixate: bool = True
    """Repeat the segmentation around the innermost point of the region that was found."""
    min_strong: Share = 0.5
    """Minimum share of an object's contour that follows strong edges. An edge is strong if its border probability is
    above 1/2. Edges whose nearer side lies outside the object are not counted.
    """
    max_iou: Share = 0.5
    """Maximum intersection over union of two objects. If two objects overlap more, the object is removed whose contour
    has the smaller share of strong edges (see `min_strong`).
    """
    min_area_px2: Area_px2 = 500.0
    """Minimum area of an object, px^2."""
    max_area: Share = 0.2
    """Maximum area of an object as a share of the frame. Regions with a larger area are probably tables or walls."""


class Found(NamedTuple):
    """Object found around a point.

    mask: mask (H, W) of the object. strong: share of the contour that follows strong edges (`Judge.share`).
    """

    mask: Mask
    strong: float


@dataclass(frozen=True)
class Mishra2012(Baseline[SimpleConfig]):
    """Segmentation around points on the nearer side of depth borders."""

    name = "mishra2012"
    config: SimpleConfig = field(default_factory=SimpleConfig)

    def divide(self, frame: Frame) -> Division:
        """Return one region for each object, and one region for the rest of the frame."""
        config = self.config.at_size(frame.shape)
        boundary = find_boundary(frame.color, frame.depth, frame.camera, config)
        found = find_simple(boundary, config)
        return Division(paint([f.mask for f in reversed(found)], frame.shape), boundary.value)


def find_simple(boundary: Boundary, config: SimpleConfig) -> list[Found]:
    """Return the objects of a frame, best contour first.

    The best contour has the largest share of strong edges (`Judge.share`).
    """
    kept: list[Found] = []
    for found in sorted(_look_around(boundary, config), key=lambda f: -f.strong):
        if all(_iou(found.mask, other.mask) <= config.max_iou for other in kept):
            kept.append(found)
    return kept


def _look_around(boundary: Boundary, config: SimpleConfig) -> Iterator[Found]:
    """Yield the objects around the points with the most votes, in descending order of votes."""
    votes, edges, judge = count_votes(boundary, config), edge_map(boundary, config), Judge(boundary, config)
    for _ in range(config.max_fixations):
        y, x = np.unravel_index(int(votes.argmax()), votes.shape)
        if votes[y, x] < config.min_votes:
            return
        cv2.circle(votes, (int(x), int(y)), round(config.shift_px), 0, -1)
        found = judge(edges, (int(y), int(x)))
        if found is not None and config.refixate:
            found = judge(edges, innermost(found.mask))
        if found is not None and found.strong >= config.min_strong:
            votes[found.mask] = 0
            yield found


def count_votes(boundary: Boundary, config: SimpleConfig) -> Floats:
    """Return the number (H, W) of border pixels that vote for each pixel as a point inside an object.

    A border pixel votes for the point that lies `shift_px` away, on the nearer side of the border. If the nearer side
    is unknown for all borders, each border pixel votes for one point on each side.
    """
    owned = boundary.side != 0
    strong = (boundary.strong & owned if owned.any() else boundary.strong).view(np.uint8)
    _, fragment, stats, _ = cv2.connectedComponentsWithStats(strong, connectivity=8)
    long = stats[:, cv2.CC_STAT_AREA] >= config.min_length_px
    long[0] = False
    y, x = np.nonzero(long[fragment])
    normal, side = boundary.normal[y, x], boundary.side[y, x, None]
    votes = np.zeros(strong.shape, np.float32)
    for sign in (1,) if owned.any() else (1, -1):
        shift = normal * np.where(side == 0, sign, side) * np.float32(config.shift_px)
        v, u = np.rint(y + shift[:, 0]).astype(int), np.rint(x + shift[:, 1]).astype(int)
        there = (v >= 0) & (v < strong.shape[0]) & (u >= 0) & (u < strong.shape[1])
        np.add.at(votes, (v[there], u[there]), np.float32(1))
    return np.asarray(cv2.boxFilter(votes, -1, (VOTES_PX, VOTES_PX), normalize=False), np.float32)


class Judge:
    """Callable object that segments the object around a point, and tests the area and the contour of the object."""

    def __init__(self, boundary: Boundary, config: SimpleConfig) -> None:
        self.boundary, self.config = boundary, config
        self.y, self.x = np.nonzero(boundary.strong)
        beside = (~boundary.strong).view(np.uint8)
        self.distance, self.nearest = cv2.distanceTransformWithLabels(
            beside, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
        )
        self.number = np.zeros(self.y.size + 1, np.int64)
        self.number[self.nearest[self.y, self.x]] = np.arange(self.y.size)

    def __call__(self, edges: Floats, point: tuple[int, int]) -> Found | None:
        """Return the object around a pixel (y, x), or None if the area or the contour of the region does not pass the
        tests.

        edges: boundary map (H, W) of `edge_map`.
        """
        config, shape = self.config, edges.shape
        contour = contour_around(edges, point, config)
        mask = inside(contour, (shape[0], shape[1]))
        area = np.count_nonzero(mask)
        if not config.min_area_px2 <= area <= config.max_area * mask.size:
            return None
        strong = self.share(contour, point)
        return Found(mask, strong) if strong >= HARDLY * config.min_strong else None

    def share(self, contour: Points, point: tuple[int, int]) -> float:
        """Return the share of a contour that follows strong edges, without edges whose nearer side lies outside the
        contour.

        The share of strong edges is measured by length along the contour.
        """
        height, width = self.distance.shape
        y, x = np.rint(contour).astype(int).T
        y, x = y.clip(0, height - 1), x.clip(0, width - 1)
        edge = self.number[self.nearest[y, x]]
        v, u = self.y[edge], self.x[edge]
        towards = self.boundary.normal[v, u] * self.boundary.side[v, u, None]
        outside = (towards * (np.stack([y, x], axis=1) - point)).sum(axis=1) > 0
        strong = (self.distance[y, x] <= BESIDE_PX) & ~outside
        length = np.hypot(*(np.roll(contour, -1, axis=0) - np.roll(contour, 1, axis=0)).T)
        return float(strong @ length / length.sum())


def _iou(a: Mask, b: Mask) -> float:
    return float(np.count_nonzero(a & b) / np.count_nonzero(a | b))
