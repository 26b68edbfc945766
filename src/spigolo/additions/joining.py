"""Joining of regions that are parts of one object (our addition, not in the paper).

The graph partition can split an object into several regions. An object is split at depth steps within the object,
between the wall and the inside of a cup, or because of noise. Four rules join regions that are parts of one object.
Each of the four rules compares two neighbouring regions. The class `Joining` contains the parameters of the four rules.

- vessel: the wall and the inside of a cup. The rule `vessel` joins two regions if the front region is convex, the
  region behind it is concave, and both have the same top height.
- cap: the upper face and the side of a box, or a filled cup. The rule `cap` joins two regions if the depth step across
  their border is small and the border is not a valley. The two regions must also lie above each other in the image,
  have similar top heights, and form a nearly convex shape.
- smooth: two parts of one surface that were separated because of noise. The rule `smooth` joins two regions if their
  border has a small depth step, is not a valley, and has no large mean boundary value.
- enclosed: a region that is surrounded by an object, such as the bottom of a bowl. The rule `enclosed` joins only
  regions on the support plane or without depth with the object around them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.additions.plane import Plane, above_mask
from spigolo.clock import stage
from spigolo.frames.frame import Camera
from spigolo.kernels import borders, moments
from spigolo.settings.additions import Additions
from spigolo.settings.joining import Joining
from spigolo.settings.support import Support
from spigolo.stages.cues import Cues
from spigolo.stages.regions import Regions

GAP_LIMIT_M, BEND_LIMIT_M = 0.15, 0.02
TOP_PERCENT = 95
MOST_PARTS = 1000
"""Maximum number of regions of a frame that are tested for joining. If a frame has more regions, only the largest
regions are tested.
"""
CUT_SOLIDITY = 0.9
LEAST_ABOVE = 0.85
"""Minimum number of image columns that two joined regions share, divided by the number of image columns of one region.

