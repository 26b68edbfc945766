"""Where objects stand and lie, so that none goes through another.

On one level it is enough that the shadows which objects would throw straight down do not meet.
"""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.synthetic.household import Product, Rest
from spigolo.synthetic.scene import SceneObject

__all__ = ["Plot", "settled"]

FloatArray = npt.NDArray[np.float64]
Spot = tuple[float, float]

_GAP_M = 0.001
_TRIES = 40


def settled(product: Product, rest: Rest, yaw_deg: float, roll_deg: float, spot_m: Spot) -> SceneObject:
    """The product at a spot (x, y) in metres, let down until it touches z = 0; roll where the rest leaves it open."""
    roll_deg = roll_deg if rest.roll_deg is None else rest.roll_deg
    hung = SceneObject(product.name, (*spot_m, 0.0), yaw_deg, product.parts, rest.tilt_deg, roll_deg)
    lowest_m = float((product.points_m @ hung.rotation[2]).min())
    return SceneObject(product.name, (*spot_m, -lowest_m), yaw_deg, product.parts, rest.tilt_deg, roll_deg)


class Plot:
    """A level within a convex outline (N, 2) in metres, and the footprints of what stands there already."""

    def __init__(self, outline_m: npt.ArrayLike) -> None:
        self.outline = _hull(np.asarray(outline_m, np.float64))
        self.footprints: list[npt.NDArray[np.float32]] = []

    def take(self, thing: SceneObject) -> bool:
        """Whether the thing fits; if so its place is taken."""
        points = np.concatenate([part.mesh.vertices_m for part in thing.parts]) @ thing.rotation[:2].T
        footprint = _grown(_hull(points + np.array(thing.position_m[:2])))
        inside = all(cv2.pointPolygonTest(self.outline, (float(x), float(y)), False) >= 0 for x, y in footprint)
        if not inside or not all(_apart(footprint, other) for other in self.footprints):
            return False
        self.footprints.append(footprint)
        return True

    def place(
        self, product: Product, rests: tuple[Rest, ...], spot: Callable[[], Spot], rng: np.random.Generator
    ) -> SceneObject | None:
        """The product in one of these rests, somewhere that `spot` proposes (x, y); None where there is no room."""
        for _ in range(_TRIES):
            rest = rests[int(rng.integers(len(rests)))]
            yaw_deg, roll_deg = rng.uniform(-180, 180, 2)
            thing = settled(product, rest, float(yaw_deg), float(roll_deg), spot())
            if self.take(thing):
                return thing
        return None


def _hull(points_m: FloatArray) -> npt.NDArray[np.float32]:
    return np.asarray(cv2.convexHull(points_m.astype(np.float32))[:, 0], np.float32)


def _apart(a: npt.NDArray[np.float32], b: npt.NDArray[np.float32]) -> bool:
    """Whether a line along an edge of one of two convex polygons divides them."""
    for corners in (a, b):
        edges = np.roll(corners, -1, axis=0) - corners
        across = np.stack([edges[:, 1], -edges[:, 0]])
        along_a, along_b = a @ across, b @ across
        if np.any((along_a.max(axis=0) < along_b.min(axis=0)) | (along_b.max(axis=0) < along_a.min(axis=0))):
            return True
    return False


def _grown(hull_m: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """A little larger, so that neighbours do not touch."""
    out = hull_m - hull_m.mean(axis=0)
    return np.asarray(hull_m + _GAP_M * out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-9), np.float32)
