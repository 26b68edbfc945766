"""Kernels that map the surfaces of a depth map into the image of another camera."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel

NEAREST_M = 0.01
"""Minimum distance of a surface from the target camera, in metres. Surfaces nearer to the target camera are not
drawn.
"""
FARTHEST_PX = 1e9
"""Maximum absolute image coordinate of a drawn point, in pixels."""
ROUNDING = 1e-6
"""Margin outside a triangle in which pixel centres count as inside, as a share of the triangle's height."""
SMALLEST_PX2 = 1e-6
"""Minimum value of twice the area of a triangle in the image, in square pixels. Triangles with a smaller area are not
drawn.
"""


@inlined
def project(x, y, z, P):
    """Project pixel (x, y) of the source camera at depth z to (u, v, 1 / Z) in the target camera.

    The result is (0, 0, 0) if the point is too near to the target camera or too far outside the target image.
    """
    Z = (P[2, 0] * x + P[2, 1] * y + P[2, 2]) * z + P[2, 3]
    if not Z >= NEAREST_M:
        return 0.0, 0.0, 0.0
    w = 1.0 / Z
    u = ((P[0, 0] * x + P[0, 1] * y + P[0, 2]) * z + P[0, 3]) * w
    v = ((P[1, 0] * x + P[1, 1] * y + P[1, 2]) * z + P[1, 3]) * w
    if abs(u) < FARTHEST_PX and abs(v) < FARTHEST_PX:
        return u, v, w
    return 0.0, 0.0, 0.0


@inlined
def one_surface(a, b, step_m, step_share):
    """Return True if two depth values are valid and differ by less than a depth step, so that both belong to one
    surface.
    """
    return a > 0.0 and b > 0.0 and abs(a - b) <= max(step_m, step_share * min(a, b))


@inlined
def middle(a, b):
    """Return the depth at the image point halfway between two pixels with the depths a and b that lie on one plane."""
    return 2.0 * a * b / (a + b)


@inlined
def triangle(a, b, c):
    """Return corner a of a triangle, its sides from a to b and from a to c, and a scale. Corners are projected points
    (u, v, 1 / Z). The scale is 1 / (twice the signed area), or 0 for a nearly degenerate triangle.
    """
    b_x, b_y, c_x, c_y = b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]
    area = b_x * c_y - b_y * c_x
    scale = 1.0 / area if abs(area) > SMALLEST_PX2 else 0.0
    return a[0], a[1], a[2], b_x, b_y, b[2] - a[2], c_x, c_y, c[2] - a[2], scale


@inlined
def inverse_depth_at(x, y, t):
    """Return 1 / Z of a triangle at the image point (x, y), or 0 outside the triangle."""
    a_x, a_y, a_w, b_x, b_y, b_w, c_x, c_y, c_w, scale = t
    share_b = ((x - a_x) * c_y - (y - a_y) * c_x) * scale
    share_c = (b_x * (y - a_y) - b_y * (x - a_x)) * scale
    inside = (share_b >= -ROUNDING) & (share_c >= -ROUNDING) & (share_b + share_c <= 1.0 + ROUNDING) & (scale != 0.0)
    return a_w + share_b * b_w + share_c * c_w if inside else 0.0


@inlined
def draw_quad(a, b, c, d, out):
    """Draw the triangles a b c and a c d into the depth map out (H, W), in metres. Pixels that already show a nearer
    surface stay unchanged.

    a, b, c, d: projected points (u, v, 1 / Z). Nothing is drawn if a point has 1 / Z = 0.
    """
    height, width = out.shape
    first_x = int(max(np.ceil(min(a[0], b[0], c[0], d[0]) - ROUNDING), 0.0))
    last_x = int(min(np.floor(max(a[0], b[0], c[0], d[0]) + ROUNDING), width - 1.0))
    first_y = int(max(np.ceil(min(a[1], b[1], c[1], d[1]) - ROUNDING), 0.0))
    last_y = int(min(np.floor(max(a[1], b[1], c[1], d[1]) + ROUNDING), height - 1.0))
    if first_x > last_x or first_y > last_y or min(a[2], b[2], c[2], d[2]) == 0.0:
        return
    upper, lower = triangle(a, b, c), triangle(a, c, d)
    for y in range(first_y, last_y + 1):
        for x in range(first_x, last_x + 1):
            w = max(inverse_depth_at(x, y, upper), inverse_depth_at(x, y, lower))
            if w > 0.0 and (out[y, x] == 0.0 or w * out[y, x] > 1.0):
                out[y, x] = 1.0 / w


