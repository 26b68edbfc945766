"""Buffers that are kept between frames, so that no frame has to ask the system for tens of megabytes anew."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

LARGEST_HEAP_BLOCK = 32 * 2**20 - 2**13
"""Size of the largest block whose release raises glibc's thresholds, without its header. See mallopt(3)."""


class Workspace:
    """Named pieces of scratch memory. One per thread. No result ever lies in it."""

    def __init__(self) -> None:
        keep_freed_memory()
        self._memory: dict[str, npt.NDArray[np.uint8]] = {}

    def array(self, name: str, size: int, dtype: npt.DTypeLike) -> npt.NDArray[Any]:
        """An array (size,) with whatever values the last user left. The same memory as long as it is large enough.

        Two arrays of one name, whatever their type, are the same memory.
        """
        bytes_ = size * np.dtype(dtype).itemsize
        held = self._memory.get(name)
        if held is None or held.size < bytes_:
            held = self._memory[name] = np.empty(bytes_, np.uint8)
        return held[:bytes_].view(dtype)

    @property
    def size_bytes(self) -> int:
        """Return the number of bytes that it holds at the moment."""
        return sum(memory.nbytes for memory in self._memory.values())


def keep_freed_memory() -> None:
    """Let the C library keep the memory that a frame frees for the next one, up to 64 MB.

    glibc gives freed memory back to the system above twice the size of the largest block freed so far. That costs a
    frame up to a fifth of its time. This frees a large block that was never touched. On other systems it does nothing.
    """
    np.empty(LARGEST_HEAP_BLOCK, np.uint8)
