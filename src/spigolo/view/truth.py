"""Images of the ground truth overlaid on the colour image, with found and missed objects."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Color, Mask

FOUND, MISSED = (60, 220, 90), (255, 60, 60)
HATCH_STEP_PX = 12


def truth_picture(
    color: Color, labels: npt.NDArray[np.integer[Any]], found: Collection[int], ignore: Mask | None = None
) -> Color:
    """Draw the outlines of the objects in the ground truth over a colour image (H, W, 3). Outlines of found objects are
    green, and outlines of missed objects are red.

    - labels: label image (H, W) of the ground truth, 0 = background.
    - found: labels of the found objects.
    - ignore: mask (H, W) of pixels that are not evaluated. Pixels that are not evaluated are drawn hatched.
    """
    picture = color.copy()
    if ignore is not None:
        picture[ignore] = picture[ignore] // 2
        picture[ignore & (np.add.outer(*map(np.arange, labels.shape)) % HATCH_STEP_PX < 2)] = 150
    width = max(2, round(3 * labels.shape[0] / 480))
    for label in np.unique(labels[labels > 0]).tolist():
        outlines, _ = cv2.findContours((labels == label).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        cv2.drawContours(picture, outlines, -1, FOUND if label in found else MISSED, width, cv2.LINE_AA)
    return picture
