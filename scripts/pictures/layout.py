"""Functions that crop, scale and colour the pictures of the documentation."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

import spigolo as sp
from spigolo.frames.frame import Color

Window = tuple[int, int, int, int]
"""Pixel box (y0, x0, y1, x1) with y1 and x1 exclusive."""

CONTACT = (60, 220, 90)


def zoom(picture: npt.NDArray[np.uint8], window: Window, factor: float) -> Color:
    """Return a rectangular part of a picture, enlarged by a factor without smoothing."""
    y0, x0, y1, x1 = window
    part = picture[y0:y1, x0:x1]
    return np.asarray(cv2.resize(part, None, fx=factor, fy=factor, interpolation=cv2.INTER_NEAREST), np.uint8)


def smaller(picture: Color) -> Color:
    """Return a picture at 60 % of its size."""
    return np.asarray(cv2.resize(picture, None, fx=0.6, fy=0.6, interpolation=cv2.INTER_AREA), np.uint8)


def support_picture(result: sp.Segmentation) -> Color:
    """Return the darkened colour image with the pixels of the support plane in green."""
    color, on = result.frame.color, result.support
    assert on is not None
    picture = (color * np.float32(0.45)).astype(np.uint8)
    picture[on] = (0.6 * color[on] + 0.4 * np.array(CONTACT)).astype(np.uint8)
    return picture
