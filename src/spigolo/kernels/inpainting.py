"""Kernels that fill small holes in the depth map, and find and measure connected areas of missing depth (gaps).

Each gap consists of runs of missing pixels. A run is an uninterrupted series of missing pixels in one image row, stored
as (row, first column, last column + 1).
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel


@inlined
def blend(near, far, mean, step_m, step_share):
    """Return the mean depth around a hole. If the nearest and the farthest depth around the hole differ by a depth
    step, return the farthest depth.
    """
    return far if far - near > max(step_m, step_share * near) else mean


@inlined
def around(depth, y, x):
    """Return the minimum, maximum, sum and number of the valid depth values of the 8 neighbours of a pixel."""
    near, far, total, count = np.inf, 0.0, 0.0, 0
    for v in range(max(y - 1, 0), min(y + 2, depth.shape[0])):
        for u in range(max(x - 1, 0), min(x + 2, depth.shape[1])):
            d = depth[v, u]
            if d > 0.0:
                near, far, total, count = min(near, d), max(far, d), total + d, count + 1
    return near, far, total, count


@kernel
def close_holes(depth, holes, step_m, step_share, values):
    """Fill each pixel of `holes` with the mean depth of its valid 8-neighbours. If these neighbours contain a depth
    step, fill the pixel with their farthest depth.

    Pixels without a valid neighbour stay 0. Each call fills the outermost layer of pixels of a hole.

    - depth (H, W): depth map in metres, changed in place.
    - holes (N,) int64: indices y * W + x of missing pixels.
    - values (N,) float32: scratch memory.
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
    """List the runs of missing pixels of all image rows in runs (N, 3) int32. Return the number of runs.

    The array `runs` must have enough rows for all runs.
    """
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
    """Return the root of a run in the union-find forest of runs."""
    while parent[run] != run:
        parent[run] = parent[parent[run]]
        run = parent[run]
    return run


@kernel
def join_runs(runs, parent, gaps):
    """Join the runs of missing pixels into 8-connected gaps, and number the gaps from 0. Return the number of gaps.

    - runs (N, 3): runs of missing pixels, as returned by `find_runs`.
    - parent (N,) int32: scratch memory.
    - gaps (N,) int32: number of the gap of each run.
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
    """Measure each gap: number of pixels, minimum and maximum depth around the gap, and contact with the image border.

    - runs (N, 3), gaps (N,): runs of missing pixels, and number of the gap of each run, as in `join_runs`.
    - area (G,) int64, initially zero: number of pixels of each gap.
    - near (G,) float32, initially +inf: minimum depth around each gap, in metres.
    - far (G,) float32, initially zero: maximum depth around each gap, in metres.
    - on_border (G,) uint8, initially zero: 1 if a gap touches the image border.
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
    """Compute the radius of each gap: the largest distance between a pixel of the gap and the nearest pixel with depth.

    distance (H, W): distance of each pixel to the nearest pixel with depth. radius (G,) float32, initially zero.
    """
    for k in range(len(runs)):
        gap, (y, first, end) = gaps[k], runs[k]
        for x in range(first, end):
            radius[gap] = max(radius[gap], distance[y, x])
