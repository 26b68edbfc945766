"""Buffers that are kept between frames, so that no frame has to ask the system for tens of megabytes anew."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt


class Workspace:
    """Named scratch arrays. One per thread; no result ever lies in it."""

    def __init__(self) -> None:
        self._arrays: dict[str, npt.NDArray[Any]] = {}

    def array(self, name: str, size: int, dtype: npt.DTypeLike) -> npt.NDArray[Any]:
        """An array (size,) with whatever values the last user left; the same memory as long as it is large enough."""
        held = self._arrays.get(name)
        if held is None or held.size < size or held.dtype != np.dtype(dtype):
            held = self._arrays[name] = np.empty(size, dtype)
        return held[:size]

    @property
    def size_bytes(self) -> int:
        """What it holds at the moment."""
        return sum(array.nbytes for array in self._arrays.values())
