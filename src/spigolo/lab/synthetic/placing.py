"""Random placement of objects on a plane or on each other, without collisions.

Objects on the plane are placed so that their vertical projections do not overlap.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.lab.synthetic.household import Product, Rest
from spigolo.lab.synthetic.scene import SceneObject

__all__ = ["Plot", "height_m", "settled", "world_points"]

FloatArray = npt.NDArray[np.float64]
Outline = npt.NDArray[np.float32]
Spot = tuple[float, float]

_GAP_M = 0.0002
_ALL_ROUND = np.stack([np.cos(np.arange(12) * np.pi / 6), np.sin(np.arange(12) * np.pi / 6)], axis=-1)
_LEVEL_M = 0.001
_TRIES = 40


def settled(product: Product, rest: Rest, yaw_deg: float, roll_deg: float, spot_m: Spot) -> SceneObject:
    """Place a product at (x, y), so that its lowest point is at z = 0.

    Parameters
    ----------
    product
        Household object to place.
    rest
        Stable orientation of the product.
    yaw_deg
        Rotation about the vertical axis, degrees.
    roll_deg
        Rotation about the object's z axis, in degrees. If `rest.roll_deg` is not None, it replaces `roll_deg`.
    spot_m
        Position (x, y), metres.

    """
    roll_deg = roll_deg if rest.roll_deg is None else rest.roll_deg
    hung = SceneObject(product.name, (*spot_m, 0.0), yaw_deg, product.parts, rest.tilt_deg, roll_deg)
    lowest_m = float((product.points_m @ hung.rotation[2]).min())
    return SceneObject(product.name, (*spot_m, -lowest_m), yaw_deg, product.parts, rest.tilt_deg, roll_deg)


def height_m(product: Product, rest: Rest) -> float:
    """Return the height of the product in a stable orientation, metres."""
    return float(np.ptp(product.points_m @ settled(product, rest, 0.0, 0.0, (0.0, 0.0)).rotation[2]))


class Plot:
    """Horizontal area with a convex outline (N, 2) in metres, on which objects are placed.

    allows: function that returns True if an object may be placed at its position.
    """

    def __init__(self, outline_m: npt.ArrayLike, allows: Callable[[SceneObject], bool] = lambda thing: True) -> None:
        self.outline = _hull(np.asarray(outline_m, np.float64))
        self.allows = allows
        self.taken: list[tuple[SceneObject, Outline]] = []

    def keep_off(self, gap_m: float) -> None:
        """Require a minimum distance of `gap_m` metres between objects already placed and objects placed later."""
        self.taken = [(thing, _grown(footprint, gap_m)) for thing, footprint in self.taken]

    def take(self, thing: SceneObject) -> bool:
        """Place an object at its given position. Return False if the position is occupied, outside the area or not
        allowed by `allows`.
        """
        footprint = _footprint(thing)
        if not (self._is_free(footprint) and self.allows(thing)):
            return False
        self.taken.append((thing, footprint))
        return True

    def place(
        self,
        product: Product,
        rests: tuple[Rest, ...],
        spot: Callable[[], Spot],
        rng: np.random.Generator,
        touching: bool = False,
    ) -> SceneObject | None:
        """Place a product at a random free position. Return None if no free position is found.

        Parameters
        ----------
        product
            Household object to place.
        rests
            Stable orientations to choose from.
        spot
            Function that returns a random position (x, y), metres.
        rng
            Random number generator.
        touching
            True to move the placed product until it touches the nearest object.

        """
        for _ in range(_TRIES):
            rest = rests[int(rng.integers(len(rests)))]
            yaw_deg, roll_deg = rng.uniform(-180, 180, 2)
            thing = settled(product, rest, float(yaw_deg), float(roll_deg), spot())
            if self._is_free(_footprint(thing)) and self.allows(thing):
                thing = self._pushed(thing) if touching else thing
                self.taken.append((thing, _footprint(thing)))
                return thing
        return None

    def pile(self, product: Product, rest: Rest, below: SceneObject, rng: np.random.Generator) -> SceneObject | None:
        """Place a product on the flat top of another object.

        Return None if the product does not fit on the top, or would collide with another object.
        """
        points = world_points(below)
        top_m = float(points[:, 2].max())
        face = _hull(points[points[:, 2] > top_m - _LEVEL_M, :2])
        middle, reach = face.mean(axis=0), np.ptp(face, axis=0) / 4
        others = [footprint for thing, footprint in self.taken if thing is not below]
        for _ in range(_TRIES):
            x, y = map(float, rng.uniform(middle - reach, middle + reach))
            thing = settled(product, rest, float(rng.uniform(-180, 180)), 0.0, (x, y))
            points = world_points(thing)
            footprint = _footprint(thing)
            rests_on_it = _within(_hull(points[points[:, 2] < _LEVEL_M, :2]), face)
            if rests_on_it and all(_apart(footprint, other) for other in others):
                thing = replace(thing, position_m=(x, y, thing.position_m[2] + top_m + _GAP_M))
                self.taken.append((thing, footprint))
                return thing
        return None

    def _is_free(self, footprint: Outline) -> bool:
        return _within(footprint, self.outline) and all(_apart(footprint, other) for _, other in self.taken)

    def _pushed(self, thing: SceneObject) -> SceneObject:
        """Move an object towards the nearest other object until the two objects touch."""
        if not self.taken:
            return thing
        footprint = _footprint(thing)
        ways = [other.mean(axis=0) - footprint.mean(axis=0) for _, other in self.taken]
        way = min(ways, key=lambda way: float(np.linalg.norm(way)))
        free, blocked = 0.0, 1.0
        for _ in range(12):
            share = (free + blocked) / 2
            free, blocked = (share, blocked) if self._is_free(footprint + share * way) else (free, share)
        x, y, z = thing.position_m
        return replace(thing, position_m=(x + free * float(way[0]), y + free * float(way[1]), z))


def world_points(thing: SceneObject) -> FloatArray:
    """Return the vertices (N, 3) of an object in the world frame, metres."""
    points = np.concatenate([part.mesh.vertices_m for part in thing.parts])
    return np.asarray(points @ thing.rotation.T + np.array(thing.position_m))


def _footprint(thing: SceneObject) -> Outline:
    """Return the convex outline (N, 2) of an object's vertical projection, enlarged by 0.2 mm."""
    return _grown(_hull(world_points(thing)[:, :2]), _GAP_M)


def _within(corners: Outline, outline: Outline) -> bool:
    return all(cv2.pointPolygonTest(outline, (float(x), float(y)), False) >= 0 for x, y in corners)


def _hull(points_m: FloatArray) -> Outline:
    return np.asarray(cv2.convexHull(points_m.astype(np.float32))[:, 0], np.float32)


def _apart(a: Outline, b: Outline) -> bool:
    """Return True if two convex polygons do not overlap (separating axis theorem)."""
    for corners in (a, b):
        edges = np.roll(corners, -1, axis=0) - corners
        across = np.stack([edges[:, 1], -edges[:, 0]])
        along_a, along_b = a @ across, b @ across
        if np.any((along_a.max(axis=0) < along_b.min(axis=0)) | (along_b.max(axis=0) < along_a.min(axis=0))):
            return True
    return False


def _grown(hull_m: Outline, by_m: float) -> Outline:
    """Enlarge a convex outline (N, 2) by `by_m` on all sides."""
    return _hull((hull_m[:, None] + by_m * _ALL_ROUND).reshape(-1, 2))
