"""Bundled demo scene: household objects on a table, modelled in code and rendered with MuJoCo.

World frame: x to the right, y away from the robot, z up. The table top is at z = 0. Lengths are in metres.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.lab.synthetic import textures
from spigolo.lab.synthetic.meshes import arc, box, faceted, gable_roof, lathe, line, tube
from spigolo.lab.synthetic.rendering import Lighting, developed, render_depth, render_geoms, render_light
from spigolo.lab.synthetic.scene import CAMERA, Part, SceneObject, View, compile_scene
from spigolo.lab.synthetic.structured_light import simulate_structured_light

__all__ = [
    "CAMERA",
    "OBJECT_NAMES",
    "RenderedScene",
    "load_model",
    "make_demo_frame",
    "render_colour",
    "render_demo_scene",
    "render_geometry",
]

_VIEW = View(look_at_m=(-0.005, 0.03, 0.05), distance_m=0.81, pitch_deg=40.0)
_LIGHTING = Lighting(
    aim_m=_VIEW.look_at_m,
    lamp_m=(-0.9, -1.15, 2.0),
    lamp_radius_m=0.45,
    lamp_rgb=0.85 * np.array([1.0, 0.95, 0.87]),
    sky_rgb=1.05 * np.array([0.93, 0.98, 1.08]),
)
_COLOUR_NOISE_LEVELS = 0.4  # standard deviation in grey levels, 0..255. More noise makes the PNG file larger


@dataclass(frozen=True)
class RenderedScene:
    """Rendered images of a scene."""

    rgb: npt.NDArray[np.uint8]
    """Colour image (H, W, 3), 8-bit RGB."""
    depth_m: npt.NDArray[np.float32]
    """Depth map (H, W), metres."""
    label: npt.NDArray[np.uint8]
    """Label image (H, W), 0 = background, 1..N = objects."""


def scene_objects() -> list[SceneObject]:
    """Create the objects of the demo scene, in the order of their labels 1..N."""
    pair_yaw_deg = -24.0
    tea_m, plain_m = (0.125, 0.07, 0.17), (0.09, 0.10, 0.10)
    tea_at = np.array([0.25, 0.19])
    # The plain box touches the right side of the tea box. The front of the plain box is slightly nearer to the camera.
    yaw = np.radians(pair_yaw_deg)
    along, back = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
    plain_at = tea_at + (tea_m[0] + plain_m[0]) / 2 * along - 0.030 * back
    return [
        SceneObject("cereal box", (-0.265, 0.19, 0), 17, (Part(box((0.17, 0.06, 0.245)), textures.cereal_box()),)),
        SceneObject("milk carton", (-0.035, 0.23, 0), 38, _milk_carton_parts()),
        SceneObject("tea box", (tea_at[0], tea_at[1], 0), pair_yaw_deg, (Part(box(tea_m), textures.tea_box()),)),
        SceneObject(
            "plain box",
            (plain_at[0], plain_at[1], 0),
            pair_yaw_deg,
            (Part(box(plain_m), textures.plain_card((150, 116, 176)), 0.05, 0.1),),
        ),
        SceneObject("bowl", (-0.21, -0.055, 0), 0, _bowl_parts()),
        SceneObject("mug", (0.15, -0.02, 0), -32, _mug_parts()),
        SceneObject("can", (0.01, 0.115, 0), 178, _can_parts()),
        SceneObject("ball", (0.30, -0.10, 0.042), -150, _ball_parts(), tilt_deg=52),
        SceneObject("flashlight", (-0.02, -0.19, 0.0175), 24, _flashlight_parts(), tilt_deg=90),
    ]


OBJECT_NAMES: tuple[str, ...] = (
    "cereal box",
    "milk carton",
    "tea box",
    "plain box",
    "bowl",
    "mug",
    "can",
    "ball",
    "flashlight",
)


def _milk_carton_parts() -> tuple[Part, ...]:
    width_m, wall_m = 0.072, 0.15
    return (
        Part(box((width_m, width_m, wall_m)), textures.milk_carton(), 0.2, 0.4),
        Part(gable_roof(width_m, width_m, wall_m, 0.032, 0.016), textures.milk_roof(), 0.2, 0.4),
    )


def _bowl_parts() -> tuple[Part, ...]:
    """Create a hollow bowl, 17 cm in diameter, with a foot ring and a 4 mm thick wall."""
    t = np.linspace(0.0, 1.0, 40)
    outside = np.column_stack([0.036 + 0.049 * np.sin(t * np.pi / 2) ** 0.9, 0.008 + 0.060 * t**1.7])
    inside = np.column_stack([0.081 * np.sin(t * np.pi / 2) ** 0.85, 0.012 + 0.056 * t**2.1])[::-1]
    rim = arc((0.083, 0.068), 0.002, 0, 180, 9)
    foot = line((0.0, 0.0), (0.036, 0.0)), line((0.036, 0.0), (0.036, 0.008))
    glaze = textures.glazed((44, 150, 152), (238, 228, 206), 0.09)
    return (Part(lathe([*foot, outside, rim, inside]), glaze, 0.5, 0.6),)


def _mug_parts() -> tuple[Part, ...]:
    """Create a hollow mug with a handle, 8 cm in diameter and 9 cm high."""
    foot_corner = arc((0.034, 0.006), 0.006, -90, 0, 8)
    inner_corner = arc((0.030, 0.012), 0.006, 0, -90, 8)
    outside = [line((0.0, 0.0), (0.034, 0.0)), np.vstack([foot_corner, line((0.040, 0.088))])]
    inside = [
        arc((0.038, 0.088), 0.002, 0, 180, 9),
        np.vstack([line((0.036, 0.088)), inner_corner]),
        line((0.030, 0.006), (0.0, 0.006)),
    ]
    cream = textures.plain_card((242, 232, 214))
    turn = np.linspace(-np.pi / 2, np.pi / 2, 28)
    handle = np.column_stack([0.0385 + 0.027 * np.cos(turn), 0 * turn, 0.048 + 0.025 * np.sin(turn)])
    return (
        Part(lathe(outside), textures.mug_glaze(), 0.4, 0.6),
        Part(lathe(inside), cream, 0.4, 0.6),
        Part(tube(handle, 0.0052), cream, 0.4, 0.6),
    )


def _can_parts() -> tuple[Part, ...]:
    """Create a tin can with a printed label, and a metal lid with a raised rim."""
    side = [
        line((0, 0.004), (0.0335, 0.004)),
        line((0.0335, 0.004), (0.0335, 0.106)),
        line((0.0335, 0.106), (0, 0.106)),
    ]
    metal = textures.plain_card((186, 188, 192))
    rim = np.vstack([arc((0.0335, 0.1085), 0.0012, 0, 90, 5), arc((0.0320, 0.1085), 0.0012, 90, 180, 5)])
    step = arc((0.022, 0.1065), 0.0008, 0, 180, 7)
    lid = [line((0, 0.105), (0.0347, 0.105)), line((0.0347, 0.105), (0.0347, 0.1085)), rim]
    lid += [line((0.0308, 0.1085), (0.0308, 0.1065)), line((0.0308, 0.1065), (0.0228, 0.1065)), step]
    lid += [line((0.0212, 0.1065), (0, 0.1065))]
    foot = [line((0, 0), (0.0345, 0)), line((0.0345, 0), (0.0345, 0.005)), line((0.0345, 0.005), (0, 0.005))]
    return (
        Part(lathe(side), textures.can_label(), 0.25, 0.5),
        Part(lathe(lid), metal, 0.7, 0.6),
        Part(lathe(foot), metal, 0.7, 0.6),
    )


def _ball_parts() -> tuple[Part, ...]:
    """Create a ball with a diameter of 84 mm, centred at the origin of the object's frame."""
    cap_from_deg = 74
    wedges = lathe([arc((0, 0), 0.042, -cap_from_deg, cap_from_deg, 60)])
    blue = textures.plain_card((38, 92, 170))
    caps = [lathe([arc((0, 0), 0.0421, -90, -cap_from_deg, 12)]), lathe([arc((0, 0), 0.0421, cap_from_deg, 90, 12)])]
    return (Part(wedges, textures.beach_ball(), 0.06, 0.4), *(Part(cap, blue, 0.06, 0.4) for cap in caps))


