"""Drawing of objects over the colour image."""

from __future__ import annotations

import colorsys
from collections.abc import Mapping

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Color, Mask

GOLDEN_RATIO = 0.618034
FONT = cv2.FONT_HERSHEY_SIMPLEX
WHITE, INK = (255, 255, 255), (20, 20, 20)

Tint = npt.NDArray[np.uint8]


def palette(count: int) -> npt.NDArray[np.uint8]:
    """Return RGB colours (count, 3) uint8 for the object numbers 1..count. Objects with consecutive numbers have
    clearly different colours.
    """
    return np.array([tint_of(number) for number in range(1, count + 1)], np.uint8).reshape(-1, 3)


def tint_of(number: int) -> Tint:
    """Return the RGB colour (3,) uint8 of an object number, which starts at 1."""
    hue = (0.02 + (number - 1) * GOLDEN_RATIO) % 1.0
    color = colorsys.hsv_to_rgb(hue, 0.9, 0.92) if number % 2 else colorsys.hsv_to_rgb(hue, 0.75, 1.0)
    return np.asarray(np.round(np.array(color) * 255), np.uint8)


def draw_objects(color: Color, masks: Mapping[int, Mask]) -> Color:
    """Draw the masks of objects over an image (H, W, 3). The background of the image is darkened. Each object is tinted
    in its colour and outlined.

    masks: dict of masks (H, W), indexed by object number. The object number determines the colour of an object.
    """
    picture = (color * np.float32(0.45)).astype(np.uint8)
    for number, mask in masks.items():
        tint = tint_of(number)
        picture[mask] = (0.6 * color[mask] + 0.4 * tint).astype(np.uint8)
        outlines, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        cv2.drawContours(picture, outlines, -1, tint.tolist(), max(1, round(2 * _scale(color))), cv2.LINE_AA)
    return picture


def draw_numbers(picture: Color, masks: Mapping[int, Mask]) -> None:
    """Draw the number of each object into an image (H, W, 3), which is changed in place.

    masks: dict of masks (H, W), indexed by object number.
    """
    for number, mask in masks.items():
        _draw_number(picture, number, mask, tint_of(number), _scale(picture))


def _scale(picture: Color) -> float:
    return float(max(picture.shape[0] / 480, 0.5))


def _draw_number(picture: Color, number: int, mask: Mask, tint: Tint, scale: float) -> None:
    """Draw a number in a disc at the innermost pixel of a mask. The number is not drawn at the centroid, because the
    centroid may lie outside the mask.
    """
    inside = cv2.distanceTransform(np.pad(mask, 1).astype(np.uint8), cv2.DIST_L2, 3)
    y, x = np.unravel_index(int(inside.argmax()), inside.shape)
    center = int(x) - 1, int(y) - 1
    text, size = str(number), 0.45 * scale
    (width, height), _ = cv2.getTextSize(text, FONT, size, 1)
    cv2.circle(picture, center, round(11 * scale), tint.tolist(), -1, cv2.LINE_AA)
    cv2.circle(picture, center, round(11 * scale), WHITE, 1, cv2.LINE_AA)
    cv2.putText(picture, text, (center[0] - width // 2, center[1] + height // 2), FONT, size, INK, 1, cv2.LINE_AA)
