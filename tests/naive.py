"""The slow twin of every kernel, in the paper's printed forms and in plain loops.

Twins return their result where kernels fill an array, and take what the paper's formula takes: an image where the
kernel takes the points made of it, a mask where it takes an integral image, weights where it takes sorted edges.
"""

from __future__ import annotations

import colorsys
import itertools
import math
import struct
from collections import Counter, deque
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]
Intrinsics = tuple[float, float, float, float]

OFFSETS = ((0, 1), (1, 0), (1, 1), (-1, 1))
NORMALS = ((0, 1), (-1, 1), (-1, 0), (-1, -1))
"""(n_y, n_x) at 0, 45, 90 and 135 degrees, rows counted downwards."""


def pixels(image: Array) -> Iterator[tuple[int, int]]:
    return ((y, x) for y in range(image.shape[0]) for x in range(image.shape[1]))


def inside(image: Array, y: int, x: int) -> bool:
    return 0 <= y < image.shape[0] and 0 <= x < image.shape[1]


def window(image: Array, y: int, x: int, r: int) -> list[Any]:
    """The pixels of rows y-r..y+r and columns x-r..x+r that the image has, one by one."""
    square = [(v, u) for v in range(y - r, y + r + 1) for u in range(x - r, x + r + 1)]
    return [image[v, u] for v, u in square if inside(image, v, u)]


# --- colour ---------------------------------------------------------------------------------------------------


def hsv(rgb: Array) -> tuple[float, float, float]:
    """Hue in degrees, saturation and value in 0..1 of a colour in 0..255."""
    h, s, v = colorsys.rgb_to_hsv(*(float(channel) / 255 for channel in rgb))
    return 360 * h, s, v


def hsv_points(rgb: Array, k_dv: float, k_ds: float) -> Array:
    out = np.empty((3, *rgb.shape[:2]))
    for y, x in pixels(rgb):
        h, s, v = hsv(rgb[y, x])
        chroma = k_ds * s * np.exp(1j * math.radians(h))
        out[:, y, x] = np.array([k_dv * v, chroma.real, chroma.imag]) / math.hypot(k_dv, k_ds)
    return out


def hsv_difference(a: tuple[float, float, float], b: tuple[float, float, float], k_dv: float, k_ds: float) -> float:
    """Eq. 4 as printed, by the angle between both hues."""
    d_v = k_dv * abs(a[2] - b[2])
    d_h = abs(a[0] - b[0])
    theta = d_h if d_h < 180 else 360 - d_h
    square = a[1] ** 2 + b[1] ** 2 - 2 * a[1] * b[1] * math.cos(math.radians(theta))
    d_s = k_ds * math.sqrt(max(square, 0.0))
    return math.sqrt(d_v**2 + d_s**2) / math.sqrt(k_dv**2 + k_ds**2)


def color_difference(rgb_i: Array, rgb_j: Array, k_dv: float, k_ds: float) -> float:
    return min(hsv_difference(hsv(rgb_i), hsv(rgb_j), k_dv, k_ds), 1.0)


# --- weights --------------------------------------------------------------------------------------------------


def depth_difference(d_i: float, d_j: float, scale: float, noise: float) -> float:
    beyond_noise = abs(float(d_i) - float(d_j)) - noise * float(min(d_i, d_j)) ** 2
    return 0.0 if 0 in (d_i, d_j) or beyond_noise < 0 else min(beyond_noise * scale, 1.0)


def eq_22(d_hsv: float, d_depth: float, d_sal: float, k_x: float, k_y: float, k_s: float) -> float:
    below = 2 + k_x + k_y + k_s
    first = (k_y * math.log2(1 + d_hsv) + k_x * math.log2(1 + d_depth)) / below
    coupled = d_depth * d_sal ** (1 + d_depth) + d_depth * d_hsv ** (1 + d_depth)
    return first + (coupled + k_s * math.log2(1 + d_sal)) / below


def eq_23(d_hsv: float, d_depth: float, d_bound: float, k_x: float, k_b: float) -> float:
    return (k_x * d_depth * math.log2(1 + d_hsv) + k_b * d_bound) / (k_x + k_b)


def _plane(
    rgb: Array,
    depth: Array,
    cue: Array,
    scale: float,
    noise: float,
    k_dv: float,
    k_ds: float,
    ends: str,
    offset: tuple[int, int],
    cost: Callable[[float, float, float], float],
) -> Array:
    out = np.full(depth.shape, np.inf)
    for y, x in pixels(depth):
        v, u = y + offset[0], x + offset[1]
        if inside(depth, v, u):
            d_hsv = color_difference(rgb[y, x], rgb[v, u], k_dv, k_ds)
            d_depth = depth_difference(depth[y, x], depth[v, u], scale, noise)
            at_ends = [float(cue[y, x])] if ends == "i" else [float(cue[y, x]), float(cue[v, u])]
            out[y, x] = cost(d_hsv, d_depth, max(at_ends))
    return out


def saliency_plane(
    rgb: Array,
    depth: Array,
    saliency: Array,
    scale: float,
    noise: float,
    k_dv: float,
    k_ds: float,
    k: tuple[float, float, float],
    ends: str,
    offset: tuple[int, int],
) -> Array:
    """k = (k_x, k_y, k_s)."""
    return _plane(rgb, depth, saliency, scale, noise, k_dv, k_ds, ends, offset, lambda *cues: eq_22(*cues, *k))


def boundary_plane(
    rgb: Array,
    depth: Array,
    boundary: Array,
    scale: float,
    noise: float,
    k_dv: float,
    k_ds: float,
    k: tuple[float, float],
    ends: str,
    offset: tuple[int, int],
) -> Array:
    """k = (k_x, k_b)."""
    return _plane(rgb, depth, boundary, scale, noise, k_dv, k_ds, ends, offset, lambda *cues: eq_23(*cues, *k))


def feature_plane(features: Array, k_xy: float, offset: tuple[int, int]) -> Array:
    """Eq. 1 with the coordinates written out among the features; what is NaN at an end is left out."""
    _, height, width = features.shape
    out = np.full((height, width), np.inf)
    for y, x in pixels(out):
        v, u = y + offset[0], x + offset[1]
        if inside(out, v, u):
            here, there = [np.array([*features[:, a, b], k_xy * a, k_xy * b], np.float64) for a, b in ((y, x), (v, u))]
            out[y, x] = math.sqrt(np.nansum((here - there) ** 2))
    return out


# --- depth ----------------------------------------------------------------------------------------------------


