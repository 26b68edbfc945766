"""Boundaries found in the depth map alone, where a colour edge is missing."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel
from spigolo.kernels.edges import SIGN_TANGENT, back_project, contact_angle_deg, is_contact, unit_vector


@kernel
def fill_shadows(depth, max_run, out):
    """Gives each run of missing pixels in a row the farther depth of its two ends: a shadow lies on the background.

    Runs longer than max_run and those that reach the image border stay 0. depth and out (H, W) metres.
    """
    height, width = depth.shape
    for y in range(height):
        last = 0.0
        x = 0
        while x < width:
            end = x
            while end < width and depth[y, end] == 0.0:
                end += 1
            after = depth[y, end] if end < width else 0.0
            known = last > 0.0 and after > 0.0 and end - x <= max_run
            background = max(last, after) if known else 0.0
            out[y, x:end] = background
            if end < width:
                out[y, end] = after
            last = after
            x = end + 1


@inlined
def bend(before, here, after):
    """How much the depth bends at a pixel, in metres: a step bends by its height, a slanted plane hardly at all."""
    return abs(2.0 * here - before - after)


@inlined
def hollow(before, here, after):
    """How far a pixel lies behind the chord between its samples, in metres: along a line in space 1 / Z is linear."""
    return here - 2.0 * before * after / (before + after)


@inlined
def least_hollow(camera, shape, crease_px, crease_high_deg):
    """No crease of crease_high_deg or less is hollow by less than this times its depth.

    Its sides are at least crease_px d / f long, so its tip lies their length times cos(angle / 2) behind the chord;
    along a slanted ray that is longer by the ray's length. Spares most pixels the angle.
    """
    fx, fy, cx, cy = camera
    x, y = max(cx, shape[1] - cx) / fx, max(cy, shape[0] - cy) / fy
    rounding = 0.99
    return rounding * crease_px / max(fx, fy) * np.cos(crease_high_deg * np.pi / 360.0) / np.sqrt(1.0 + x * x + y * y)


@inlined
def step_row(depth, filled, y, n_y, n_x, step_px, step_m, step_per_m, margin, steps):
    """Marks the pixels of row y at which the depth bends along (n_y, n_x)."""
    width = depth.shape[1] - 2 * margin
    v, u = step_px * n_y, step_px * n_x
    here, before, after = filled[y, margin:], filled[y - v, margin - u :], filled[y + v, margin + u :]
    m_here, m_before, m_after = depth[y, margin:], depth[y - v, margin - u :], depth[y + v, margin + u :]
    out = steps[y, margin:]
    for x in range(width):
        d = float(here[x])
        limit = max(step_m, step_per_m * d * d)
        measured = (m_here[x] > 0.0) | (m_before[x] > 0.0) | (m_after[x] > 0.0)
        known = (here[x] > 0.0) & (before[x] > 0.0) & (after[x] > 0.0) & measured
        out[x] |= known & (bend(float(before[x]), d, float(after[x])) >= limit)


@inlined
def hollow_row(depth, filled, y, n_y, n_x, step_px, crease_px, least, margin, hollows):
    """Marks the pixels of row y that lie deep enough behind their chord along (n_y, n_x) for a crease."""
    width = depth.shape[1] - 2 * margin
    v, u = step_px * n_y, step_px * n_x
    m_here, m_before, m_after = depth[y, margin:], depth[y - v, margin - u :], depth[y + v, margin + u :]
    v, u = crease_px * n_y, crease_px * n_x
    here, before, after = filled[y, margin:], filled[y - v, margin - u :], filled[y + v, margin + u :]
    for x in range(width):
        measured = (m_here[x] > 0.0) | (m_before[x] > 0.0) | (m_after[x] > 0.0)
        b, d, a = float(before[x]), float(here[x]), float(after[x])
        nearest = min(b, d, a)
        hollows[x] = measured & (nearest > 0.0) & (hollow(b, d, a) >= least * nearest)


@inlined
def crease_angle(filled, y, x, n_y, n_x, crease_px, camera):
    """Signed angle (eqs. 14-19) between both sides of a pixel along (n_y, n_x)."""
    fx, fy, cx, cy = camera
    v, u = crease_px * n_y, crease_px * n_x
    here = back_project(filled, y, x, fx, fy, cx, cy)
    v_plus = unit_vector(back_project(filled, y + v, x + u, fx, fy, cx, cy), here)
    v_minus = unit_vector(back_project(filled, y - v, x - u, fx, fy, cx, cy), here)
    return contact_angle_deg(v_plus, v_minus, n_y, n_x, SIGN_TANGENT)


@kernel
def mark_contours(
    depth, filled, camera, step_px, step_m, step_per_m, crease_px, crease_low_deg, crease_high_deg, steps, creases
):
    """Marks depth steps and concave creases, looked for in the four directions of the grid.

    A step bends by max(step_m, step_per_m d^2) or more over step_px; a crease is a contact by the signed angle of
    eqs. 14-19 over crease_px. A step is marked only where the pixel or a sample of it is valid in depth (H, W);
    samples come from filled, the same with its shadows filled, in metres. camera (fx, fy, cx, cy);
    steps, creases (H, W) uint8, zero where nothing is written.
    """
    height, width = depth.shape
    margin = max(step_px, crease_px)
    least = least_hollow(camera, depth.shape, crease_px, crease_high_deg)
    hollows = np.empty(max(width - 2 * margin, 0), np.uint8)
    for y in range(margin, height - margin):
        for n_y, n_x in ((0, 1), (1, 0), (1, 1), (-1, 1)):
            step_row(depth, filled, y, n_y, n_x, step_px, step_m, step_per_m, margin, steps)
            hollow_row(depth, filled, y, n_y, n_x, step_px, crease_px, least, margin, hollows)
            for k in range(hollows.size):
                if hollows[k] != 0 and creases[y, margin + k] == 0:
                    angle = crease_angle(filled, y, margin + k, n_y, n_x, crease_px, camera)
                    creases[y, margin + k] = is_contact(angle, crease_low_deg, crease_high_deg)
