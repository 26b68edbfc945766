"""Support plane: the largest plane of a frame, on which objects stand (our addition, not in the paper)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import chain

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.clock import stage
from spigolo.frames.frame import Camera, DepthMap, Mask
from spigolo.kernels import planes as kernel
from spigolo.settings.additions import Facing, Support

SAMPLES = 3000
HYPOTHESES = 200
REFINEMENTS = 3
SPECKLE_PX = 5
STACKED_M = 0.1
STACKED_SLACK_M = 0.05
STACKED_COSINE = 0.97
"""Minimum cosine of the angle between the normals of the largest plane and a second one above it, i.e. 14 degrees.

A second support is at least 10 cm above the first. Heights are tested in steps of 5 cm.
"""
MOST_BELOW = 0.25
CELLS = 24
"""Number of grid cells along the longer image side in the test for opaque planes.

A plane is not opaque if more than a maximum share of the points that it surrounds lie below it.
"""
SPARSE = 0.6
"""Share of measured depth in a frame below which sides of a plane may be unseen. An opaque plane then has fewer points
below it than on it.
"""
TALLEST_M = 0.3
"""Maximum height above a plane at which points count as things standing on it, metres."""
MOST_PLANES = 6
SEED = 7
"""Fixed seed of RANSAC, so that the same frame gives the same plane."""

Points = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Plane:
    """Plane with unit normal (3,) towards the camera. The height of point p is normal . p + offset_m."""

    normal: Points
    offset_m: float

    def height_m(self, points: Points) -> Points:
        """Return the heights (N,) of points (N, 3) above the plane. The side of the camera is positive."""
        return np.asarray(points @ self.normal + self.offset_m)

    def height_map_m(self, depth: DepthMap, camera: Camera) -> npt.NDArray[np.float32]:
        """Return the height (H, W) of every pixel of a depth map (H, W) in metres. Missing depth gives offset_m."""
        out = np.empty(depth.shape, np.float32)
        kernel.measure_heights(depth, *self.slopes(depth.shape, camera), np.float32(self.offset_m), out)
        return out

    def slopes(
        self, shape: tuple[int, ...], camera: Camera
    ) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32], np.float32]:
        """Return slopes for columns, for rows and a constant slope. height = (sum of the three) * depth + offset_m."""
        a, b, c = (float(v) for v in self.normal)
        slope_x = (np.arange(shape[1], dtype=np.float32) - np.float32(camera.cx)) * np.float32(a / camera.fx)
        slope_y = (np.arange(shape[0], dtype=np.float32) - np.float32(camera.cy)) * np.float32(b / camera.fy)
        return slope_x, slope_y, np.float32(c)


def tolerance_m(depth: npt.NDArray[np.floating], config: Support) -> npt.NDArray[np.float32]:
    """Return the maximum distance of plane pixels from the plane: `min_height_m`, or the depth error if that is
    larger.
    """
    return np.maximum(np.float32(config.min_height_m), np.float32(config.noise_per_m) * depth * depth)


@stage("support plane")
def find_support(
    depth: DepthMap,
    camera: Camera | None,
    config: Support | None,
    max_distance_m: float | None = None,
    roi: Mask | None = None,
) -> Plane | None:
    """Find the support plane, within reach and near the region of interest if the parameters require it.

    depth: (H, W) in metres, as measured. max_distance_m: the reach. roi: pixels (H, W) of the region of interest.
    Returns None without parameters or camera, or if no plane has enough of the measured pixels.
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


