"""Statistics for comparing rendered frames with real frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, fields
from itertools import pairwise

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.doctor.local_planes import fit_local_planes
from spigolo.frames.frame import Frame

__all__ = ["BANDS_M", "Realism", "quartiles", "realism"]

BANDS_M = (0.4, 0.6, 0.8, 1.1, 1.6)
"""Limits between the depth ranges for which noise is measured, metres."""
WIDTH_PX = 640
"""Width to which images are resized before pixels on image edges are counted, in pixels. Without resizing, larger
images would have a smaller share of pixels on edges.
"""
CANNY = (60.0, 150.0)
"""Thresholds of `cv2.Canny` on 8-bit grey images."""
LEAST_WINDOWS = 500
"""Minimum number of pixels in a depth range for an estimate of the depth noise. A pixel counts only if no depth is
missing in the 7x7 pixels around it.
"""


@dataclass(frozen=True, slots=True)
class Realism:
    """Statistics of a frame: missing depth, image edges, brightness and depth noise."""

    missing: float
    """Share of pixels without depth, 0..1."""
    edges: float
    """Share of pixels on Canny edges of the colour image, 0..1."""
    brightness: float
    """Median grey level of the colour image, 0..255."""
    noise_04: float
    """Depth noise at a depth of 0.4 to 0.6 m, in mm. The value is NaN if fewer than `LEAST_WINDOWS` pixels are in this
    depth range.
    """
    noise_06: float
    """Depth noise at a depth of 0.6 to 0.8 m, in mm. The value is NaN if fewer than `LEAST_WINDOWS` pixels are in this
    depth range.
    """
    noise_08: float
    """Depth noise at a depth of 0.8 to 1.1 m, in mm. The value is NaN if fewer than `LEAST_WINDOWS` pixels are in this
    depth range.
    """
    noise_11: float
    """Depth noise at a depth of 1.1 to 1.6 m, in mm. The value is NaN if fewer than `LEAST_WINDOWS` pixels are in this
    depth range.
    """


def realism(frame: Frame) -> Realism:
    """Compute the statistics of one frame."""
    grey = cv2.cvtColor(frame.color, cv2.COLOR_RGB2GRAY)
    height = round(grey.shape[0] * WIDTH_PX / grey.shape[1])
    small = cv2.resize(grey, (WIDTH_PX, height), interpolation=cv2.INTER_AREA)
    edges = float(np.mean(cv2.Canny(small, *CANNY) > 0))
    return Realism(float(np.mean(frame.depth == 0)), edges, float(np.median(grey)), *_noise_mm(frame.depth))


def _noise_mm(depth: npt.NDArray[np.float32]) -> list[float]:
    """Return the depth noise in each depth range in millimetres: the median deviation of pixels from a locally fitted
    plane.

    Planes are fitted to inverse depth. Residuals of inverse depth are multiplied by the squared depth, which gives
    residuals of depth.
    """
    planes = fit_local_planes(depth)
    residual_mm = 1000 * planes.residual[planes.whole] * depth[planes.whole].astype(np.float64) ** 2
    distance_m = depth[planes.whole]
    bands = [residual_mm[(low <= distance_m) & (distance_m < high)] for low, high in pairwise(BANDS_M)]
    return [float(np.median(band)) if band.size >= LEAST_WINDOWS else float("nan") for band in bands]


def quartiles(figures: Sequence[Realism]) -> Mapping[str, tuple[float, float, float]]:
    """Return the first quartile, median and third quartile of each statistic over several frames."""
    values = np.array([astuple(one) for one in figures], np.float64)
    answers = {}
    for field, column in zip(fields(Realism), values.T, strict=True):
        known = column[np.isfinite(column)]
        low, middle, high = np.percentile(known, [25, 50, 75]) if known.size else [float("nan")] * 3
        answers[field.name] = (float(low), float(middle), float(high))
    return answers
