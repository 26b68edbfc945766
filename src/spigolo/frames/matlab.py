"""Reader of numeric arrays in MATLAB files, version 5 to 7.

This module replaces other libraries, which may crash the process on damaged MATLAB files.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

HEADER_BYTES = 128
MATRIX, COMPRESSED = 14, 15
KINDS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
"""NumPy type codes of numbers in MATLAB files, indexed by MATLAB's type number."""
NUMERIC = range(6, 16)
"""MATLAB's class numbers of numeric arrays. MATLAB's other classes are text, cells and structures."""
MOST_BYTES = 2**26
"""Maximum size in bytes of a variable that is read. Larger variables cannot be camera parameters."""


def numeric_arrays(data: bytes) -> dict[str, npt.NDArray[Any]]:
    """Return the numeric arrays of a MATLAB file, indexed by name. Raises ValueError if `data` is not a MATLAB file."""
    order = {b"IM": "<", b"MI": ">"}.get(data[126:128])
    if order is None:
        kind = "of version 7.3 (HDF5)" if data.startswith(b"\x89HDF") else "not of version 5"
        raise ValueError(f"the file is {kind}: save the file in MATLAB with -v7")
    try:
        return dict(_variables(data[HEADER_BYTES:], order))
    except (struct.error, zlib.error, KeyError, IndexError, OverflowError, StopIteration) as error:
        raise ValueError(f"the file is damaged ({type(error).__name__})") from None


def _variables(data: bytes, order: str) -> Iterator[tuple[str, npt.NDArray[Any]]]:
    for kind, content in _elements(data, order):
        if kind == COMPRESSED:
            yield from _variables(zlib.decompressobj().decompress(content, MOST_BYTES), order)
        elif kind == MATRIX:
            found = _array(content, order)
            if found is not None:
                yield found


def _elements(data: bytes, order: str) -> Iterator[tuple[int, bytes]]:
    """Yield the type number and the content of each data element of a MATLAB file.

    order: "<" or ">" for the byte order.
    """
    place = 0
    while place + 8 <= len(data):
        kind, size = struct.unpack_from(f"{order}II", data, place)
        if kind >> 16:
            yield kind & 0xFFFF, data[place + 4 : place + 4 + min(kind >> 16, 4)]
            place += 8
            continue
        yield kind, data[place + 8 : place + 8 + size]
        place += 8 + size + (0 if kind == COMPRESSED else -size % 8)


def _array(content: bytes, order: str) -> tuple[str, npt.NDArray[Any]] | None:
    """Return the name and the array of a numeric variable, or None for a variable that is not numeric."""
    parts = list(_elements(content, order))
    (flags,) = struct.unpack_from(f"{order}I", parts[0][1])
    if flags & 0xFF not in NUMERIC:
        return None
    shape = struct.unpack(f"{order}{len(parts[1][1]) // 4}i", parts[1][1])
    kind, stored = parts[3]
    numbers = np.frombuffer(stored, np.dtype(order + KINDS[kind]), math.prod(shape) if min(shape) > 0 else 0)
    return parts[2][1].decode("ascii", "replace"), numbers.reshape(shape, order="F")
