"""Kernels that select the Canny pixels that are boundaries of objects (equations 12-19)."""

from __future__ import annotations

import numpy as np

from spigolo.kernels._jit import inlined, kernel

SIGN_TANGENT, SIGN_X, SIGN_NONE = 0, 1, 2
TAN_HALF_BIN = np.sqrt(2.0) - 1.0
"""Tangent of 22.5 degrees, which is half the angle between two neighbouring directions."""
ROUNDING = 1e-9
"""Relative rounding error of a cosine. If the cosine of an angle differs from a limit by less than the rounding error,
the angle is compared instead of the cosine.
"""


@kernel
def steepest(gx, gy):
    """Return the maximum over all pixels of gx^2 + gy^2, for gradients gx, gy (H, W) int16."""
    largest = np.int32(0)
    for y in range(gx.shape[0]):
        along_x, along_y = gx[y], gy[y]
        for x in range(along_x.size):
            dx, dy = np.int32(along_x[x]), np.int32(along_y[x])
            largest = max(largest, np.int32(np.int32(dx * dx) + np.int32(dy * dy)))
    return largest


@inlined
def normal_direction(gx, gy):
    """Round the direction of a gradient to one of four neighbours of a pixel, and return the offset N = (n_y, n_x) of
    this neighbour. Opposite gradients give the same neighbour.

    Gradients near 0, 45, 90 and 135 degrees give the neighbour at the right, upper right, top and upper left. The code
    of the function has no branches, for speed.
    """
    along_x, along_y = abs(float(gx)), abs(float(gy))
    level, upright = along_y <= TAN_HALF_BIN * along_x, along_x <= TAN_HALF_BIN * along_y
    sideways = 0 if upright else (1 if (gx > 0) == (gy < 0) else -1)
    return (0 if level else -1), (1 if level else sideways)


@inlined
def depth_gradient(depth, y, x, v, u, with_missing):
    """Eq. 12. Return rho, the depth of an edge pixel minus the depth of a sample in metres.

    If one depth is missing, rho is 0. If with_missing is True, missing depth counts as 0 m instead.
    """
    here, there = float(depth[y, x]), float(depth[v, u])
    known = (here != 0.0) & (there != 0.0)
    return here - there if known | with_missing else 0.0


@inlined
def is_depth_boundary(rho_plus, rho_minus, step_m, signed):
    """Eq. 13. Return True for a depth boundary, where the depth gradient to at least one side of the edge is step_m or
    more.
    """
    if not signed:
        rho_plus, rho_minus = abs(rho_plus), abs(rho_minus)
    return not ((rho_plus < step_m) & (rho_minus < step_m))


@inlined
def back_project(depth, y, x, fx, fy, cx, cy):
    """Eq. 14. Return the point (X, Y, Z), in metres, that a pixel shows."""
    d = float(depth[y, x])
    return (x - cx) * d / fx, (y - cy) * d / fy, d


@inlined
def difference(point, origin):
    """Return the vector from `origin` to `point`."""
    return point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]


@inlined
def unit_vector(point, origin):
    """Eqs. 15, 16. Return the unit vector from `origin` to `point`, or the zero vector if both points coincide."""
    a, b, c = difference(point, origin)
    norm = np.sqrt(a * a + b * b + c * c)
    if norm == 0.0:
        return 0.0, 0.0, 0.0
    return a / norm, b / norm, c / norm


@inlined
def dot(a, b):
    """Return the inner product of two vectors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def cross(a, b):
    """Return the cross product of two vectors."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def along_edge(c, n_y, n_x, sign_rule):
    """Eq. 19. Return a number that is positive in a valley and negative on a ridge.

    - c: cross product of the directions from the edge to both sides.
    - n_y, n_x: normal of the edge.
    - sign_rule: choice of the returned number. SIGN_TANGENT: component of c along the edge. SIGN_X: x component of c,
      as in the paper. SIGN_NONE: 0. At vertical edges, the x component of c is 0, so that its sign has no meaning.
    """
    if sign_rule == SIGN_X:
        return c[0] if n_y != 0 else 0.0
    if sign_rule == SIGN_TANGENT:
        return -n_y * c[0] + n_x * c[1]
    return 0.0


@inlined
def contact_angle_deg(v_plus, v_minus, n_y, n_x, sign_rule):
    """Eqs. 17, 19. Return the angle between two directions in degrees, negative at a convex boundary."""
    c = cross(v_plus, v_minus)
    angle = np.arctan2(np.sqrt(dot(c, c)), dot(v_plus, v_minus)) * 180.0 / np.pi
    return -angle if along_edge(c, n_y, n_x, sign_rule) < 0.0 else angle