def mark_steps(depth: Array, error_per_m: float, step_factor: float) -> Array:
    out = np.ones(depth.shape, np.uint8)
    for y, x in pixels(depth):
        d = float(depth[y, x])
        beside = [float(depth[v, u]) for v, u in ((y, x + 1), (y + 1, x)) if inside(depth, v, u)]
        if d == 0 or any(abs(e - d) >= step_factor * error_per_m * d**2 for e in beside):
            out[y, x] = 0
    return out


def smoothing_radius(
    depth: Array, distance: Array, error_per_m: float, radius_per_error: float, max_radius: int
) -> Array:
    out = np.empty(depth.shape, np.int32)
    for y, x in pixels(depth):
        by_error = radius_per_error * error_per_m * float(depth[y, x]) ** 2
        r = math.floor(min(by_error, float(distance[y, x]) / math.sqrt(2), max_radius) + 0.5)
        while r > 0 and not (inside(depth, y - r, x - r) and inside(depth, y + r, x + r)):
            r -= 1
        out[y, x] = r
    return out


def mean_boxes(depth: Array, left_out: Array, radius: Array) -> Array:
    """Eq. 8; where nothing is left out, eq. 5, whose divisor counts missing pixels too."""
    out = depth.astype(np.float64)
    for y, x in pixels(depth):
        values = window(depth, y, x, radius[y, x])
        kept = [
            float(d) for d, out_of_it in zip(values, window(left_out, y, x, radius[y, x]), strict=True) if not out_of_it
        ]
        if depth[y, x] != 0 and kept and radius[y, x] > 0:
            out[y, x] = math.fsum(kept) / len(kept)
    return out


