"""Measurements of every region in the image and in space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.additions.plane import Plane
from spigolo.additions.stance import Stance
from spigolo.errors import CameraError
from spigolo.frames.camera import kernel_numbers
from spigolo.frames.frame import DepthMap, Frame, Mask
from spigolo.kernels import moments
from spigolo.objects.boxes import OrientedBox, fit_box
from spigolo.objects.scores import contour_strength, region_score
from spigolo.stages.depth import missing_mask
from spigolo.stages.regions import Regions

Labels = npt.NDArray[np.int32]

SPREAD_OF_SQUARE = 12
"""Squared side length of a rectangle, divided by the variance of the coordinates of its points along this side."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True, repr=False)
class RegionFacts:
    """Measurements of one region in the image and in space."""

    region: int
    """Number of the region in `Segmentation.regions`."""
    score: float
    """Score of the region from 0 to 1, computed by `region_score`. Whole objects have high scores."""
    area_px: int
    """Number of pixels of the region."""
    box_px: tuple[int, int, int, int]
    """Bounding box (y0, x0, y1, x1) of the region in pixels, y1 and x1 exclusive."""
    centroid_px: tuple[float, float]
    """Centroid (y, x) of the region in pixels."""
    centroid_m: tuple[float, float, float] | None
    """Mean (X, Y, Z) of the region's measured points in metres. The value is None if measured points or intrinsics are
    missing.
    """
    spread_px2: tuple[float, float]
    """Eigenvalues (lambda1, lambda2) of the covariance of the region's pixel coordinates, px^2, largest first."""
    eccentricity: float
    """Eccentricity sqrt(1 - lambda2 / lambda1) of the region, from 0 for a disc to 1 for a line."""
    missing: float
    """Share of the region's pixels without measured depth."""
    unfilled: float
    """Share of the region's pixels without depth after in-painting."""
    dark: float
    """Share of the region's pixels that are dark. A pixel is dark if its brightness max(R, G, B) is at most 23 of 255.
    """
    above: float | None
    """Share of the region's measured pixels above the support plane. The value is None if the frame has no support
    plane.
    """
    inside: float | None
    """Share of the region's pixels inside the region of interest. If the region of interest is a box in metres, pixels
    without depth are not counted. The value is None if no region of interest is given.
    """
    contour: float
    """Mean boundary value along the region's border, from 0 to 1."""
    cut: float | None
    """Share of the region's outline that lies on the image border.

    The value is None in three cases: `Rules.wall` or `Additions.support` is off, intrinsics are missing, or the region
    is lower than `Wall.min_height_m`.
    """
    hides: float | None
    """Share of the region's outline along which the depth outside is larger than the depth inside by a step. Parts of
    the outline next to a nearer object are not counted.

    The value is None if `RegionFacts.cut` is None, or if too little of the outline has depth.
    """
    ledge: float | None
    """Share of the region's outline along which the height above the support plane changes by a step. The value is None
    in three cases: `Rules.wall` is off, intrinsics or the support plane are missing, or too little of the outline has
    depth.
    """
    lean_deg: float | None
    """Angle between the region's mean surface normal and the line of sight, in degrees.

    The value is None if `RegionFacts.cut` is None, or if too few pixels of the region have a surface normal.
    """
    regions: Labels
    """Region number of each pixel of the frame, as an array (H, W)."""
    frame: Frame
    """Frame that contains the region."""
    plane: Plane | None
    """Support plane of the frame. The value is None if no plane was found."""

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self._summary()})"

    def _summary(self) -> str:
        y0, x0, y1, x1 = self.box_px
        place = "" if self.centroid_m is None else f" at {self.centroid_m[2]:.2f} m"
        return f"{self.area_px} px in ({y0}, {x0}, {y1}, {x1}){place}, score {self.score:.2f}"

    @property
    def mask(self) -> Mask:
        """Mask (H, W) of the region's pixels. Each access to the property creates a new array."""
        return np.asarray(self.regions == self.region)

    @property
    def distance_m(self) -> float | None:
        """Distance of the region's centroid from the camera in metres. The value is None if depth or intrinsics are
        missing.
        """
        return None if self.centroid_m is None else float(np.linalg.norm(self.centroid_m))

    @property
    def size_m(self) -> tuple[float, float] | None:
        """Approximate length and width of the region in metres. The value is None if depth or intrinsics are missing.

        Length and width are the side lengths of a rectangle that faces the camera, at the distance of the region. The
        pixel coordinates of the rectangle have the same variances (`spread_px2`) as those of the region.
        """
        camera, center = self.frame.camera, self.centroid_m
        if camera is None or center is None:
            return None
        pixel_m = 2 * center[2] / (camera.fx + camera.fy)
        length, width = (float(np.sqrt(SPREAD_OF_SQUARE * spread)) * pixel_m for spread in self.spread_px2)
        return length, width

    def to_dict(self) -> dict[str, Any]:
        """Return the measurements as a dict that can be written as JSON."""
        facts = {name: getattr(self, name) for name in MEASURED}
        return {name: list(fact) if isinstance(fact, tuple) else fact for name, fact in facts.items()}

    def points_m(self, trim_m: float | None = None) -> npt.NDArray[np.float32]:
        """Return the region's measured points (N, 3) in metres, in the camera's frame. The points are ordered by image
        row and then by column.

        Points from in-painted depth are not included. Raises CameraError for a frame without intrinsics.

        trim_m: maximum distance of a point from the oriented box, in metres. Points farther from the box are not
        returned, because they are probably flying pixels, whose depth lies between object and background. If `trim_m`
        is None, all points are returned.
        """
        if self.frame.camera is None:
            raise CameraError("expected intrinsics for points in metres, got a frame without a camera")
        points = self.frame.camera.back_project(self.frame.depth, self.mask)
        box = None if trim_m is None else self.oriented_box()
        return points if box is None or trim_m is None else points[box.contains(points, trim_m)]

    def oriented_box(self) -> OrientedBox | None:
        """Return the oriented box around the region's measured surface. One axis of the box is the normal of the
        support plane.

        Returns None if fewer than 10 pixels have depth or if intrinsics are missing.
        """
        camera = self.frame.camera
        if camera is None:
            return None
        return fit_box(self.mask, self.frame.depth, camera, None if self.plane is None else self.plane.normal)


