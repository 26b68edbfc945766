"""Visual saliency of the colour image, and the power law that is applied to the saliency (equation 10).

The saliency of a pixel is the difference between its grey value and the mean grey value of surrounding squares of
several sizes (Montabone & Soto 2010).
"""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.clock import stage
from spigolo.frames.frame import Color
from spigolo.kernels import saliency as kernel
from spigolo.settings.paper import SaliencyConfig

Map = npt.NDArray[np.float32]

SHARES = np.arange(256, dtype=np.float32) / np.float32(255)


def fine_grained_saliency(image: Color, config: SaliencyConfig) -> Map:
    """Return the saliency V_S (H, W) of an RGB image (H, W, 3), from 0 to 1 in steps of 1/255."""
    return np.asarray(cv2.LUT(_levels(image, config), SHARES), np.float32)


def _levels(image: Color, config: SaliencyConfig) -> npt.NDArray[np.uint8]:
    """Return the saliency V_S (H, W) of an RGB image (H, W, 3), from 0 to 255."""
    gray = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
    for _ in range(2):
        gray = cv2.GaussianBlur(gray, (3, 3), 0)
    on, off = np.empty(gray.shape, np.int32), np.empty(gray.shape, np.int32)
    kernel.center_surround(gray, cv2.integral(gray), np.asarray(config.surrounds_px, np.int64), on, off)
    levels = np.empty(gray.shape, np.uint8)
    kernel.join_levels(on, off, levels)
    return levels


def power_law(saliency: Map, power: float) -> Map:
    """Eq. 10. Scale a saliency map (H, W) to a maximum of 1, and raise its values to the exponent `power`."""
    largest = saliency.max(initial=0)
    return np.asarray((saliency / largest) ** np.float32(power), np.float32) if largest > 0 else np.zeros_like(saliency)


@stage("saliency")
def saliency_cue(image: Color, config: SaliencyConfig) -> Map:
    """Return the saliency map (H, W) after the power law, from 0 to 1, for the cost function of equation 22."""
    levels = _levels(image, config)
    present = SHARES[: int(levels.max(initial=0)) + 1]
    table = np.zeros_like(SHARES)
    table[: present.size] = power_law(present, config.power)  # 256 powers instead of one power for each pixel
    return np.asarray(cv2.LUT(levels, table), np.float32)
