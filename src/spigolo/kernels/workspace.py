"""Scratch memory that is reused from frame to frame."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

LARGEST_HEAP_BLOCK = 32 * 2**20 - 2**13
"""Size in bytes of the memory block that `keep_freed_memory` frees. The C library glibc raises its memory thresholds
only when it frees blocks up to this size (see mallopt(3)).
"""


class Workspace:
    """Named arrays of scratch memory. Use one Workspace for each thread."""

    def __init__(self) -> None:
        keep_freed_memory()
        self._memory: dict[str, npt.NDArray[np.uint8]] = {}

    def array(self, name: str, size: int, dtype: npt.DTypeLike) -> npt.NDArray[Any]:
        """Return an array (size,) with undefined content, in memory that is reused by later calls with the same name.

        Arrays with the same name share memory, even if their types differ.
        """
        bytes_ = size * np.dtype(dtype).itemsize
        held = self._memory.get(name)
        if held is None or held.size < bytes_:
            held = self._memory[name] = np.empty(bytes_, np.uint8)
        return held[:bytes_].view(dtype)

    @property
    def size_bytes(self) -> int:
        """Return the total size of the scratch memory in bytes."""
        return sum(memory.nbytes for memory in self._memory.values())


def keep_freed_memory() -> None:
    """Let the C library glibc keep up to 64 MB of freed memory, to save time in the next frame.

    By default, glibc keeps freed memory up to a threshold, and returns the rest to the operating system. This threshold
    of freed memory grows with the largest freed block. This function frees one large block to raise the threshold. With
    other C libraries, this function has no effect.
    """
    np.empty(LARGEST_HEAP_BLOCK, np.uint8)
