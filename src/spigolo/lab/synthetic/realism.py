"""Statistics for the comparison of rendered frames with real ones.

Letters used in shapes: B = distance bands.
"""

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
"""Limits of the distance bands, metres."""
WIDTH_PX = 640
"""Image width at which edges are counted. A larger image of the same scene has fewer edges per pixel."""
CANNY = (60.0, 150.0)
"""Thresholds of `cv2.Canny` on 8-bit grey images."""
LEAST_WINDOWS = 500
"""Minimum number of complete windows in a band for a noise estimate."""


@dataclass(frozen=True, slots=True)
class Realism:
    """Statistics of a frame.

    missing: share of pixels without depth. edges: share of pixels on Canny edges. brightness: median grey, 0..255.
    noise_*: depth noise in millimetres for each distance band of `BANDS_M`. The noise is the median rms residual to
    planes in 7x7 windows, NaN if a band has too few windows.
    """

    missing: float
    edges: float
    brightness: float
    noise_04: float
    noise_06: float
    noise_08: float
    noise_11: float


def realism(frame: Frame) -> Realism:
    """Return the statistics of one frame."""
    grey = cv2.cvtColor(frame.color, cv2.COLOR_RGB2GRAY)
    height = round(grey.shape[0] * WIDTH_PX / grey.shape[1])
    small = cv2.resize(grey, (WIDTH_PX, height), interpolation=cv2.INTER_AREA)
    edges = float(np.mean(cv2.Canny(small, *CANNY) > 0))
    return Realism(float(np.mean(frame.depth == 0)), edges, float(np.median(grey)), *_noise_mm(frame.depth))


def _noise_mm(depth: npt.NDArray[np.float32]) -> list[float]:
    """Return the noise of each distance band, mm. Planes are fitted to inverse depth.

    The noise of inverse depth is the noise of depth divided by the squared depth.
    """
    planes = fit_local_planes(depth)
    residual_mm = 1000 * planes.residual[planes.whole] * depth[planes.whole].astype(np.float64) ** 2
    distance_m = depth[planes.whole]
    bands = [residual_mm[(low <= distance_m) & (distance_m < high)] for low, high in pairwise(BANDS_M)]
    return [float(np.median(band)) if band.size >= LEAST_WINDOWS else float("nan") for band in bands]


def quartiles(figures: Sequence[Realism]) -> Mapping[str, tuple[float, float, float]]:
    """Return the first quartile, median and third quartile of each statistic over frames. NaN without values."""
    values = np.array([astuple(one) for one in figures], np.float64)
    answers = {}
    for field, column in zip(fields(Realism), values.T, strict=True):
        known = column[np.isfinite(column)]
        low, middle, high = np.percentile(known, [25, 50, 75]) if known.size else [float("nan")] * 3
        answers[field.name] = (float(low), float(middle), float(high))
    return answers
