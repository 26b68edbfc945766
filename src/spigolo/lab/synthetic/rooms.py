"""Surroundings of rendered scenes: floors, walls and lighting.

World frame: x to the right, y away from the camera, z up. Lengths are in metres.
"""

from __future__ import annotations

import numpy as np

from spigolo.lab.synthetic.meshes import Mesh, joined, prism, rounded_rectangle
from spigolo.lab.synthetic.rendering import Lighting
from spigolo.lab.synthetic.scene import Part
from spigolo.lab.synthetic.surfaces import SURFACES, surface
from spigolo.lab.synthetic.textures import Image

__all__ = ["aisle_light", "any_kind", "block", "finish", "floor", "hall", "room", "room_light", "shelf_kind"]

LAMP_SAMPLES, SKY_SAMPLES = 5, 13


def block(centre_m: tuple[float, float, float], size_m: tuple[float, float, float]) -> Mesh:
    """Create an axis-aligned box."""
    outline, _ = rounded_rectangle(size_m[:2], min(size_m[:2]) / 100, 2)
    return prism(outline + centre_m[:2], centre_m[2] - size_m[2] / 2, centre_m[2] + size_m[2] / 2)


def room(rng: np.random.Generator, floor_m: float, wall_y_m: float) -> list[Part]:
    """Create a floor, a wall at the back, and sometimes a wall at one side.

    Parameters
    ----------
    rng
        Random number generator.
    floor_m
        Height of the floor (z), metres.
    wall_y_m
        Position of the back wall (y), metres.

    """
    below = surface(str(rng.choice(["plain", "wood", "checker", "terrazzo", "cloth"])), rng)
    paint = surface("plain", rng)
    parts = [
        floor(below, floor_m),
        Part(block((0.0, wall_y_m + 0.05, floor_m + 1.25), (5.0, 0.1, 2.5)), paint, 0.0, 0.0),
    ]
    if rng.uniform() < 0.3:
        side_m = rng.choice([-1, 1]) * rng.uniform(1.0, 1.6)
        parts.append(Part(block((side_m, 0.0, floor_m + 1.25), (0.1, 5.0, 2.5)), paint, 0.0, 0.0))
    return parts


def hall(rng: np.random.Generator, floor_m: float, wall_y_m: float) -> list[Part]:
    """Create a large room with floor, back wall and side walls, in plain colours.

    Parameters
    ----------
    rng
        Random number generator.
    floor_m
        Height of the floor (z), metres.
    wall_y_m
        Position of the back wall (y), metres.

    """
    below = str(rng.choice(["carpet", "carpet", "wood", "terrazzo", "paint"]))
    paint = surface("paint", rng)
    middle_m = floor_m + 1.5
    sides = [block((side * rng.uniform(1.6, 3.0), 0.0, middle_m), (0.1, 9.0, 3.0)) for side in (-1, 1)]
    behind = block((0.0, wall_y_m + 0.05, middle_m), (9.0, 0.1, 3.0))
    return [floor(surface(below, rng), floor_m), Part(joined([behind, *sides]), paint, 0.0, 0.0)]


def floor(texture: Image, floor_m: float) -> Part:
    """Create a floor of 6 m x 6 m. floor_m: height of the floor."""
    outline, _ = rounded_rectangle((6.0, 6.0), 0.01, 2)
    return Part(prism(outline, floor_m - 0.05, floor_m, texture_m=1.3), texture, 0.05, 0.2)


def room_light(rng: np.random.Generator, aim_m: tuple[float, float, float]) -> Lighting:
    """Create the lighting of a room: a lamp at a random position above the scene, and diffuse light."""
    lamp_m = rng.uniform(-1.2, 1.2), rng.uniform(-1.3, 0.5), rng.uniform(1.4, 2.2)
    lamp = rng.uniform(0.2, 0.9)
    return _lighting(rng, aim_m, lamp_m, lamp, 1.6 - lamp, 0.0)


def aisle_light(rng: np.random.Generator, aim_m: tuple[float, float, float]) -> Lighting:
    """Create the lighting of an aisle between shelves: a lamp above the aisle, and diffuse light from the front."""
    lamp_m = rng.uniform(-0.8, 0.8), rng.uniform(-1.8, -0.9), rng.uniform(0.6, 1.6)
    lamp = rng.uniform(0.2, 0.8)
    return _lighting(rng, aim_m, lamp_m, lamp, 1.6 - lamp, 60.0)


def _lighting(
    rng: np.random.Generator,
    aim_m: tuple[float, float, float],
    lamp_m: tuple[float, float, float],
    lamp: float,
    sky: float,
    sky_tilt_deg: float,
) -> Lighting:
    """Create a lamp of random warm or cold colour, and diffuse light. If the lamp has a warm colour, the diffuse light
    has a cold colour, and vice versa.
    """
    warmth = rng.uniform(-0.06, 0.12)
    tint = np.array([1 + warmth, 1.0, 1 - 1.2 * warmth])
    return Lighting(
        aim_m, lamp_m, rng.uniform(0.15, 0.5), lamp * tint, sky / tint, sky_tilt_deg, LAMP_SAMPLES, SKY_SAMPLES
    )


def any_kind(rng: np.random.Generator) -> str:
    """Return the name of a random surface texture."""
    return str(rng.choice(list(SURFACES)))


def shelf_kind(rng: np.random.Generator) -> str:
    """Return the name of a random surface texture for shelves."""
    return str(rng.choice(["plain", "plain", "wood", "terrazzo", "cloth"]))


def finish(rng: np.random.Generator) -> tuple[float, float]:
    """Return random values of MuJoCo's material properties specular and shininess, from matt to glossy."""
    return rng.uniform(0.0, 0.35), rng.uniform(0.1, 0.6)
