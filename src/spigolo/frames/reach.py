"""Detection of depth values that no camera measures: the largest value of an integer type, and distances over 50 m."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

REACH_M = 50.0
"""Maximum distance in metres that an RGB-D camera measures. Depth beyond this distance counts as missing."""
NEAREST_M, FARTHEST_M = 1e-6, 1e8
"""Minimum and maximum depth in metres. Depth values below NEAREST_M or above FARTHEST_M count as missing."""
LEAST_WITHIN, MOST_EQUAL = 0.01, 0.5
"""Limits to detect depth in a wrong unit, such as millimetres that were read as metres.

- LEAST_WITHIN: the unit is wrong if the number of pixels up to REACH_M, divided by that of pixels beyond REACH_M, is at
  most this limit.
- MOST_EQUAL: a depth value means missing depth if at least this share of the pixels beyond REACH_M has the value. If no
  depth value means missing depth, the unit is wrong if most pixels lie beyond REACH_M.

Depth in a wrong unit does not count as missing, so that a message can suggest the right unit.
"""
LARGEST_UINT16 = 65535
"""The value 65535 means missing depth in 16-bit files. In arrays of 32-bit and 64-bit integers, which may have been
read from 16-bit files, 65535 means missing depth too.
"""


@dataclass(frozen=True, slots=True)
class OutOfReach:
    """Description of positive depth values that no camera measures. These implausible values count as missing depth.

    - value: the most frequent implausible depth value, as stored.
    - pixels: number of pixels with the most frequent implausible value.
    - share: `pixels` divided by the number of all pixels of the frame.
    - kind: integer type whose largest value is `value`, such as "uint16". The type `kind` is empty if `value` is a
      distance beyond REACH_M.
    """

    value: float
    pixels: int
    share: float
    kind: str = ""

    def __str__(self) -> str:
        what = f"the largest value of {self.kind}" if self.kind else f"farther than {REACH_M:.0f} m"
        few = "1 pixel" if self.pixels == 1 else f"{self.pixels} pixels"
        where = f"{self.share:.1%} of the pixels" if self.share >= 0.001 else few
        return f"depth {self.value:g}, {what}, counts as missing (at {where})"


def is_sentinel(stored: npt.NDArray[Any]) -> npt.NDArray[np.bool_]:
    """Return the mask (H, W) of pixels with the largest value of the integer type. In integer types with more than 16
    bits, pixels with the value 65535 also belong to the mask.
    """
    largest = np.iinfo(stored.dtype).max
    found = stored == largest
    return np.asarray(found | (stored == LARGEST_UINT16) if largest > LARGEST_UINT16 else found)


def drop_out_of_reach(stored: npt.NDArray[Any], metres: npt.NDArray[np.float32]) -> OutOfReach | None:
    """Set depth values that no camera measures to 0 in `metres` (H, W).

    Return a description of the removed values, or None if all depth values are plausible.

    stored: the same depth map (H, W) before its conversion to metres.
    """
    beyond = metres > REACH_M
    sentinel = is_sentinel(stored) if stored.dtype.kind in "ui" else np.zeros_like(beyond)
    if beyond.any():
        beyond &= np.isfinite(stored) & ~sentinel
        within = int(np.count_nonzero((metres >= NEAREST_M) & (metres <= REACH_M) & ~sentinel))
        if _is_wrong_unit(stored[beyond], within):
            beyond[...] = False
    dropped = np.asarray(beyond | sentinel)
    if not dropped.any():
        return None
    values, counts = np.unique(stored[dropped], return_counts=True)
    value = values[counts.argmax()]
    metres[dropped] = 0
    kind = _kind(stored.dtype, value) if (sentinel & (stored == value)).any() else ""
    pixels = int(counts.max())
    return OutOfReach(float(value), pixels, pixels / dropped.size, kind)


def _is_wrong_unit(beyond: npt.NDArray[Any], within: int) -> bool:
    """Return True if depth values beyond REACH_M are probably valid distances in another unit, such as millimetres.

    - beyond: depth values (N,) beyond REACH_M, as stored.
    - within: number of pixels within REACH_M.
    """
    if within <= LEAST_WITHIN * beyond.size:
        return True
    return within < beyond.size and int(np.unique(beyond, return_counts=True)[1].max()) < MOST_EQUAL * beyond.size


def _kind(dtype: np.dtype[Any], value: Any) -> str:
    return "uint16" if value == LARGEST_UINT16 else str(dtype)
