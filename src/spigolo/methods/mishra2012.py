"""Mishra et al. 2012, *Segmenting "Simple" Objects Using RGB-D*: points inside objects, and the objects around them.

At a depth border the nearer side is the owner, so it points into an object. The region that `mishra2009` finds around
such a point is a simple object if borders that it owns, or contact boundaries, enclose it.

Only an outline of the text was available. The choice of points and the acceptance of objects are our reading, and all
numbers are our choice. Their method knows the camera's pose, which shows contact with the table. Here, contact is a
valley of the depth.
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
"""Half of what is asked of a contour is enough to look again."""
BESIDE_PX = 3.0
"""Maximum distance in pixels between a contour and the edge that it follows."""
VOTES_PX = 9
"""Votes are counted in a square of this width."""


class SimpleConfig(FixationConfig):
    """Parameters of `mishra2012`: those of `mishra2009`, and how points are chosen and objects accepted."""

    min_length_px: Annotated[int, Field(ge=1, le=10_000)] = 20
    """Shorter fragments of strong edges point at nothing."""
    shift_px: Positive = 18.0
    """Distance of fixation points from a border, on the side that owns it."""
    max_fixations: Annotated[int, Field(ge=0, le=10_000)] = 40
    """The most points that are tried."""
    min_votes: NotNegative = 8.0
    """Minimum number of border pixels that point at a fixation point. A straight border by itself gives 9."""
    refixate: bool = True
    """Look again from the innermost point of what was found."""
    min_strong: Share = 0.5
    """Least share of the contour that is strong and owned by the inside, or a contact boundary."""
    max_iou: Share = 0.5
    """Maximum IoU of two objects. Among two that overlap more, the one with more evidence stays."""
    min_area_px2: Area_px2 = 500.0
    """Smaller ones are none."""
    max_area: Share = 0.2
    """Larger shares of the frame are surfaces that objects stand on."""


class Found(NamedTuple):
    """An object (H, W) and the share of its contour that speaks for it."""

    mask: Mask
    strong: float


@dataclass(frozen=True)
class Mishra2012(Baseline[SimpleConfig]):
    """Objects around the points that depth borders point at. The rest of the frame is one region."""

    name = "mishra2012"
    config: SimpleConfig = field(default_factory=SimpleConfig)

    def divide(self, frame: Frame) -> Division:
        """Return the rest of the frame and every simple object. If two overlap, the one with more evidence gets the
        pixels.
        """
        config = self.config.at_size(frame.shape)
        boundary = find_boundary(frame.color, frame.depth, frame.camera, config)
        found = find_simple(boundary, config)
        return Division(paint([f.mask for f in reversed(found)], frame.shape), boundary.value)


def find_simple(boundary: Boundary, config: SimpleConfig) -> list[Found]:
    """The simple objects of a frame, the best founded first."""
    kept: list[Found] = []
    for found in sorted(_look_around(boundary, config), key=lambda f: -f.strong):
        if all(_iou(found.mask, other.mask) <= config.max_iou for other in kept):
            kept.append(found)
    return kept


def _look_around(boundary: Boundary, config: SimpleConfig) -> Iterator[Found]:
    """Objects around the points that most borders point at, one after the other."""
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
    """Count the border pixels that point at each pixel (H, W): the point `shift_px` from them on the owner's side.

    Borders without an owner count only if there are no others. They point to both sides.
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
    """Judge of points: finds the region around a point, and the share of its contour that supports it."""

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
        """Return the region around a pixel (y, x). None if its area is out of bounds or it owns hardly any of its
        border.
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
        """Return the share of a contour that has a strong edge next to it, owned by its inside or by nobody. Points
        count by their length.
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
