"""Kernels for contours that are found only in the depth map, where a colour edge is missing."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel
from spigolo.kernels.edges import SIGN_TANGENT, cosine_limits, makes_contact

f32 = np.float32
CLOSE, ROUNDING = 0.99, 1e-6
"""Margins of the first test in float32, relative and per metre. Values closer to a limit are tested again exactly."""
MAY_STEP, MAY_CREASE = 1, 2
WORD = 8
"""Number of marks in a row that are tested at once. Most marks are 0."""


@kernel
def fill_shadows(depth, max_run, out):
    """Give each run of missing pixels in a row the larger depth of its two ends, as a shadow lies on the background.

    Runs longer than max_run and runs at the image border stay 0. depth and out (H, W) in metres.
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
    """Return the bend of the depth at a pixel, m. At a step it is the height of the step, on a slanted plane
    almost 0.
    """
    return abs(2.0 * here - before - after)


@inlined
def is_step(before, here, after, step_m, step_per_m):
    """Return True if the depth at a pixel of depth d bends by at least max(step_m, step_per_m d^2)."""
    return bend(before, here, after) >= max(step_m, step_per_m * here * here)


@inlined
def hollow(before, here, after):
    """Return the distance of a pixel behind the chord between its samples, m. 1 / Z is linear along a line in space."""
    return here - f32(2.0) * before * after / (before + after)


@inlined
def least_hollow(camera, shape, crease_px, crease_high_deg):
    """Return a lower bound of a crease's distance behind its chord, as a share of its depth. Creases have at most
    crease_high_deg.

    The sides of a crease are at least crease_px d / f long. The tip of the crease lies behind the chord by the length
    of the sides times cos(angle / 2). Along a slanted ray the distance is longer by the ray's length. With this bound,
    the angle is computed for few pixels only.
    """
    fx, fy, cx, cy = camera
    x, y = max(cx, shape[1] - cx) / fx, max(cy, shape[0] - cy) / fy
    of_depth = crease_px / max(fx, fy) * np.cos(crease_high_deg * np.pi / 360.0) / np.sqrt(1.0 + x * x + y * y)
    return f32(CLOSE * of_depth - ROUNDING)


@inlined
def step_row(filled, y, n_y, n_x, step_px, step_m, step_per_m, margin, maybe):
    """Mark the pixels of row y that may be steps along (n_y, n_x): all steps and a few more, in float32 for speed."""
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
    """Mark the pixels of row y that are far enough behind their chord along (n_y, n_x) for a crease, and above the
    noise.
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
    """Return True if both sides of a pixel along (n_y, n_x) form a contact (eqs. 14-19)."""
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
    """Mark depth steps and concave creases in the four directions of the grid.

    At a step, depth bends by at least max(step_m, step_per_m d^2) over step_px. A crease is a contact by the signed
    angle of eqs. 14-19 over crease_px, and its tip lies behind the chord by at least noise_per_m d^2. Both are marked
    only if the pixel or one of its two samples at step_px is valid in depth (H, W). Samples come from filled, which is
    depth with filled shadows, in metres.

    camera (fx, fy, cx, cy). steps, creases (H, W) uint8, initially zero.
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