@inlined
def draw_quarter(depth, y, x, to_y, to_x, P, step_m, step_share, out):
    """Draw one quarter of the square of pixel (y, x): the quarter towards the neighbour (y + to_y, x + to_x).

    The depth at each corner is interpolated between the pixel and its neighbours on the same surface.
    """
    height, width = depth.shape
    z = np.float64(depth[y, x])
    v, u = y + to_y, x + to_x
    beside = np.float64(depth[y, u]) if 0 <= u < width else 0.0
    below = np.float64(depth[v, x]) if 0 <= v < height else 0.0
    across = np.float64(depth[v, u]) if 0 <= u < width and 0 <= v < height else 0.0
    side = middle(z, beside) if one_surface(z, beside, step_m, step_share) else z
    foot = middle(z, below) if one_surface(z, below, step_m, step_share) else z
    total, count = 1.0 / z, 1.0
    for other in (beside, below, across):
        if one_surface(z, other, step_m, step_share):
            total += 1.0 / other
            count += 1.0
    half_y, half_x = y + 0.5 * to_y, x + 0.5 * to_x
    draw_quad(
        project(x, y, z, P),
        project(half_x, y, side, P),
        project(half_x, half_y, count / total, P),
        project(x, half_y, foot, P),
        out,
    )


@inlined
def project_row(depth, y, P, points):
    """Project all pixels of row y of the depth map to points (w, 3): u, v and 1 / Z. Missing depth gives 1 / Z = 0."""
    for x in range(depth.shape[1]):
        z = np.float64(depth[y, x])
        if z > 0.0:
            points[x, 0], points[x, 1], points[x, 2] = project(x, y, z, P)
        else:
            points[x, 2] = 0.0


@kernel
def splat_depth(depth, P, step_m, step_share, out):
    """Draw the surfaces of a depth map into the depth map of another camera. If several surfaces cover a pixel, the
    nearest surface is kept.

    Four neighbouring pixels on one surface are drawn as a quadrilateral between their projections. A depth step is a
    difference of more than max(step_m, step_share * nearest depth). If the four depths contain a depth step, one
    quarter of its pixel square is drawn for each of the four pixels (`draw_quarter`). At a depth step, a surface ends
    half a pixel beyond its last pixel.

    - depth (h, w): depth map in metres.
    - P (3, 4): projection matrix, (u Z, v Z, Z) = P (x z, y z, z, 1). Pixel (x, y) at depth z is projected to the image
      point (u, v) at depth Z.
    - out (H, W), initially zero: depth map of the other camera in metres.
    """
    height, width = depth.shape
    above, here = np.zeros((width, 3)), np.zeros((width, 3))
    for y in range(height + 1):  # each group of four pixels is indexed by its lower right pixel (y, x)
        above, here = here, above
        if y < height:
            project_row(depth, y, P, here)
        for x in range(width + 1):
            if 0 < y < height and 0 < x < width:
                a, b, c, d = depth[y - 1, x - 1], depth[y - 1, x], depth[y, x], depth[y, x - 1]
                if one_surface(min(a, b, c, d), max(a, b, c, d), step_m, step_share):
                    draw_quad(
                        (above[x - 1, 0], above[x - 1, 1], above[x - 1, 2]),
                        (above[x, 0], above[x, 1], above[x, 2]),
                        (here[x, 0], here[x, 1], here[x, 2]),
                        (here[x - 1, 0], here[x - 1, 1], here[x - 1, 2]),
                        out,
                    )
                    continue
            for v in range(max(y - 1, 0), min(y + 1, height)):
                for u in range(max(x - 1, 0), min(x + 1, width)):
                    if depth[v, u] > 0.0:
                        to_y, to_x = (1 if v < y else -1), (1 if u < x else -1)
                        draw_quarter(depth, v, u, to_y, to_x, P, step_m, step_share, out)
