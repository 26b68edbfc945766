"""Scenes for pictures of the documentation: products on a wooden table, rendered with MuJoCo.

World axes: x to the right, y away from the camera, z up. The table top is z = 0. Lengths are in metres.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

import spigolo as sp
from pictures.layout import Window
from spigolo.frames.frame import Color
from spigolo.lab.synthetic.household import household
from spigolo.lab.synthetic.meshes import box
from spigolo.lab.synthetic.placing import settled
from spigolo.lab.synthetic.prints import carton, cover, palette
from spigolo.lab.synthetic.rendering import Lighting
from spigolo.lab.synthetic.rooms import block, floor
from spigolo.lab.synthetic.scene import Part, SceneObject, View
from spigolo.lab.synthetic.staging import Stage, record
from spigolo.lab.synthetic.structured_light import StructuredLight
from spigolo.lab.synthetic.surfaces import surface
from spigolo.lab.synthetic.textures import box_panels, plain_card

Size = tuple[float, float, float]
Spot = tuple[float, float]

TABLE_M = 1.4, 0.9, 0.03
FLAT_M = 0.13, 0.10
PACKED_M = 0.11, 0.085, 0.12
TWO_BOXES = (130, 180, 350, 460)


@dataclass(frozen=True)
class FlatBoxes:
    """Frame of boxes of several heights in two rows. places_px: pixels (x, y) at which the heights are written."""

    frame: sp.Frame
    heights_mm: tuple[int, ...]
    places_px: npt.NDArray[np.intp]

    @property
    def window(self) -> Window:
        """Return the pixel box around all boxes."""
        (x0, y0), (x1, y1) = self.places_px.min(axis=0), self.places_px.max(axis=0)
        return int(y0) - 95, int(x0) - 85, int(y1) + 30, int(x1) + 85

    def labelled(self) -> Color:
        """Return the colour image with the height of each box written below the box."""
        picture = self.frame.color.copy()
        for height_mm, (x, y) in zip(self.heights_mm, self.places_px.tolist(), strict=True):
            for ink, width in (((20, 20, 20), 4), ((255, 255, 255), 1)):
                cv2.putText(picture, f"{height_mm}", (x - 9, y), cv2.FONT_HERSHEY_DUPLEX, 0.55, ink, width, cv2.LINE_AA)
        return picture


def flat_boxes(heights_mm: tuple[int, ...], distance_m: float) -> FlatBoxes:
    """Render six printed boxes of 13 x 10 cm in two rows, with the given heights."""
    spots = [(-0.2 + 0.2 * (k % 3), 0.12 - 0.2 * (k // 3)) for k in range(6)]
    things = [
        _box((*FLAT_M, height / 1000), spot, 8 * k - 20, 30 + k)
        for k, (height, spot) in enumerate(zip(heights_mm, spots, strict=True))
    ]
    view = View((0.0, 0.02, 0.0), distance_m, 40.0)
    below = [(x, y - 0.095, 0.0) for x, y in spots]
    return FlatBoxes(_photograph(things, view, seed=1), heights_mm, _pixels(below, view))


def groceries() -> sp.Frame:
    """Render six products near the camera, with more depth noise than usual."""
    things = [
        _product("cereal_1", (-0.22, 0.12), 20),
        _product("Milk", (0.0, 0.16), 35),
        _product("soda_can_1", (0.16, 0.05), 0),
        _product("book_1", (-0.12, -0.12), 15),
        _product("carton_1", (0.12, -0.12), -20, rest=1),
        _product("box_1", (0.3, 0.12), -15),
    ]
    return _photograph(things, View((0.03, 0.02, 0.04), 0.7, 35.0, -10.0), seed=2, noise_level=1.6)


def two_boxes(behind_m: float) -> sp.Frame:
    """Render two boxes of equal size that touch. The right box is `behind_m` behind the left box."""
    size_m = 0.10, 0.08, 0.14
    things = [_box(size_m, (-0.05, 0.0), 0, 3), _box(size_m, (0.0505, behind_m), 0, 9)]
    return _photograph(things, View((0.0, 0.0, 0.05), 0.7, 35.0, 20.0), seed=1)


def packed_layer(raised_m: float) -> sp.Frame:
    """Render a layer of packed boxes that is wider than the image. One box is higher than all other boxes, by
    `raised_m`.
    """
    x, y, z = PACKED_M
    things = []
    for row, column in np.ndindex(9, 11):
        height_m = z + (raised_m if (row, column) == (4, 5) else 0.0)
        spot = 1.01 * x * (column - 5), 1.01 * y * (row - 4)
        things.append(_box_from_above((x, y, height_m), spot, row + column))
    return _photograph(things, View((0.0, 0.0, z), 0.6, 75.0, 5.0), seed=1)


def _box(size_m: Size, spot_m: Spot, yaw_deg: float, print_seed: int) -> SceneObject:
    """Return a printed carton that stands on the table."""
    parts = (Part(box(size_m), carton(size_m, np.random.default_rng(print_seed)), 0.1, 0.3),)
    return SceneObject("box", (*spot_m, 0.0), yaw_deg, parts)


def _box_from_above(size_m: Size, spot_m: Spot, kind: int) -> SceneObject:
    """Return a carton with a printed upper face."""
    rng = np.random.default_rng(kind % 3)
    x, y = (round(2400 * length) for length in size_m[:2])
    colours = palette(rng)
    side = plain_card(colours[0])
    return SceneObject(
        "box", (*spot_m, 0.0), 0.0, (Part(box(size_m), box_panels(side, side, cover((y, x), colours, rng)), 0.1, 0.3),)
    )


def _product(name: str, spot_m: Spot, yaw_deg: float, rest: int = 0) -> SceneObject:
    product = household(name)
    return settled(product, product.rests[rest], yaw_deg, 0.0, spot_m)


def _photograph(things: Sequence[SceneObject], view: View, seed: int, noise_level: float = 1.0) -> sp.Frame:
    """Render objects on a wooden table, with a sensor model of the first Kinect. noise_level: depth noise as a multiple
    of the noise of the Kinect.
    """
    top = block((0.0, 0.0, -TABLE_M[2] / 2), TABLE_M)
    wood, ground = surface("wood", np.random.default_rng(1)), surface("plain", np.random.default_rng(9))
    surroundings = Part(top, wood, 0.1, 0.2), floor(ground, -0.75)
    lamp, sky = 0.8 * np.array([1.0, 0.96, 0.9]), np.array([0.95, 0.98, 1.05])
    lighting = Lighting(view.look_at_m, (-0.7, -1.0, 1.8), 0.4, lamp, sky)
    sensor = StructuredLight(rim_loss=0.3, patch_px=3.0, edge_jitter_px=0.6).at_noise_level(noise_level)
    stage = Stage(tuple(things), surroundings, view, lighting, sensor, grey=125.0, noise_levels=1.0, contrast=1.1)
    return record(stage, "docs", np.random.default_rng(seed)).sample.frame


def _pixels(points_m: Sequence[tuple[float, float, float]], view: View) -> npt.NDArray[np.intp]:
    """Project points, given in world axes in metres, to pixels (N, 2) in the order (x, y)."""
    x, y, z, _ = view.world_to_camera @ np.column_stack([points_m, np.ones(len(points_m))]).T
    camera = view.camera
    return np.stack([camera.fx * x / z + camera.cx, camera.fy * y / z + camera.cy], axis=1).round().astype(np.intp)
