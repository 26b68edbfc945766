"""Kernels that find contours in the depth map, without the colour image: depth steps and concave creases."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel
from spigolo.kernels.edges import SIGN_TANGENT, cosine_limits, makes_contact

f32 = np.float32
CLOSE, ROUNDING = 0.99, 1e-6
"""Margins of the fast float32 tests that select the pixels that may lie on contours. The thresholds are multiplied by
`CLOSE`. The constant `ROUNDING` is a margin for rounding errors, as a share of the depth. The selected pixels are
tested again in float64.
"""
MAY_STEP, MAY_CREASE = 1, 2
WORD = 8
"""Number of one-byte marks that are compared with 0 as one 64-bit number, for speed."""


@kernel
def fill_shadows(depth, max_run, out):
    """Fill each run of missing pixels in an image row with the depth of the background. The depth of the background is
    the larger of the two depths next to the run.

    Runs of more than max_run pixels and runs at the image border stay 0. depth, out (H, W) in metres.
    """
    height, width = depth.shape
    for y in range(height):
        row, filled, x = depth[y], out[y], 0
        while x < width:
            if row[x] != 0.0:
                filled[x] = row[x]
                x += 1
                continue
            end = x
            while end < width and row[end] == 0.0:
                end += 1
            known = x > 0 and end < width and end - x <= max_run
            background = max(row[x - 1], row[end]) if known else row[x]
            for k in range(x, end):
                filled[k] = background
            x = end


@inlined
def bend(before, here, after):
    """Return the absolute second difference of three depth samples in metres. At a depth step, the second difference is
    the height of the step. On a plane, the second difference is almost 0.
    """
    return abs(2.0 * here - before - after)


@inlined
def is_step(before, here, after, step_m, step_per_m):
    """Return True if the second difference of depth at a pixel of depth d is at least max(step_m, step_per_m d^2)."""
    return bend(before, here, after) >= max(step_m, step_per_m * here * here)


@inlined
def hollow(before, here, after):
    """Return the distance of a pixel behind the straight line between the samples on both sides of the pixel, in
    metres.

    Along a straight line in space, 1 / Z is linear in the image.
    """
    return here - f32(2.0) * before * after / (before + after)


@inlined
def least_hollow(camera, shape, crease_px, crease_high_deg):
    """Return the minimum distance of a crease behind its chord, divided by the depth of the crease. The chord is the
    straight line between the samples crease_px pixels away on both sides.

    The minimum distance is valid for creases with an angle of at most crease_high_deg. At depth d, each side of a
    crease is at least crease_px d / f long, where f is the focal length in pixels. The crease lies behind the chord by
    at least the length of a side times cos(angle / 2). Pixels with a smaller distance behind the chord are not creases,
    and their angle is not computed.
    """
    fx, fy, cx, cy = camera
    x, y = max(cx, shape[1] - cx) / fx, max(cy, shape[0] - cy) / fy
    of_depth = crease_px / max(fx, fy) * np.cos(crease_high_deg * np.pi / 360.0) / np.sqrt(1.0 + x * x + y * y)
    return f32(CLOSE * of_depth - ROUNDING)


@inlined
def step_row(filled, y, n_y, n_x, step_px, step_m, step_per_m, margin, maybe):
    """Mark the pixels of row y that may be depth steps in the direction (n_y, n_x), by a fast test in float32."""
    v, u = step_px * n_y, step_px * n_x
    here, before, after = filled[y, margin:], filled[y - v, margin - u :], filled[y + v, margin + u :]
    least, per_m, rounding = f32(CLOSE * step_m), f32(CLOSE * step_per_m), f32(ROUNDING)
    for x in range(maybe.size):
        d = here[x]
        bent = abs(d + d - before[x] - after[x]) + rounding * d
        known = (d > f32(0.0)) & (before[x] > f32(0.0)) & (after[x] > f32(0.0))
        maybe[x] = known & (bent >= least) & (bent >= per_m * d * d)


@inlined
def hollow_row(filled, y, n_y, n_x, crease_px, least, noise_per_m, margin, maybe):
    """Mark the pixels of row y that may be creases in the direction (n_y, n_x).

    A pixel is marked if its distance behind the chord between two samples is at least noise_per_m times its squared
    depth. The distance behind the chord must also be at least `least` times the smallest of the three depths.
    """
    v, u = crease_px * n_y, crease_px * n_x
    here, before, after = filled[y, margin:], filled[y - v, margin - u :], filled[y + v, margin + u :]
    for x in range(maybe.size):
        b, d, a = before[x], here[x], after[x]
        known = (d > f32(0.0)) & (b > f32(0.0)) & (a > f32(0.0))
        nearest = min(b, a)
        nearest = min(nearest, d)
        deep = hollow(b, d, a)
        maybe[x] |= np.uint8(MAY_CREASE) * (known & (deep >= least * nearest) & (deep >= noise_per_m * d * d))


@inlined
def is_crease(filled, y, x, n_y, n_x, crease_px, camera, low_deg, high_deg, cosines):
    """Return True if the surfaces on both sides of a pixel in the direction (n_y, n_x) meet at the angle of a contact
    (equations 14-19).
    """
    v, u = crease_px * n_y, crease_px * n_x
    return makes_contact(filled, y, x, v, u, camera, n_y, n_x, SIGN_TANGENT, low_deg, high_deg, cosines)


@inlined
def is_hole(depth, y, x, v, u):
    """Return True if depth is missing at the pixel (y, x) and at the samples (y - v, x - u) and (y + v, x + u)."""
    return depth[y, x] == 0.0 and depth[y - v, x - u] == 0.0 and depth[y + v, x + u] == 0.0


@kernel
def mark_contours(
    depth,
    filled,
    camera,
    step_px,
    step_m,
    step_per_m,
    crease_px,
    crease_low_deg,
    crease_high_deg,
    noise_per_m,
    steps,
    creases,
):
    """Mark depth steps and concave creases in four directions: horizontal, vertical and both diagonals.

    At a depth step, the second difference of depth is at least max(step_m, step_per_m d^2), where d is the depth of the
    pixel. The samples for the second difference lie step_px pixels away on both sides. At a crease, the surfaces
    between the pixel and the samples crease_px pixels away meet at the angle of a contact (equations 14-19). In
    addition, the pixel at a crease lies at least noise_per_m d^2 behind the straight line between the two samples
    crease_px pixels away. A pixel is not marked if depth is missing at the pixel and at both samples step_px away.

    - depth (H, W): depth map in metres.
    - filled (H, W): depth with filled shadows, from which the samples are taken.
    - camera (fx, fy, cx, cy): intrinsics.
    - steps, creases (H, W) uint8, initially zero: marks of depth steps and of creases.
    """
    height, width = depth.shape
    margin = max(step_px, crease_px)
    least = least_hollow(camera, depth.shape, crease_px, crease_high_deg)
    cosines = cosine_limits(crease_low_deg, crease_high_deg)
    inner = max(width - 2 * margin, 0)
    room = np.zeros((inner + WORD - 1) // WORD * WORD, np.uint8)
    maybe, words = room[:inner], room.view(np.uint64)
    for y in range(margin, height - margin):
        for n_y, n_x in ((0, 1), (1, 0), (1, 1), (-1, 1)):
            step_row(filled, y, n_y, n_x, step_px, step_m, step_per_m, margin, maybe)
            hollow_row(filled, y, n_y, n_x, crease_px, least, f32(noise_per_m), margin, maybe)
            v, u = step_px * n_y, step_px * n_x
            for word in range(words.size):
                for k in range(WORD * word if words[word] else WORD * (word + 1), WORD * (word + 1)):
                    x = margin + k
                    if room[k] == 0 or is_hole(depth, y, x, v, u):
                        continue
                    if room[k] & MAY_STEP and steps[y, x] == 0:
                        before, here, after = filled[y - v, x - u], filled[y, x], filled[y + v, x + u]
                        steps[y, x] = is_step(float(before), float(here), float(after), step_m, step_per_m)
                    if room[k] & MAY_CREASE and creases[y, x] == 0:
                        creases[y, x] = is_crease(
                            filled, y, x, n_y, n_x, crease_px, camera, crease_low_deg, crease_high_deg, cosines
                        )