def _flashlight_parts() -> tuple[Part, ...]:
    """Create a cylindrical flashlight, 15 cm long. The axis of the flashlight is the z axis, and its rear end is at z =
    0.
    """
    profile = [
        line((0.0, 0.0), (0.0155, 0.0)),
        arc((0.0155, 0.002), 0.002, -90, 0, 5),
        line((0.0175, 0.002), (0.0175, 0.148)),
        arc((0.0155, 0.148), 0.002, 0, 90, 5),
        line((0.0155, 0.150), (0.0, 0.150)),
    ]
    return (Part(lathe(profile), textures.flashlight_bands(), 0.3, 0.5),)


def _surroundings() -> list[SceneObject]:
    """Create the table, floor and wall, which have label 0 (background)."""
    rng = np.random.default_rng(20)
    table = np.array([[-1.0, -0.62], [1.0, -0.62], [1.0, 0.70], [-1.0, 0.70]])
    top = [(*corner, 0.0) for corner in table]
    low = [(*corner, -0.035) for corner in table]
    whole, edge = (0.0, 0.0, 1.0, 1.0), (0.0, 0.0, 1.0, 0.03)
    sides = [([low[k], low[(k + 1) % 4], top[(k + 1) % 4], top[k]], edge) for k in range(4)]
    table_mesh = faceted([(top, whole), (low[::-1], whole), *sides])
    floor = faceted([([(-4, -2, -0.74), (4, -2, -0.74), (4, 2.0, -0.74), (-4, 2.0, -0.74)], whole)])
    wall = faceted([([(-4, 2.0, -0.74), (4, 2.0, -0.74), (4, 2.0, 2.0), (-4, 2.0, 2.0)], whole)])
    return [
        SceneObject("table", (0, 0, 0), 0, (Part(table_mesh, textures.wood(rng), 0.12, 0.2),)),
        SceneObject("floor", (0, 0, 0), 0, (Part(floor, textures.plaster((122, 118, 116), rng), 0.0, 0.0),)),
        SceneObject("wall", (0, 0, 0), 0, (Part(wall, textures.plaster((178, 190, 188), rng), 0.0, 0.0),)),
    ]


