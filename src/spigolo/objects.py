"""From regions to objects: facts about every region, rejection with a reason, the answer (section III-F)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.boxes import OrientedBox, fit_box
from spigolo.config import Config, Rejection
from spigolo.cues import Cues
from spigolo.depth import missing_mask
from spigolo.frame import Frame, Mask
from spigolo.kernels import moments
from spigolo.regions import VGA_PX2, Regions
from spigolo.support import above_mask, support_mask

Labels = npt.NDArray[np.int32]


class Reason(str, Enum):
    """Why a region is no object, in the order in which the rules are asked."""

    SUPPORT = "support"
    WEAK_CONTOUR = "weak contour"
    OUT_OF_REACH = "out of reach"
    TOO_LONG = "too long"
    TOO_WIDE = "too wide"
    TOO_THIN = "too thin"
    MISSING_DEPTH = "missing depth"
    DARK = "dark"


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RegionFacts:
    """What is known of one region.

    region: its number in `trace.regions`. box_px: (y0, x0, y1, x1), the last two exclusive. centroid_px: (y, x).
    centroid_m: mean (X, Y, Z) of its measured points, None without any. spread_px2: the eigenvalues
    (lambda1, lambda2) of the covariance of its pixel coordinates. eccentricity: sqrt(1 - lambda2 / lambda1).
    missing: share of its pixels without measured depth. unfilled: share still without depth after in-painting.
    dark: share in the first three of 32 brightness bins. above: share of its measured pixels that stand above the
    support plane, None where there is no plane. contour: mean of the boundary cue along its border, in [0, 1], None
    where the cost reads no boundary.
    """

    region: int
    area_px: int
    box_px: tuple[int, int, int, int]
    centroid_px: tuple[float, float]
    centroid_m: tuple[float, float, float] | None
    spread_px2: tuple[float, float]
    eccentricity: float
    missing: float
    unfilled: float
    dark: float
    above: float | None
    contour: float | None
    regions: Labels = field(repr=False)
    frame: Frame = field(repr=False)

    @property
    def mask(self) -> Mask:
        """Its pixels, (H, W) bool, a new array each time."""
        return np.asarray(self.regions == self.region)

    @property
    def distance_m(self) -> float | None:
        """Distance of the centroid from the camera, None without depth."""
        return None if self.centroid_m is None else float(np.linalg.norm(self.centroid_m))

    def points_m(self) -> npt.NDArray[np.float32]:
        """Its measured points (N, 3) in the camera's frame, in raster order; never in-painted depth."""
        return self.frame.camera.back_project(self.frame.depth, self.mask)

    def oriented_box(self) -> OrientedBox | None:
        """The box around its measured surface, trimmed against flying pixels; None with fewer than 10 points."""
        return fit_box(self.mask, self.frame.depth, self.frame.camera)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ObjectMask(RegionFacts):
    """An object. label: its number in `Segmentation.labels`."""

    label: int


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RejectedRegion(RegionFacts):
    """A region that is no object. reason: the first rule it breaks; why: the same with the numbers."""

    reason: Reason
    why: str


@dataclass(frozen=True, slots=True, eq=False)
class Segmentation:
    """The answer. Iterating, indexing and len() go over the objects; np.asarray() gives the labels.

    labels: (H, W) int32, 0 = background, 1..N = objects. rejected: all other regions with their reasons.
    support: (H, W) bool, background pixels on the plane that objects stand on; None where none was looked for or found.
    preset, digest: name of the configuration and a hash of its values.
    """

    labels: Labels
    objects: tuple[ObjectMask, ...]
    rejected: tuple[RejectedRegion, ...]
    support: Mask | None
    preset: str
    digest: str

    def __iter__(self) -> Iterator[ObjectMask]:
        return iter(self.objects)

    def __len__(self) -> int:
        return len(self.objects)

    def __getitem__(self, index: int) -> ObjectMask:
        return self.objects[index]

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        if copy is False and dtype is not None and np.dtype(dtype) != self.labels.dtype:
            raise ValueError(f"labels are int32: another type ({np.dtype(dtype)}) needs a copy")
        labels = self.labels if dtype is None else self.labels.astype(dtype, copy=False)
        return labels.copy() if copy else labels


def select_objects(regions: Regions, cues: Cues, frame: Frame, config: Config) -> Segmentation:
    """Measures every region and sorts it into objects and rejected regions.

    Pixel limits are those of a 640x480 image and grow with its area.
    """
    plane, rule = cues.support, config.rejection.support
    above, on_plane = None, None
    if plane is not None and rule is not None:
        above = above_mask(plane, frame.depth, frame.camera, rule)
        on_plane = support_mask(plane, frame.depth, frame.camera, rule)
    objects: list[ObjectMask] = []
    rejected: list[RejectedRegion] = []
    for facts in measure_regions(regions, cues, frame, above):
        verdict = judge(facts, config.rejection, regions.labels.size / VGA_PX2)
        if verdict is None:
            objects.append(ObjectMask(label=len(objects) + 1, **_fields(facts)))
        else:
            rejected.append(RejectedRegion(reason=verdict[0], why=verdict[1], **_fields(facts)))
    label_of = np.zeros(regions.count, np.int32)
    for o in objects:
        label_of[o.region] = o.label
    labels = label_of[regions.labels]
    support = None if on_plane is None else on_plane & (labels == 0)
    return Segmentation(labels, tuple(objects), tuple(rejected), support, config.name, config.digest)


