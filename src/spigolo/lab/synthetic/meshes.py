"""Procedural triangle meshes with texture coordinates for rendered scenes.

Lengths are in metres, and z is up. The corners of a face are in anticlockwise order, seen from outside.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = [
    "Mesh",
    "arc",
    "box",
    "faceted",
    "gable_roof",
    "joined",
    "lathe",
    "line",
    "moved",
    "prism",
    "rounded_rectangle",
    "sheet",
    "tub",
    "tube",
]

FloatArray = npt.NDArray[np.float64]
Rectangle = tuple[float, float, float, float]  # left, top, right, bottom in texture coordinates


@dataclass(frozen=True)
class Mesh:
    """Triangle mesh with vertices (N, 3) in metres, unit normals (N, 3), texture coordinates uv (N, 2) and triangles
    (M, 3).
    """

    vertices_m: FloatArray
    normals: FloatArray
    uv: FloatArray
    triangles: npt.NDArray[np.int64]


def arc(centre: tuple[float, float], radius_m: float, start_deg: float, stop_deg: float, count: int) -> FloatArray:
    """Return the points (count, 2) of a circular arc in the (r, z) plane, as a profile for `lathe`.

    An angle of 0 degrees is the direction +r, and an angle of 90 degrees is the direction +z.
    """
    angle = np.radians(np.linspace(start_deg, stop_deg, count))
    return np.column_stack([centre[0] + radius_m * np.cos(angle), centre[1] + radius_m * np.sin(angle)])


def line(*points: tuple[float, float]) -> FloatArray:
    """Return the points (K, 2) of a polyline in the (r, z) plane, as a profile for `lathe`."""
    return np.array(points, dtype=np.float64)


def lathe(sections: Sequence[FloatArray], around: int = 96) -> Mesh:
    """Create a solid of revolution by rotating a profile about the z axis.

    The texture coordinate u goes from 0 to 1 around the axis. The texture coordinate v goes from about 1 at the lowest
    point to about 0 at the highest point.

    Parameters
    ----------
    sections
        Smooth sections of the profile. Each section is an array (K, 2) of points (r, z), metres. Edges between sections
        are sharp. Along the profile, from its first to its last point, the solid is on the left.
    around
        Number of facets around the axis.

    """
    lowest, highest = min(p[:, 1].min() for p in sections), max(p[:, 1].max() for p in sections)
    turn = np.linspace(0.0, 1.0, around + 1)  # seam vertices exist twice, for u = 0 and u = 1
    cos, sin = np.cos(2 * np.pi * turn), np.sin(2 * np.pi * turn)
    parts = []
    for profile in sections:
        tangent = np.gradient(profile, axis=0)
        outward = np.column_stack([tangent[:, 1], -tangent[:, 0]])
        outward /= np.linalg.norm(outward, axis=1, keepdims=True)
        r, z = profile[:, :1], np.repeat(profile[:, 1:], around + 1, axis=1)
        vertices = np.stack([r * cos, r * sin, z], axis=-1)
        normals = np.stack([outward[:, :1] * cos, outward[:, :1] * sin, 0 * z + outward[:, 1:]], axis=-1)
        # Textures repeat, so that filtering at v = 0 and v = 1 would mix the first image row with the last.
        v = 0.002 + 0.996 * (highest - z) / (highest - lowest)
        uv = np.stack([np.broadcast_to(turn, z.shape), v], axis=-1)
        parts.append(_grid_mesh(vertices, normals, uv))
    return joined(parts)


def tube(path_m: npt.ArrayLike, radius_m: float, around: int = 16) -> Mesh:
    """Create a tube by sweeping a circle along a path (K, 3) in the x-z plane, for example the handle of a mug."""
    path = np.asarray(path_m, dtype=np.float64)
    tangent = np.gradient(path, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    side = np.array([0.0, 1.0, 0.0])
    up = np.cross(side, tangent)
    turn = np.linspace(0.0, 2 * np.pi, around + 1)
    normals = np.cos(turn)[:, None] * up[:, None] + np.sin(turn)[:, None] * side
    shape = normals.shape[:2]
    uv = np.stack(np.broadcast_arrays(np.zeros(shape), np.linspace(0, 1, shape[0])[:, None]), axis=-1)
    sweep = _grid_mesh(path[:, None] + radius_m * normals, normals, uv)
    caps = []
    for end, sign in ((0, -1.0), (-1, 1.0)):
        ring = path[end] + radius_m * normals[end, :-1]
        middle = np.broadcast_to(path[end], ring.shape)
        after = np.roll(ring, -1, axis=0)
        corners = np.stack([middle, ring, after] if sign > 0 else [middle, after, ring], axis=1)
        caps.append(faceted([(triangle, (0.0, 0.0, 0.0, 0.0)) for triangle in corners]))
    return joined([sweep, *caps])


def faceted(polygons: Sequence[tuple[npt.ArrayLike, Rectangle]]) -> Mesh:
    """Create a mesh from flat convex polygons with 3 or 4 corners. Each polygon is covered with a rectangular part of
    the texture.

    Corners are in anticlockwise order, seen from outside. The first corner of a polygon is at the bottom left of its
    texture rectangle.
    """
    parts = []
    for corners, (left, top, right, bottom) in polygons:
        vertices = np.asarray(corners, dtype=np.float64)
        normal = np.cross(vertices[1] - vertices[0], vertices[-1] - vertices[0])
        normals = np.tile(normal / np.linalg.norm(normal), (len(vertices), 1))
        quad = [(left, bottom), (right, bottom), (right, top), (left, top)]
        triangle = [(left, bottom), (right, bottom), ((left + right) / 2, top)]
        uv = np.array(quad if len(vertices) == 4 else triangle)
        fan = [(0, k, k + 1) for k in range(1, len(vertices) - 1)]
        parts.append(Mesh(vertices, normals, uv, np.array(fan, dtype=np.int64)))
    return joined(parts)


def box(size_m: tuple[float, float, float]) -> Mesh:
    """Create a box that stands on z = 0.

    The texture has three panels from left to right. The first panel covers the front and back of the box. The second
    panel covers the left and right side, and the third panel covers the top and bottom.
    """
    x, y, z = size_m[0] / 2, size_m[1] / 2, size_m[2]
    front, side, top = panels()
    return faceted(
        [
            ([(-x, -y, 0), (x, -y, 0), (x, -y, z), (-x, -y, z)], front),
            ([(x, y, 0), (-x, y, 0), (-x, y, z), (x, y, z)], front),
            ([(x, -y, 0), (x, y, 0), (x, y, z), (x, -y, z)], side),
            ([(-x, y, 0), (-x, -y, 0), (-x, -y, z), (-x, y, z)], side),
            ([(-x, -y, z), (x, -y, z), (x, y, z), (-x, y, z)], top),
            ([(-x, y, 0), (x, y, 0), (x, -y, 0), (-x, -y, 0)], top),
        ]
    )


def rounded_rectangle(
    size_m: tuple[float, float], radius_m: float, per_corner: int = 8
) -> tuple[FloatArray, FloatArray]:
    """Return the points (N, 2) of a rounded rectangle in anticlockwise order, and the outward unit normals (N, 2) at
    these points. The rectangle is centred at the origin.

    If the corner radius is half the length of the shorter side, the ends of the rectangle are semicircles.
    """
    turn = np.radians(np.linspace(0, 90, per_corner) + 90 * np.arange(4)[:, None]).ravel()
    outward = np.column_stack([np.cos(turn), np.sin(turn)])
    signs = np.repeat([(1, 1), (-1, 1), (-1, -1), (1, -1)], per_corner, axis=0)
    return signs * (np.array(size_m) / 2 - radius_m) + radius_m * outward, outward


def prism(outline_m: FloatArray, low_m: float, high_m: float, texture_m: float | None = None) -> Mesh:
    """Create a vertical prism with a convex outline (N, 2) between two heights.

    texture_m: side length of the square that the texture covers, in metres. The default is the larger side of the
    outline's bounding box.
    """
    corner = outline_m.min(axis=0)
    extent = np.ptp(outline_m, axis=0).max() if texture_m is None else texture_m
    flat_uv = (outline_m - corner) / extent * [1, -1] + [0, 1]
    fan = np.array([(0, k, k + 1) for k in range(1, len(outline_m) - 1)])
    parts = []
    for z, up in ((high_m, 1.0), (low_m, -1.0)):
        vertices = np.column_stack([outline_m, np.full(len(outline_m), z)])
        parts.append(Mesh(vertices, np.tile([0, 0, up], (len(vertices), 1)), flat_uv, fan if up > 0 else fan[:, ::-1]))
    faces = []
    for a, b in zip(outline_m, np.roll(outline_m, -1, axis=0), strict=True):
        width = float(np.linalg.norm(b - a)) / extent
        if width > 1e-9:
            shown = (0.0, 0.0, width, (high_m - low_m) / extent)
            faces.append(([(*a, low_m), (*b, low_m), (*b, high_m), (*a, high_m)], shown))
    return joined([*parts, faceted(faces)])


def tub(size_m: tuple[float, float], radius_m: float, sections: Sequence[FloatArray]) -> Mesh:
    """Create a solid by moving a profile along a rounded rectangle. The function `lathe` moves a profile along a
    circle.

    In the profile with points (r, z), r is the distance outwards from the rounded rectangle.

    The texture coordinate u goes from 0 to 1 around the rounded rectangle. The texture coordinate v is the length along
    the profile, divided by the circumference of the rounded rectangle.
    """
    outline, outward = (np.vstack([ring, ring[:1]]) for ring in rounded_rectangle(size_m, radius_m))
    steps = np.linalg.norm(np.diff(outline, axis=0), axis=1)
    around = np.concatenate([[0], np.cumsum(steps)]) / steps.sum()
    parts, along_m = [], 0.0
    for profile in sections:
        tangent = np.gradient(profile, axis=0)
        tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
        outset, z = profile[:, 0, None, None], np.repeat(profile[:, 1:], len(outline), axis=1)
        vertices = np.concatenate([outline + outset * outward, z[..., None]], axis=-1)
        normals = np.concatenate(
            [tangent[:, 1, None, None] * outward, np.broadcast_to(-tangent[:, :1], z.shape)[..., None]], axis=-1
        )
        lengths = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(profile, axis=0), axis=1))])
        v = np.broadcast_to((along_m + lengths[:, None]) / steps.sum(), z.shape)
        parts.append(_grid_mesh(vertices, normals, np.stack([np.broadcast_to(around, z.shape), v], axis=-1)))
        along_m += lengths[-1]
    return joined(parts)


def gable_roof(width_m: float, depth_m: float, base_z_m: float, roof_m: float, fin_m: float) -> Mesh:
    """Create the roof of a milk carton: two slopes, and a vertical fin along the ridge."""
    x, y, low, ridge, top = width_m / 2, depth_m / 2, base_z_m, base_z_m + roof_m, base_z_m + roof_m + fin_m
    fin = 0.0015  # half the thickness of the glued cardboard
    _, side, flat = panels()
    return faceted(
        [
            ([(-x, -y, low), (x, -y, low), (x, -fin, ridge), (-x, -fin, ridge)], flat),
            ([(x, y, low), (-x, y, low), (-x, fin, ridge), (x, fin, ridge)], flat),
            ([(x, -y, low), (x, y, low), (x, fin, ridge), (x, -fin, ridge)], flat),
            ([(-x, y, low), (-x, -y, low), (-x, -fin, ridge), (-x, fin, ridge)], flat),
            ([(-x, -fin, ridge), (x, -fin, ridge), (x, -fin, top), (-x, -fin, top)], side),
            ([(x, fin, ridge), (-x, fin, ridge), (-x, fin, top), (x, fin, top)], side),
            ([(x, -fin, ridge), (x, fin, ridge), (x, fin, top), (x, -fin, top)], side),
            ([(-x, fin, ridge), (-x, -fin, ridge), (-x, -fin, top), (-x, fin, top)], side),
            ([(-x, -fin, top), (x, -fin, top), (x, fin, top), (-x, fin, top)], side),
            ([(-x, y, low), (x, y, low), (x, -y, low), (-x, -y, low)], flat),
        ]
    )


def sheet(points_m: FloatArray, uv: FloatArray) -> Mesh:
    """Create a smooth surface through a grid of points (rows, columns, 3).

    Seen from outside the surface, rows of the grid go up and columns go to the right.
    """
    normals = np.cross(np.gradient(points_m, axis=1), np.gradient(points_m, axis=0))
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-12)
    return _grid_mesh(points_m, normals, uv)


def moved(mesh: Mesh, rotation: FloatArray, shift_m: npt.ArrayLike = (0.0, 0.0, 0.0)) -> Mesh:
    """Rotate a mesh about the origin by a rotation matrix (3, 3), then translate it."""
    return Mesh(mesh.vertices_m @ rotation.T + np.asarray(shift_m), mesh.normals @ rotation.T, mesh.uv, mesh.triangles)


def panels() -> tuple[Rectangle, Rectangle, Rectangle]:
    """Return the texture rectangles of the three panels of a box.

    A small margin around each panel prevents texture filtering from mixing adjacent panels.
    """
    inset = 0.004
    left, middle, right = ((k / 3 + inset, inset, (k + 1) / 3 - inset, 1 - inset) for k in range(3))
    return left, middle, right


def joined(parts: Sequence[Mesh]) -> Mesh:
    """Merge several meshes into one mesh."""
    starts = np.cumsum([0] + [len(part.vertices_m) for part in parts])
    return Mesh(
        np.concatenate([part.vertices_m for part in parts]),
        np.concatenate([part.normals for part in parts]),
        np.concatenate([part.uv for part in parts]),
        np.concatenate([part.triangles + start for part, start in zip(parts, starts[:-1], strict=True)]),
    )


def _grid_mesh(vertices: FloatArray, normals: FloatArray, uv: FloatArray) -> Mesh:
    """Create the mesh of a grid of vertices (rows, columns, 3). Triangles without area are left out."""
    rows, columns = vertices.shape[:2]
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    triangles = np.concatenate([np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
    flat = vertices.reshape(-1, 3)
    corners = flat[triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return Mesh(flat, normals.reshape(-1, 3), uv.reshape(-1, 2), triangles[area > 1e-12])