MEASURED = tuple(f.name for f in fields(RegionFacts) if f.name not in ("regions", "frame", "plane"))
"""Names of the measurements that `RegionFacts.to_dict` returns."""


def measure_regions(
    regions: Regions,
    depth: DepthMap,
    frame: Frame,
    contour: npt.NDArray[np.float32],
    above: Mask | None = None,
    inside: tuple[Mask, Mask] | None = None,
    stance: Stance | None = None,
    plane: Plane | None = None,
) -> list[RegionFacts]:
    """Return the measurements of every region, indexed by region number.

    - depth: in-painted depth map (H, W) in metres.
    - contour: map (H, W) of boundary values that `contour_cue` returns.
    - above: mask (H, W) of the measured pixels above the support plane.
    - inside: two masks (H, W), as returned by `roi_mask`: the pixels inside the region of interest, and the pixels
      whose position is known.
    - stance: measurements of each region that separate objects from walls.
    - plane: support plane.
    """
    points = _sum_points(regions, frame)
    measured = points[:, 0]
    strength = contour_strength(regions, contour)
    standing = None if above is None else _share(regions, above, measured)
    wanted = None if inside is None else _share(regions, inside[0] & inside[1], regions.count_where(inside[1]))
    score = region_score(strength, measured / regions.labels.size, standing)
    return [
        RegionFacts(
            region=k,
            score=float(score[k]),
            above=None if standing is None else float(standing[k]),
            inside=None if wanted is None else float(wanted[k]),
            contour=float(strength[k]),
            cut=None if stance is None else _known(stance.cut[k]),
            hides=None if stance is None else _known(stance.hides[k]),
            ledge=None if stance is None else _known(stance.ledge[k]),
            lean_deg=None if stance is None else _known(stance.lean_deg[k]),
            frame=frame,
            plane=plane,
            **place,
        )
        for k, place in enumerate(_places(regions, depth, frame, points))
    ]


