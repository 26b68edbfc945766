"""Rendered scenes of shelves: a few products in a shelf bin, seen from the front in low light."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice

import cv2
import numpy as np

from spigolo.lab.datasets import rutgers
from spigolo.lab.synthetic.household import Product, Rest, household
from spigolo.lab.synthetic.meshes import Mesh, joined
from spigolo.lab.synthetic.placing import Plot, height_m, settled, world_points
from spigolo.lab.synthetic.prints import brushed_metal
from spigolo.lab.synthetic.rendering import Lighting
from spigolo.lab.synthetic.rooms import aisle_light, block, room
from spigolo.lab.synthetic.scene import Part, SceneObject, View
from spigolo.lab.synthetic.staging import Stage
from spigolo.lab.synthetic.structured_light import StructuredLight
from spigolo.lab.synthetic.textures import Image, plain_card, plaster, write

__all__ = ["PRODUCTS", "VIEWS", "shelf_stage"]

Rng = np.random.Generator

PRODUCTS = (
    "cereal_3", "box_1", "box_3", "box_4", "carton_2", "carton_3", "book_1", "book_2", "pouch_1", "pouch_2", "glue_1",
    "soda_can_3",
)  # fmt: skip
VIEWS = {"view_1": (0.0, 14.0), "view_2": (-16.0, 8.0), "view_3": (17.0, 26.0)}
"""Yaw of the camera to the side and pitch of the camera downwards, in degrees, indexed by the name of the view."""
_WALL_M, _BOARD_M = 0.006, 0.02
_LIPS_M = 0.035, 0.05
"""Minimum and maximum height of the lip (vertical strip at the front edge) of a shelf board, in metres."""


def shelf_stage(name: str, rng: Rng) -> Stage:
    """Create a scene with one to three products in the middle bin of a shelf with 3 x 3 bins.

    No product is partly hidden by the edges of the bin. Products are sorted by their distance from the camera, nearest
    first.
    """
    width_m, tall_m, deep_m = rng.uniform(0.25, 0.3), rng.uniform(0.21, 0.26), rng.uniform(0.38, 0.43)
    inner = np.array([(-1, 0.0), (1, 0.0), (1, 1), (-1, 1)]) * [width_m / 2, deep_m] + [0.0, 0.012]
    yaw_deg, pitch_deg = np.array(VIEWS[name]) + rng.normal(0, 3, 2)
    look_at_m = float(rng.normal(0, 0.02)), 0.1, 0.42 * tall_m
    view = View(look_at_m, rng.uniform(0.58, 0.72), pitch_deg, yaw_deg, rng.normal(0, 1.5), rutgers.CAMERA)
    plot = Plot(inner, lambda thing: _in_sight(thing, view, width_m, tall_m))
    placed = (_placed(household(str(name)), plot, width_m, deep_m, tall_m, rng) for name in rng.permutation(PRODUCTS))
    things = list(islice((thing for thing in placed if thing is not None), int(rng.integers(1, 4))))
    things.sort(key=lambda thing: float(np.linalg.norm(world_points(thing) - view.position_m, axis=1).min()))
    return Stage(
        tuple(things),
        tuple(_shelf(width_m, tall_m, deep_m, rng)),
        view,
        _light(view, rng),
        _sensor(rng),
        (_tool(view, rng),),
        grey=rng.uniform(28, 100),
        noise_levels=rng.uniform(1.0, 3.0),
        blur_px=rng.uniform(0.4, 0.6),
        sharpening=rng.uniform(1.6, 3.2),
        contrast=rng.uniform(1.1, 1.4),
        saturation=0.6,
    )


def _placed(product: Product, plot: Plot, width_m: float, deep_m: float, room_m: float, rng: Rng) -> SceneObject | None:
    """Place a product in a shelf bin: standing, lying or leaning against a wall. Return None if no free position is
    found.
    """
    if product.name.startswith(("book", "pouch")) and rng.uniform() < 0.6:
        side = int(rng.choice([-1, 1]))
        leaning = settled(product, Rest(side * rng.uniform(8, 20), 90.0), 0.0, 0.0, (0.0, 0.0))
        across_m = product.points_m @ leaning.rotation[0]
        wall_m = side * width_m / 2 - (across_m.max() if side > 0 else across_m.min()) - side * 0.002
        for _ in range(20):
            spot_m = float(wall_m), float(rng.uniform(0.1, deep_m - 0.1))
            thing = settled(product, Rest(leaning.tilt_deg, 90.0), 0.0, 0.0, spot_m)
            if plot.take(thing):
                return thing
    fitting = tuple(rest for rest in product.rests if height_m(product, rest) < room_m - 0.02)

    def spot() -> tuple[float, float]:
        return float(rng.uniform(-0.4, 0.4) * width_m), float(rng.uniform(0.05, 0.55) * deep_m)

    return plot.place(product, fitting, spot, rng)


def _in_sight(thing: SceneObject, view: View, width_m: float, tall_m: float) -> bool:
    """Return True if the whole object is visible through the front opening of its shelf bin."""
    rays = world_points(thing) - view.position_m
    x, _, z = (view.position_m + rays * (-view.position_m[1] / rays[:, 1])[:, None]).T
    low_m, high_m = _lip_middle_m(0.0) + _LIPS_M[1] / 2, _lip_middle_m(tall_m + _BOARD_M) - _LIPS_M[1] / 2
    return bool(np.all((np.abs(x) < width_m / 2) & (low_m < z) & (z < high_m)))


def _lip_middle_m(board_top_m: float) -> float:
    return board_top_m - 0.012


def _shelf(width_m: float, tall_m: float, deep_m: float, rng: Rng) -> list[Part]:
    """Create a shelf with cardboard walls and steel boards."""
    pitch_x, pitch_z = width_m + _WALL_M, tall_m + _BOARD_M
    span_m, middle_m = 3 * pitch_x, 0.5 * tall_m
    tone = rng.uniform(0.8, 1.1)
    cardboard = plaster((round(150 * tone), round(112 * tone), round(78 * tone)), rng)
    printed = _printed(cardboard, rng)
    steel = brushed_metal(rng, rng.uniform(150, 210))
    uprights = [block(((k - 1.5) * pitch_x, deep_m / 2, middle_m), (_WALL_M, deep_m, 3 * pitch_z)) for k in range(4)]
    back = block((0.0, deep_m + 0.016, middle_m), (span_m, 0.006, 3 * pitch_z))
    boards = [block((0.0, deep_m / 2, k * pitch_z - _BOARD_M / 2), (span_m, deep_m, _BOARD_M)) for k in range(-1, 3)]
    lips: list[Mesh] = [
        block((0.0, -0.003, _lip_middle_m(k * pitch_z)), (span_m, 0.004, rng.uniform(*_LIPS_M))) for k in range(-1, 3)
    ]
    return [
        Part(joined([*uprights, back]), printed, 0.0, 0.1),
        Part(joined(boards), brushed_metal(rng, rng.uniform(85, 135)), 0.85, 0.5),
        Part(joined(lips), _perforated(steel), 0.7, 0.5),
        *room(rng, -1.1, deep_m + 0.6),
    ]


def _printed(cardboard: Image, rng: Rng) -> Image:
    """Draw printed words and strips of tape on a cardboard texture."""
    image = np.asarray(cv2.resize(cardboard, (1024, 1024)), np.uint8)
    for _ in range(int(rng.integers(3, 9))):
        x, y = (int(at) for at in rng.integers(60, 964, 2))
        if rng.uniform() < 0.5:
            write(
                image,
                str(rng.choice(["THIS SIDE UP", "RECYCLE", "PB2400", "KEEP DRY"])),
                (x, y),
                (150, 3),
                (62, 46, 36),
            )
        else:
            image[y : y + 14, x - 60 : x + 200] = np.clip(image[y : y + 14, x - 60 : x + 200] * 1.2, 0, 255)
    fluted = 1 + 0.05 * np.sin(np.arange(1024) / 2.2)[:, None]
    return np.clip(image * fluted[..., None], 0, 255).astype(np.uint8)


def _perforated(steel: Image) -> Image:
    """Draw a row of holes and the labels of the bins on a steel texture."""
    image = np.asarray(cv2.resize(steel, (1024, 1024)), np.uint8)
    for x in range(16, 1024, 32):
        cv2.rectangle(image, (x, 1008), (x + 9, 1012), (30, 30, 32), -1)
    for x in (160, 480, 800):
        cv2.rectangle(image, (x, 990), (x + 60, 1020), (236, 232, 214), -1)
        write(image, "B", (x + 30, 1005), (12, 3), (20, 20, 22))
    return image


def _light(view: View, rng: Rng) -> Lighting:
    """Create the lighting: weak light from the aisle, and a lamp near the camera that casts large shadows."""
    aisle = aisle_light(rng, view.look_at_m)
    side_m, up_m = rng.choice([-1, 1]) * rng.uniform(0.1, 0.4), rng.uniform(0.1, 0.5)
    lamp_m = view.position_m + side_m * view.axes[0] + up_m * view.axes[1]
    x, y, z = map(float, lamp_m)
    share = rng.uniform(0.3, 0.8)
    return replace(
        aisle, lamp_m=(x, y, z), lamp_radius_m=rng.uniform(0.02, 0.15), lamp_rgb=1.6 * share * np.ones(3),
        sky_rgb=1.6 * (1 - share) * np.ones(3), lamp_samples=12, sky_samples=28,
    )  # fmt: skip


def _tool(view: View, rng: Rng) -> SceneObject:
    """Create a black robot gripper at the edge of the image. The gripper is too near to the camera, so its depth is
    missing.
    """
    up, side = rng.choice([-1, 1]) * rng.uniform(0.115, 0.15), rng.uniform(-0.12, 0.12)
    forward = np.array(view.look_at_m) - view.position_m
    middle = view.position_m + 0.3 * forward / np.linalg.norm(forward) + side * view.axes[0] + up * view.axes[1]
    x, y, z = map(float, middle)
    black = plain_card((24, 24, 26))
    return SceneObject(
        "tool", (x, y, z), view.yaw_deg, (Part(block((0.0, 0.0, 0.0), (0.14, 0.08, 0.07)), black, 0.1, 0.2),)
    )


def _sensor(rng: Rng) -> StructuredLight:
    """Create the model of a depth camera on the wrist of a robot, with a random noise level."""
    left, right, top, bottom = (int(edge) for edge in rng.integers(8, 30, 4))
    level = float(np.exp(rng.uniform(np.log(0.5), np.log(2.0))))
    camera = StructuredLight(
        dark_brightness=0.13,
        patch_px=3.0,
        steepest_angle_deg=rng.uniform(53, 65),
        rim_loss=0.35,
        edge_jitter_px=0.9,
        margin_px=(top, right, bottom, left),
    )
    return camera.at_noise_level(level)
