"""Kernel that draws triangle meshes into a depth map."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import kernel
from spigolo.kernels.registration import ROUNDING, inverse_depth_at, triangle


@kernel
def draw_mesh(points, triangles, out):
    """Draw the triangles of a mesh into a depth map. Pixels that already show a nearer surface stay unchanged.

    Triangles with a corner too near the camera are skipped.

    - points (V, 3): image position (u, v) in pixels and 1 / Z of each vertex. The value 0 for 1 / Z marks a vertex too
      near the camera.
    - triangles (T, 3) int32: indices of the vertices.
    - out (H, W), initially zero: depth map in metres.
    """
    height, width = out.shape
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        a = (points[i, 0], points[i, 1], points[i, 2])
        b = (points[j, 0], points[j, 1], points[j, 2])
        c = (points[k, 0], points[k, 1], points[k, 2])
        if min(a[2], b[2], c[2]) <= 0.0:
            continue
        first_x = int(max(np.ceil(min(a[0], b[0], c[0]) - ROUNDING), 0.0))
        last_x = int(min(np.floor(max(a[0], b[0], c[0]) + ROUNDING), width - 1.0))
        first_y = int(max(np.ceil(min(a[1], b[1], c[1]) - ROUNDING), 0.0))
        last_y = int(min(np.floor(max(a[1], b[1], c[1]) + ROUNDING), height - 1.0))
        drawn = triangle(a, b, c)
        for y in range(first_y, last_y + 1):
            for x in range(first_x, last_x + 1):
                w = inverse_depth_at(x, y, drawn)
                if w > 0.0 and (out[y, x] == 0.0 or w * out[y, x] > 1.0):
                    out[y, x] = 1.0 / w