def load_model() -> Any:
    """Compile the demo scene to a ``mujoco.MjModel``. The body ``object k`` of the model is the object with label k."""
    bodies = {thing.name: thing for thing in _surroundings()}
    bodies |= {f"object {label}": thing for label, thing in enumerate(scene_objects(), start=1)}
    return compile_scene("spigolo demo scene", bodies, _VIEW)


def make_demo_frame(seed: int = 0) -> RenderedScene:
    """Render the demo scene with simulated noise of the colour camera and the depth camera."""
    ideal = render_demo_scene()
    rng = np.random.default_rng(seed)
    depth_m = simulate_structured_light(ideal.depth_m, ideal.rgb, CAMERA.fx, rng)
    noisy = ideal.rgb + rng.normal(0.0, _COLOUR_NOISE_LEVELS, ideal.rgb.shape)
    return RenderedScene(np.clip(np.round(noisy), 0, 255).astype(np.uint8), depth_m, ideal.label)


def render_demo_scene() -> RenderedScene:
    """Render colour image, noise-free depth map and labels of the demo scene."""
    model = load_model()
    depth_m, label = render_geometry(model)
    return RenderedScene(render_colour(model), depth_m, label)


def render_geometry(model: Any) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.uint8]]:
    """Render the noise-free depth map (H, W) in metres and the label image (H, W) of a model from ``load_model()``."""
    import mujoco

    label_of_geom = np.zeros(model.ngeom + 1, dtype=np.uint8)  # the last entry is for geom -1, the background
    for k in range(1, len(OBJECT_NAMES) + 1):
        body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, f"object {k}")
        label_of_geom[:-1][model.geom_bodyid == body] = k
    return render_depth(model), label_of_geom[render_geoms(model)]


def render_colour(model: Any) -> npt.NDArray[np.uint8]:
    """Render the anti-aliased colour image (H, W, 3) of a model from ``load_model()``."""
    return developed(render_light(model, _LIGHTING))