@inlined
def is_contact(angle_deg, low_deg, high_deg):
    """Eq. 18. Return True if an angle lies between both thresholds of a contact boundary."""
    return not (angle_deg > high_deg or angle_deg < low_deg)


@inlined
def cosine_limits(low_deg, high_deg):
    """Return the largest and the smallest cosine of the angles from low_deg to high_deg.

    For an angle outside of 0..180 degrees, the returned limit is 2 or -2, which no cosine reaches.
    """
    largest = np.cos(low_deg * np.pi / 180.0) if 0.0 <= low_deg <= 180.0 else (2.0 if low_deg < 0.0 else -2.0)
    smallest = np.cos(high_deg * np.pi / 180.0) if 0.0 <= high_deg <= 180.0 else (2.0 if high_deg < 0.0 else -2.0)
    return largest, smallest


@inlined
def scaled_point(depth, y, x, fx, fy, cx, cy):
    """Return the point of equation 14, multiplied by fx fy. The multiplication by fx fy avoids divisions and leaves
    angles unchanged.
    """
    d = float(depth[y, x])
    return (x - cx) * d * fy, (y - cy) * d * fx, d * fx * fy


@inlined
def makes_contact(depth, y, x, v, u, camera, n_y, n_x, sign_rule, low_deg, high_deg, cosines):
    """Eqs. 14-19. Return True for a contact at the edge pixel (y, x) between the surfaces at offsets (v, u) and (-v,
    -u).

    The cosine of the angle is compared with the limits of `cosine_limits`. The angle itself is computed only if the
    cosine is close to a limit or low_deg is negative.
    """
    fx, fy, cx, cy = camera
    if low_deg >= 0.0:
        here = scaled_point(depth, y, x, fx, fy, cx, cy)
        a = difference(scaled_point(depth, y + v, x + u, fx, fy, cx, cy), here)
        b = difference(scaled_point(depth, y - v, x - u, fx, fy, cx, cy), here)
        along, lengths = along_edge(cross(a, b), n_y, n_x, sign_rule), np.sqrt(dot(a, a) * dot(b, b))
        below, above, rounding = cosines[0] * lengths - dot(a, b), dot(a, b) - cosines[1] * lengths, ROUNDING * lengths
        between = below > 0.0 and above > 0.0
        if abs(below) > rounding and abs(above) > rounding and (not between or abs(along) > rounding):
            return between and along > 0.0
    here = back_project(depth, y, x, fx, fy, cx, cy)
    plus = back_project(depth, y + v, x + u, fx, fy, cx, cy)
    minus = back_project(depth, y - v, x - u, fx, fy, cx, cy)
    angle = contact_angle_deg(unit_vector(plus, here), unit_vector(minus, here), n_y, n_x, sign_rule)
    return is_contact(angle, low_deg, high_deg)


@kernel
def classify_edges(edges, gx, gy, depth, camera, step_px, step_m, signed, missing_is_boundary, contact_px, low_deg,
                   high_deg, sign_rule, depth_boundary, contact):  # fmt: skip
    """Eqs. 12-19. Classify every edge pixel as a depth boundary, a contact, both or neither.

    Edge pixels closer to the image border than max(step_px, contact_px) + 1 pixels are skipped, because their samples
    may lie outside the image. If missing_is_boundary is True, missing depth counts as 0 m in equation 12.

    - edges (H, W) uint8: nonzero at edge pixels.
    - gx, gy (H, W) int16: gradients of the grey image along x and y.
    - depth (H, W): depth map in metres.
    - camera (fx, fy, cx, cy): intrinsics.
    - depth_boundary, contact (H, W) uint8, initially zero: 1 at depth boundaries and at contacts.
    """
    height, width = edges.shape
    margin = max(step_px, contact_px) + 1
    cosines = cosine_limits(low_deg, high_deg)
    columns = np.empty(width, np.int64)
    for y in range(margin, height - margin):
        count = np.uint64(0)
        for x in range(margin, width - margin):
            columns[count] = x
            count += np.uint64(edges[y, x] != 0)
        for x in columns[:count]:
            n_y, n_x = normal_direction(gx[y, x], gy[y, x])
            v, u = step_px * n_y, step_px * n_x
            rho_plus = depth_gradient(depth, y, x, y + v, x + u, missing_is_boundary)
            rho_minus = depth_gradient(depth, y, x, y - v, x - u, missing_is_boundary)
            depth_boundary[y, x] = is_depth_boundary(rho_plus, rho_minus, step_m, signed)
            v, u = contact_px * n_y, contact_px * n_x
            if depth[y, x] == 0.0 or depth[y + v, x + u] == 0.0 or depth[y - v, x - u] == 0.0:
                continue
            contact[y, x] = makes_contact(depth, y, x, v, u, camera, n_y, n_x, sign_rule, low_deg, high_deg, cosines)
