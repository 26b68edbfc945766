"""Search for flat objects, which the other stages miss because of their small height (`settings.Flats`).

The colour image is divided along its edges into cells. A cell counts as raised if its mean height above the support
surface is larger than a limit. The mean height of many pixels has far less noise than that of one pixel, so the limit
can be a few millimetres. Printed patterns on the surface have edges too, but the cells between these edges are not
raised.
"""

from __future__ import annotations

from collections.abc import Iterator

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.additions.plane import Plane
from spigolo.frames.camera import Camera
from spigolo.frames.frame import DepthMap, Mask
from spigolo.settings.support import Flats

STEP = 2
"""Distance in pixels between the rows, and between the columns, in which flat objects are searched."""
FIT_STEP = 4
"""Distance between the rows, and between the columns, to which the support surface is fitted. The distance is counted
in rows and columns of the search for flat objects, which are `STEP` pixels apart.
"""
FIT_ROUNDS = 4
LEAST_FITTED = 80
"""Minimum number of pixels to which the support surface is fitted."""
BELOW, ABOVE = 3.0, 1.5
"""Maximum distances of a pixel below and above the fitted surface, as multiples of the noise. Pixels farther from the
surface are left out of the next fit. The limit `ABOVE` is smaller than `BELOW`, because objects lie above the surface.
"""

Heights = npt.NDArray[np.float32]
Labels = npt.NDArray[np.int32]
Square = npt.NDArray[np.uint8]


def find_flats(free: Mask, depth: DepthMap, camera: Camera, plane: Plane, edges: Mask, config: Flats) -> Labels:
    """Return the labels (H, W) of the flat objects of a frame, from 1, and 0 elsewhere.

    - free: mask (H, W) of the pixels that belong to no object.
    - depth: measured depth (H, W) in metres, 0 where missing.
    - edges: mask (H, W) of the edges of the colour image.
    """
    nothing = np.zeros(depth.shape, np.int32)
    some = np.s_[::STEP, ::STEP]  # the outlines are refined later, so every second row and column are enough
    slope_x, slope_y, slope = plane.slopes(depth.shape, camera)
    z = depth[some]
    above = (slope_x[None, ::STEP] + slope_y[::STEP, None] + slope) * z + np.float32(plane.offset_m)
    surface = surface_heights(above, z > 0, config.band_m)
    if surface is None:
        return nothing
    heights, noise_m = surface
    limit_m = max(config.min_height_m, config.noise_factor * noise_m)
    near = free[some] & (z > 0) & (np.abs(heights) < config.band_m)
    lines = cv2.dilate(edges.view(np.uint8), np.ones((3, 3), np.uint8))[some]
    _, cells, stats, _ = cv2.connectedComponentsWithStats((near & (lines == 0)).view(np.uint8), connectivity=4)
    areas = stats[:, cv2.CC_STAT_AREA]
    raised = _mean_heights(cells, areas, heights, config) > limit_m
    if not raised.any():
        return nothing
    low = ~raised & (STEP**2 * areas >= config.min_cell_px2)
    low[0] = False
    upper = near & ~low[cells] & (raised[cells] | (heights > limit_m))
    found = np.zeros(z.shape, np.int32)
    for number, patch in enumerate(_patches(upper, near, cells, raised, areas, config), start=1):
        found[patch & (found == 0)] = number
    whole = found.repeat(STEP, axis=0).repeat(STEP, axis=1)[: depth.shape[0], : depth.shape[1]]
    return np.where(free, whole, np.int32(0))


