"""Search for the support plane, on which objects stand (our addition, not in the paper).

RANSAC proposes the largest planes in a sample of pixels, and least squares refines the proposed planes. Then, one plane
is chosen by the rules in `settings.Support`. For example, the support plane must face up, and points below it must not
be visible.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial
from itertools import chain

import numpy as np

from spigolo.additions.plane import SAMPLES, Plane, Points, Sample, tolerance_m
from spigolo.clock import stage
from spigolo.frames.frame import Camera, DepthMap, Mask
from spigolo.kernels import planes as kernel
from spigolo.settings.support import Facing, Support

HYPOTHESES = 200
REFINEMENTS = 3
STACKED_M = 0.1
STACKED_SLACK_M = 0.05
STACKED_COSINE = 0.97
"""Minimum cosine of the angle between the normals of two planes that count as parallel. The normals of parallel planes
therefore differ by at most 14 degrees.

A parallel plane above the largest plane is fitted to points with a height of more than `STACKED_M` above the largest
plane. The points used for this fit differ in height by at most `STACKED_SLACK_M`.
"""
MOST_BELOW = 0.25
"""Maximum share of points below a plane that counts as opaque. Only points on or below the plane are counted, and only
if the plane surrounds them in the image.
"""
LOWER_SHARE = 0.5
"""Minimum number of points on a lower plane that replaces the support plane, divided by the number of points on the
replaced plane.
"""
SPARSE = 0.6
"""Minimum share of pixels with depth in a frame with the normal test for opaque planes. If a smaller share of the frame
has depth, a plane does not count as opaque if more points lie below it than on it.
"""
MOST_PLANES = 6
SEED = 7
"""Fixed seed of RANSAC, so that the same frame gives the same plane."""


@stage("support plane")
def find_support(
    depth: DepthMap,
    camera: Camera | None,
    config: Support | None,
    max_distance_m: float | None = None,
    roi: Mask | None = None,
) -> Plane | None:
    """Find the support plane of a depth map.

    Returns None if `camera` or `config` is None, or if no plane fulfils the rules.

    - depth: measured depth map (H, W) in metres.
    - max_distance_m: maximum depth in metres, used if `config.within_reach` is set.
    - roi: mask (H, W) of the region of interest, used if `config.near_roi` is set.
    """
    if camera is None or config is None:
        return None
    kept = depth
    if roi is not None and config.near_roi is not None and roi.any():
        y0, x0, y1, x1 = _grown_box(roi, config.near_roi)
        kept = np.zeros_like(depth)
        kept[y0:y1, x0:x1] = depth[y0:y1, x0:x1]
    if config.within_reach and max_distance_m is not None:
        kept = np.where(kept <= max_distance_m, kept, np.float32(0))
    return _find_plane(kept, camera, config)


def faces_up(plane: Plane, share: float, rule: Facing) -> bool:
    """Return True if a plane faces up, so that objects can stand on the plane.

    share: share of the frame's measured pixels that lie on the plane.
    """
    x, y, _ = plane.normal
    if rule.up is not None:
        up = np.asarray(rule.up, np.float64)
        return bool(plane.normal @ up >= np.cos(np.radians(rule.max_tilt_deg)) * np.linalg.norm(up))
    if y > np.sin(np.radians(rule.max_down_deg)):
        return False
    return bool(abs(x) <= np.sin(np.radians(rule.max_roll_deg)) or share >= rule.min_share_sideways)


def _grown_box(mask: Mask, share: float) -> tuple[int, int, int, int]:
    """Return the bounding box (y0, x0, y1, x1) of a mask (H, W). The box is enlarged on each side by a share of its
    height and width.
    """
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    ends = []
    for first, end, size in ((rows[0], rows[-1] + 1, mask.shape[0]), (columns[0], columns[-1] + 1, mask.shape[1])):
        more = round(share * (end - first))
        ends.append((max(int(first) - more, 0), min(int(end) + more, size)))
    return ends[0][0], ends[1][0], ends[0][1], ends[1][1]


def _find_plane(depth: DepthMap, camera: Camera, config: Support) -> Plane | None:
    """Find the support plane of a depth map (H, W) in metres, from a random sample of its pixels. Return None if no
    plane fulfils the rules.
    """
    valid = np.flatnonzero(depth > 0)
    if valid.size < 3:
        return None
    rng = np.random.default_rng(SEED)
    y, x = np.divmod(valid[rng.integers(valid.size, size=min(SAMPLES, valid.size))], depth.shape[1])
    sample = Sample.at(y, x, depth, camera)
    planes = _largest_planes(sample, rng, config)
    plane = _choose(planes, sample, sparse=valid.size < SPARSE * depth.size, config=config)
    return (
        plane if plane is None or config.max_below is None else _lowered(plane, config.max_below, sample, rng, config)
    )


def _choose(planes: Iterable[Plane], sample: Sample, sparse: bool, config: Support) -> Plane | None:
    """Return the first plane that fulfils the rules, or a parallel plane above this plane. Return None if no plane
    faces up.

    - planes: planes to choose from, largest first.
    - sparse: True if much of the frame's depth is missing.
    """
    facing = config.facing
    remaining = (p for p in planes if facing is None or faces_up(p, sample.share_on(p, config), facing))
    plane = next(remaining, None)
    if plane is None:
        return None
    is_opaque = partial(_is_opaque, sample=sample, sparse=sparse, config=config)
    if config.opaque:
        plane = next(filter(is_opaque, chain([plane], remaining)), plane)
    if config.min_things is not None:
        plane = _with_things(plane, filter(is_opaque, remaining), config.min_things, sample, config)
    stacked = None if config.stacked_share is None else _stacked(plane, config.stacked_share, sample, config)
    return stacked if stacked is not None and is_opaque(stacked) else plane


def _is_opaque(plane: Plane, sample: Sample, sparse: bool, config: Support) -> bool:
    """Return True if a plane is opaque: almost no points below the plane are visible.

    A table is opaque, because it hides the floor. The plane through the front edges of a shelf is not opaque, because
    points behind the plane are visible.
    """
    if sparse and np.count_nonzero(_below(plane, sample, config)) > np.count_nonzero(sample.on(plane, config)):
        return False
    return _visible_below(plane, sample, config)[1] <= MOST_BELOW


def _below(plane: Plane, sample: Sample, config: Support) -> Mask:
    """Return a mask (N,) of the sampled points that lie below a plane by more than the tolerance."""
    return np.asarray(plane.height_m(sample.points) < -tolerance_m(sample.points[:, 2], config))


def _visible_below(plane: Plane, sample: Sample, config: Support) -> tuple[Mask, float]:
    """Return a mask (N,) of the points that lie below a plane and are surrounded by the plane in the image. Also return
    the number of surrounded points below the plane, divided by the number of all surrounded points on or below the
    plane.
    """
    on = sample.on(plane, config)
    surrounded = sample.surrounded(on)
    below = _below(plane, sample, config) & surrounded
    both = int(np.count_nonzero(below | (on & surrounded)))
    return below, int(np.count_nonzero(below)) / max(both, 1)


def _lowered(plane: Plane, max_below: float, sample: Sample, rng: np.random.Generator, config: Support) -> Plane:
    """Lower a plane in steps, as long as too many points are visible below the plane. Each lower plane is nearly
    parallel to the previous plane.

    For example, if a plane lies on the upper side of a heap of objects, many points between the objects are visible
    below it. A lower plane is used only if a smaller share of points is visible below it. The number of points on a
    lower plane must be at least `LOWER_SHARE` times the number of points on the previous plane.
    """
    below, share = _visible_below(plane, sample, config)
    while share > max_below:
        hypotheses = _hypotheses(sample.points[below], rng, config)
        found = next((p for p in hypotheses if p.normal @ plane.normal > STACKED_COSINE), None)
        lower = None if found is None else _refine(found, sample, config)
        if lower is None or lower.normal @ plane.normal < STACKED_COSINE:
            break
        if sample.share_on(lower, config) < LOWER_SHARE * sample.share_on(plane, config):
            break
        below, share_below = _visible_below(lower, sample, config)
        if share_below >= share:
            break
        plane, share = lower, share_below
    return plane


def _with_things(plane: Plane, others: Iterable[Plane], min_things: float, sample: Sample, config: Support) -> Plane:
    """Return the first plane on which at least the share `min_things` of the points stands. The plane `plane` is tested
    first, and then the planes `others`. If too few points stand on every plane, return `plane`.
    """
    if sample.share_standing_on(plane, config) >= min_things:
        return plane
    apart = ~sample.on(plane, config)
    for other in others:
        own = float((sample.on(other, config) & apart).mean())
        if own >= config.min_share and sample.share_standing_on(other, config) >= min_things:
            return other
    return plane


def _stacked(floor: Plane, stacked_share: float, sample: Sample, config: Support) -> Plane | None:
    """Return the largest plane that is parallel to `floor` and above `floor`. Return None if too few points lie on the
    parallel plane.
    """
    height = np.sort(floor.height_m(sample.points))
    height = height[height > STACKED_M]
    if height.size < 3:
        return None
    within = np.searchsorted(height, height + STACKED_SLACK_M) - np.arange(height.size)
    low = height[within.argmax()]
    heights = floor.height_m(sample.points)
    band = (heights >= low) & (heights <= low + STACKED_SLACK_M)
    plane = _refine(_fit(sample.points[band]), sample, config) if np.count_nonzero(band) >= 3 else None
    if plane is None or plane.normal @ floor.normal < STACKED_COSINE:
        return None
    least = max(stacked_share * sample.share_on(floor, config), config.min_share)
    return plane if sample.share_on(plane, config) >= least else None


def _largest_planes(sample: Sample, rng: np.random.Generator, config: Support) -> Iterator[Plane]:
    """Yield up to `MOST_PLANES` different planes, approximately in descending order of their size. At least the share
    `min_share` of the sampled points lies on each plane.
    """
    tried: list[Plane] = []
    for hypothesis in _hypotheses(sample.points, rng, config):
        if len(tried) == MOST_PLANES:
            return
        if any(_is_alike(hypothesis, other) for other in tried):
            continue
        plane = _refine(hypothesis, sample, config)
        if plane is None or sample.share_on(plane, config) < config.min_share:
            return
        tried.append(plane)
        yield plane


def _is_alike(plane: Plane, other: Plane) -> bool:
    near = abs(plane.offset_m - other.offset_m) < STACKED_SLACK_M
    return bool(near and plane.normal @ other.normal > STACKED_COSINE)


def _hypotheses(points: Points, rng: np.random.Generator, config: Support) -> Iterator[Plane]:
    """Yield planes, each through three random points of the sample `points` (N, 3). Planes on which the most points lie
    come first.
    """
    a, b, c = points[rng.integers(len(points), size=(3, HYPOTHESES))]
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 1e-9)
    offsets = -(normals * a).sum(1)
    near = np.zeros(HYPOTHESES, np.int64)
    planes = np.column_stack([normals, offsets]).astype(np.float32)
    tolerance = tolerance_m(points[:, 2].astype(np.float32), config)
    kernel.count_near(points.astype(np.float32).T.copy(), planes, tolerance, near)
    near[lengths[:, 0] <= 1e-9] = 0
    for k in np.argsort(-near, kind="stable"):
        yield _towards_camera(normals[k], float(offsets[k]))


def _refine(plane: Plane, sample: Sample, config: Support) -> Plane | None:
    """Refine a plane by repeated least squares on the points within the tolerance. Return None if fewer than three
    points lie within the tolerance.
    """
    for _ in range(REFINEMENTS):
        inliers = sample.points[sample.on(plane, config)]
        if len(inliers) < 3:
            return None
        plane = _fit(inliers)
    return plane


def _fit(points: Points) -> Plane:
    """Return the least-squares plane through points (N, 3)."""
    middle = points.mean(0)
    normal = np.linalg.eigh(np.cov((points - middle).T))[1][:, 0]
    return _towards_camera(normal, -float(normal @ middle))


def _towards_camera(normal: Points, offset_m: float) -> Plane:
    """Return the plane with its normal towards the camera. The camera is at the origin, so the offset of the returned
    plane is not negative.
    """
    return Plane(normal, offset_m) if offset_m >= 0 else Plane(-normal, -offset_m)
