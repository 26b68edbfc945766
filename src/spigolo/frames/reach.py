"""Detection of stored values that no camera measured: the largest value of an integer type, and too large distances."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

REACH_M = 50.0
"""Maximum distance in metres that an RGB-D camera measures. Depth beyond it is missing."""
NEAREST_M, FARTHEST_M = 1e-6, 1e8
"""Range of depth in metres. No camera measures nearer, and the squares of larger values exceed float32."""
LEAST_WITHIN, MOST_EQUAL = 0.01, 0.5
"""Minimum share of depth within reach, and minimum share of the most frequent value among depth beyond it.

If both are undercut, the unit is probably wrong. All depth is then kept, so that a message can suggest the unit.
"""
LARGEST_UINT16 = 65535
"""Value that also means missing in wider integer types, as many files were converted from 16 bits."""


@dataclass(frozen=True, slots=True)
class OutOfReach:
    """Positive depth values that count as missing.

    value: the most frequent such value, as stored. pixels: number of such pixels. share: share of the frame. kind: the
    integer type whose largest value it is, or "" for a distance beyond REACH_M.
    """

    value: float
    pixels: int
    share: float
    kind: str = ""

    def __str__(self) -> str:
        what = f"the largest value of {self.kind}" if self.kind else f"farther than {REACH_M:.0f} m"
        share = f"{self.share:.1%} of the depth" if self.share >= 0.001 else f"depth of {self.pixels} pixels"
        return f"{share} is {self.value:g}, {what}, and counts as missing"


def is_sentinel(stored: npt.NDArray[Any]) -> npt.NDArray[np.bool_]:
    """Return True (H, W) where integers have the largest value of their type, or of 16 bits in a wider type."""
    largest = np.iinfo(stored.dtype).max
    found = stored == largest
    return np.asarray(found | (stored == LARGEST_UINT16) if largest > LARGEST_UINT16 else found)


def drop_out_of_reach(stored: npt.NDArray[Any], metres: npt.NDArray[np.float32]) -> OutOfReach | None:
    """Set implausible depth in `metres` (H, W) to 0. Return a description of it, or None if all depth is plausible.

    stored (H, W): the same depth before conversion to metres.
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
    """Return True if values beyond reach are probably distances in a wrong unit: nearly all values, or most with
    variation.

    within: number of pixels within reach.
    """
    if within <= LEAST_WITHIN * beyond.size:
        return True
    return within < beyond.size and int(np.unique(beyond, return_counts=True)[1].max()) < MOST_EQUAL * beyond.size


def _kind(dtype: np.dtype[Any], value: Any) -> str:
    return "uint16" if value == LARGEST_UINT16 else str(dtype)