For the rule `vessel`, the divisor is the number of columns of the inside of the vessel. For the rule `cap`, the divisor
is the number of columns of the narrower region.
"""

Counts = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Border:
    """Measurements of the border between a region a and a neighbouring region b that is farther away. Depth is sampled
    on both sides of the border.

    - gap_m: mean absolute depth difference across the border, metres.
    - behind_m: mean signed depth difference across the border, metres, positive if region b is behind region a.
    - bend_m: mean distance of the border behind the straight line between the depth samples on both sides, metres. The
      distance is positive if the border is a valley.
    - boundary: mean value of the boundary map along the border.
    """

    a: int
    b: int
    gap_m: float
    behind_m: float
    bend_m: float
    boundary: float


@stage("joining")
def join_parts(regions: Regions, cues: Cues, plane: Plane | None, camera: Camera | None, config: Additions) -> Regions:
    """Join the regions that are parts of one object.

    The regions are returned unchanged if joining is switched off or if the support plane or the camera is unknown.
    """
    if config.joining is None or config.support is None or plane is None or camera is None:
        return regions
    parts = _Parts(regions, cues, plane, camera, config.joining, config.support)
    root = np.arange(regions.count)
    for border in parts.borders():
        if parts.is_vessel(border) or parts.is_cap(border) or parts.is_smooth(border):
            _unite(root, border.a, border.b)
    for inner, outer in parts.enclosed(root):
        _unite(root, inner, outer)
    return regions.joined(root)


def _unite(root: Counts, a: int, b: int) -> None:
    """Merge the groups that contain regions a and b. The root of a group is its smallest region number."""
    low, high = sorted((root[a], root[b]))
    root[root == high] = low


class _Parts:
    """Regions of a frame with the measurements that the joining rules compare."""

    def __init__(
        self, regions: Regions, cues: Cues, plane: Plane, camera: Camera, config: Joining, support: Support
    ) -> None:
        self.config, self.cues, self.labels = config, cues, regions.labels
        self.height = plane.height_map_m(cues.depth, camera)
        sums, self.boxes = np.zeros((regions.count, 6)), np.zeros((regions.count, 4), np.int32)
        moments.sum_regions(regions.labels, sums, self.boxes)
        self.area = sums[:, 0]
        measured = regions.count_where(np.asarray(cues.depth > 0))
        above = regions.count_where(above_mask(plane, cues.depth, camera, support))
        self.stands = (above >= config.min_above * measured) & (measured >= config.min_measured * self.area)
        self.stands &= self.area <= config.max_share * self.labels.size
        self.ids = np.flatnonzero(self.stands)
        if self.ids.size > MOST_PARTS:
            self.ids = np.sort(self.ids[np.argsort(-self.area[self.ids], kind="stable")[:MOST_PARTS]])
        self.number = np.full(regions.count, -1, np.int32)
        self.number[self.ids] = np.arange(self.ids.size)
        self.focal_px = camera.fx
        self.hollowness = self._hollowness()
        self._tops: dict[int, float] = {}

    def borders(self) -> Iterator[Border]:
        """Yield the borders between regions above the support plane, with their measurements. Short borders and borders
        with few measured pixels are skipped.
        """
        count = self.ids.size
        sums = np.zeros((count, count, borders.SUMS))
        cue = self.cues.boundary
        boundary = np.zeros(self.labels.shape, np.float32) if cue is None else cue
        borders.sum_borders(
            self.labels, self.number, self.cues.depth, boundary, self.config.reach_px, GAP_LIMIT_M, BEND_LIMIT_M, sums
        )
        behind, known = sums[:, :, borders.BEHIND], sums[:, :, borders.MEASURED] > 0
        for a, b in np.argwhere((behind > 0) | (np.triu(behind == 0) & known)):
            pairs, measured, gap, behind, bend, strength = sums[a, b].tolist()
            if pairs >= self.config.min_border_px and measured >= self.config.min_measured * pairs:
                yield Border(
                    int(self.ids[a]),
                    int(self.ids[b]),
                    gap / measured,
                    behind / measured,
                    bend / measured,
                    strength / pairs,
                )

    def is_vessel(self, border: Border) -> bool:
        """Return True if region a of the border is the wall of a vessel, and region b is the inside of this vessel."""
        rule, front, back = self.config.vessel, self.hollowness[border.a], self.hollowness[border.b]
        if rule is None:
            return False
        sure = back >= rule.sure_hollow_back and back - front >= rule.sure_contrast
        if not sure and not self._has_room(border):
            return False
        return (
            border.behind_m >= rule.min_behind_m
            and front <= rule.max_hollow_front
            and back >= rule.min_hollow_back
            and back - front >= rule.min_contrast
            and self._ends_alike(border, rule.top_m, rule.top_share)
            and self._solidity((border.a, border.b)) >= (rule.sure_solidity if sure else rule.min_solidity)
        )

    def _has_room(self, border: Border) -> bool:
        """Return True if region b fits into a vessel whose wall is region a.

        Region b must overlap region a in image columns. The distance of region b behind region a must be at most the
        width of region a in metres.
        """
        shared, across, own = self._columns(border)
        y0, x0, y1, x1 = self.boxes[border.a]
        wall = self.cues.depth[y0:y1, x0:x1][self._crop(border.a) == border.a]
        width_m = across * float(np.median(wall[wall > 0])) / self.focal_px
        return shared >= LEAST_ABOVE * own and border.behind_m <= width_m

    def _columns(self, border: Border) -> tuple[int, int, int]:
        """Return three numbers of image columns: the columns that both regions share, the columns of region a, and the
        columns of region b.
        """
        (left, right), (start, end) = self.boxes[border.a, 1::2].tolist(), self.boxes[border.b, 1::2].tolist()
        return max(min(right, end) - max(left, start), 0), right - left, end - start

    def is_cap(self, border: Border) -> bool:
        """Return True if one region of the border is the upper face of an object, and the other region is its side."""
        rule = self.config.cap
        shared, *widths = self._columns(border)
        return (
            rule is not None
            and shared >= LEAST_ABOVE * min(widths)
            and border.gap_m <= rule.max_gap_m
            and border.bend_m <= rule.max_bend_m
            and self._ends_alike(border, 0.0, rule.top_share)
            and self._solidity((border.a, border.b)) >= rule.min_solidity
        )

    def is_smooth(self, border: Border) -> bool:
        """Return True if both regions of the border form one flat or convex surface."""
        rule = self.config.smooth
        return (
            rule is not None
            and border.gap_m <= rule.max_gap_m
            and border.bend_m <= rule.max_bend_m
            and border.boundary <= rule.max_boundary
        )

    def enclosed(self, root: Counts) -> Iterator[tuple[int, int]]:
        """Yield pairs (region, object) of region numbers that the rule `enclosed` joins. The first region of a pair
        lies on the support plane or has no depth. The object surrounds this region and is given by the smallest number
        of its joined regions.
        """
        least = self.config.enclosed
        if least is None:
            return
        inner = np.asarray((self.boxes[:, :2] > 0).all(1) & (self.boxes[:, 2:] < self.labels.shape).all(1))
        for k in np.flatnonzero(~self.stands & (self.area <= self.config.max_share * self.labels.size)):
            labels = self._crop(int(k), 1)
            here = (labels == k).view(np.uint8)
            ring = (cv2.dilate(here, np.ones((3, 3), np.uint8)) > 0) & (here == 0)
            around = np.bincount(root[labels[ring]], minlength=root.size)
            outer = int(around.argmax())
            if around[outer] < least * around.sum() or not self.stands[root == outer].any():
                continue
            parts = [int(k), *np.flatnonzero(root == outer).tolist()]
            if inner[k] or self._solidity(parts) >= CUT_SOLIDITY:
                yield int(k), outer

    def _crop(self, k: int, margin: int = 0) -> npt.NDArray[np.int32]:
        (top, left), (bottom, right) = np.maximum(self.boxes[k, :2] - margin, 0), self.boxes[k, 2:] + margin
        return self.labels[top:bottom, left:right]

    def _hollowness(self) -> npt.NDArray[np.float64]:
        """Return the hollowness (R,) of each region. A chord is a straight line in space between the left and the right
        end of the region in one image row. Hollowness is the summed distance of the surface behind the middles of the
        chords, divided by the summed lengths of the chords.
        """
        sums = np.zeros((self.ids.size, 2))
        borders.sum_hollows(self.labels, self.number, self.cues.depth, self.focal_px, self.config.margin_px, sums)
        out = np.zeros(self.number.size)
        out[self.ids] = sums[:, 0] / np.maximum(sums[:, 1], 1e-6)
        return out

    def top_m(self, k: int) -> float:
        """Return the height of the top of region k above the support plane, in metres, and store the height for later
        calls.
        """
        if k not in self._tops:
            self._tops[k] = self._find_top_m(k)
        return self._tops[k]

    def _find_top_m(self, k: int) -> float:
        y0, x0, y1, x1 = self.boxes[k]
        there = (self._crop(k) == k) & (self.cues.depth[y0:y1, x0:x1] > 0)
        return float(np.percentile(self.height[y0:y1, x0:x1][there], TOP_PERCENT)) if there.any() else 0.0

    def _ends_alike(self, border: Border, tolerance_m: float, share: float) -> bool:
        """Return True if the tops of both regions have the same height above the support plane, within a tolerance."""
        a, b = self.top_m(border.a), self.top_m(border.b)
        return abs(a - b) <= max(tolerance_m, share * max(a, b))

    def _solidity(self, parts: Sequence[int]) -> float:
        """Return the solidity of the union of some regions: the area of the union divided by the area of its convex
        hull.
        """
        (y0, x0), (y1, x1) = self.boxes[parts, :2].min(0), self.boxes[parts, 2:].max(0)
        own = np.isin(self.labels[y0:y1, x0:x1], parts).view(np.uint8)
        outlines, _ = cv2.findContours(own, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        hull: Any = cv2.convexHull(np.vstack(outlines))
        return sum(map(cv2.contourArea, outlines)) / max(cv2.contourArea(hull), 1.0)
