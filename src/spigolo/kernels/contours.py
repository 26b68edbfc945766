"""Boundaries found in the depth map alone, where a colour edge is missing."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel
from spigolo.kernels.edges import SIGN_TANGENT, cosine_limits, makes_contact

f32 = np.float32
CLOSE, ROUNDING = 0.99, 1e-6
"""Margins of the first test in float32. Values closer to a limit are tested again exactly. The second is rounding per
metre.
"""
MAY_STEP, MAY_CREASE = 1, 2
WORD = 8
"""Marks of a row are looked at eight at a time, as most are 0."""


@kernel
def fill_shadows(depth, max_run, out):
    """Give each run of missing pixels in a row the farther depth of its two ends: a shadow lies on the background.

    Runs longer than max_run and those that reach the image border stay 0. depth and out (H, W) metres.
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
    """Return how much the depth bends at a pixel, in metres. A step bends by its height, a slanted plane hardly at
    all.
    """
    return abs(2.0 * here - before - after)


@inlined
def is_step(before, here, after, step_m, step_per_m):
    """True if the depth bends by max(step_m, step_per_m d^2) or more at a pixel of depth d."""
    return bend(before, here, after) >= max(step_m, step_per_m * here * here)


@inlined
def hollow(before, here, after):
    """Return how far a pixel lies behind the chord between its samples, in metres. Along a line in space, 1 / Z is
    linear.
    """
    return here - f32(2.0) * before * after / (before + after)


@inlined
def least_hollow(camera, shape, crease_px, crease_high_deg):
    """No crease of crease_high_deg or less is hollow by less than this times its depth.

    Its sides are at least crease_px d / f long, so its tip lies their length times cos(angle / 2) behind the chord.
    Along a slanted ray that is longer by the ray's length. Spares most pixels the angle.
    """
    fx, fy, cx, cy = camera
    x, y = max(cx, shape[1] - cx) / fx, max(cy, shape[0] - cy) / fy
    of_depth = crease_px / max(fx, fy) * np.cos(crease_high_deg * np.pi / 360.0) / np.sqrt(1.0 + x * x + y * y)
    return f32(CLOSE * of_depth - ROUNDING)


@inlined
def step_row(filled, y, n_y, n_x, step_px, step_m, step_per_m, margin, maybe):
    """Pixels of row y that may be steps along (n_y, n_x): all of them and a few more, in float32 to be quick."""
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
    """Pixels of row y that lie deep enough behind their chord along (n_y, n_x) for a crease, and beyond the noise."""
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
    """True if both sides of a pixel along (n_y, n_x) make a contact (eqs. 14-19)."""
    v, u = crease_px * n_y, crease_px * n_x
    return makes_contact(filled, y, x, v, u, camera, n_y, n_x, SIGN_TANGENT, low_deg, high_deg, cosines)


@inlined
def is_hole(depth, y, x, v, u):
    """True if neither a pixel nor its samples at (v, u) before and after it have depth."""
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
    """Mark depth steps and concave creases, looked for in the four directions of the grid.

    A step bends by max(step_m, step_per_m d^2) or more over step_px. A crease is a contact by the signed angle of
    eqs. 14-19 over crease_px whose tip lies behind the chord by noise_per_m d^2 or more. Either is marked only where
    the pixel or one of its two samples at step_px is valid in depth (H, W). Samples come from filled, the same with its
    shadows filled, in metres. camera (fx, fy, cx, cy). steps, creases (H, W) uint8, zero where nothing is written.
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
