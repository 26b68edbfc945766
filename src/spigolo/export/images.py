"""Export of labels as a PNG image, and of object outlines as YOLO text."""

from __future__ import annotations

import cv2
import numpy as np

from spigolo.frames.files import PathLike, write_bytes, write_png
from spigolo.objects.segmentation import ObjectMask, Segmentation

CLASS = 0
MIN_POINTS = 3


def labels(result: Segmentation, path: PathLike) -> None:
    """Write the label image (H, W) as a 16-bit PNG: 0 = background, 1..N = objects.

    Read the image with `cv2.imread(path, cv2.IMREAD_UNCHANGED)`. Without IMREAD_UNCHANGED, OpenCV converts 16 bits to 8
    bits.
    """
    write_png(path, result.labels.astype(np.uint16))


def yolo(result: Segmentation, path: PathLike) -> None:
    """Write the object outlines as YOLO segmentation text, one line `0 x1 y1 x2 y2 ...` for each object.

    The x coordinates are divided by the image width, and the y coordinates by the image height. If an object has
    several outlines, only the largest outline is written.
    """
    height, width = result.labels.shape
    outlines = (_outline(o) / (width, height) for o in result)
    lines = (" ".join(f"{v:.6f}" for v in outline.ravel()) for outline in outlines if len(outline) >= MIN_POINTS)
    write_bytes(path, "".join(f"{CLASS} {line}\n" for line in lines).encode())


def _outline(o: ObjectMask) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Return the largest outline (N, 2) of an object in pixels (x, y). The left border of the image is at x = 0, and
    the upper border is at y = 0.
    """
    found, _ = cv2.findContours(o.mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    return np.asarray(max(found, key=cv2.contourArea)[:, 0], np.float64) + 0.5
