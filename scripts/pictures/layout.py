"""Windows, scales and colours that several pictures share."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

import spigolo as sp
from spigolo.frames.frame import Color

Window = tuple[int, int, int, int]
"""(y0, x0, y1, x1), the last two exclusive."""

CONTACT = (60, 220, 90)


def zoom(picture: npt.NDArray[np.uint8], window: Window, factor: float) -> Color:
    """A window of a picture, enlarged without smoothing."""
    y0, x0, y1, x1 = window
    part = picture[y0:y1, x0:x1]
    return np.asarray(cv2.resize(part, None, fx=factor, fy=factor, interpolation=cv2.INTER_NEAREST), np.uint8)


def smaller(picture: Color) -> Color:
    """A picture at half the size, for six in one."""
    return np.asarray(cv2.resize(picture, None, fx=0.6, fy=0.6, interpolation=cv2.INTER_AREA), np.uint8)


def support_picture(result: sp.Segmentation) -> Color:
    """The darkened colour image, with the pixels of the support in green."""
    color, on = result.frame.color, result.support
    assert on is not None
    picture = (color * np.float32(0.45)).astype(np.uint8)
    picture[on] = (0.6 * color[on] + 0.4 * np.array(CONTACT)).astype(np.uint8)
    return picture
