"""Kernels that convert RGB colours to points in the HSV cone (equation 4), in float32."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel

f32 = np.float32
SQRT3_HALF, HALF = f32(np.sqrt(3) / 2), f32(0.5)
TINY = f32(1e-20)

COS2, COS4, COS6, COS8 = f32(-0.54831135), f32(0.05010745), f32(-0.0018310980), f32(3.5003934e-05)
SIN1, SIN3, SIN5, SIN7 = f32(1.0471975), f32(-0.19139575), f32(0.010489378), f32(-0.00026577872)
"""Coefficients of polynomials that approximate cos(t pi / 3) - 1 and sin(t pi / 3) for t in [-1, 1], with an error
below 4e-8.
"""


@inlined
def hue_in_sector(r, g, b, value, chroma):
    """Return the angle between a hue and the hue of the nearest primary colour (red, green or blue). The returned angle
    is between -1 and 1, in units of 60 degrees.
    """
    difference = g - b if value == r else (b - r if value == g else r - g)
    return difference / (chroma if chroma > TINY else TINY)


@inlined
def largest(r, g, b):
    """Return the largest of three values."""
    other = g if g > b else b
    return r if r > other else other


@inlined
def smallest(r, g, b):
    """Return the smallest of three values."""
    other = g if g < b else b
    return r if r < other else other


@inlined
def hue_circle(r, g, b):
    """Return (s cos h, s sin h) for an RGB colour with saturation s and hue h, and (0, 0) for grey."""
    value = largest(r, g, b)
    chroma = value - smallest(r, g, b)
    t = hue_in_sector(r, g, b, value, chroma)
    t2 = t * t
    cos = f32(1.0) + t2 * (COS2 + t2 * (COS4 + t2 * (COS6 + t2 * COS8)))
    sin = t * (SIN1 + t2 * (SIN3 + t2 * (SIN5 + t2 * SIN7)))
    turn = f32(0.0) if value == r else (SQRT3_HALF if value == g else -SQRT3_HALF)  # sine of 0, 120 or 240 degrees
    turn_cos = f32(1.0) if value == r else -HALF
    saturation = chroma / (value if value > TINY else TINY)
    return saturation * (cos * turn_cos - sin * turn), saturation * (sin * turn_cos + cos * turn)


@kernel
def hsv_points(rgb, k_dv, k_ds, out):
    """Map each RGB colour to a point, such that the distance of two points is the colour difference of equation 4.

    The point is (k_dv v, k_ds s cos h, k_ds s sin h) / sqrt(k_dv^2 + k_ds^2) for hue h, saturation s and value v.

    - rgb (H, W, 3) float32: colours from 0 to 255.
    - out (3, H, W) float32: points.
    """
    height, width, _ = rgb.shape
    norm = np.sqrt(k_dv * k_dv + k_ds * k_ds)
    of_value, of_circle = f32(k_dv / 255.0 / norm), f32(k_ds / norm)
    r, g, b = np.empty(width, np.float32), np.empty(width, np.float32), np.empty(width, np.float32)
    for y in range(height):
        for x in range(width):
            r[x], g[x], b[x] = rgb[y, x, 0], rgb[y, x, 1], rgb[y, x, 2]
        value, cos, sin = out[0, y], out[1, y], out[2, y]
        for x in range(width):  # one output array per loop, so that the compiler can vectorise the loop
            value[x] = of_value * largest(r[x], g[x], b[x])
        for x in range(width):
            cos[x] = of_circle * hue_circle(r[x], g[x], b[x])[0]
        for x in range(width):
            sin[x] = of_circle * hue_circle(r[x], g[x], b[x])[1]


@inlined
def color_difference(a, b, c, a_other, b_other, c_other):
    """Eq. 4. Return the colour difference delta_hsv of two points, clipped to at most 1."""
    a, b, c = a - a_other, b - b_other, c - c_other
    distance = np.sqrt(a * a + b * b + c * c)
    return distance if distance < f32(1.0) else f32(1.0)
