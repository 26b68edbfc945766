"""Check for coarse depth. If disparity is measured in whole pixels, or depth is stored with 8 bits, the depth values of
a frame are far apart.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from spigolo.doctor.findings import Finding, fine, note, warning
from spigolo.frames.frame import DepthMap

STEPS = "depth steps"

TICK_M = 1e-4
"""Resolution to which depth values are rounded, in metres."""
GAP_PER_M = 4e-3
"""Two depth values are similar if they differ by at most GAP_PER_M * depth^2. The steps between depth values, divided
by depth^2, are 2.9e-3 1/m for a Kinect v1, and at least 1.6e-2 1/m for whole-pixel disparity.
"""
GAP_UNITS = 2.5
"""Two depth values are also similar if they differ by at most this many units of the stored depth. Steps of one unit
are therefore never reported.
"""
ALONE = 0.8
"""Depth is reported as coarse if at least this share of the pixels with similar depth have exactly the same depth. The
share of pixels with exactly the same depth is computed for each pixel, and the median over all pixels is compared with
`ALONE`.
"""
FEWEST = 8
"""Minimum number of different depth values in a frame. With fewer different values, the steps between depth values
cannot be judged.
"""
SATURATED_SHARE = 0.005
"""The largest depth value is reported only if at least this share of the frame's pixels has this value."""
SATURATED_RATIO = 1.4
"""The largest depth value is reported only if it is at least this many times the second largest value."""


@dataclass(frozen=True, slots=True, eq=False)
class Levels:
    """Different depth values of a frame in ascending order, as multiples of `TICK_M` (ticks), and the number of pixels
    with each value.
    """

    ticks: npt.NDArray[np.int64]
    counts: npt.NDArray[np.int64]

    @property
    def unit(self) -> int:
        """Return the greatest common divisor of the depth values, as a multiple of `TICK_M`."""
        return int(np.gcd.reduce(self.ticks)) if self.ticks.size else 1


def levels_of(depth: DepthMap) -> Levels:
    """Return the different depth values of a depth map (H, W) in metres."""
    return Levels(*np.unique(np.rint(depth[depth > 0] / TICK_M).astype(np.int64), return_counts=True))


def check_steps(depth: DepthMap) -> Finding:
    """Check if the steps between depth values are much larger than the steps of any depth camera."""
    levels = levels_of(depth)
    if levels.ticks.size < FEWEST:
        why = f"depth steps cannot be judged: the frame has only {levels.ticks.size} different depth values"
        return note(STEPS, why, judged=False)
    share = _alone(levels)
    middle = int(np.searchsorted(np.cumsum(levels.counts), levels.counts.sum() / 2))
    if share < ALONE:
        return fine(STEPS, f"{levels.ticks.size} different depth values, without wide gaps between them")
    gap_m = _gap_m(levels, middle)
    return warning(
        STEPS,
        f"expected depth in steps of millimetres, found steps of {1000 * gap_m:.0f} mm at"
        f" {levels.ticks[middle] * TICK_M:.2f} m and {levels.ticks.size} depth values in all: switch on subpixel"
        " disparity, and store depth with 16 bits instead of scaled 8-bit values",
    )


def check_saturated(depth: DepthMap) -> Finding:
    """Check if many pixels have the same depth value, and if this value is much larger than all other depth values. A
    single value far beyond all others is probably a code for missing depth.
    """
    levels = levels_of(depth)
    if levels.ticks.size >= FEWEST:
        share, ratio = levels.counts[-1] / depth.size, levels.ticks[-1] / levels.ticks[-2]
        if share >= SATURATED_SHARE and ratio >= SATURATED_RATIO:
            value_m = levels.ticks[-1] * TICK_M
            return warning(
                "largest depth",
                f"expected measured depth, found {value_m:.3f} m in {share:.1%} of the frame and no other value beyond"
                f" {levels.ticks[-2] * TICK_M:.3f} m: if this value means missing depth, store 0 instead (raw Kinect"
                " disparity uses 2047: convert the disparity to metres first)",
            )
    return fine("largest depth", "no single value lies far beyond all other depth values")


def _alone(levels: Levels) -> float:
    """For each pixel, divide the number of pixels with equal depth by the number of pixels with similar depth. Return
    the median of the quotients of all pixels.
    """
    half = np.maximum(GAP_PER_M * TICK_M * levels.ticks.astype(np.float64) ** 2, GAP_UNITS * levels.unit)
    total = np.concatenate([[0], np.cumsum(levels.counts)])
    low = np.searchsorted(levels.ticks, levels.ticks - half, "left")
    high = np.searchsorted(levels.ticks, levels.ticks + half, "right")
    share = levels.counts / (total[high] - total[low])
    order = np.argsort(share)
    return float(share[order][np.searchsorted(np.cumsum(levels.counts[order]), levels.counts.sum() / 2)])


def _gap_m(levels: Levels, middle: int) -> float:
    """Return the mean distance, in metres, from the depth value at index `middle` to the next smaller and the next
    larger frequent value. A value is frequent if it occurs at least 0.1 times as often as the value at `middle`.
    """
    common = np.nonzero(levels.counts >= 0.1 * levels.counts[middle])[0]
    place = int(np.searchsorted(common, middle))
    near = levels.ticks[common[max(place - 1, 0) : place + 2]]
    return float(np.diff(near).mean()) * TICK_M if near.size > 1 else 0.0