def _grown_box(mask: Mask, share: float) -> tuple[int, int, int, int]:
    """Return the box around a mask (H, W), enlarged by a share of its height and width on each side."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    ends = []
    for first, end, size in ((rows[0], rows[-1] + 1, mask.shape[0]), (columns[0], columns[-1] + 1, mask.shape[1])):
        more = round(share * (end - first))
        ends.append((max(int(first) - more, 0), min(int(end) + more, size)))
    return ends[0][0], ends[1][0], ends[0][1], ends[1][1]


def faces_up(plane: Plane, share: float, rule: Facing) -> bool:
    """Return True if objects can stand on a plane with this share of the measured pixels."""
    x, y, _ = plane.normal
    if rule.up is not None:
        up = np.asarray(rule.up, np.float64)
        return bool(plane.normal @ up >= np.cos(np.radians(rule.max_tilt_deg)) * np.linalg.norm(up))
    if y > np.sin(np.radians(rule.max_down_deg)):
        return False
    return bool(abs(x) <= np.sin(np.radians(rule.max_roll_deg)) or share >= rule.min_share_sideways)


def _find_plane(depth: DepthMap, camera: Camera, config: Support) -> Plane | None:
    """Find the plane with the most measured pixels. None without a rule, a camera, or a plane of `min_share` of them.

    RANSAC runs on a sample of the pixels. Least squares then refines the plane on the points within the tolerance.
    """
    valid = np.flatnonzero(depth > 0)
    if valid.size < 3:
        return None
    rng = np.random.default_rng(SEED)
    y, x = np.divmod(valid[rng.integers(valid.size, size=min(SAMPLES, valid.size))], depth.shape[1])
    z = depth[y, x].astype(np.float64)
    sample = np.stack([(x - camera.cx) / camera.fx * z, (y - camera.cy) / camera.fy * z, z], axis=1)
    cells = np.stack([y, x], axis=1) * CELLS // max(depth.shape)
    is_opaque = partial(_is_opaque, sample=sample, cells=cells, sparse=valid.size < SPARSE * depth.size, config=config)
    planes: Iterator[Plane] = _largest_planes(sample, rng, config)
    if config.facing is not None:
        faces = partial(faces_up, rule=config.facing)
        planes = (p for p in planes if faces(p, _share(p, sample, config)))
    plane = next(planes, None)
    if plane is None:
        return None
    if config.opaque:
        plane = next(filter(is_opaque, chain([plane], planes)), plane)
    if config.min_things is not None:
        plane = _with_things(plane, filter(is_opaque, planes), sample, cells, config)
    stacked = None if config.stacked_share is None else _stacked(plane, sample, config)
    return stacked if stacked is not None and is_opaque(stacked) else plane


def support_mask(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> Mask:
    """Return the pixels (H, W) that lie on the plane, within the tolerance."""
    return np.asarray(_sides(plane, depth, camera, config) == kernel.ON)


def above_mask(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> Mask:
    """Return the pixels (H, W) that are above the plane by more than the tolerance."""
    return np.asarray(_sides(plane, depth, camera, config) == kernel.ABOVE)


def _sides(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> npt.NDArray[np.uint8]:
    out = np.empty(depth.shape, np.uint8)
    least, noise = np.float32(config.min_height_m), np.float32(config.noise_per_m)
    kernel.tell_sides(depth, *plane.slopes(depth.shape, camera), np.float32(plane.offset_m), least, noise, out)
    return out


def foot_contour(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> Mask:
    """Return the pixels (H, W) above the plane that have a neighbour on the plane or without depth: object outlines.

    Speckles of one or two pixels are removed first.
    """
    above = cv2.medianBlur(above_mask(plane, depth, camera, config).view(np.uint8), SPECKLE_PX)
    beside = (above == 0).view(np.uint8)
    return np.asarray((above > 0) & (cv2.dilate(beside, np.ones((3, 3), np.uint8)) > 0))


def _on(plane: Plane, points: Points, config: Support) -> Mask:
    return np.asarray(np.abs(plane.height_m(points)) <= tolerance_m(points[:, 2], config))


def _share(plane: Plane, sample: Points, config: Support) -> float:
    return float(_on(plane, sample, config).mean())


def _refine(plane: Plane, sample: Points, config: Support) -> Plane | None:
    """Refine a plane by repeated least squares on the points within the tolerance. None if there are too few."""
    for _ in range(REFINEMENTS):
        inliers = sample[_on(plane, sample, config)]
        if len(inliers) < 3:
            return None
        plane = _fit(inliers)
    return plane


def _stacked(floor: Plane, sample: Points, config: Support) -> Plane | None:
    """Return the largest plane above `floor` and parallel to it. None if its share is too small."""
    assert config.stacked_share is not None
    height = np.sort(floor.height_m(sample))
    height = height[height > STACKED_M]
    if height.size < 3:
        return None
    within = np.searchsorted(height, height + STACKED_SLACK_M) - np.arange(height.size)
    low = height[within.argmax()]
    band = (floor.height_m(sample) >= low) & (floor.height_m(sample) <= low + STACKED_SLACK_M)
    plane = _refine(_fit(sample[band]), sample, config) if np.count_nonzero(band) >= 3 else None
    if plane is None or plane.normal @ floor.normal < STACKED_COSINE:
        return None
    least = max(config.stacked_share * _share(floor, sample, config), config.min_share)
    return plane if _share(plane, sample, config) >= least else None


def _is_opaque(plane: Plane, sample: Points, cells: npt.NDArray[np.int64], sparse: bool, config: Support) -> bool:
    """Return True if almost no points are visible through the plane, where the plane surrounds them on three sides.

    A table hides the floor. The front edges of a shelf lie in one plane too, but surround points behind it.

    cells (N, 2): position of each sample point in a coarse grid. A cell belongs to the plane if most of its points do.
    sparse: True for a frame without most of its depth.
    """
    on, below = _on(plane, sample, config), plane.height_m(sample) < -tolerance_m(sample[:, 2], config)
    surrounded = _surrounded(on, cells)
    if sparse and np.count_nonzero(below) > np.count_nonzero(on):
        return False
    return bool(np.count_nonzero(below & surrounded) <= MOST_BELOW * np.count_nonzero((below | on) & surrounded))


def _with_things(
    plane: Plane, others: Iterable[Plane], sample: Points, cells: npt.NDArray[np.int64], config: Support
) -> Plane:
    """Return the plane, or the first of the other planes with objects on it if almost nothing stands on the plane."""
    assert config.min_things is not None
    if _things(plane, sample, cells, config) >= config.min_things:
        return plane
    apart = ~_on(plane, sample, config)
    for other in others:
        own = float((_on(other, sample, config) & apart).mean())
        if own >= config.min_share and _things(other, sample, cells, config) >= config.min_things:
            return other
    return plane


def things_on(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> float:
    """Return the share of the measured pixels that stand on a plane, estimated on a grid of pixels."""
    step = max(round((depth.size / SAMPLES) ** 0.5), 1)
    y, x = np.nonzero(depth[::step, ::step])
    if y.size == 0:
        return 0.0
    y, x = y * step, x * step
    z = depth[y, x].astype(np.float64)
    sample = np.stack([(x - camera.cx) / camera.fx * z, (y - camera.cy) / camera.fy * z, z], axis=1)
    return _things(plane, sample, np.stack([y, x], axis=1) * CELLS // max(depth.shape), config)


def _things(plane: Plane, sample: Points, cells: npt.NDArray[np.int64], config: Support) -> float:
    """Return the share of the sample that stands on a plane.

    These points are at most `TALLEST_M` above the plane, and the plane surrounds them on three sides.
    """
    height = plane.height_m(sample)
    above = (height > tolerance_m(sample[:, 2], config)) & (height < TALLEST_M)
    return float((above & _surrounded(_on(plane, sample, config), cells)).mean())


def _surrounded(on: Mask, cells: npt.NDArray[np.int64]) -> Mask:
    """Return True for sample points (N,) in grid cells with the plane on at least three sides. on (N,): points on the
    plane.
    """
    votes = np.zeros(cells.max(axis=0) + 1, np.int64)
    np.add.at(votes, (cells[:, 0], cells[:, 1]), 2 * on - 1)
    shown, along = (votes > 0).astype(np.int64), np.maximum.accumulate
    sides = along(shown, 0) + along(shown[::-1], 0)[::-1] + along(shown, 1) + along(shown[:, ::-1], 1)[:, ::-1]
    return np.asarray((sides >= 3)[cells[:, 0], cells[:, 1]])


def _largest_planes(sample: Points, rng: np.random.Generator, config: Support) -> Iterator[Plane]:
    """Return up to six different planes, roughly the largest first, each with at least `min_share` of the sample."""
    tried: list[Plane] = []
    for hypothesis in _hypotheses(sample, rng, config):
        if len(tried) == MOST_PLANES:
            return
        if any(_is_alike(hypothesis, other) for other in tried):
            continue
        plane = _refine(hypothesis, sample, config)
        if plane is None or _share(plane, sample, config) < config.min_share:
            return
        tried.append(plane)
        yield plane


def _is_alike(plane: Plane, other: Plane) -> bool:
    near = abs(plane.offset_m - other.offset_m) < STACKED_SLACK_M
    return bool(near and plane.normal @ other.normal > STACKED_COSINE)


def _hypotheses(sample: Points, rng: np.random.Generator, config: Support) -> Iterator[Plane]:
    """Return planes through three random points each, sorted by their number of sample points, largest first."""
    a, b, c = sample[rng.integers(len(sample), size=(3, HYPOTHESES))]
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 1e-9)
    offsets = -(normals * a).sum(1)
    near = np.zeros(HYPOTHESES, np.int64)
    planes = np.column_stack([normals, offsets]).astype(np.float32)
    tolerance = tolerance_m(sample[:, 2].astype(np.float32), config)
    kernel.count_near(sample.astype(np.float32).T.copy(), planes, tolerance, near)
    near[lengths[:, 0] <= 1e-9] = 0
    for k in np.argsort(-near, kind="stable"):
        yield _towards_camera(normals[k], float(offsets[k]))


def _fit(points: Points) -> Plane:
    """Return the least-squares plane through points (N, 3)."""
    middle = points.mean(0)
    normal = np.linalg.eigh(np.cov((points - middle).T))[1][:, 0]
    return _towards_camera(normal, -float(normal @ middle))


def _towards_camera(normal: Points, offset_m: float) -> Plane:
    """Return the plane with its normal towards the camera, which is at the origin. The offset is then positive."""
    return Plane(normal, offset_m) if offset_m >= 0 else Plane(-normal, -offset_m)
