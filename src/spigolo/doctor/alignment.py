"""Check that depth is aligned with colour. At a depth step, colour usually changes too.

A depth contour consists of the pixels on the near side of a depth step. The contours are shifted over the colour image.
For every shift, the mean colour gradient at the contour pixels is computed. In an aligned frame, the mean gradient is
largest without a shift.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from spigolo.doctor.findings import Finding, fine, note, warning
from spigolo.doctor.scaling import Pair, ScaleFit, best_scale
from spigolo.frames.frame import Color, DepthMap
from spigolo.kernels.contours import fill_shadows

ALIGNMENT = "alignment"

ELSEWHERE = "To check the alignment, run the doctor on a frame with boxes in front of a background of another colour"
SEARCH_PX = 24
TOLERANCE_PX = 4
"""Maximum shift between depth and colour that does no harm, in pixels. The shift must be smaller than 5 px. The
detection of object boundaries compares depth at a distance of 5 px from an image edge, on both sides of the edge.
"""
MIN_CONTOUR_SHARE = 500 / (640 * 480)
"""Minimum share of contour pixels in the image. With fewer contour pixels, the alignment of depth and colour cannot be
judged.
"""
MIN_CONTRAST, MIN_PEAK = 0.2, 3.0
"""Minimum of `Fit.score` (`MIN_CONTRAST`) and minimum of `Fit.peak` (`MIN_PEAK`). If `Fit.score` or `Fit.peak` is below
its minimum, the alignment of depth and colour cannot be judged.
"""
SHIFTED = 0.95
"""Depth is reported as shifted against colour if the quotient `Fit.unshifted` / `Fit.score` is below this value."""
MIRRORED = 0.8
"""Depth is reported as mirrored if the score of the unchanged contours, divided by the score of the mirrored contours,
is below this value.
"""

STEP_OFFSET_PX = 2
STEP_M, STEP_PER_M = 0.02, 0.012
"""A depth contour requires a depth step of more than max(STEP_M, STEP_PER_M * depth^2) metres."""
MAX_SHADOW_PX = 60
GRADIENT_SIGMA_PX, AROUND_PX = 1.2, 33
FLAT_GRADIENT = 2.0
"""Constant, in grey levels per pixel, that is added to the mean gradient around a pixel before gradients are divided by
this mean gradient. Image noise in areas of uniform colour therefore has little weight.
"""
MAX_GRADIENT = 3.0
"""Colour gradients are limited to this multiple of the mean gradient around the pixel, so that a few strong image edges
do not decide the result.
"""

TURNS = {"mirrored left to right": (1,), "upside down": (0, 1), "mirrored top to bottom": (0,)}
"""Kinds of mirrored depth, and the array axes (0 = rows, 1 = columns) whose order is reversed in each kind."""


@dataclass(frozen=True, slots=True)
class Fit:
    """Best shift of the depth contours (dx_px, dy_px), and the mean colour gradient under the shifted contours (score).

    peak: difference between the score and the mean score of all shifts, divided by the standard deviation of these
    scores. unshifted: best score among the shifts of at most `TOLERANCE_PX`.
    """

    dx_px: int
    dy_px: int
    score: float
    peak: float
    unshifted: float

    @property
    def is_clear(self) -> bool:
        """Return True if the score and the peak reach their minimum values, so that the best shift is reliable."""
        return self.score >= MIN_CONTRAST and self.peak >= MIN_PEAK


def check_alignment(color: Color, filled: DepthMap) -> Finding:
    """Check if depth is shifted or mirrored relative to colour.

    filled: depth map (H, W) in metres, in which small gaps are in-painted.
    """
    contours = depth_contours(filled)
    count = count_contours(contours)
    if count < MIN_CONTOUR_SHARE * filled.size:
        return note(
            ALIGNMENT,
            f"the alignment of depth and colour cannot be judged: the frame has only {count} pixels of depth steps."
            f" {ELSEWHERE}",
            judged=False,
        )
    gradients = color_gradients(color)
    fit = best_shift(contours, gradients)
    turned = {name: best_shift(_turn(contours, axes), gradients) for name, axes in TURNS.items()}
    name = max(turned, key=lambda n: turned[n].score)
    if turned[name].is_clear and fit.score < MIRRORED * turned[name].score:
        return warning(
            ALIGNMENT,
            f"expected depth contours on image edges, found that the contours match if depth is {name}:"
            " mirror or rotate one of the two images",
        )
    scaled = best_scale(contours, gradients)
    if scaled.is_clear:
        return _not_registered(scaled)
    if not fit.is_clear:
        why = "the alignment of depth and colour cannot be judged: the colour does not change at depth steps"
        return note(ALIGNMENT, f"{why}. {ELSEWHERE}", judged=False)
    if fit.unshifted < SHIFTED * fit.score:
        moved = f"{fit.dx_px:+d} px in x and {fit.dy_px:+d} px in y"
        if max(abs(fit.dx_px), abs(fit.dy_px)) == SEARCH_PX:
            moved += " or more"
        return warning(
            ALIGNMENT,
            f"expected depth contours on image edges, found that the contours match if depth is moved by {moved}:"
            " register depth to colour, and use images of the same instant",
        )
    return fine(ALIGNMENT, "depth contours lie on image edges")


def _not_registered(fit: ScaleFit) -> Finding:
    return warning(
        ALIGNMENT,
        f"expected depth contours on image edges, found that the contours match if depth is scaled by {fit.scale:.2f}"
        f" about the image centre and moved by {fit.dx_px:+.0f} px in x and {fit.dy_px:+.0f} px in y: register depth to"
        " colour (register_depth does)",
    )


def depth_contours(depth: DepthMap) -> Pair:
    """Return two maps (H, W), one for depth steps along x and one for depth steps along y. A map is 1 on the near side
    of a depth step, and 0 elsewhere. Pixels near the image border are 0.

    Missing depth next to objects (shadows) is first filled with the depth of the background. A depth step counts only
    if its near side is flat. A slanted surface therefore does not count as a step.
    """
    limit = np.maximum(np.float32(STEP_M), np.float32(STEP_PER_M) * depth * depth)
    pair = []
    for axis in (1, 0):
        filled = _fill_along(depth, axis)
        contour = np.zeros(depth.shape, bool)
        for sign in (1, -1):
            beyond, behind = np.roll(filled, -sign * STEP_OFFSET_PX, axis), np.roll(filled, sign * STEP_OFFSET_PX, axis)
            flat = (behind > 0) & (np.abs(behind - depth) < limit / 2)
            contour |= (depth > 0) & (beyond - depth > limit) & flat
        inner = np.zeros(depth.shape, np.float32)
        inside = (slice(SEARCH_PX, -SEARCH_PX), slice(SEARCH_PX, -SEARCH_PX))
        inner[inside] = contour[inside]
        pair.append(inner)
    return pair[0], pair[1]


def count_contours(contours: Pair) -> int:
    """Return the number of contour pixels in the map along x plus the number in the map along y."""
    return int(contours[0].sum() + contours[1].sum())


def color_gradients(color: Color) -> Pair:
    """Return the colour gradients (H, W) along x and along y. Each gradient is divided by the mean gradient around the
    pixel. The mean of each map is 0. At each pixel, the colour channel with the largest gradient is used.
    """
    smooth = cv2.GaussianBlur(color, (0, 0), GRADIENT_SIGMA_PX)
    along_x, along_y = (
        np.abs(cv2.Scharr(smooth, cv2.CV_16S, *order)).max(axis=2).astype(np.float32) / 32 for order in ((1, 0), (0, 1))
    )
    around = cv2.boxFilter(along_x + along_y, -1, (AROUND_PX, AROUND_PX)) + FLAT_GRADIENT
    x, y = np.minimum(along_x / around, MAX_GRADIENT), np.minimum(along_y / around, MAX_GRADIENT)
    return x - x.mean(), y - y.mean()


def best_shift(contours: Pair, gradients: Pair) -> Fit:
    """Try all shifts of the contours up to 24 px in x and y. Return the shift with the largest mean colour gradient at
    the contour pixels.
    """
    inside = (slice(SEARCH_PX, -SEARCH_PX), slice(SEARCH_PX, -SEARCH_PX))
    sums = sum(
        np.asarray(cv2.matchTemplate(gradient, contour[inside], cv2.TM_CCORR))
        for contour, gradient in zip(contours, gradients, strict=True)
    )
    scores = np.asarray(sums) / max(count_contours(contours), 1)
    y, x = np.unravel_index(int(scores.argmax()), scores.shape)
    near = slice(SEARCH_PX - TOLERANCE_PX, SEARCH_PX + TOLERANCE_PX + 1)
    best, deviation = float(scores.max()), float(scores.std())
    peak = (best - float(scores.mean())) / deviation if deviation > 0 else 0.0
    return Fit(int(x) - SEARCH_PX, int(y) - SEARCH_PX, best, peak, float(scores[near, near].max()))


def _fill_along(depth: DepthMap, axis: int) -> DepthMap:
    rows = np.ascontiguousarray(depth if axis == 1 else depth.T)
    filled = np.empty_like(rows)
    fill_shadows(rows, MAX_SHADOW_PX, filled)
    return filled if axis == 1 else filled.T


def _turn(contours: Pair, axes: tuple[int, ...]) -> Pair:
    x, y = (np.ascontiguousarray(np.flip(c, axes)) for c in contours)
    return x, y
