"""Depth that was never registered: its contours fit those of colour once they are scaled about the image centre.

The depth camera has another focal length than the colour camera, and stands next to it.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

Map = npt.NDArray[np.float32]
Pair = tuple[Map, Map]
"""Maps of upright edges (compared along x) and of level ones (compared along y)."""

WIDTH_PX = 320
"""Width of the images that are compared."""
SEARCH_PX = 20
"""Shifts that are tried with each scale, px of those images. A camera's distance moves near things by as much."""
TRIED = np.exp(np.arange(np.log(0.86), np.log(1.9), 0.04))
"""Scales that are tried: ratios of the colour camera's focal length to that of the depth camera."""
MIN_SCORE, MAX_UNSCALED = 0.1, 0.82
"""Minimum score of a scale, and maximum ratio of the best score without scale to it."""
MIN_EVIDENCE, UNSCALED_COSTS = 2.45, 4.0
"""Minimum of the peak, less that share times UNSCALED_COSTS: the closer no scale is, the clearer the peak must be."""
SAME = 0.07
"""Logarithm of a scale up to which it counts as none."""


@dataclass(frozen=True, slots=True)
class ScaleFit:
    """The best scale of depth contours about the image centre, and the shift after it in px of the image.

    score: mean gradient under the contours. unscaled: the same for the best shift without scale. peak: distance of the
    score from the mean of all scales and shifts, in standard deviations.
    """

    scale: float
    dx_px: float
    dy_px: float
    score: float
    unscaled: float
    peak: float

    @property
    def is_clear(self) -> bool:
        """True if the scale fits far better than none, and better than chance."""
        share = self.unscaled / max(self.score, MIN_SCORE)
        evident = self.peak - UNSCALED_COSTS * share >= MIN_EVIDENCE
        return self.score >= MIN_SCORE and share < MAX_UNSCALED and evident


def best_scale(contours: Pair, gradients: Pair) -> ScaleFit:
    """Try every scale with every shift. contours and gradients: those of `depth_contours` and `color_gradients`."""
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
    """Return the mean gradient under the scaled contours for each shift."""
    sums, count = np.zeros((2 * SEARCH_PX + 1, 2 * SEARCH_PX + 1), np.float32), 0
    for (y, x), gradient in zip(places, gradients, strict=True):
        template = _drawn(y, x, scale, shape, size)
        count += int(template.sum())
        sums += cv2.matchTemplate(gradient, template, cv2.TM_CCORR)
    return np.asarray(sums / max(count, 1), np.float32)


def _drawn(
    y: npt.NDArray[np.intp], x: npt.NDArray[np.intp], scale: float, shape: tuple[int, int], size: tuple[int, int]
) -> npt.NDArray[np.float32]:
    """Return the contour pixels, scaled about the image centre and shrunk, as counts."""
    height, width = shape
    u = ((x - (width - 1) / 2) * scale / width + 0.5) * size[0]
    v = ((y - (height - 1) / 2) * scale / height + 0.5) * size[1]
    columns, rows = np.floor(u).astype(np.intp), np.floor(v).astype(np.intp)
    inside = (columns >= 0) & (columns < size[0]) & (rows >= 0) & (rows < size[1])
    flat = np.bincount(rows[inside] * size[0] + columns[inside], minlength=size[0] * size[1])
    return flat.reshape(size[1], size[0]).astype(np.float32)
