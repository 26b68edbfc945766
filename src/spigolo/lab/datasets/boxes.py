"""Bounding boxes of the data set UW RGB-D Scenes v1, stored in MATLAB files (version 5).

The variable `bboxes` in the file is a 1 x N cell array with one cell per frame. A cell is empty, or holds a struct
array with the fields category (text), instance (number), top, bottom, left and right. Box limits are in pixels, counted
from 1, and belong to the box.
"""

from __future__ import annotations

import importlib
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from spigolo.errors import FileError
from spigolo.frames.frame import Mask

FIELDS = ("category", "instance", "top", "bottom", "left", "right")


@dataclass(frozen=True, slots=True)
class ObjectBox:
    """Bounding box of an object. The box contains the pixels image[top:bottom, left:right]."""

    category: str
    """Class of the object, such as "soda_can"."""
    instance: int
    """Number of the object among the objects of its class."""
    top: int
    bottom: int
    left: int
    right: int


def read_boxes(path: Path, number: int) -> tuple[ObjectBox, ...]:
    """Read the bounding boxes of one frame.

    number: frame number, counted from 1. Raises FileError if the file cannot be read.
    """
    frames = _read_all(path)
    if not 1 <= number <= len(frames):
        raise FileError(f"expected boxes of frame {number} in {path}, got boxes of {len(frames)} frames")
    return frames[number - 1]


def box_of(category: str, instance: int, mask: Mask) -> ObjectBox:
    """Return the smallest bounding box around a mask (H, W). The mask must not be empty."""
    y, x = np.nonzero(mask)
    return ObjectBox(category, instance, int(y.min()), int(y.max()) + 1, int(x.min()), int(x.max()) + 1)


def boxes_to_mat(frames: Mapping[int, Sequence[ObjectBox]]) -> bytes:
    """Return the content of a MATLAB file with the bounding boxes.

    frames: bounding boxes of each frame, indexed by the frame number, which is counted from 1.
    """
    cell = np.empty((1, max(frames, default=0)), object)
    for k in range(cell.shape[1]):
        boxes = frames.get(k + 1, ())
        stored = np.empty((1, len(boxes)), [(name, object) for name in FIELDS])
        for n, box in enumerate(boxes):
            stored[0, n] = (box.category, box.instance, box.top + 1, box.bottom, box.left + 1, box.right)
        cell[0, k] = stored if boxes else np.empty((0, 0))
    file = io.BytesIO()
    _scipy_io(Path("boxes")).savemat(file, {"bboxes": cell}, do_compression=True)
    return file.getvalue()


@lru_cache(maxsize=32)
def _read_all(path: Path) -> tuple[tuple[ObjectBox, ...], ...]:
    try:
        cell = _scipy_io(path).loadmat(str(path))["bboxes"].ravel()
        return tuple(tuple(_box(box) for box in frame.ravel()) if frame.size else () for frame in cell)
    except FileError:
        raise
    except Exception as error:  # scipy may raise any exception
        raise FileError(
            f"expected a MATLAB file with bboxes, a cell of structs with {', '.join(FIELDS)}, in {path}: {error!r}"
        ) from None


def _box(stored: Any) -> ObjectBox:
    values = {name: np.asarray(stored[name]).ravel()[0] for name in FIELDS}
    top, bottom, left, right = (int(values[name]) for name in FIELDS[2:])
    return ObjectBox(str(values["category"]), int(values["instance"]), top - 1, bottom, left - 1, right)


def _scipy_io(path: Path) -> Any:
    try:
        return importlib.import_module("scipy.io")
    except ImportError:
        raise FileError(f'expected scipy for {path}, but it is missing: pip install "spigolo[datasets]"') from None