def surface_heights(heights: Heights, measured: Mask, band_m: float) -> tuple[Heights, float] | None:
    """Return the heights (H, W) above the support surface, and the noise of the surface, in metres. Returns None if too
    few pixels lie near the support plane.

    The surface is a polynomial of the second degree in the pixel coordinates, because the depth of many cameras is
    slightly curved.

    - heights: heights (H, W) above the support plane in metres.
    - measured: mask (H, W) of the pixels with depth.
    - band_m: maximum distance of a pixel from the support plane, in metres, at which the pixel is used for the fit.
    """
    height, width = heights.shape
    y, x = np.linspace(-1, 1, height, dtype=np.float32)[:, None], np.linspace(-1, 1, width, dtype=np.float32)[None, :]
    some = np.s_[FIT_STEP // 2 :: FIT_STEP, FIT_STEP // 2 :: FIT_STEP]
    kept = measured[some] & (np.abs(heights[some]) < band_m)
    ys, xs, values = (np.broadcast_to(v, heights.shape)[some][kept].astype(float) for v in (y, x, heights))
    terms = np.stack((np.ones_like(ys), ys, xs, ys * ys, ys * xs, xs * xs), axis=1)
    used = np.ones(values.size, bool)
    for _ in range(FIT_ROUNDS):
        if np.count_nonzero(used) < LEAST_FITTED:
            return None
        chosen = terms[used]
        factors = np.linalg.lstsq(chosen.T @ chosen, chosen.T @ values[used], rcond=None)[0]
        rest = values - terms @ factors
        noise_m = 1.4826 * float(np.median(np.abs(rest[used])))
        used = (rest <= ABOVE * noise_m) & (rest >= -BELOW * noise_m)
    low, high = np.percentile(terms[used] @ factors, (1, 99)).astype(np.float32)
    c, c_y, c_x, c_yy, c_yx, c_xx = factors.astype(np.float32)
    surface = (c_y * y + c_yy * y * y + c) + (c_x * x + c_xx * x * x) + (c_yx * y) * x
    return heights - np.clip(surface, low, high, out=surface), noise_m


def _mean_heights(
    cells: Labels, areas: npt.NDArray[np.int32], heights: Heights, config: Flats
) -> npt.NDArray[np.float64]:
    """Return the mean height of each cell in metres. Very small and very large cells get the mean height 0."""
    asked = (STEP**2 * areas >= config.min_cell_px2) & (areas <= config.max_share * cells.size)
    asked[0] = False
    sums = np.bincount(cells.ravel(), heights.ravel(), areas.size)
    return np.where(asked, sums / np.maximum(areas, 1), 0.0)


def _patches(
    upper: Mask,
    near: Mask,
    cells: Labels,
    raised: npt.NDArray[np.bool_],
    areas: npt.NDArray[np.int32],
    config: Flats,
) -> Iterator[Mask]:
    """Yield the mask (H, W) of each connected patch of raised pixels that the support surface surrounds."""
    gap_reach = 2 * max(round(config.gap_px / STEP), 1)
    ring_reach = max(round(config.ring_px / STEP), gap_reach + 1)
    height, width = upper.shape
    _, patches, stats, _ = cv2.connectedComponentsWithStats(upper.view(np.uint8), connectivity=4)
    sizes = stats[1:, cv2.CC_STAT_AREA]
    fitting = (STEP**2 * sizes >= config.min_area_px2) & (sizes <= config.max_share * upper.size)
    for number in (np.flatnonzero(fitting) + 1).tolist():
        left, top, across, down, area = stats[number].tolist()
        if left <= 1 or top <= 1 or left + across >= width - 1 or top + down >= height - 1:
            continue
        reach = ring_reach + 2
        box = slice(max(top - reach, 0), top + down + reach), slice(max(left - reach, 0), left + across + reach)
        filled = _with_pockets(patches[box] == number, cells[box], raised, areas, area, _square(gap_reach))
        if np.count_nonzero(filled) > config.max_share * upper.size:
            continue
        around = (cv2.dilate(filled, _square(ring_reach)) > 0) & (cv2.dilate(filled, _square(gap_reach)) == 0)
        others = upper[box] & (patches[box] != number)
        surface = around & near[box] & ~upper[box]
        if np.count_nonzero(surface) < config.min_ring * np.count_nonzero(around & ~others):
            continue
        if 2 * np.count_nonzero(surface) >= np.count_nonzero(around):
            out = np.zeros(upper.shape, np.uint8)
            out[box] = cv2.dilate(filled, _square(1))
            yield out > 0


def _with_pockets(
    patch: Mask,
    cells: Labels,
    raised: npt.NDArray[np.bool_],
    areas: npt.NDArray[np.int32],
    area: int,
    reach: Square,
) -> npt.NDArray[np.uint8]:
    """Fill the holes of a patch, and add low cells with at least half of their border near the patch. For example, the
    bottom of a tray is added to the patch. Holes and cells that are larger than the patch itself are not added.
    """
    filled = patch.astype(np.uint8)
    _, holes, stats, _ = cv2.connectedComponentsWithStats((~patch).view(np.uint8), connectivity=4)
    outside = np.unique(np.concatenate((holes[0], holes[-1], holes[:, 0], holes[:, -1])))
    small = stats[:, cv2.CC_STAT_AREA] <= area
    small[outside] = False
    filled[small[holes]] = 1
    beside = cv2.dilate(patch.view(np.uint8), reach) > 0
    for number in np.unique(cells[beside & (cells > 0)]):
        if raised[number] or areas[number] > area:
            continue
        cell = cells == number
        if np.count_nonzero(cell) < areas[number]:  # the cell continues outside the patch's surroundings
            continue
        border = (cv2.dilate(cell.view(np.uint8), _square(1)) > 0) & ~cell
        if 2 * np.count_nonzero(border & beside) >= np.count_nonzero(border):
            filled[cell] = 1
    return np.asarray(cv2.morphologyEx(filled, cv2.MORPH_CLOSE, _square(2)))


def _square(reach: int) -> Square:
    return np.ones((2 * reach + 1, 2 * reach + 1), np.uint8)