def halve_depth(depth: Array) -> Array:
    """Lower median of the valid depths of each block of two by two; blocks at an odd end repeat their pixels."""
    wide = np.pad(depth, [(0, n % 2) for n in depth.shape], mode="edge")
    out = np.zeros((wide.shape[0] // 2, wide.shape[1] // 2), np.float32)
    for y, x in pixels(out):
        valid = sorted(d for d in wide[2 * y : 2 * y + 2, 2 * x : 2 * x + 2].ravel() if d > 0)
        out[y, x] = valid[(len(valid) - 1) // 2] if valid else 0
    return out


def close_holes(depth: Array, holes: Array, step_m: float, step_share: float) -> Array:
    """holes: mask (H, W)."""
    out = depth.astype(np.float64)
    for y, x in pixels(depth):
        rim = [float(d) for d in window(depth, y, x, 1) if d > 0]
        if holes[y, x] and depth[y, x] == 0 and rim:
            step = max(rim) - min(rim) > max(step_m, step_share * min(rim))
            out[y, x] = max(rim) if step else math.fsum(rim) / len(rim)
    return out


def find_runs(depth: Array) -> list[list[int]]:
    runs: list[list[int]] = []
    for y, x in np.argwhere(depth == 0).tolist():
        if runs and runs[-1][0] == y and runs[-1][2] == x:
            runs[-1][2] = x + 1
        else:
            runs.append([y, x, x + 1])
    return runs


def join_runs(depth: Array) -> list[int]:
    """The gap of each run: areas of missing pixels in the order of their first pixels."""
    areas = flood(depth == 0, 8)
    return number_regions([int(areas[y, x]) for y, x, _ in find_runs(depth)]).tolist()


def _gap_pixels(depth: Array) -> list[list[tuple[int, int]]]:
    of_gap: dict[int, list[tuple[int, int]]] = {}
    for gap, (y, first, end) in zip(join_runs(depth), find_runs(depth), strict=True):
        of_gap.setdefault(gap, []).extend((y, x) for x in range(first, end))
    return [of_gap[gap] for gap in range(len(of_gap))]


def measure_gaps(depth: Array) -> tuple[list[int], list[float], list[float], list[bool]]:
    """Area, nearest (+inf without any) and farthest depth (0) of the rim, on the border, of each gap."""
    area, near, far, on_border = [], [], [], []
    for there in _gap_pixels(depth):
        rim = [float(d) for y, x in there for d in window(depth, y, x, 1) if d > 0]
        area.append(len(there))
        near.append(min(rim, default=np.inf))
        far.append(max(rim, default=0))
        on_border.append(any(y in (0, depth.shape[0] - 1) or x in (0, depth.shape[1] - 1) for y, x in there))
    return area, near, far, on_border


def widest(depth: Array, distance: Array) -> list[float]:
    return [max(float(distance[y, x]) for y, x in there) for there in _gap_pixels(depth)]


def distance_to_zero(mask: Array, cap: int) -> Array:
    zeros = np.argwhere(mask == 0)
    out = np.full(mask.shape, float(cap))
    for y, x in pixels(mask):
        if len(zeros):
            out[y, x] = min(float(np.hypot(*(zeros - (y, x)).T).min()), cap)
    return out


# --- saliency -------------------------------------------------------------------------------------------------


def center_surround(gray: Array, surrounds: list[int]) -> tuple[Array, Array]:
    """In whole numbers: |centre - mean| cut to a whole level is (|n centre - sum|) // n."""
    on, off = np.zeros(gray.shape, np.int64), np.zeros(gray.shape, np.int64)
    for y, x in pixels(gray):
        for half in surrounds:
            around = gray[max(y - half + 1, 0) : y + half + 1, max(x - half + 1, 0) : x + half + 1].astype(np.int64)
            n, center = around.size - 1, int(gray[y, x])
            if n > 0:
                excess = n * center - (int(around.sum()) - center)
                on[y, x] += max(excess, 0) // n
                off[y, x] += max(-excess, 0) // n
    return on, off


def join_levels(on: Array, off: Array) -> Array:
    """Each as 255 of its largest, cut to whole levels; their sum, at most 255."""
    share = [value.astype(np.int64) * 255 // max(int(value.max()), 1) for value in (on, off)]
    return np.minimum(share[0] + share[1], 255)


# --- edges ----------------------------------------------------------------------------------------------------


def steepest(gx: Array, gy: Array) -> int:
    return max((int(gx[at]) ** 2 + int(gy[at]) ** 2 for at in pixels(gx)), default=0)


def nearest_normal(gx: float, gy: float) -> Array:
    """The one of the four directions (n_y, n_x) that the gradient or its opposite is nearest to."""
    along = [abs(gx * n_x + gy * n_y) / math.hypot(n_y, n_x) for n_y, n_x in NORMALS]
    return np.array(NORMALS[int(np.argmax(along))])


def contact_angle(depth: Array, K: Array, e: Array, n: Array, offset: int, sign_rule: str) -> float:
    """Eqs. 14-17 and 19 at the edge pixel e = (y, x); `tangent` asks for the sign along the edge."""
    p_e, p_plus, p_minus = (
        np.linalg.inv(K) @ (float(depth[tuple(at)]) * np.array([at[1], at[0], 1.0]))
        for at in (e, e + offset * n, e - offset * n)
    )
    v_plus = (p_plus - p_e) / np.linalg.norm(p_plus - p_e)
    v_minus = (p_minus - p_e) / np.linalg.norm(p_minus - p_e)
    v_cross = np.cross(v_plus, v_minus)
    theta = math.degrees(math.atan2(np.linalg.norm(v_cross), v_plus @ v_minus))
    if sign_rule == "x":
        upright = n[0] == 0  # all three points lie in one image row: the x component is zero
        sign = 0.0 if upright else v_cross[0]
    elif sign_rule == "none":
        sign = 0.0
    else:
        sign = v_cross @ np.array([-n[0], n[1], 0])
    return -theta if sign < 0 else theta


def classify_edges(
    edges: Array,
    gx: Array,
    gy: Array,
    depth: Array,
    camera: Intrinsics,
    step_px: int,
    step_m: float,
    signed: bool,
    missing_is_boundary: bool,
    contact_px: int,
    low_deg: float,
    high_deg: float,
    sign_rule: str,
) -> tuple[Array, Array]:
    fx, fy, cx, cy = camera
    K = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
    depth_boundary, contact = np.zeros(edges.shape, np.uint8), np.zeros(edges.shape, np.uint8)
    reach = max(step_px, contact_px) + 1
    for y, x in np.argwhere(edges > 0):
        if not (inside(edges, y - reach, x - reach) and inside(edges, y + reach, x + reach)):
            continue
        e, n = np.array([y, x]), nearest_normal(int(gx[y, x]), int(gy[y, x]))
        three = [float(depth[tuple(at)]) for at in (e, e + step_px * n, e - step_px * n)]
        rho = [three[0] - d if (three[0] and d) or missing_is_boundary else 0.0 for d in three[1:]]
        if not signed:
            rho = [abs(r) for r in rho]
        is_texture = rho[0] < step_m and rho[1] < step_m
        depth_boundary[y, x] = not is_texture
        if all(depth[tuple(at)] for at in (e, e + contact_px * n, e - contact_px * n)):
            theta = contact_angle(depth, K, e, n, contact_px, sign_rule)
            contact[y, x] = not (theta > high_deg or theta < low_deg)
    return depth_boundary, contact


def sum_contours(labels: Array, boundary: Array) -> Array:
    """(R, 2): pairs of 4-neighbours across the border of each region, and the sum of the larger boundary of each."""
    out = np.zeros((labels.max() + 1, 2))
    for y, x in pixels(labels):
        for v, u in ((y, x + 1), (y + 1, x)):
            if inside(labels, v, u) and labels[v, u] != labels[y, x]:
                for region in (labels[y, x], labels[v, u]):
                    out[region] += 1, float(max(boundary[y, x], boundary[v, u]))
    return out


def fill_shadows(depth: Array, max_run: int) -> Array:
    out = depth.copy()
    for y, x in np.argwhere(depth == 0):
        before, after = np.flatnonzero(depth[y, :x]), x + 1 + np.flatnonzero(depth[y, x + 1 :])
        if before.size and after.size and after[0] - before[-1] - 1 <= max_run:
            out[y, x] = max(depth[y, before[-1]], depth[y, after[0]])
    return out


def mark_contours(
    depth: Array,
    filled: Array,
    camera: Intrinsics,
    step_px: int,
    step_m: float,
    step_per_m: float,
    crease_px: int,
    low_deg: float,
    high_deg: float,
    noise_per_m: float = 0.0,
) -> tuple[Array, Array]:
    """Steps and creases at pixels that are measured, or have a measured pixel `step_px` beside them."""
    fx, fy, cx, cy = camera
    K = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
    steps, creases = np.zeros(depth.shape, np.uint8), np.zeros(depth.shape, np.uint8)
    reach = max(step_px, crease_px)
    for y, x in pixels(depth):
        if not (inside(depth, y - reach, x - reach) and inside(depth, y + reach, x + reach)):
            continue
        for e, n in ((np.array([y, x]), np.array(normal)) for normal in NORMALS):
            at_step = [tuple(e - step_px * n), (y, x), tuple(e + step_px * n)]
            at_crease = [tuple(e - crease_px * n), (y, x), tuple(e + crease_px * n)]
            if not any(depth[at] for at in at_step):
                continue
            before, here, after = (float(filled[at]) for at in at_step)
            if all((before, here, after)):
                steps[y, x] |= abs(2 * here - before - after) >= max(step_m, step_per_m * here**2)
            if all(filled[at] for at in at_crease) and is_beyond_noise([filled[at] for at in at_crease], noise_per_m):
                creases[y, x] |= low_deg <= contact_angle(filled, K, e, n, crease_px, "tangent") <= high_deg
    return steps, creases


def is_beyond_noise(along: list[np.float32], noise_per_m: float) -> bool:
    """Whether the middle one of three depths lies behind the chord of the others by the noise, in float32."""
    before, here, after = along
    return bool(here - np.float32(2) * before * after / (before + after) >= np.float32(noise_per_m) * here * here)


# --- seeded partition -----------------------------------------------------------------------------------------

SIDES = ((0, 1), (1, 0), (0, -1), (-1, 0))


def count_ramps(labels: Array, depth: Array, reach: int, step_m: float, step_share: float) -> list[int]:
    """Number of profiles across a depth step on a border between labels, and of their pixels between both depths."""
    profiles, between = 0, 0
    ends, low, high = max(reach // 3, 1), np.float32(0.15), np.float32(0.85)
    for y, x in pixels(labels):
        for dy, dx in ((0, 1), (1, 0)):
            if not inside(labels, y + dy, x + dx) or labels[y + dy, x + dx] == labels[y, x]:
                continue
            profile = [(y + k * dy, x + k * dx) for k in range(1 - reach, reach + 1)]
            if not (inside(labels, *profile[0]) and inside(labels, *profile[-1])):
                continue
            along = [depth[at] for at in profile]
            first = next((z for z in along[:ends] if z > 0), np.float32(0))
            last = next((z for z in along[: -ends - 1 : -1] if z > 0), np.float32(0))
            near, step = min(first, last), abs(first - last)
            if near > 0 and step > max(np.float32(step_m), np.float32(step_share) * near):
                profiles += 1
                between += sum(near + low * step < z < near + high * step for z in along[ends:-ends])
    return [profiles, int(between)]


def border_pixels(labels: Array) -> list[int]:
    """Indices y * W + x of the pixels with a 4-neighbour that has another label."""

    def at_border(y: int, x: int) -> bool:
        beside = [(y + dy, x + dx) for dy, dx in SIDES]
        return any(inside(labels, *at) and labels[at] != labels[y, x] for at in beside)

    return [y * labels.shape[1] + x for y, x in pixels(labels) if at_border(y, x)]


def measure_layers(labels: Array, near_hole: Array, width: int, hole_width: int) -> tuple[Array, Array]:
    """Layer of every pixel, counted from the borders between labels, and the number of layers of each label.

    255: a pixel without a layer, or a label that goes on beyond its last one.
    """
    layer = np.full(labels.shape, 255, np.uint8)
    layer.reshape(-1)[border_pixels(labels)] = 1

    def reached(y: int, x: int, number: int) -> bool:
        """Whether a pixel of that layer touches this one: by a corner too, if the layer's number is odd."""
        corners = () if number % 2 == 0 else ((1, 1), (1, -1), (-1, 1), (-1, -1))
        beside = [(y + dy, x + dx) for dy, dx in (*SIDES, *corners)]
        return any(inside(labels, *at) and layer[at] == number for at in beside)

    for number in range(1, max(width, hole_width)):
        for y, x in pixels(labels):
            if layer[y, x] == 255 and number < (hole_width if near_hole[y, x] else width) and reached(y, x, number):
                layer[y, x] = number + 1
    inner = np.zeros(int(labels.max()) + 1, np.int32)
    for at in pixels(labels):
        goes_on = layer[at] == 255 and any(reached(*at, number) for number in range(1, max(width, hole_width) + 1))
        inner[labels[at]] = max(inner[labels[at]], 255 if goes_on else layer[at] if layer[at] < 255 else 0)
    return layer, inner


def open_layers(labels: Array, layer: Array, inner: Array, share: float) -> Array:
    """Flags of the pixels in the outer share of their label's layers: 1, with 2 and 4 in the first and last column."""
    out = np.zeros(labels.shape, np.uint8)
    for at in pixels(labels):
        layers = int(inner[labels[at]])
        if layer[at] < 255 and (layers == 255 or layer[at] <= float(np.float32(share)) * layers):
            out[at] = 1
    return flag_columns(out)


def flag_columns(opened: Array) -> Array:
    """The flags with those of the first and last column."""
    out = opened.copy()
    for y, x in pixels(opened):
        if opened[y, x] and x == 0:
            out[y, x] |= 2
        if opened[y, x] and x == opened.shape[1] - 1:
            out[y, x] |= 4
    return out


def grow_seeds(
    color: Array, depth: Array, labels: Array, opened: Array, memory: float, carry: float, step: tuple[float, ...]
) -> Array:
    """Labels by Prim's algorithm as a search of all edges for the lightest, the earliest found first among equals.

    step: metres, the same per squared distance, and the weight of a full one.
    """
    labels, opened, color = labels.copy(), opened > 0, color.astype(np.float32)
    tree = {at: color[at] for at in pixels(labels) if not opened[at]}
    edges: list[tuple[int, tuple[int, int], tuple[int, int]]] = []

    def weigh(here: tuple[int, int], other: tuple[int, int], before: float) -> int:
        d = tree[here] - color[other]
        weight = np.sqrt(np.float32(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]))
        a, b = depth[here], depth[other]
        if a > 0 and b > 0:
            weight += min(abs(a - b) / max(step[0], step[1] * a * a), 1.0) * step[2]
        return min(int(weight + before), 2047)

    def near(p: tuple[int, int]) -> list[tuple[int, int]]:
        beside = [(p[0] + dy, p[1] + dx) for dy, dx in SIDES]
        return [at for at in beside if inside(labels, *at)]

    for p in pixels(labels):
        edges += [(weigh(q, p, 0.0), q, p) for q in near(p) if opened[p] and not opened[q]]
    while edges:
        weight, here, p = edges.pop(min(range(len(edges)), key=lambda k: (edges[k][0], k)))
        if not opened[p]:
            continue
        opened[p] = False
        labels[p] = labels[here]
        tree[p] = np.float32(memory) * tree[here] + np.float32(1 - memory) * color[p]
        edges += [(weigh(p, q, np.float32(carry) * np.float32(weight)), p, q) for q in near(p) if opened[q]]
    return labels


def follow_seeds(before: Array, after: Array, source_of: Array, regions: Array) -> tuple[Array, list[int]]:
    """Regions with those of the seeds where labels differ, and the area of each region."""
    out = regions.copy()
    for y, x in pixels(before):
        if before[y, x] != after[y, x]:
            out[y, x] = regions[divmod(int(source_of[y * before.shape[1] + x]), before.shape[1])]
    return out, [int(np.count_nonzero(out == k)) for k in range(int(regions.max()) + 1)]


# --- sorting --------------------------------------------------------------------------------------------------


def pack(weights: Array, numbers: list[int]) -> Array:
    """Edges as 64 bits: those of the float32 weight, 30 of the pixel, 2 of the plane. weights (P, H, W)."""
    flat, size = weights.reshape(-1), weights[0].size
    bits = [int(np.abs(flat[k]).view(np.uint32)) for k in numbers]
    return np.array([b << 32 | (k % size) << 2 | k // size for b, k in zip(bits, numbers, strict=True)], np.uint64)


def scatter(packed: Array, base: int, shift: int, mask: int) -> list[int]:
    return sorted((int(edge) for edge in packed), key=lambda edge: ((edge >> 32) - base >> shift) & mask)


def sort_edges(weights: Array) -> list[int]:
    return [number for _, number in sorted((float(weight), number) for number, weight in enumerate(weights))]


# --- merging --------------------------------------------------------------------------------------------------


class Forest:
    """Textbook components: the component of each pixel, and of each component its pixels and I(R) of eq. 2."""

    def __init__(self, count: int) -> None:
        self.component = {pixel: pixel for pixel in range(count)}
        self.members = {pixel: [pixel] for pixel in range(count)}
        self.internal = dict.fromkeys(range(count), 0.0)

    def join(self, a: int, b: int, weight: float) -> None:
        if len(self.members[a]) < len(self.members[b]):
            a, b = b, a
        for pixel in self.members[b]:
            self.component[pixel] = a
        self.members[a] += self.members.pop(b)
        self.internal[a] = max(self.internal[a], self.internal.pop(b), weight)

    def labels(self) -> Array:
        return number_regions([self.component[pixel] for pixel in range(len(self.component))])


def numbered_edges(weights: Array) -> list[tuple[int, int, int]]:
    """(number, pixel, neighbour) of all edges inside the image, by number."""
    _, height, width = weights.shape
    edges = []
    for number in range(weights.size):
        plane, pixel = divmod(number, height * width)
        y, x = divmod(pixel, width)
        v, u = y + OFFSETS[plane][0], x + OFFSETS[plane][1]
        if inside(weights[0], v, u):
            edges.append((number, pixel, v * width + u))
    return edges


def sorted_edges(weights: Array) -> list[tuple[float, int, int]]:
    """(weight, pixel, neighbour) of all edges inside the image, by weight, then by edge number."""
    flat = weights.reshape(-1)
    return [(w, i, j) for w, _, i, j in sorted((float(flat[n]), n, i, j) for n, i, j in numbered_edges(weights))]


def merge(weights: Array, gamma: float) -> Forest:
    """Eqs. 2, 3 over planes (P, H, W) of float32 weights."""
    forest = Forest(weights[0].size)
    for weight, i, j in sorted_edges(weights):
        a, b = forest.component[i], forest.component[j]
        bounds = [forest.internal[c] + gamma / len(forest.members[c]) for c in (a, b)]
        if a != b and weight <= min(bounds):
            forest.join(a, b, weight)
    return forest


def absorb_small(forest: Forest, weights: Array, min_size: float) -> None:
    for weight, i, j in sorted_edges(weights):
        a, b = forest.component[i], forest.component[j]
        if a != b and min(len(forest.members[a]), len(forest.members[b])) < min_size:
            forest.join(a, b, weight)


def record(area: int, bound: float) -> int:
    """A region's size above the bits of the largest float32 that is not above its bound."""
    below = np.float32(min(bound, float(np.finfo(np.float32).max)))
    if float(below) > bound:
        below = np.nextafter(below, np.float32(0))
    return area << 32 | int(below.view(np.uint32))


def plant(weights: Array, gamma: float) -> tuple[list[int], list[int]]:
    """Root of every pixel and record of that root, once straight edges of weight 0 have merged."""
    straight = np.where(weights[:2] == 0, weights[:2], np.float32(np.inf))
    forest = merge(straight, 1e30)
    roots = [min(forest.members[forest.component[pixel]]) for pixel in range(straight[0].size)]
    areas = Counter(roots)
    return roots, [record(areas[root], gamma / areas[root]) for root in roots]


def drop_detours(weights: Array) -> set[int]:
    """Numbers of the edges that come last of a triangle (8-connected) or a square, by weight and number.

    But for those to the right in the first and the last row and the one below the first pixel.
    """
    edges, flat = numbered_edges(weights), weights.reshape(-1)
    order = {frozenset((i, j)): (float(flat[n]), n) for n, i, j in edges}
    near: dict[int, set[int]] = {}
    for _, i, j in edges:
        near.setdefault(i, set()).add(j)
        near.setdefault(j, set()).add(i)
    found = set()
    for number, i, j in edges:
        if len(weights) == 4:
            paths = [(i, k, j) for k in near[i] & near[j]]
        else:
            paths = [(i, k, m, j) for k in near[i] - {j} for m in near[j] - {i} if m in near[k]]
        if any(all(order[frozenset(s)] < order[frozenset((i, j))] for s in itertools.pairwise(path)) for path in paths):
            found.add(number)
    _, height, width = weights.shape
    on_rim = set(range(width)) | set(range((height - 1) * width, height * width)) | {height * width}
    return found - on_rim


def drop_final(edges: list[tuple[float, int, int]], roots: list[int], bounds: Array, step: int) -> list[bool]:
    """Which of these edges (weight, pixel, neighbour) lie between regions that one of them can still merge."""
    heavy = [w > min(bounds[roots[i]], bounds[roots[j]]) for w, i, j in edges]
    if 2 * step * sum(heavy[::step]) < len(edges):
        return [True] * len(edges)
    useful = {roots[pixel] for w, i, j in edges for pixel in (i, j) if w <= bounds[roots[pixel]]}
    return [roots[i] in useful and roots[j] in useful for _, i, j in edges]


def collect(
    weights: Array, low: float, high: float, roots: list[int], flags: Array, least: int, detours: bool
) -> list[int]:
    """Numbers of the edges of these weights between two regions, with so many flagged ends; maybe without detours."""
    kept, left_out = [], set() if detours else drop_detours(weights)
    for number, i, j in numbered_edges(weights):
        flagged = int(flags[i]) + int(flags[j])
        if low <= float(weights.reshape(-1)[number]) < high and roots[i] != roots[j] and flagged >= least:
            kept.append(number)
    return [number for number in kept if number not in left_out]


def roots_of(parent: Array) -> list[int]:
    """The root of every node."""
    roots = []
    for node in range(len(parent)):
        root = node
        while parent[root] != root:
            root = int(parent[root])
        roots.append(root)
    return roots


def flag_open(low: float, roots: list[int], bounds: Array) -> list[bool]:
    """Pixels of regions that could still merge over an edge of weight `low`."""
    return [bool(bounds[root] >= low) for root in roots]


def flag_small(min_size: float, roots: list[int]) -> list[bool]:
    sizes = Counter(roots)
    return [sizes[root] < min_size for root in roots]


def number_regions(roots: list[int]) -> Array:
    first_seen = {root: number for number, root in enumerate(dict.fromkeys(roots))}
    return np.array([first_seen[root] for root in roots], np.int32)


def partition(weights: Array, gamma: float, min_size: float) -> Array:
    forest = merge(weights, gamma)
    absorb_small(forest, weights, min_size)
    return forest.labels().reshape(weights.shape[1:])


def flood(labels: Array, connectivity: int) -> Array:
    """Connected areas of equal label, numbered in raster order."""
    steps = [
        (dy, dx)
        for dy in (-1, 0, 1)
        for dx in (-1, 0, 1)
        if abs(dy) + abs(dx) in ((1,) if connectivity == 4 else (1, 2))
    ]
    out = np.full(labels.shape, -1)
    areas = 0
    for start in pixels(labels):
        if out[start] >= 0:
            continue
        queue = deque([start])
        out[start] = areas
        while queue:
            y, x = queue.popleft()
            for v, u in ((y + dy, x + dx) for dy, dx in steps):
                if inside(labels, v, u) and out[v, u] < 0 and labels[v, u] == labels[y, x]:
                    out[v, u] = areas
                    queue.append((v, u))
        areas += 1
    return out


# --- sums over regions ----------------------------------------------------------------------------------------


def sum_regions(labels: Array, count: int) -> tuple[Array, Array]:
    sums, boxes = np.zeros((count, 6)), np.zeros((count, 4), np.int32)
    for k in range(count):
        y, x = np.nonzero(labels == k)
        sums[k] = y.size, y.sum(), x.sum(), (y * y).sum(), (y * x).sum(), (x * x).sum()
        boxes[k] = y.min(), x.min(), y.max() + 1, x.max() + 1
    return sums, boxes


def sum_depth(labels: Array, depth: Array, camera: Intrinsics, count: int) -> Array:
    fx, fy, cx, cy = camera
    K = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
    sums = np.zeros((count, 4))
    for k in range(count):
        y, x = np.nonzero((labels == k) & (depth > 0))
        points = np.linalg.solve(K, np.stack([x, y, np.ones_like(x)]) * depth[y, x].astype(np.float64))
        sums[k] = y.size, *points.sum(axis=1)
    return sums


def spread(of_region: Array, labels: Array) -> Array:
    return np.array([[of_region[k] for k in row] for row in labels])


def count_marked(labels: Array, mask: Array, count: int) -> list[int]:
    return [int(((labels == k) & (mask > 0)).sum()) for k in range(count)]


def count_dark(labels: Array, color: Array, count: int) -> list[int]:
    """In the first three of 32 bins of max(R, G, B)."""
    brightness = color.max(axis=2)
    return [int(np.histogram(brightness[labels == k], bins=32, range=(0, 256))[0][:3].sum()) for k in range(count)]


# --- borders and planes ---------------------------------------------------------------------------------------


def behind_chord(before: float, here: float, after: float) -> float:
    """How far `here` lies behind the straight line in space between two points, along its ray."""
    return here - 2 / (1 / before + 1 / after)


def sum_borders(
    labels: Array, number: Array, depth: Array, boundary: Array, reach: int, gap_limit: float, bend_limit: float
) -> Array:
    """(S, S, 6): pairs, measured pairs, |gap|, how far the second lies behind, valley, boundary."""
    count = int(number.max(initial=-1)) + 1
    out = np.zeros((count, count, 6))
    for p in (np.array(at) for at in pixels(labels)):
        for step in (np.array([0, 1]), np.array([1, 0])):
            q, side_p, side_q = p + step, p - (reach - 1) * step, p + reach * step
            if not (inside(labels, *side_p) and inside(labels, *side_q)) or not inside(labels, *q):
                continue
            a, b = labels[tuple(p)], labels[tuple(q)]
            if a == b or labels[tuple(side_p)] != a or labels[tuple(side_q)] != b or min(number[a], number[b]) < 0:
                continue
            here, there, between = (float(depth[tuple(at)]) for at in (side_p, side_q, p))
            strength = max(boundary[tuple(p)], boundary[tuple(q)])
            entry = np.array([1, 0, 0, 0, 0, strength])
            if min(here, there, between) > 0:
                gap = float(np.clip(there - here, -gap_limit, gap_limit))
                valley = float(np.clip(behind_chord(here, between, there), -bend_limit, bend_limit))
                entry[1:5] = 1, abs(gap), gap, valley
            out[number[a], number[b]] += entry
            out[number[b], number[a]] += entry * np.array([1, 1, 1, -1, 1, 1])
    return out


def collect_pairs(labels: Array, boundary: Array) -> list[tuple[int, int, float]]:
    """Lower and higher region and stronger boundary of every pair of 4-neighbours in two regions, row by row."""
    out = []
    for y, x in pixels(labels):
        for v, u in ((y, x + 1), (y + 1, x)):
            if inside(labels, v, u) and labels[v, u] != labels[y, x]:
                ends = sorted((int(labels[y, x]), int(labels[v, u])))
                out.append((ends[0], ends[1], float(max(boundary[y, x], boundary[v, u]))))
    return out


def sum_hollows(labels: Array, number: Array, depth: Array, fx: float, margin: int) -> Array:
    """(S, 2): how far the middle of every run lies behind the chord between its ends, and the chord's length."""
    out = np.zeros((int(number.max(initial=-1)) + 1, 2))
    for y, row in enumerate(labels):
        cuts = [0, *(np.flatnonzero(np.diff(row)) + 1), len(row)]
        for first, end in itertools.pairwise(cuts):
            left, right = first + margin, end - 1 - margin
            if number[row[first]] < 0 or right - left < 8:
                continue
            ends_and_middle = [float(depth[y, x]) for x in (left, (left + right) // 2, right)]
            if min(ends_and_middle) > 0:
                a, middle, b = ends_and_middle
                across, behind = (right - left) * (a + b) / 2 / fx, behind_chord(a, middle, b)
                if abs(behind) <= 0.6 * across:
                    out[number[row[first]]] += behind, math.hypot(across, a - b)
    return out


def sum_outlines(
    labels: Array,
    depth: Array,
    height: Array,
    lengths_px: tuple[int, int, int],
    step: tuple[float, float],
    ledge: tuple[float, float],
) -> Array:
    """(R, 6): sides across the outline; of these measured, farther, nearer, stepped in height; on the image border.

    height (H, W) above the support. lengths_px: where depth is sampled, where the own slope is, the widest shadow.
    """
    near, deep, shadow = lengths_px
    out = np.zeros((int(labels.max()) + 1, 6))
    for p in (np.array(at) for at in pixels(labels)):
        k = labels[tuple(p)]
        for step_to in (np.array(direction) for direction in ((0, 1), (0, -1), (1, 0), (-1, 0))):
            if not inside(labels, *(p + step_to)):
                out[k, 5] += 1
                continue
            if labels[tuple(p + step_to)] == k:
                continue
            out[k, 0] += 1
            own = [
                tuple(at)
                for at in (p - (near - 1) * step_to, p)
                if inside(labels, *at) and labels[tuple(at)] == k and depth[tuple(at)] > 0
            ]
            beyond = [tuple(p + (near + further) * step_to) for further in range(shadow + 1)]
            seen = [at for at in beyond if inside(labels, *at) and depth[at] > 0]
            if not own or not seen:
                continue
            inner, outer = float(depth[own[0]]), float(depth[seen[0]])
            slope, at = 0.0, tuple(p - (deep - 1) * step_to)
            if inside(labels, *at) and labels[at] == k and depth[at] > 0:
                slope = abs(inner - float(depth[at])) / (deep - near) * 2 * near
            least = step[0] + step[1] * inner + slope
            rise = abs(height[own[0]] - height[seen[0]])
            out[k, 1:5] += [1, outer - inner > least, inner - outer > least, rise > max(ledge[0], ledge[1] * inner**2)]
    return out


def sum_normals(labels: Array, depth: Array, wanted: Array, camera: Intrinsics, reach: int) -> Array:
    """(R, 7): the normal of a pixel is the cross product of the tangents along its row and column, of length 1."""
    fx, fy, cx, cy = camera
    out = np.zeros((len(wanted), 7))
    for y, x in pixels(labels):
        k, z = labels[y, x], float(depth[y, x])
        cross = [(y, x - reach), (y, x + reach), (y - reach, x), (y + reach, x)]
        if not wanted[k] or z <= 0:
            continue
        if not all(inside(labels, *at) and labels[at] == k and depth[at] > 0 for at in cross):
            continue
        left, right, up, down = (float(depth[at]) for at in cross)
        sight = np.array([(x - cx) / fx, (y - cy) / fy, 1.0])
        # derivatives of the point z * sight along x and along y
        along_row = (right - left) / (2 * reach) * sight + z * np.array([1 / fx, 0, 0])
        along_column = (down - up) / (2 * reach) * sight + z * np.array([0, 1 / fy, 0])
        normal = np.cross(along_row, along_column)
        out[k] += [1, *(normal / np.linalg.norm(normal)), *(sight / np.linalg.norm(sight))]
    return out


def count_near(points: Array, planes: Array, tolerance: Array) -> list[int]:
    """points (N, 3)."""
    heights = [points.astype(np.float64) @ plane[:3].astype(np.float64) + float(plane[3]) for plane in planes]
    return [int((np.abs(h) <= tolerance).sum()) for h in heights]


def measure_heights(depth: Array, K: Array, normal: Array, offset: float) -> Array:
    return np.array([[normal @ np.linalg.solve(K, [x, y, 1]) * depth[y, x] + offset for x in range(depth.shape[1])]
                     for y in range(depth.shape[0])])  # fmt: skip


def tell_sides(depth: Array, K: Array, normal: Array, offset: float, least: float, noise: float) -> Array:
    """0 missing, 1 below, 2 on, 3 above."""
    out = np.zeros(depth.shape, np.uint8)
    for y, x in np.argwhere(depth > 0):
        point = np.linalg.solve(K, [x, y, 1]) * float(depth[y, x])
        height, tolerance = float(normal @ point) + offset, max(least, noise * float(depth[y, x]) ** 2)
        out[y, x] = 3 if height > tolerance else (2 if abs(height) <= tolerance else 1)
    return out


# --- Potts model ----------------------------------------------------------------------------------------------


def interaction_plane(
    distance: Array,
    depth: Array,
    mean: float,
    repulsion: float,
    step: float,
    step_per_m: float,
    penalty: float,
    offset: tuple[int, int],
) -> Array:
    out = np.zeros(depth.shape)
    for y, x in pixels(depth):
        v, u = y + offset[0], x + offset[1]
        if inside(depth, v, u):
            z = sorted((float(depth[y, x]), float(depth[v, u])))
            out[y, x] = max(1 - float(distance[y, x]) / mean, -repulsion)
            if z[0] > 0 and z[1] - z[0] > max(step, step_per_m * z[0] ** 2):
                out[y, x] = -penalty
    return out


def draw(seed: int, sweep: int, pixel: int, which: int) -> int:
    """32 bits, mixed again with each number that comes in."""
    bits = seed
    for number in (sweep, pixel, which):
        bits = (bits * 0x9E3779B1 + number) % 2**32
        for shift, odd in ((15, 0x85EBCA77), (13, 0xC2B2AE3D), (16, 1)):
            bits = (bits ^ bits >> shift) * odd % 2**32
    return bits


def neighbours(planes: Array, y: int, x: int) -> list[tuple[tuple[int, int], float]]:
    """(pixel, interaction) of the 8 neighbours, in raster order."""
    pairs = {}
    for plane, (dy, dx) in zip(planes, OFFSETS, strict=True):
        for at, there in (((y, x), (y + dy, x + dx)), ((y - dy, x - dx), (y - dy, x - dx))):
            if inside(plane, y, x) and inside(plane, *there):
                pairs[there] = float(plane[at])
    return sorted(pairs.items())


def sweep(spins: Array, planes: Array, values: int, temperature: float, seed: int, number: int) -> tuple[Array, int]:
    """Spins after the sweep, and how many changed."""
    spins, changed = spins.copy(), 0
    for top, left in ((0, 0), (0, 1), (1, 0), (1, 1)):
        before = spins.copy()  # pixels of a quarter do not see each other
        for y, x in ((y, x) for y, x in pixels(spins) if (y % 2, x % 2) == (top, left)):
            near = [(before[at], force) for at, force in neighbours(planes, y, x)]
            pixel = y * spins.shape[1] + x
            energy = Counter[int]()
            for spin, force in near:
                energy[int(spin)] -= force
            offered = [draw(seed, number, pixel, 0) % values, *(int(s) for s, _ in near if s != before[y, x])]
            other = min(offered, key=lambda spin: energy[spin])  # the first of equals
            rise = energy[other] - energy[int(before[y, x])]
            likely = rise <= 0 or draw(seed, number, pixel, 1) / 2**32 < math.exp(-rise / temperature)
            if other != before[y, x] and likely:
                spins[y, x], changed = other, changed + 1
    return spins, changed


# --- registration ---------------------------------------------------------------------------------------------


def one_surface(a: float, b: float, step_m: float, step_share: float) -> bool:
    return min(a, b) > 0 and abs(a - b) <= max(step_m, step_share * min(a, b))


def _quads(depth: Array, step_m: float, step_share: float) -> Iterator[list[tuple[float, float, float]]]:
    """Corners (x, y, depth) of all that is drawn: between four pixels on one surface, else the quarters of pixels."""
    around = np.pad(depth.astype(np.float64), 1)
    for top, left in pixels(around[1:, 1:]):
        corners = [(top, left), (top, left + 1), (top + 1, left + 1), (top + 1, left)]
        z = [float(around[corner]) for corner in corners]
        if one_surface(min(z), max(z), step_m, step_share):
            yield [(x - 1, y - 1, around[y, x]) for y, x in corners]
            continue
        for y, x in (corner for corner in corners if around[corner] > 0):
            z_here = float(around[y, x])
            same = [other for other in corners if one_surface(z_here, float(around[other]), step_m, step_share)]
            near = {other: 1 / around[other] for other in same}
            beside, below = (y, 2 * left + 1 - x), (2 * top + 1 - y, x)
            quarter = [[(y, x)], [(y, x), beside], list(near), [(y, x), below]]
            middles = [(left + 0.5 if k in (1, 2) else x, top + 0.5 if k in (2, 3) else y) for k in range(4)]
            means = [float(np.mean([near[p] for p in group if p in near])) for group in quarter]
            yield [(u - 1, v - 1, 1 / mean) for (u, v), mean in zip(middles, means, strict=True)]


def splat_depth(
    depth: Array, source: Array, target: Array, T: Array, step_m: float, step_share: float, shape: tuple[int, int]
) -> Array:
    """source, target: K (3, 3)."""
    out = np.zeros(shape)
    for quad in _quads(depth, step_m, step_share):
        points = [np.linalg.solve(source, [x, y, 1]) * z for x, y, z in quad]
        moved = np.array([T[:3, :3] @ point + T[:3, 3] for point in points])
        if moved[:, 2].min() < 0.01:
            continue
        projected = target @ (moved / moved[:, 2:]).T
        first = np.clip(np.floor(projected.min(axis=1)).astype(int), 0, None)
        last = np.clip(np.ceil(projected.max(axis=1)).astype(int), None, [shape[1] - 1, shape[0] - 1, 1])
        for triangle in ([0, 1, 2], [0, 2, 3]):
            if abs(np.linalg.det(projected[:, triangle])) <= 1e-6:
                continue
            to_shares = np.linalg.inv(projected[:, triangle])
            for y in range(first[1], last[1] + 1):
                for x in range(first[0], last[0] + 1):
                    shares = to_shares @ (x, y, 1)
                    if shares.min() >= -1e-6:
                        z = 1 / (shares @ (1 / moved[triangle, 2]))
                        out[y, x] = min(z, out[y, x] or z)
    return out


def fit_sides(
    edges: Array, direction: Array, normals: Array, disparity: Array, radius: int, strip: float, weak: float,
    least: float,
) -> Array:  # fmt: skip
    """(H, W, 4): where the line through each half-disc meets the edge, and its slope."""
    out = np.zeros((*edges.shape, 4))
    for y, x in zip(*np.nonzero(edges), strict=True):
        sides: list[list[tuple[float, float, float]]] = [[], []]
        for v, u in pixels(disparity):
            away = float(normals[direction[y, x]] @ (v - y, u - x))
            if disparity[v, u] > 0 and math.hypot(v - y, u - x) <= radius and away != 0:
                sides[away < 0].append((away, float(disparity[v, u]), weak if abs(away) < strip else 1.0))
        if min(sum(w for _, _, w in side) for side in sides) >= least:
            out[y, x] = [number for side in sides for number in _line(side)]
    return out


def _line(points: list[tuple[float, float, float]]) -> tuple[float, float]:
    away, value, weight = np.array(points).T
    if np.ptp(away) < 1e-6:
        return float(np.average(value, weights=weight)), 0.0
    root = np.sqrt(weight)
    solution = np.linalg.lstsq(np.stack([root, root * away], axis=1), root * value, rcond=None)[0]
    return float(solution[0]), float(solution[1])


def closed_path(radial: Array, angular: Array, least: int, most: int) -> float:
    """Cost of the cheapest closed path, tried from every start."""
    rays = len(radial)
    before = [[0.0, *itertools.accumulate(row.tolist())] for row in angular]  # of all radii below k
    radii = range(least, most + 1)
    lowest = math.inf
    for start in radii:
        cost = {k: float(radial[0, k]) if k == start else math.inf for k in radii}
        for t in range(1, rays + 1):
            way = {k: min(cost[j] + abs(before[t - 1][k] - before[t - 1][j]) for j in radii) for k in radii}
            cost = {k: way[k] + float(radial[t % rays, k]) for k in radii}
        lowest = min(lowest, way[start])
    return lowest


# --- data sets ------------------------------------------------------------------------------------------------


def draw_mesh(points: Array, triangles: Array, shape: tuple[int, int]) -> Array:
    """Depth of the nearest triangle at each pixel centre, 0 beside all; by the signs of three areas."""
    out = np.zeros(shape)
    for y, x in pixels(out):
        for corners in points[triangles]:
            (a_x, a_y, a_w), (b_x, b_y, b_w), (c_x, c_y, c_w) = corners
            shares = np.array([
                (b_x - x) * (c_y - y) - (b_y - y) * (c_x - x),
                (c_x - x) * (a_y - y) - (c_y - y) * (a_x - x),
                (a_x - x) * (b_y - y) - (a_y - y) * (b_x - x),
            ])  # fmt: skip
            if min(a_w, b_w, c_w) <= 0 or not ((shares > 0).all() or (shares < 0).all()):
                continue
            depth = shares.sum() / float(shares @ np.array([a_w, b_w, c_w]))
            if out[y, x] == 0 or depth < out[y, x]:
                out[y, x] = depth
    return out


def pack_rvl(values: np.ndarray) -> bytes:
    """What ROS makes of depth (M,) uint16: runs and differences in nibbles, eight of them a little-endian word."""
    nibbles: list[int] = []

    def put(number: int) -> None:
        while number > 7:
            nibbles.append(8 | number & 7)
            number >>= 3
        nibbles.append(number)

    rest, last = [int(v) for v in values], 0
    while rest:
        zeros = next((k for k, v in enumerate(rest) if v), len(rest))
        count = next((k for k, v in enumerate(rest[zeros:]) if not v), len(rest) - zeros)
        put(zeros)
        put(count)
        for value in rest[zeros : zeros + count]:
            put(2 * (value - last) if value >= last else -2 * (value - last) - 1)
            last = value
        rest = rest[zeros + count :]
    nibbles += [0] * (-len(nibbles) % 8)
    words = [int("".join(f"{n:x}" for n in nibbles[k : k + 8]), 16) for k in range(0, len(nibbles), 8)]
    return struct.pack(f"<{len(words)}I", *words)


def unpack_rvl(packed: bytes, count: int) -> list[int]:
    """The numbers of an RVL stream; raises StopIteration where it is cut off or has other than `count`."""
    digits = iter("".join(f"{word:08x}" for word in struct.unpack(f"<{len(packed) // 4}I", packed)))

    def number() -> int:
        octal = ""
        while len(octal) < 11:
            nibble = int(next(digits), 16)
            octal = str(nibble % 8) + octal
            if nibble < 8:
                return int(octal, 8)
        raise StopIteration

    def run() -> range:
        length = number()
        if length > count - len(out):
            raise StopIteration
        return range(length)

    out: list[int] = []
    last = 0
    while len(out) < count:
        out += [0 for _ in run()]
        for _ in run():
            step = number()
            last += -(step // 2) - 1 if step % 2 else step // 2
            out.append(last % 65536)
    return out


def unpack_lzf(packed: bytes) -> bytes:
    """What an LZF stream holds; raises IndexError where it is cut off."""
    out, rest = bytearray(), iter(packed)
    for control in rest:
        if control < 32:
            literal = bytes(itertools.islice(rest, control + 1))
            if len(literal) <= control:
                raise IndexError("cut off")
            out += literal
            continue
        length = control >> 5
        length += 2 + (next(rest) if length == 7 else 0)
        back = ((control & 31) << 8) + next(rest) + 1
        for _ in range(length):
            out.append(out[-back])
    return bytes(out)
