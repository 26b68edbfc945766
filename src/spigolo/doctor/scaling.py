"""Detection of depth that is not registered to colour. Without registration, depth contours lie on the image edges only
after the contours are enlarged or reduced about the image centre.

The depth and the colour camera have different focal lengths, so objects have different sizes in the two images.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

Map = npt.NDArray[np.float32]
Pair = tuple[Map, Map]
"""Two maps (H, W). The first map contains vertical edges (changes along x), the second map horizontal edges (changes
along y).
"""

WIDTH_PX = 320
"""Width of the downscaled images that are compared, in pixels."""
SEARCH_PX = 20
"""Maximum shift in x and y that is tried with each scale, in pixels of the downscaled images. The shift is caused by
the distance between the depth camera and the colour camera.
"""
TRIED = np.exp(np.arange(np.log(0.86), np.log(1.9), 0.04))
"""Scales that are tried. A scale is the focal length of the colour camera divided by the focal length of the depth
camera.
"""
MIN_SCORE, MAX_UNSCALED = 0.1, 0.82
"""Conditions for a clear best scale. MIN_SCORE: minimum of `ScaleFit.score`. MAX_UNSCALED: maximum of
`ScaleFit.unscaled` / `ScaleFit.score`.
"""
MIN_EVIDENCE, UNSCALED_COSTS = 2.45, 4.0
"""A clear best scale requires that `ScaleFit.peak` - UNSCALED_COSTS * `ScaleFit.unscaled` / `ScaleFit.score` is at
least `MIN_EVIDENCE`.
"""
SAME = 0.07
"""A scale counts as 1 (no scaling) if the absolute value of its natural logarithm is at most this limit."""


@dataclass(frozen=True, slots=True)
class ScaleFit:
    """Best scale of the depth contours about the image centre, and the shift after scaling, in pixels.

    score: mean colour gradient under the scaled contours. unscaled: best score without scaling. peak: difference
    between the score and the mean score of all scales and shifts, divided by the standard deviation of these scores.
    """

    scale: float
    dx_px: float
    dy_px: float
    score: float
    unscaled: float
    peak: float

    @property
    def is_clear(self) -> bool:
        """Return True if the best scale matches contours and image edges much better than the scale 1 and than all
        other scales.
        """
        share = self.unscaled / max(self.score, MIN_SCORE)
        evident = self.peak - UNSCALED_COSTS * share >= MIN_EVIDENCE
        return self.score >= MIN_SCORE and share < MAX_UNSCALED and evident


def best_scale(contours: Pair, gradients: Pair) -> ScaleFit:
    """Find the scale and the shift of the contours for which the mean colour gradient at the contour pixels is largest.
    contours, gradients: results of `depth_contours` and `color_gradients`.
    """
    height, width = contours[0].shape
    shrink = max(width / WIDTH_PX, 1.0)
    size = (round(width / shrink), round(height / shrink))
    small = [np.pad(_shrunk(gradient, size), SEARCH_PX) for gradient in gradients]
    places = [np.nonzero(contour) for contour in contours]
    scores = np.stack([_scores(places, small, float(scale), (height, width), size) for scale in TRIED])
    scaled = np.abs(np.log(TRIED)) > SAME
    best = int(np.where(scaled, scores.max(axis=(1, 2)), -np.inf).argmax())
    y, x = np.unravel_index(int(scores[best].argmax()), scores[best].shape)
    score, deviation = float(scores[best].max()), float(scores.std())
    peak = (score - float(scores.mean())) / deviation if deviation > 0 else 0.0
    dx, dy = (float(place - SEARCH_PX) * shrink for place in (x, y))
    return ScaleFit(float(TRIED[best]), dx, dy, score, float(scores[~scaled].max()), peak)


def _shrunk(gradient: Map, size: tuple[int, int]) -> Map:
    return np.asarray(cv2.resize(gradient, size, interpolation=cv2.INTER_AREA), np.float32)


def _scores(
    places: list[tuple[npt.NDArray[np.intp], ...]],
    gradients: list[npt.NDArray[np.float32]],
    scale: float,
    shape: tuple[int, int],
    size: tuple[int, int],
) -> npt.NDArray[np.float32]:
    """Return the mean colour gradient under the scaled contours for each shift in y and x."""
    sums, count = np.zeros((2 * SEARCH_PX + 1, 2 * SEARCH_PX + 1), np.float32), 0
    for (y, x), gradient in zip(places, gradients, strict=True):
        template = _drawn(y, x, scale, shape, size)
        count += int(template.sum())
        sums += cv2.matchTemplate(gradient, template, cv2.TM_CCORR)
    return np.asarray(sums / max(count, 1), np.float32)


def _drawn(
    y: npt.NDArray[np.intp], x: npt.NDArray[np.intp], scale: float, shape: tuple[int, int], size: tuple[int, int]
) -> npt.NDArray[np.float32]:
    """Scale contour pixels about the image centre, and return the number of contour pixels at each pixel of a
    downscaled image.
    """
    height, width = shape
    u = ((x - (width - 1) / 2) * scale / width + 0.5) * size[0]
    v = ((y - (height - 1) / 2) * scale / height + 0.5) * size[1]
    columns, rows = np.floor(u).astype(np.intp), np.floor(v).astype(np.intp)
    inside = (columns >= 0) & (columns < size[0]) & (rows >= 0) & (rows < size[1])
    flat = np.bincount(rows[inside] * size[0] + columns[inside], minlength=size[0] * size[1])
    return flat.reshape(size[1], size[0]).astype(np.float32)
