"""Reading of named arrays from NumPy files."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.errors import FileError

PathLike = str | os.PathLike[str]
Array = npt.NDArray[Any]
MAX_UNPACKED = 2 << 30
"""Maximum size in bytes of all arrays of a .npz file after decompression. Without the limit, a small compressed file
could fill the memory.
"""
ALONE = ""
"""Name under which the array of a .npy file is returned, because a .npy file stores no name."""


def load_arrays(path: PathLike, what: str = "arrays") -> Mapping[str, Array]:
    """Return the arrays of a .npz or .npy file in a dict, indexed by name. Raises FileError for an unreadable file.

    what: description of the arrays in error messages.
    """
    try:
        stored = np.load(path, allow_pickle=False)
        if isinstance(stored, np.ndarray):
            return {ALONE: stored}
        with stored:
            _check_unpacked(stored)
            return {name: np.asarray(stored[name]) for name in stored.files}
    except Exception as error:  # NumPy evaluates the file header as Python code, which may raise any exception
        raise FileError(f"expected {what} in {path}, but the file cannot be read: {_reason(error)}") from None


def _check_unpacked(stored: Any) -> None:
    size = sum(member.file_size for member in stored.zip.infolist())
    if size > MAX_UNPACKED:
        raise ValueError(f"the arrays have {size} bytes (maximum {MAX_UNPACKED}): save fewer or smaller arrays")


def pick(arrays: Mapping[str, Array], names: Sequence[str], what: str, path: PathLike) -> Array:
    """Return the first array that has one of the given names, or the only array of the file. Raises FileError if the
    file has several arrays, but no array with one of the names.
    """
    lower = {name.lower(): array for name, array in arrays.items()}
    found = next((lower[name] for name in names if name in lower), None)
    if found is None and len(arrays) == 1:
        found = next(iter(arrays.values()))
    if found is None:
        named = ", ".join(arrays) or "none"
        raise FileError(
            f"expected {what} as {' or '.join(names[:3])} in {path}, got the arrays {named}: rename an array"
        )
    return found


def names_in(path: PathLike) -> tuple[str, ...]:
    """Return the names of the arrays of a .npz file in lower case, or an empty tuple if the file cannot be read."""
    try:
        with np.load(Path(path), allow_pickle=False) as stored:
            return tuple(name.lower() for name in stored.files)
    except Exception:
        return ()


def _reason(error: Exception) -> str:
    sentence = " ".join(str(error).split())
    if "allow_pickle" in sentence:
        return (
            "the file holds pickled Python objects, such as a dict: save arrays with numpy.savez(FILE, depth=...,"
            " rgb=...)"
        )
    return sentence
