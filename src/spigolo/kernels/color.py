"""Colour as points of the HSV cone (eq. 4)."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel


@inlined
def hue_rad(r, g, b, value, chroma):
    """Hue of an RGB colour in radians, 0 for grey."""
    if chroma == 0.0:
        return 0.0
    if value == r:
        sixth = (g - b) / chroma
    elif value == g:
        sixth = 2.0 + (b - r) / chroma
    else:
        sixth = 4.0 + (r - g) / chroma
    return sixth * np.pi / 3.0


@kernel
def hsv_points(rgb, k_dv, k_ds, out):
    """Maps each colour to a point whose distance to another one is their colour difference.

    rgb (H, W, 3) float32 in 0..255;
    out (3, H, W) float32 = (k_dv v, k_ds s cos h, k_ds s sin h) / sqrt(k_dv^2 + k_ds^2).
    By the law of cosines the Euclidean distance of two such points is eq. 4.
    """
    height, width = rgb.shape[0], rgb.shape[1]
    norm = np.sqrt(k_dv * k_dv + k_ds * k_ds)
    for y in range(height):
        for x in range(width):
            r, g, b = float(rgb[y, x, 0]), float(rgb[y, x, 1]), float(rgb[y, x, 2])
            value = max(r, g, b)
            chroma = value - min(r, g, b)
            saturation = chroma / value if value > 0.0 else 0.0
            hue = hue_rad(r, g, b, value, chroma)
            out[0, y, x] = k_dv * value / 255.0 / norm
            out[1, y, x] = k_ds * saturation * np.cos(hue) / norm
            out[2, y, x] = k_ds * saturation * np.sin(hue) / norm


@inlined
def color_difference(points, y, x, v, u):
    """Eq. 4. delta_hsv of pixels (y, x) and (v, u), clipped at 1, which the formula exceeds by up to 7e-4."""
    a = float(points[0, y, x]) - float(points[0, v, u])
    b = float(points[1, y, x]) - float(points[1, v, u])
    c = float(points[2, y, x]) - float(points[2, v, u])
    return min(np.sqrt(a * a + b * b + c * c), 1.0)
