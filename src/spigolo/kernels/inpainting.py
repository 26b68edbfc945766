"""Small gaps in depth: sampling holes are closed, gaps are measured."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel


@inlined
def blend(near, far, mean, step_m, step_share):
    """The mean of a rim, or its far value where the rim spans a depth step."""
    return far if far - near > max(step_m, step_share * near) else mean


@kernel
def close_holes(depth, holes, step_m, step_share, out):
    """Gives each pixel of `holes` the mean of its valid 8-neighbours, the farthest where they span a step.

    Pixels without a valid neighbour stay 0: a second pass closes holes that are two pixels wide.
    """
    height, width = depth.shape
    for y in range(height):
        for x in range(width):
            out[y, x] = depth[y, x]
            if not holes[y, x] or depth[y, x] > 0.0:
                continue
            near, far, total, count = np.inf, 0.0, 0.0, 0
            for v in range(max(y - 1, 0), min(y + 2, height)):
                for u in range(max(x - 1, 0), min(x + 2, width)):
                    d = depth[v, u]
                    if d > 0.0:
                        near, far, total, count = min(near, d), max(far, d), total + d, count + 1
            if count > 0:
                out[y, x] = blend(near, far, total / count, step_m, step_share)


@kernel
def measure_gaps(gaps, distance, depth, radius, near, far):
    """For each component of missing pixels: largest inscribed radius (px), nearest and farthest valid depth of its rim.

    gaps (H, W) component number, 0 where depth is valid; distance (H, W) to the nearest valid pixel.
    radius, near, far (components,) are filled; near starts at +inf.
    """
    height, width = gaps.shape
    for y in range(height):
        for x in range(width):
            gap = gaps[y, x]
            if gap == 0:
                continue
            radius[gap] = max(radius[gap], distance[y, x])
            for v in range(max(y - 1, 0), min(y + 2, height)):
                for u in range(max(x - 1, 0), min(x + 2, width)):
                    d = depth[v, u]
                    if d > 0.0:
                        near[gap], far[gap] = min(near[gap], d), max(far[gap], d)
