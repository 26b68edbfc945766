"""Preparation of the depth map: in-painting of small gaps, and smoothing that does not fill shadows (equations 5-8).

In-painting comes first, because sampling holes (at most two pixels wide) would make all smoothing windows tiny. Large
shadows (missing depth next to objects) are not filled and keep the depth 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.clock import stage
from spigolo.frames.frame import DepthMap, Mask
from spigolo.kernels import inpainting, smoothing
from spigolo.settings.paper import DepthConfig, Inpainting, Smoothing

Integral = npt.NDArray[np.float64]


@stage("depth")
def prepare_depth(depth: DepthMap, config: DepthConfig) -> DepthMap:
    """In-paint and smooth a depth map (H, W) in metres. Return D_s (H, W), which is 0 where depth is still missing."""
    if config.inpainting is not None:
        depth = inpaint_small_gaps(depth, config.inpainting)
    return depth if config.smoothing.mean == "none" else smooth(depth, config.smoothing)


def missing_mask(depth: DepthMap) -> Mask:
    """Eq. 6. Return the mask B_D (H, W) of pixels without depth."""
    return np.asarray(depth == 0)


def smoothing_area_map(depth: DepthMap, config: Smoothing) -> tuple[npt.NDArray[np.int32], Mask]:
    """Return the smoothing radius S (H, W) of each pixel, in pixels, and the depth-change map C (H, W) of Holzer et al.

    The smoothing radius grows with the depth error alpha d^2 at depth d. The radius decreases near depth steps, missing
    depth and the image border.
    """
    smooth_here = np.empty(depth.shape, np.uint8)
    smoothing.mark_steps(depth, config.error_per_m, config.step_factor, smooth_here)
    distance = _distance(smooth_here, int(np.ceil((config.max_radius_px + 1) * np.sqrt(2))))
    radius = np.empty(depth.shape, np.int32)
    smoothing.smoothing_radius(
        depth, distance, config.error_per_m, config.radius_per_error_px_m, config.max_radius_px, radius
    )
    return radius, smooth_here == 0


@stage("depth: smoothing")
def smooth(depth: DepthMap, config: Smoothing) -> DepthMap:
    """Eqs. 5, 7, 8. Return the mean depth (H, W) in the smoothing window of each pixel, in metres.

    The window of a pixel with radius r has (2r+1)^2 pixels. The mean is computed without missing pixels, and without
    depth steps if `config.skip_steps` is set. If `config.mean` is "plain", all pixels are used, and missing pixels have
    the depth 0. Pixels without depth stay without depth.
    """
    radius, steps = smoothing_area_map(depth, config)
    if config.mean == "plain":
        left_out = np.zeros(depth.shape, bool)
    else:
        left_out = steps | missing_mask(depth) if config.skip_steps else missing_mask(depth)
    out = np.empty_like(depth)
    counted = np.where(left_out, np.float32(0), depth)
    smoothing.mean_boxes(depth, _integral(counted), _count_integral(left_out), radius, out)
    return out


def _integral(image: DepthMap) -> Integral:
    """Return the integral image (H+1, W+1) of an image in float64, because float32 would cause depth errors of
    centimetres.
    """
    return np.asarray(cv2.integral(image, sdepth=cv2.CV_64F), np.float64)


def _count_integral(mask: Mask) -> npt.NDArray[np.int32]:
    """Return the integral image (H+1, W+1) of a mask (H, W)."""
    return np.asarray(cv2.integral(mask.view(np.uint8), sdepth=cv2.CV_32S), np.int32)


@stage("depth: in-painting")
def inpaint_small_gaps(depth: DepthMap, config: Inpainting) -> DepthMap:
    """Fill sampling holes (at most two pixels wide) and small gaps of a depth map (H, W) in metres.

    Gaps at the image border are not filled. If the pixels around a gap contain a depth step, the gap is a shadow on the
    background. A gap on a depth step therefore gets the largest depth of the pixels around it.

    config: parameters with lengths and areas scaled to the image size (`Settings.at_size`).
    """
    depth = depth.copy()
    if config.sampling_holes:
        _close(depth, np.flatnonzero(sampling_holes(missing_mask(depth))), 2, config)
    gaps, max_radius = find_gaps(depth), config.max_radius_px
    radius = np.zeros(len(gaps), np.float32)
    inpainting.widest(_distance(depth == 0, int(max_radius) + 2), gaps.runs, gaps.gap_of_run, radius)
    small = (gaps.area_px <= config.max_area_px2) & (radius <= max_radius) & ~gaps.on_border & (gaps.far_m > 0)
    step = gaps.far_m - gaps.near_m > np.maximum(config.step_m, config.step_share * gaps.near_m)
    shadows, holes = (small & step)[gaps.gap_of_run], (small & ~step)[gaps.gap_of_run]
    far_m = np.repeat(gaps.far_m[gaps.gap_of_run[shadows]], gaps.lengths[shadows])
    depth.reshape(-1)[gaps.pixels(shadows)] = far_m
    _close(depth, gaps.pixels(holes), int(np.ceil(radius[small & ~step].max(initial=0))), config)
    return depth


def sampling_holes(missing: Mask) -> Mask:
    """Return the mask (H, W) of holes that are at most two pixels wide.

    missing: mask (H, W) of pixels without depth.
    """
    wide = cv2.morphologyEx(missing.view(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))
    return np.asarray(missing & (wide == 0))


def _close(depth: DepthMap, holes: npt.NDArray[np.int64], layers: int, config: Inpainting) -> None:
    """Fill holes in a depth map, one layer of pixels after the other, from outside to inside.

    holes: indices y * W + x of the pixels in holes.
    """
    values = np.empty(holes.size, np.float32)
    for _ in range(layers):
        inpainting.close_holes(depth, holes, config.step_m, config.step_share, values)


def _distance(mask: Mask | npt.NDArray[np.uint8], cap: int) -> npt.NDArray[np.float32]:
    """Return the distance (H, W), in pixels, of each pixel to the nearest zero of a mask (H, W), at most `cap`."""
    out = np.empty(mask.shape, np.float32)
    smoothing.distance_to_zero(mask.view(np.uint8), cap, np.empty(mask.shape, np.int16), out)
    return out


@dataclass(frozen=True, slots=True, eq=False)
class Gaps:
    """Gaps of a depth map, which are 8-connected components of pixels without depth.

    - runs: (N, 3), row, first column and last column + 1 of every run of missing pixels in an image row.
    - gap_of_run: (N,), number of the gap of each run.
    - area_px: (G,), number of pixels of each gap.
    - near_m, far_m: (G,), smallest and largest valid depth around each gap in metres, 0 if no neighbour is valid.
    - on_border: (G,), True if the gap touches the image border.
    """

    width: int
    runs: npt.NDArray[np.int32]
    gap_of_run: npt.NDArray[np.int32]
    area_px: npt.NDArray[np.int64]
    near_m: npt.NDArray[np.float32]
    far_m: npt.NDArray[np.float32]
    on_border: Mask

    def __len__(self) -> int:
        return self.area_px.size

    @property
    def lengths(self) -> npt.NDArray[np.int64]:
        """Return the number of pixels (N,) of each run of missing pixels."""
        return np.asarray(self.runs[:, 2] - self.runs[:, 1], np.int64)

    def pixels(self, wanted: Mask) -> npt.NDArray[np.int64]:
        """Return the indices y * W + x of all pixels of the selected runs.

        wanted: mask (N,) of the selected runs.
        """
        row, first, _ = self.runs[wanted].astype(np.int64).T
        length = self.lengths[wanted]
        before = np.cumsum(length) - length
        return np.repeat(row * self.width + first - before, length) + np.arange(length.sum())


def find_gaps(depth: DepthMap) -> Gaps:
    """Return the connected areas without depth of a depth map (H, W) in metres."""
    height, width = depth.shape
    runs = np.empty((height * (width // 2 + 1), 3), np.int32)
    runs = runs[: inpainting.find_runs(depth, runs)]
    gap_of_run, scratch = np.empty(len(runs), np.int32), np.empty(len(runs), np.int32)
    count = inpainting.join_runs(runs, scratch, gap_of_run)
    area, on_border = np.zeros(count, np.int64), np.zeros(count, np.uint8)
    near, far = np.full(count, np.inf, np.float32), np.zeros(count, np.float32)
    inpainting.measure_gaps(depth, runs, gap_of_run, area, near, far, on_border)
    near[far == 0] = 0
    return Gaps(width, runs, gap_of_run, area, near, far, on_border.view(bool))


def missing_share(depth: DepthMap, max_distance_m: float | None = None) -> float:
    """Return the share of missing depth in a frame: the area of the gaps in the depth map, divided by the area of the
    frame.

    Gaps at the image border are not counted, because they may lie outside the view of the depth camera. A gap is also
    not counted if all valid depth around it is larger than `max_distance_m`.
    """
    gaps = find_gaps(depth)
    counted = ~gaps.on_border & (gaps.far_m > 0)
    if max_distance_m is not None:
        counted &= gaps.near_m <= max_distance_m
    return float(gaps.area_px[counted].sum() / depth.size)
