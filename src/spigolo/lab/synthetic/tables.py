"""Rendered scenes on tables: different objects (family `table`), or instances of one object in clutter (family
`multi`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from spigolo.lab.datasets import tejani, uw_scenes
from spigolo.lab.datasets.visibility import TOLERANCE_M
from spigolo.lab.synthetic import furniture
from spigolo.lab.synthetic.household import FLAT_KINDS, Product, Rest, household, kind_of
from spigolo.lab.synthetic.meshes import joined, prism, rounded_rectangle
from spigolo.lab.synthetic.placing import Plot, height_m
from spigolo.lab.synthetic.rendering import Lighting
from spigolo.lab.synthetic.rooms import block, finish, hall, room_light
from spigolo.lab.synthetic.scene import Part, SceneObject, View
from spigolo.lab.synthetic.staging import Stage
from spigolo.lab.synthetic.structured_light import StructuredLight
from spigolo.lab.synthetic.surfaces import surface

__all__ = ["CLUTTER", "INSTANCES", "TABLES", "multi_stage", "table_stage"]

Rng = np.random.Generator

TABLES = {
    "table_1": ("bowl_2", "cap_1", "cap_4", "cereal_1", "coffee_mug_1", "coffee_mug_4", "flashlight_3", "soda_can_4"),
    "desk_1": ("cap_4", "coffee_mug_5", "soda_can_6"),
    "kitchen_small_1": (
        "bowl_4", "cap_1", "cereal_2", "coffee_mug_5", "flashlight_2", "flashlight_5", "soda_can_1", "soda_can_6",
    ),
}  # fmt: skip
"""Names of the objects in each scene of the family `table`, as in the data set UW RGB-D Scenes."""

INSTANCES = ("Milk", "Coffee_Cup", "Shampoo", "Camera")
"""Names of the objects that occur several times in a scene. Each scene of the family `multi` has the name of the object
that it repeats.
"""
CLUTTER = (
    "box_1",
    "box_2",
    "carton_1",
    "book_1",
    "soda_can_2",
    "bowl_1",
    "coffee_mug_2",
    "glue_1",
    "flashlight_1",
    "pouch_1",
)
_CLEAR_M = TOLERANCE_M + 0.001
"""Minimum distance between labelled and unlabelled objects, in metres.

