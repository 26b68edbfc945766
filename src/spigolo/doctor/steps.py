"""Coarse depth: whole-pixel disparity, or 8 bits kept in 16, leave wide gaps between the depths that occur."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from spigolo.doctor.findings import Finding, fine, note, warning
from spigolo.frames.frame import DepthMap

STEPS = "depth steps"

TICK_M = 1e-4
"""Resolution at which depths count as equal."""
GAP_PER_M = 4e-3
"""Half the window around a depth by its square, 1/m. A Kinect v1 has steps of 2.9e-3, whole pixels of disparity 1.6e-2
or more."""
GAP_UNITS = 2.5
"""The same in units of the file, so that millimetres at close range are no gap."""
ALONE = 0.8
"""Median share of a depth in its window from which on depth is coarse."""
FEWEST = 8
"""Number of depths that a frame must have to be judged."""
SATURATED_SHARE = 0.005
"""Minimum share of the frame that holds the largest depth for it to be no distance."""
SATURATED_RATIO = 1.4
"""Minimum ratio of that depth to the next smaller one."""


@dataclass(frozen=True, slots=True, eq=False)
class Levels:
    """The depths that occur, in ticks and in ascending order, and how many pixels have each."""

    ticks: npt.NDArray[np.int64]
    counts: npt.NDArray[np.int64]

    @property
    def unit(self) -> int:
        """The largest number of ticks that all depths are multiples of."""
        return int(np.gcd.reduce(self.ticks)) if self.ticks.size else 1


def levels_of(depth: DepthMap) -> Levels:
    """Return the depths that occur in a depth map (H, W)."""
    return Levels(*np.unique(np.rint(depth[depth > 0] / TICK_M).astype(np.int64), return_counts=True))


def check_steps(depth: DepthMap) -> Finding:
    """Find depth that comes in steps far wider than those of any depth camera at its distance."""
    levels = levels_of(depth)
    if levels.ticks.size < FEWEST:
        return note(STEPS, f"depth steps cannot be judged: {levels.ticks.size} different depths are few", judged=False)
    share = _alone(levels)
    middle = int(np.searchsorted(np.cumsum(levels.counts), levels.counts.sum() / 2))
    if share < ALONE:
        return fine(STEPS, f"{levels.ticks.size} different depths, no wide gaps between them")
    gap_m = _gap_m(levels, middle)
    return warning(
        STEPS,
        f"expected depth in steps of millimetres, found steps of {1000 * gap_m:.0f} mm at"
        f" {levels.ticks[middle] * TICK_M:.2f} m and {levels.ticks.size} depths in all: switch subpixel disparity on,"
        " and store depth with 16 bits, not 8 bits scaled up",
    )


def check_saturated(depth: DepthMap) -> Finding:
    """Find one depth far beyond all others that many pixels have: a code for missing depth, not a distance."""
    levels = levels_of(depth)
    if levels.ticks.size >= FEWEST:
        share, ratio = levels.counts[-1] / depth.size, levels.ticks[-1] / levels.ticks[-2]
        if share >= SATURATED_SHARE and ratio >= SATURATED_RATIO:
            value_m = levels.ticks[-1] * TICK_M
            return warning(
                "largest depth",
                f"expected distances, found {value_m:.3f} m in {share:.1%} of the frame and nothing else beyond"
                f" {levels.ticks[-2] * TICK_M:.3f} m: if it stands for missing depth, store 0 (raw Kinect disparity has"
                " 2047: convert it to metres first)",
            )
    return fine("largest depth", "no single value stands apart from all other depths")


def _alone(levels: Levels) -> float:
    """Return the median, over the pixels, of a depth's share of the pixels in the window around it."""
    half = np.maximum(GAP_PER_M * TICK_M * levels.ticks.astype(np.float64) ** 2, GAP_UNITS * levels.unit)
    total = np.concatenate([[0], np.cumsum(levels.counts)])
    low = np.searchsorted(levels.ticks, levels.ticks - half, "left")
    high = np.searchsorted(levels.ticks, levels.ticks + half, "right")
    share = levels.counts / (total[high] - total[low])
    order = np.argsort(share)
    return float(share[order][np.searchsorted(np.cumsum(levels.counts[order]), levels.counts.sum() / 2)])


def _gap_m(levels: Levels, middle: int) -> float:
    """Return the mean gap between depths that many pixels have, around the one at `middle`."""
    common = np.nonzero(levels.counts >= 0.1 * levels.counts[middle])[0]
    place = int(np.searchsorted(common, middle))
    near = levels.ticks[common[max(place - 1, 0) : place + 2]]
    return float(np.diff(near).mean()) * TICK_M if near.size > 1 else 0.0
