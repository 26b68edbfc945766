"""Rendered RGB-D frames of tables, bins and shelves without objects, to count false detections.

World frame: x to the right, y away from the camera, z up. The support plane is at z = 0. Lengths are in metres.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from spigolo.frames.frame import Frame, Mask
from spigolo.lab.synthetic.meshes import Mesh, arc, joined, line, prism, rounded_rectangle, tub
from spigolo.lab.synthetic.rendering import Lighting, developed, render_geoms, render_quickly
from spigolo.lab.synthetic.rooms import aisle_light, any_kind, block, finish, floor, room, room_light, shelf_kind
from spigolo.lab.synthetic.scene import CAMERA, Part, SceneObject, View, compile_scene
from spigolo.lab.synthetic.structured_light import simulate_structured_light
from spigolo.lab.synthetic.surfaces import SURFACES, surface

__all__ = ["FAMILIES", "empty_scene", "empty_scenes", "scene_with_a_box"]

_SHADOW_PX = 1024


@dataclass(frozen=True)
class _Scene:
    """Meshes, camera view and lighting of a scene."""

    parts: tuple[Part, ...]
    view: View
    lighting: Lighting
    exposure: float = 1.0
    """Factor by which the brightness of the colour image is multiplied, 1 = unchanged."""
    noise_levels: float = 1.0
    """Standard deviation of the colour noise in grey levels, 0..255."""


def empty_scene(family: str, seed: int) -> Frame:
    """Render a frame without objects.

    family: kind of scene, a key of `FAMILIES`. Raises ValueError for an unknown kind of scene.
    """
    return _render(family, seed, lambda view: None)[0]


def scene_with_a_box(family: str, seed: int) -> tuple[Frame, Mask]:
    """Render the scene of `empty_scene` with an added box of 9 x 7 x 13 cm.

    Return the frame, and the mask (H, W) of the box.

    A method that never finds an object has no false detections in empty scenes. The box reveals a method that never
    finds an object, because the method does not find the box either.
    """
    return _render(family, seed, lambda view: _box(family, seed, view))


def _render(family: str, seed: int, put: Callable[[View], SceneObject | None]) -> tuple[Frame, Mask]:
    if family not in FAMILIES:
        raise ValueError(f"unknown family {family!r}: expected one of {', '.join(FAMILIES)}")
    rng = np.random.default_rng([list(FAMILIES).index(family), seed])
    scene = FAMILIES[family](rng, list(SURFACES)[seed % len(SURFACES)])
    things = {"surroundings": SceneObject("surroundings", (0.0, 0.0, 0.0), 0.0, scene.parts)}
    if (box := put(scene.view)) is not None:
        things[box.name] = box
    model = compile_scene("spigolo empty scene", things, scene.view, _SHADOW_PX)
    light, ideal_m = render_quickly(model, scene.lighting)
    # The depth camera has its own light, so the exposure does not affect the measured depth.
    depth_m = simulate_structured_light(ideal_m, developed(light), CAMERA.fx, rng)
    noisy = developed(scene.exposure * light) + rng.normal(0.0, scene.noise_levels, light.shape)
    frame = Frame(np.clip(np.round(noisy), 0, 255).astype(np.uint8), depth_m, CAMERA, name=f"{family}-{seed}")
    return frame, np.asarray(render_geoms(model) >= len(scene.parts))


def _box(family: str, seed: int, view: View) -> SceneObject:
    """Create a box in the middle of the view. On a shelf, the box is 12 cm behind the front edge."""
    rng = np.random.default_rng([99, seed])
    outline, _ = rounded_rectangle((0.09, 0.07), 0.003, 3)
    at = view.look_at_m[0], 0.12 if family == "shelf" else view.look_at_m[1], 0.0
    part = Part(prism(outline, 0.0, 0.13), surface("wood" if seed % 2 else "plain", rng))
    return SceneObject("box", at, float(rng.uniform(-30, 30)), (part,))


def empty_scenes(count: int = 50) -> Iterator[Frame]:
    """Render `count` frames without objects, alternately of tables, bins and shelves."""
    names = list(FAMILIES)
    for k in range(count):
        yield empty_scene(names[k % len(names)], k // len(names))


def _table(rng: np.random.Generator, kind: str) -> _Scene:
    """Create a table with four legs in a room, and a random camera view of the table top."""
    size_m = rng.uniform(0.8, 1.8), rng.uniform(0.6, 1.0)
    thickness_m, height_m = rng.uniform(0.018, 0.045), rng.uniform(0.68, 0.78)
    round_m = min(size_m) / 2 if rng.uniform() < 0.15 else rng.choice([0.0005, 0.02, 0.06])
    top, _ = rounded_rectangle(size_m, round_m)
    leg, frame = rounded_rectangle((0.05, 0.05), 0.004, 3)[0], np.array(size_m) / 2 - 0.06 - 0.3 * round_m
    corners = [(x, y) for x in (-frame[0], frame[0]) for y in (-frame[1], frame[1])]
    legs = [prism(leg + corner, -height_m, -thickness_m) for corner in corners]
    leg_texture = surface("plain", rng)
    wall_y_m = size_m[1] / 2 + rng.uniform(0.02, 0.9)
    parts = [
        Part(prism(top, -thickness_m, 0.0), surface(kind, rng), *finish(rng)),
        Part(joined(legs), leg_texture),
        *room(rng, -height_m, wall_y_m),
    ]
    reach = 0.5 * np.array(size_m)
    look_at_m = float(rng.uniform(-0.8, 0.8) * reach[0]), float(rng.uniform(-0.7, 0.9) * reach[1]), 0.0
    yaw_deg = rng.uniform(-35, 35)
    view = View(look_at_m, rng.uniform(0.5, 1.3), rng.uniform(30, 70), yaw_deg, rng.normal(0, 1.5))
    return _Scene(tuple(parts), view, room_light(rng, look_at_m), rng.uniform(0.7, 1.15), rng.uniform(0.6, 2.0))


def _bin(rng: np.random.Generator, kind: str) -> _Scene:
    """Create a container that is open at the top, stands on a floor, and fills most of the image."""
    distance_m = rng.uniform(0.6, 1.3)
    length_m = distance_m * rng.uniform(0.75, 1.2)
    size_m = length_m, length_m * rng.uniform(0.55, 0.85)
    height_m = rng.uniform(0.1, min(0.5 * size_m[1], distance_m - 0.3))
    moulded = rng.uniform() < 0.65
    outside, inside, bottom = (_moulded if moulded else _boxed)(size_m, height_m, rng)
    walls = surface("plain" if moulded else str(rng.choice(["plain", "wood", "cloth"])), rng)
    lining = walls if rng.uniform() < 0.35 else surface(kind, rng)
    gloss = finish(rng)
    parts = (
        Part(joined([outside, inside]), walls, *gloss),
        Part(bottom, lining, *gloss),
        floor(surface(any_kind(rng), rng), 0.0),
    )
    look_at_m = float(rng.uniform(-0.25, 0.25) * size_m[0]), float(rng.uniform(-0.25, 0.25) * size_m[1]), 0.01
    view = View(look_at_m, distance_m, rng.uniform(52, 90), rng.uniform(-180, 180), rng.normal(0, 3))
    return _Scene(parts, view, room_light(rng, look_at_m), rng.uniform(0.6, 1.1), rng.uniform(0.8, 2.5))


def _moulded(size_m: tuple[float, float], height_m: float, rng: np.random.Generator) -> tuple[Mesh, Mesh, Mesh]:
    """Create a plastic container with slanted walls, round corners and a flange at the top. Return the outer surface,
    the inner surface and the floor of the container.
    """
    thick, lip_m, deep_m = 0.004, rng.uniform(0.012, 0.03), rng.uniform(0.01, 0.03)
    taper_m = height_m * np.tan(np.radians(rng.uniform(1.5, 5.0)))
    fillet_m = rng.uniform(0.004, 0.02)
    radius_m = taper_m + fillet_m + rng.uniform(0.005, 0.04)
    skirt = [
        line((thick - taper_m, 0.0), (thick, height_m - deep_m)),
        line((thick, height_m - deep_m), (lip_m, height_m - deep_m)),
        line((lip_m, height_m - deep_m), (lip_m, height_m)),
        line((lip_m, height_m), (0.0, height_m)),
    ]
    foot = arc((-taper_m - fillet_m, thick + fillet_m), fillet_m, 0, -90, 8)
    wall = [np.vstack([line((0.0, height_m)), foot])]
    outline, outward = rounded_rectangle(size_m, radius_m)
    floor = prism(outline - (taper_m + fillet_m) * outward, 0.0005, thick)
    return tub(size_m, radius_m, skirt), tub(size_m, radius_m, wall), floor


def _boxed(size_m: tuple[float, float], height_m: float, rng: np.random.Generator) -> tuple[Mesh, Mesh, Mesh]:
    """Create a carton or crate with vertical walls. Return the outer surface, the inner surface and the floor of the
    container.
    """
    thick, radius_m = rng.uniform(0.004, 0.018), 0.001
    skirt = [line((thick, 0.0), (thick, height_m)), line((thick, height_m), (0.0, height_m))]
    floor = prism(rounded_rectangle(size_m, radius_m, 2)[0], 0.0005, 0.005)
    return tub(size_m, radius_m, skirt), tub(size_m, radius_m, [line((0.0, height_m), (0.0, 0.005))]), floor


def _shelf(rng: np.random.Generator, kind: str) -> _Scene:
    """Create a shelf with 3 x 3 compartments in low light."""
    width_m, height_m, deep_m = rng.uniform(0.24, 0.42), rng.uniform(0.2, 0.34), rng.uniform(0.28, 0.48)
    board_m, divider_m, lip_m = rng.uniform(0.004, 0.022), rng.uniform(0.003, 0.015), rng.uniform(0.012, 0.05)
    boards, walls, back = (surface(k, rng) for k in (kind, shelf_kind(rng), shelf_kind(rng)))
    pitch_x, pitch_z, span_m = width_m + divider_m, height_m + board_m, 3 * (width_m + divider_m) + divider_m
    gloss = finish(rng)
    rear = block((0.0, deep_m + 0.005, 0.5 * height_m), (span_m, 0.01, 3 * pitch_z))
    uprights = [
        block(((k - 1.5) * pitch_x, deep_m / 2, 0.5 * height_m), (divider_m, deep_m - 0.01, 3 * pitch_z))
        for k in range(4)
    ]
    levels = [block((0.0, deep_m / 2, k * pitch_z - board_m / 2), (span_m, deep_m, board_m)) for k in range(-1, 3)]
    lips = [
        block((0.0, 0.002, k * pitch_z + (lip_m - board_m) / 2), (span_m, 0.004, lip_m + board_m)) for k in range(-1, 2)
    ]
    parts = [
        Part(rear, back, *gloss),
        Part(joined(uprights), walls, *gloss),
        Part(joined([*levels, *lips]), boards, *gloss),
        *room(rng, -0.9, deep_m + rng.uniform(0.1, 0.6)),
    ]
    look_at_m = float(rng.uniform(-0.2, 0.2) * width_m), float(rng.uniform(0.1, 0.6) * deep_m), 0.45 * height_m
    view = View(look_at_m, rng.uniform(0.55, 1.0), rng.uniform(-4, 32), rng.uniform(-20, 20), rng.normal(0, 1.5))
    exposure = rng.uniform(0.18, 0.7)
    return _Scene(tuple(parts), view, aisle_light(rng, look_at_m), exposure, rng.uniform(1.5, 3.5))


FAMILIES: Mapping[str, Callable[[np.random.Generator, str], _Scene]] = {"table": _table, "bin": _bin, "shelf": _shelf}
"""Functions that create a random scene, indexed by the kind of scene (family)."""
