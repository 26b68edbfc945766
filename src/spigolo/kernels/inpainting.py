"""Kernels for small gaps in depth: closing of sampling holes, and detection and measurement of gaps.

A gap is stored as runs of missing pixels (row, first column, last column + 1), in raster order.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel


@inlined
def blend(near, far, mean, step_m, step_share):
    """Return the mean depth of a rim, or its far depth if the rim spans a depth step."""
    return far if far - near > max(step_m, step_share * near) else mean


@inlined
def around(depth, y, x):
    """Return the nearest and farthest depth, the sum and the number of the valid 8-neighbours of a pixel."""
    near, far, total, count = np.inf, 0.0, 0.0, 0
    for v in range(max(y - 1, 0), min(y + 2, depth.shape[0])):
        for u in range(max(x - 1, 0), min(x + 2, depth.shape[1])):
            d = depth[v, u]
            if d > 0.0:
                near, far, total, count = min(near, d), max(far, d), total + d, count + 1
    return near, far, total, count


@kernel
def close_holes(depth, holes, step_m, step_share, values):
    """Set each pixel of `holes` to the mean of its valid 8-neighbours, or to the farthest if they span a depth step.

    depth (H, W) is changed in place. holes (N,) int64: indices of missing pixels. values (N,) float32 is scratch.
    Pixels without a valid neighbour stay 0. A second pass closes holes that are two pixels wide.
    """
    width = depth.shape[1]
    for k in range(holes.size):
        y, x = holes[k] // width, holes[k] % width
        values[k] = depth[y, x]
        if depth[y, x] == 0.0:
            near, far, total, count = around(depth, y, x)
            if count > 0:
                values[k] = blend(near, far, total / count, step_m, step_share)
    for k in range(holes.size):
        depth[holes[k] // width, holes[k] % width] = values[k]


@kernel
def find_runs(depth, runs):
    """List the runs of missing pixels in runs (N, 3) int32, which must be large enough. Return their number."""
    height, width = depth.shape
    count = 0
    for y in range(height):
        row = depth[y]
        x = 0
        while x < width:
            if row[x] > 0.0:
                x += 1
                continue
            runs[count, 0], runs[count, 1] = y, x
            while x < width and not row[x] > 0.0:
                x += 1
            runs[count, 2] = x
            count += 1
    return count


@inlined
def root_of(parent, run):
    """Return the root of a run's tree, with path halving."""
    while parent[run] != run:
        parent[run] = parent[parent[run]]
        run = parent[run]
    return run


@kernel
def join_runs(runs, parent, gaps):
    """Number the 8-connected gaps from 0 in the order of their first runs: gaps (N,) int32. Return their number.

    parent (N,) int32 is scratch memory.
    """
    for k in range(len(runs)):
        parent[k] = k
    above = 0
    for k in range(len(runs)):
        y, first, end = runs[k]
        while runs[above, 0] < y - 1 or (runs[above, 0] == y - 1 and runs[above, 2] < first):
            above += 1
        other = above
        while runs[other, 0] == y - 1 and runs[other, 1] <= end:
            a, b = root_of(parent, k), root_of(parent, other)
            parent[max(a, b)] = min(a, b)
            other += 1
    count = 0
    for k in range(len(runs)):
        root = root_of(parent, k)
        if root == k:
            gaps[k] = count
            count += 1
        else:
            gaps[k] = gaps[root]
    return count


@kernel
def measure_gaps(depth, runs, gaps, area, near, far, on_border):
    """Measure each gap: number of pixels, nearest and farthest valid depth of its rim, and contact with the image
    border.

    runs (N, 3), gaps (N,) as in `join_runs`. area (G,) int64, far (G,) float32 and on_border (G,) uint8 start as 0,
    near (G,) float32 as +inf.
    """
    height, width = depth.shape
    for k in range(len(runs)):
        gap, (y, first, end) = gaps[k], runs[k]
        area[gap] += end - first
        if y == 0 or y == height - 1 or first == 0 or end == width:
            on_border[gap] = 1
        for v in range(max(y - 1, 0), min(y + 2, height)):
            for u in range(max(first - 1, 0), min(end + 1, width)):
                d = depth[v, u]
                if d > 0.0:
                    near[gap], far[gap] = min(near[gap], d), max(far[gap], d)


@kernel
def widest(distance, runs, gaps, radius):
    """Compute the largest distance (H, W) to a valid pixel in each gap. radius (G,) float32 starts as 0."""
    for k in range(len(runs)):
        gap, (y, first, end) = gaps[k], runs[k]
        for x in range(first, end):
            radius[gap] = max(radius[gap], distance[y, x])