An object model up to `TOLERANCE_M` behind another surface counts as visible. Masks rendered from models are therefore
wrong if objects are closer to each other than `TOLERANCE_M`.
"""


def table_stage(scene: str, rng: Rng) -> Stage:
    """Create a scene of the family `table`: the objects in `TABLES[scene]` on a table in a room.

    With a probability of 50 %, flat objects lie on the table, and another object stands on one of these flat objects.
    """
    size_m = rng.uniform(1.2, 1.8), rng.uniform(0.7, 0.9)
    top, parts, wall_y_m = _table(size_m, rng)
    plot = Plot(top)
    products = [household(name) for name in TABLES[scene]]
    middle = rng.uniform(-0.15, 0.15), rng.uniform(-0.1, 0.05)
    piled = bool(rng.uniform() < 0.5)
    things = _strewn(products, plot, middle, (0.2, 0.13), rng, touching=0.25, flat=piled)
    if piled:
        things = _piled(things, things, plot, rng)
    parts += _desk_things(plot, size_m, rng) + _background(size_m, wall_y_m, rng)
    look_at_m = middle[0] + rng.normal(0, 0.06), middle[1] + rng.normal(0, 0.05), 0.03
    view = View(
        look_at_m, rng.uniform(0.75, 1.2), rng.uniform(24, 46), rng.uniform(-35, 35), rng.normal(0, 2), uw_scenes.CAMERA
    )
    sensor = _sensor(rng, (0.6, 1.6))
    return Stage(
        tuple(things), tuple(parts), view, _light(rng, look_at_m), sensor,
        grey=rng.uniform(80, 145), noise_levels=rng.uniform(0.8, 4.0), blur_px=rng.uniform(0.4, 0.6),
        sharpening=rng.uniform(0.8, 2.0), contrast=1.3,
    )  # fmt: skip


def multi_stage(name: str, rng: Rng) -> Stage:
    """Create a scene of the family `multi`: three instances of one object on a table, close to other objects.

    With a probability of 50 %, one instance stands on another object.
    """
    size_m = rng.uniform(0.9, 1.3), rng.uniform(0.7, 0.9)
    top, parts, wall_y_m = _table(size_m, rng)
    plot = Plot(top)
    middle = rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.05)
    things = _strewn([household(name)] * 3, plot, middle, (0.09, 0.075), rng, lying=0.4, touching=0.4)
    plot.keep_off(_CLEAR_M)
    others = rng.choice(CLUTTER, int(rng.integers(4, 8)), replace=False)
    clutter = [household(str(other)) for other in others]
    bystanders = _strewn(clutter, plot, middle, (0.16, 0.12), rng, lying=0.5, touching=0.4)
    if rng.uniform() < 0.5:
        things = _piled(things, [*things, *bystanders], plot, rng)
    parts += _paper(size_m, rng) + _background(size_m, wall_y_m, rng)
    look_at_m = middle[0] + rng.normal(0, 0.03), middle[1] + rng.normal(0, 0.03), 0.03
    view, sensor = _close_or_far(look_at_m, rng)
    return Stage(
        tuple(things), tuple(parts), view, _light(rng, look_at_m), sensor, tuple(bystanders),
        grey=rng.uniform(90, 150), noise_levels=rng.uniform(0.8, 3.0), blur_px=rng.uniform(0.4, 0.7),
        sharpening=rng.uniform(0.5, 1.5),
    )  # fmt: skip


def _close_or_far(look_at_m: tuple[float, float, float], rng: Rng) -> tuple[View, StructuredLight]:
    """Return a random camera view, and the model of its depth camera.

    With a probability of 40 %, the camera is precise, has a short range and is near the table. With a probability of 60
    %, the camera is similar to the first Kinect.
    """
    sensor = _sensor(rng, (0.65, 1.7))
    distance_m, pitch_deg = rng.uniform(0.75, 1.05), rng.uniform(28, 62)
    if rng.uniform() < 0.4:
        sensor = replace(sensor.at_noise_level(rng.uniform(0.25, 0.6)), furthest_m=1.1)
        distance_m, pitch_deg = rng.uniform(0.6, 0.8), rng.uniform(50, 70)
    view = View(look_at_m, distance_m, pitch_deg, rng.uniform(-45, 45), rng.normal(0, 3), tejani.CAMERA)
    return view, sensor


def _table(size_m: tuple[float, float], rng: Rng) -> tuple[npt.NDArray[np.float64], list[Part], float]:
    """Create a table in a room.

    Return the outline (N, 2) of the table top, the parts of table and room, and the y position of the back wall.
    """
    height_m, wall_y_m = rng.uniform(0.7, 0.76), size_m[1] / 2 + rng.uniform(0.02, 1.2)
    top, _ = rounded_rectangle(size_m, 0.01)
    legs = [
        block((x, y, -height_m / 2 - 0.02), (0.05, 0.05, height_m - 0.04))
        for x in (0.06 - size_m[0] / 2, size_m[0] / 2 - 0.06)
        for y in (0.06 - size_m[1] / 2, size_m[1] / 2 - 0.06)
    ]
    kind = str(rng.choice(["wood", "wood", "wood", "wood", "paint", "paint", "terrazzo", "cloth"]))
    parts = [
        Part(prism(top, -0.03, 0.0), surface(kind, rng), *finish(rng)),
        Part(joined(legs), surface("plain", rng)),
        *hall(rng, -height_m, wall_y_m),
    ]
    return top, parts, wall_y_m


def _strewn(
    products: Sequence[Product],
    plot: Plot,
    middle_m: tuple[float, float],
    spread_m: tuple[float, float],
    rng: Rng,
    lying: float = 0.15,
    touching: float = 0.0,
    flat: bool = False,
) -> list[SceneObject]:
    """Place objects at random positions around a point of the table. Objects that do not fit are left out.

    Parameters
    ----------
    products
        Household objects to place.
    plot
        Area of the table top, with the objects already placed on it.
    middle_m, spread_m
        Mean and standard deviation of the random positions (x, y), in metres.
    rng
        Random number generator.
    lying
        Probability that an object is not in its most likely orientation, for example that a can lies instead of
        standing.
    touching
        Probability that an object touches another object.
    flat
        True to lay all flat objects down on the table.

    """

    def spot() -> tuple[float, float]:
        return float(rng.normal(middle_m[0], spread_m[0])), float(rng.normal(middle_m[1], spread_m[1]))

    def placed(product: Product) -> SceneObject | None:
        rests = _rests(product, lying, rng)
        if flat and kind_of(product.name) in FLAT_KINDS:
            rests = (min(product.rests, key=lambda rest: height_m(product, rest)),)
        return plot.place(product, rests, spot, rng, bool(rng.uniform() < touching))

    return [thing for thing in map(placed, products) if thing is not None]


def _piled(things: list[SceneObject], onto: list[SceneObject], plot: Plot, rng: Rng) -> list[SceneObject]:
    """Move one of the objects onto a flat object, if it fits on the flat object. onto: objects among which the flat
    object is chosen.
    """
    flat = [thing for thing in onto if kind_of(thing.name) in FLAT_KINDS]
    for below in rng.permutation(len(flat)):
        for k in rng.permutation(len(things)):
            product = household(things[k].name)
            moved = None if things[k] is flat[below] else plot.pile(product, product.rests[0], flat[below], rng)
            if moved is not None:
                return [moved if index == k else thing for index, thing in enumerate(things)]
    return things


def _rests(product: Product, lying: float, rng: Rng) -> tuple[Rest, ...]:
    return product.rests[1:] if len(product.rests) > 1 and rng.uniform() < lying else product.rests[:1]


def _desk_things(plot: Plot, size_m: tuple[float, float], rng: Rng) -> list[Part]:
    """Create sheets of paper on the table. If the back of the table is free, usually create a monitor, a keyboard or a
    carton at the back.
    """
    parts = _paper(size_m, rng)
    back_m = size_m[1] / 2 - 0.12
    x_m = float(rng.uniform(-0.6, 0.6) * (size_m[0] / 2))
    corners = np.array([(x_m - 0.3, back_m - 0.1), (x_m + 0.3, back_m + 0.1)])
    free = all(np.any(f.min(axis=0) > corners[1]) or np.any(f.max(axis=0) < corners[0]) for _, f in plot.taken)
    if free and rng.uniform() < 0.8:
        yaw_deg = rng.uniform(-15, 15)
        make = int(rng.integers(3))
        if make == 0:
            parts += furniture.screen((x_m, back_m, 0.0), yaw_deg, rng)
        elif make == 1:
            parts.append(furniture.keyboard((x_m, back_m), yaw_deg, rng))
        else:
            parts += furniture.packing_case((x_m, back_m, 0.0), yaw_deg, rng)
    return parts


def _paper(size_m: tuple[float, float], rng: Rng) -> list[Part]:
    """Create one to four sheets of paper on the table."""
    reach = np.array(size_m) / 2 - 0.15
    spots = rng.uniform(-reach, reach, (int(rng.integers(1, 5)), 2))
    places = [(float(x), float(y), 0.0003 * k) for k, (x, y) in enumerate(spots)]
    return [furniture.sheet_of_paper(place, rng.uniform(-180, 180), rng) for place in places]


def _background(size_m: tuple[float, float], wall_y_m: float, rng: Rng) -> list[Part]:
    """Create posters on the back wall, in some scenes a chair behind the table, and in some scenes cartons next to the
    table.
    """
    parts: list[Part] = []
    for _ in range(int(rng.integers(2, 7))):
        parts += furniture.poster((rng.uniform(-1.3, 1.3), wall_y_m - 0.01, rng.uniform(0.1, 0.9)), rng)
    if wall_y_m - size_m[1] / 2 > 0.55:
        x_m = rng.uniform(-0.8, 0.8)
        parts += furniture.chair((x_m, size_m[1] / 2 + 0.27, -0.27), rng.uniform(-25, 25), rng)
    for side in (-1, 1):
        if rng.uniform() < 0.4:
            at_m = side * (size_m[0] / 2 + rng.uniform(0.3, 0.6)), rng.uniform(-0.4, 0.4), -0.7
            parts += furniture.packing_case(at_m, rng.uniform(-180, 180), rng)
    return parts


def _light(rng: Rng, aim_m: tuple[float, float, float]) -> Lighting:
    """Create the lighting of a room, with enough point lights for smooth shadows on walls."""
    return replace(room_light(rng, aim_m), lamp_samples=8, sky_samples=32, sky_tilt_deg=35.0)


def _sensor(rng: Rng, noise_levels: tuple[float, float]) -> StructuredLight:
    """Create the model of a depth camera similar to the first Kinect.

    The border of the colour image, 2 to 15 pixels wide, has no depth. noise_levels: minimum and maximum of the random
    noise level.
    """
    left, right, top, bottom = (int(edge) for edge in rng.integers(2, 16, 4))
    camera = StructuredLight(
        dark_brightness=0.07,
        rim_loss=0.3,
        patch_px=3.0,
        edge_jitter_px=0.8,
        margin_px=(top, right, bottom, left),
    )
    low, high = np.log(noise_levels)
    return camera.at_noise_level(float(np.exp(rng.uniform(low, high))))