def measure_regions(regions: Regions, cues: Cues, frame: Frame, above: Mask | None = None) -> list[RegionFacts]:
    """The facts of every region, by number. above: (H, W), measured pixels above the support."""
    sums, boxes = np.zeros((regions.count, 6)), np.zeros((regions.count, 4), np.int32)
    points, dark = np.zeros((regions.count, 4)), np.zeros(regions.count, np.int64)
    camera = (frame.camera.fx, frame.camera.fy, frame.camera.cx, frame.camera.cy)
    moments.sum_regions(regions.labels, sums, boxes)
    moments.sum_depth(regions.labels, frame.depth, camera, points)
    moments.count_dark(regions.labels, frame.color, dark)
    unfilled = np.bincount(regions.labels[missing_mask(cues.depth)], minlength=regions.count)
    standing = None if above is None else np.bincount(regions.labels[above], minlength=regions.count)
    contour = None if cues.edges is None else contour_strength(regions, cues.delta_bound)
    n, measured = sums[:, 0], points[:, 0]
    centroid = sums[:, 1:3] / n[:, None]
    large, small, eccentricity = principal_spread(sums)
    return [
        RegionFacts(
            region=k,
            area_px=int(n[k]),
            box_px=(int(boxes[k, 0]), int(boxes[k, 1]), int(boxes[k, 2]), int(boxes[k, 3])),
            centroid_px=(float(centroid[k, 0]), float(centroid[k, 1])),
            centroid_m=_mean_point(points[k]),
            spread_px2=(float(large[k]), float(small[k])),
            eccentricity=float(eccentricity[k]),
            missing=float(1 - measured[k] / n[k]),
            unfilled=float(unfilled[k] / n[k]),
            dark=float(dark[k] / n[k]),
            above=None if standing is None else float(standing[k] / max(measured[k], 1)),
            contour=None if contour is None else float(contour[k]),
            regions=regions.labels,
            frame=frame,
        )
        for k in range(regions.count)
    ]


def contour_strength(regions: Regions, boundary: npt.NDArray[np.float32]) -> npt.NDArray[np.float64]:
    """Mean of the boundary cue (H, W) along the border of each region (R,); 0 for a region without neighbours."""
    sums = np.zeros((regions.count, 2))
    moments.sum_contours(regions.labels, boundary, sums)
    return np.asarray(sums[:, 1] / np.maximum(sums[:, 0], 1))


def principal_spread(sums: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.float64], ...]:
    """lambda1 >= lambda2 (px^2) and eccentricity of each region from its moments (R, 6), covariance divided by N."""
    n, y, x, yy, yx, xx = sums.T
    a, b, c = yy / n - (y / n) ** 2, yx / n - y * x / n**2, xx / n - (x / n) ** 2
    middle, root = (a + c) / 2, np.hypot((a - c) / 2, b)
    large, small = np.maximum(middle + root, 0), np.maximum(middle - root, 0)
    ratio = np.divide(small, large, out=np.ones_like(large), where=large > 0)
    return large, small, np.sqrt(1 - ratio)


def judge(facts: RegionFacts, rules: Rejection, area_scale: float) -> tuple[Reason, str] | None:
    """The first rule that a region breaks, with its numbers in a sentence, or None.

    area_scale: pixels of the image as a multiple of 640x480.
    """
    if rules.support is not None and facts.above is not None and facts.above < rules.support.min_above:
        return Reason.SUPPORT, f"support: {facts.above:.0%} stands above the plane, least {rules.support.min_above:.0%}"
    if rules.min_contour is not None and facts.contour is not None and facts.contour < rules.min_contour:
        return Reason.WEAK_CONTOUR, f"weak contour: mean boundary {facts.contour:.2f}, least {rules.min_contour:.2f}"
    large, small = facts.spread_px2
    max_large, max_small = _scaled(rules.max_lambda1_px2, area_scale), _scaled(rules.max_lambda2_px2, area_scale)
    for reason, value, limit, form in (
        (Reason.OUT_OF_REACH, facts.distance_m, rules.max_distance_m, "centroid at {:.2f} m, limit {:.2f} m"),
        (Reason.TOO_LONG, large, max_large, "lambda1 {:.0f} px2, limit {:.0f} px2"),
        (Reason.TOO_WIDE, small, max_small, "lambda2 {:.0f} px2, limit {:.0f} px2"),
        (Reason.TOO_THIN, facts.eccentricity, rules.max_eccentricity, "eccentricity {:.3f}, limit {:.3f}"),
        (Reason.MISSING_DEPTH, facts.unfilled, rules.max_missing, "{:.0%} without depth, limit {:.0%}"),
    ):
        if limit is not None and value is not None and value > limit:
            return reason, f"{reason.value}: {form.format(value, limit)}"
    if rules.max_dark is not None and facts.dark >= rules.max_dark:
        return Reason.DARK, f"dark: {facts.dark:.0%} in the first three brightness bins, limit {rules.max_dark:.0%}"
    return None


def _scaled(limit: float | None, scale: float) -> float | None:
    return None if limit is None else limit * scale


def _mean_point(sums: npt.NDArray[np.float64]) -> tuple[float, float, float] | None:
    if sums[0] == 0:
        return None
    x, y, z = (sums[1:] / sums[0]).tolist()
    return x, y, z


def _fields(facts: RegionFacts) -> dict[str, Any]:
    return {name: getattr(facts, name) for name in RegionFacts.__dataclass_fields__}
