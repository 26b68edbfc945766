"""Buffers that are kept between frames, so that not every frame allocates tens of megabytes again."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

LARGEST_HEAP_BLOCK = 32 * 2**20 - 2**13
"""Size of the largest block whose release raises glibc's thresholds, without its header. See mallopt(3)."""


class Workspace:
    """Named pieces of scratch memory, one Workspace per thread. Results are never stored in it."""

    def __init__(self) -> None:
        keep_freed_memory()
        self._memory: dict[str, npt.NDArray[np.uint8]] = {}

    def array(self, name: str, size: int, dtype: npt.DTypeLike) -> npt.NDArray[Any]:
        """Return an array (size,) with arbitrary content. The memory is reused as long as it is large enough.

        Two arrays with the same name share memory, even if their types differ.
        """
        bytes_ = size * np.dtype(dtype).itemsize
        held = self._memory.get(name)
        if held is None or held.size < bytes_:
            held = self._memory[name] = np.empty(bytes_, np.uint8)
        return held[:bytes_].view(dtype)

    @property
    def size_bytes(self) -> int:
        """Return the current size in bytes."""
        return sum(memory.nbytes for memory in self._memory.values())


def keep_freed_memory() -> None:
    """Let the C library keep up to 64 MB of freed memory for the next frame.

    glibc returns freed memory to the system if it exceeds twice the size of the largest block freed so far. Allocating
    the memory again costs up to a fifth of the time of a frame. This function frees a large block that was never
    touched. On other systems it has no effect.
    """
    np.empty(LARGEST_HEAP_BLOCK, np.uint8)
