"""Kernels that fit lines to the disparity on both sides of an image edge, and find the cheapest closed path around a
point.
"""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel


@inlined
def line_through(n, s, ss, d, sd):
    """Return the intercept and the slope of a least-squares line. The slope is 0 if all points have the same position.

    n, s, ss, d, sd: sums of weights, of positions, of squared positions, of values, and of positions times values.
    """
    spread = n * ss - s * s
    if spread <= 1e-9 * n * n:
        return d / n, 0.0
    slope = (n * sd - s * d) / spread
    return (d - slope * s) / n, slope


@kernel
def fit_sides(edges, direction, normals, disparity, radius, strip, weak, least, out):
    """Fit a line to the disparity on each side of every edge pixel, along the normal of the edge.

    Pixels within `radius` pixels of the edge pixel are used. Pixels nearer than `strip` pixels to the edge have the
    weight `weak`, and other pixels the weight 1. The pixels on each side of the edge must have a total weight of at
    least `least`.

    - edges (H, W) uint8: nonzero at edge pixels.
    - direction (H, W) uint8: number of the row of `normals` that contains the normal of the edge at the pixel.
    - normals (K, 2) float64: unit vectors (n_y, n_x).
    - disparity (H, W) float32, 0 where missing.
    - out (H, W, 4) float32, initially zero: two values for the side to which the normal points, then two values for the
      other side. The two values are the disparity at the edge and its slope per pixel. All four values stay 0 if the
      pixels on one side have too little weight.
    """
    height, width = edges.shape
    sums = np.empty((5, 2))
    for y in range(height):
        for x in range(width):
            if edges[y, x] == 0:
                continue
            n_y, n_x = normals[direction[y, x], 0], normals[direction[y, x], 1]
            sums[:] = 0.0
            n, s, ss, d, sd = sums[0], sums[1], sums[2], sums[3], sums[4]
            for v in range(max(y - radius, 0), min(y + radius + 1, height)):
                for u in range(max(x - radius, 0), min(x + radius + 1, width)):
                    value = float(disparity[v, u])
                    if value == 0.0 or (v - y) * (v - y) + (u - x) * (u - x) > radius * radius:
                        continue
                    away = (v - y) * n_y + (u - x) * n_x
                    if away == 0.0:
                        continue
                    weight = weak if abs(away) < strip else 1.0
                    k = 0 if away > 0.0 else 1
                    n[k] += weight
                    s[k] += weight * away
                    ss[k] += weight * away * away
                    d[k] += weight * value
                    sd[k] += weight * away * value
            if min(n[0], n[1]) < least:
                continue
            for k in range(2):
                at_edge, slope = line_through(n[k], s[k], ss[k], d[k], sd[k])
                out[y, x, 2 * k], out[y, x, 2 * k + 1] = at_edge, slope


@inlined
def advance(total, across, low, high, reached, origin):
    """Compute the cheapest path from any radius on one ray to each radius low..high - 1 on the next ray.

    - total: cost of the cheapest path to each radius on the first ray.
    - across: cost of changing between the radii k and k + 1, on the way from the first ray to the next ray.
    - reached: cost of the cheapest path to each radius on the next ray.
    - origin: for each radius on the next ray, the radius on the first ray from which the cheapest path comes.
    """
    best, source = np.inf, low
    for k in range(low, high):
        if k > low:
            best += across[k - 1]
        if total[k] <= best:
            best, source = total[k], k
        reached[k], origin[k] = best, source
    best, source = np.inf, high - 1
    for k in range(high - 1, low - 1, -1):
        if k < high - 1:
            best += across[k]
        if total[k] <= best:
            best, source = total[k], k
        if best < reached[k]:
            reached[k], origin[k] = best, source


@inlined
def go_around(radial, angular, low, high, total, reached, origin):
    """Compute the cost of paths that start on ray 0 and pass all rays once, with radii within low..high on each ray.

    - total: cost of the start at each radius on ray 0.
    - reached: cost of the path that returns to each radius on ray 0.
    """
    rays = radial.shape[0]
    for t in range(1, rays + 1):
        here, before = t % rays, t - 1
        a, b = min(low[before], low[here]), max(high[before], high[here]) + 1
        advance(total, angular[before], a, b, reached, origin[before])
        for k in range(a, b):
            total[k] = reached[k] + radial[here, k] if low[here] <= k <= high[here] else np.inf


@kernel
def closed_path(radial, angular, least, most, best):
    """Find the cheapest closed path around the origin of a polar map, with a radius from `least` to `most` on every
    ray.

    First, the cheapest path through one radius on ray 0 is computed. The cheapest path through any other radius on ray
    0 need not cross the first path. Paths with a smaller radius on ray 0 are therefore searched only inside the first
    path. Paths with a larger radius are searched only outside the first path. A start radius is skipped if a lower
    bound of its cost exceeds the cost of the best path.

    - radial (T, R) float32, not negative: cost of crossing ray t between radii k - 1 and k.
    - angular (T, R) float32, not negative: cost of passing radius k between rays t and t + 1, where ray 0 follows the
      last ray.
    - best (T,) int32: radius of the path on each ray.

    Returns the cost of the path.
    """
    rays, radii = radial.shape
    paths = np.empty((radii + 2, rays), np.int32)
    paths[radii], paths[radii + 1] = least, most
    total, reached, bound = np.empty(radii), np.zeros(radii), np.zeros(radii)
    origin = np.empty((rays, radii), np.int32)
    turned = np.arange(0, -rays, -1) % rays
    for way in range(2):  # lower bound of the cost of a closed path, from both directions
        there, across = (radial, angular) if way == 0 else (radial[turned], angular[(turned - 1) % rays])
        total[:] = np.inf
        total[least : most + 1] = there[0, least : most + 1]
        go_around(there, across, paths[radii], paths[radii + 1], total, reached, origin)
        bound[:] = np.maximum(bound, reached)
    todo = [(least, most, radii, radii + 1)]
    lowest = np.inf
    while len(todo) > 0:
        first, last, inner, outer = todo.pop()
        if first > last:
            continue
        start = first + np.argmin(bound[first : last + 1])
        if bound[start] >= lowest:
            continue
        total[:] = np.inf
        total[start] = radial[0, start]
        go_around(radial, angular, paths[inner], paths[outer], total, reached, origin)
        k = start
        for t in range(rays - 1, -1, -1):
            k = origin[t, k]
            paths[start, t] = k
        if reached[start] < lowest:
            lowest = reached[start]
            best[:] = paths[start]
        todo.append((first, start - 1, inner, start))
        todo.append((start + 1, last, start, outer))
    return lowest