def remeasure(facts: Sequence[RegionFacts], regions: Regions, frame: Frame, depth: DepthMap) -> list[RegionFacts]:
    """Update the measurements of regions after their outlines have changed.

    All measurements except score, above, inside, contour, cut, hides, ledge and lean_deg are updated. The excepted
    measurements stay the same, because the rules have already accepted or rejected the regions by them.

    - facts: measurements before the change, indexed by new region number.
    - depth: in-painted depth map (H, W) in metres.
    """
    places = _places(regions, depth, frame, _sum_points(regions, frame))
    return [replace(f, region=k, frame=frame, **place) for k, (f, place) in enumerate(zip(facts, places, strict=True))]


def _places(regions: Regions, depth: DepthMap, frame: Frame, points: npt.NDArray[np.float64]) -> list[dict[str, Any]]:
    """Return the measurements that are computed from each region's mask, as one dict for each region.

    points: number of measured pixels and sums of X, Y and Z of each region (R, 4), as returned by `_sum_points`.
    """
    sums, boxes = np.zeros((regions.count, 6)), np.zeros((regions.count, 4), np.int32)
    moments.sum_regions(regions.labels, sums, boxes)
    n = np.maximum(sums[:, 0], 1)
    centroid = sums[:, 1:3] / n[:, None]
    large, small, eccentricity = principal_spread(sums)
    dark = np.zeros(regions.count, np.int64)
    moments.count_dark(regions.labels, frame.color, dark)
    unfilled = regions.count_where(missing_mask(depth)) / n
    return [
        {
            "area_px": int(sums[k, 0]),
            "box_px": (int(boxes[k, 0]), int(boxes[k, 1]), int(boxes[k, 2]), int(boxes[k, 3])),
            "centroid_px": (float(centroid[k, 0]), float(centroid[k, 1])),
            "centroid_m": None if frame.camera is None else _mean_point(points[k]),
            "spread_px2": (float(large[k]), float(small[k])),
            "eccentricity": float(eccentricity[k]),
            "missing": float(1 - points[k, 0] / n[k]),
            "unfilled": float(unfilled[k]),
            "dark": float(dark[k] / n[k]),
            "regions": regions.labels,
        }
        for k in range(regions.count)
    ]


def principal_spread(sums: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.float64], ...]:
    """Return three arrays (R,) for R regions: the variances lambda1 and lambda2 (px^2) along the principal axes, and
    the eccentricity. lambda1 is the larger variance.

    sums: result (R, 6) of `moments.sum_regions`, the number of pixels and the sums of coordinates of each region.
    """
    n, y, x, yy, yx, xx = sums.T
    n = np.maximum(n, 1)
    a, b, c = yy / n - (y / n) ** 2, yx / n - y * x / n**2, xx / n - (x / n) ** 2
    middle, root = (a + c) / 2, np.hypot((a - c) / 2, b)
    large, small = np.maximum(middle + root, 0), np.maximum(middle - root, 0)
    ratio = np.divide(small, large, out=np.ones_like(large), where=large > 0)
    return large, small, np.sqrt(1 - ratio)


def _sum_points(regions: Regions, frame: Frame) -> npt.NDArray[np.float64]:
    """Return four values (R, 4) for each region: the number of its measured pixels, and the sums of their X, Y and Z in
    metres.

    Without a camera, only the number of measured pixels is valid.
    """
    sums = np.zeros((regions.count, 4))
    moments.sum_depth(regions.labels, frame.depth, kernel_numbers(frame.camera), sums)
    return sums


def _share(regions: Regions, mask: Mask, of: npt.NDArray[np.generic]) -> npt.NDArray[np.float64]:
    return np.asarray(regions.count_where(mask) / np.maximum(of, 1))


def _known(value: np.float64) -> float | None:
    return None if np.isnan(value) else float(value)


def _mean_point(sums: npt.NDArray[np.float64]) -> tuple[float, float, float] | None:
    if sums[0] == 0:
        return None
    x, y, z = (sums[1:] / sums[0]).tolist()
    return x, y, z
