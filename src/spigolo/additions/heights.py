"""Computation of a lower minimum height of objects if the support plane has little noise (`Support.noise_factor`).

A fixed minimum height of objects must be large enough for the noisiest camera. If the noise of the support plane is
small, a lower minimum height also separates objects from the plane.
"""

from __future__ import annotations

import numpy as np

from spigolo.additions.plane import Plane, sample_frame
from spigolo.frames.frame import Camera, DepthMap
from spigolo.settings.config import Config
from spigolo.settings.support import Support

SIGMA = 1.4826
"""Factor that converts a median of absolute values to a standard deviation, for normally distributed values with mean
0.
"""


def lower_heights(config: Config, plane: Plane | None, depth: DepthMap, camera: Camera | None) -> Config:
    """Return the configuration with a lower `Support.min_height_m` if the plane has little noise. If the minimum height
    cannot be lowered, return the configuration unchanged.

    The step height `Ledge.step_m` is multiplied by the same factor as `Support.min_height_m`.

    depth: depth map (H, W) in metres.
    """
    ours = config.additions
    if ours is None or ours.support is None or ours.support.noise_factor is None or plane is None or camera is None:
        return config
    height_m = max(ours.support.noise_factor * plane_noise_m(plane, depth, camera, ours.support), ours.support.lowest_m)
    ratio = height_m / ours.support.min_height_m
    if ratio >= 1:
        return config
    support = ours.support.model_copy(update={"min_height_m": height_m})
    rules, ledge = ours.rules, ours.rules.ledge
    if ledge is not None:
        lower = ledge.model_copy(update={"step_m": ledge.step_m * ratio})
        rules = rules.model_copy(update={"ledge": lower})
    return config.model_copy(update={"additions": ours.model_copy(update={"support": support, "rules": rules})})


def plane_noise_m(plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> float:
    """Return the standard deviation of the heights above the plane, in metres, of the pixels that lie on the plane.

    The standard deviation is estimated from the median of the absolute heights at a grid of pixels. A few low objects
    on the plane hardly change the median.
    """
    sample = sample_frame(depth, camera)
    heights = np.abs(plane.height_m(sample.points[sample.on(plane, config)]))
    return SIGMA * float(np.median(heights)) if heights.size else np.inf
