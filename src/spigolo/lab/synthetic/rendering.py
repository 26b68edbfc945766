"""Rendering of a scene with MuJoCo: noise-free depth maps, and colour images with soft shadows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.lab.synthetic.scene import SUPERSAMPLING, load_mujoco

__all__ = [
    "Lighting",
    "Rendering",
    "developed",
    "render_all",
    "render_depth",
    "render_geoms",
    "render_light",
    "render_quickly",
]

FloatArray = npt.NDArray[np.float64]
FloatMap = npt.NDArray[np.float32]

_LIGHT_DISTANCE_M = 1.9


@dataclass(frozen=True)
class Lighting:
    """Lighting of a scene: a disc-shaped lamp, and diffuse light from a hemisphere (sky). Both lights are directed at
    the point `aim_m`.
    """

    aim_m: tuple[float, float, float]
    """Point (x, y, z) at which all lights are directed, metres."""
    lamp_m: tuple[float, float, float]
    """Position (x, y, z) of the lamp, metres."""
    lamp_radius_m: float
    """Radius of the lamp, metres. A larger lamp gives softer shadows."""
    lamp_rgb: FloatArray
    """Brightness of the lamp, linear RGB."""
    sky_rgb: FloatArray
    """Brightness of the diffuse light, linear RGB."""
    sky_tilt_deg: float = 0.0
    """Angle between the vertical and the axis of the hemisphere of diffuse light, towards -y, in degrees."""
    lamp_samples: int = 24
    """Number of point lights that approximate the lamp."""
    sky_samples: int = 40
    """Number of point lights that approximate the diffuse light."""

    def points(self) -> Iterator[tuple[FloatArray, FloatArray]]:
        """Yield the position (metres) and intensity (linear RGB) of each point light. Together, the point lights
        approximate the lamp or the sky.
        """
        golden = np.pi * (3 - np.sqrt(5))
        for k in range(self.lamp_samples):
            radius_m, turn = self.lamp_radius_m * np.sqrt((k + 0.5) / self.lamp_samples), golden * k
            offset = radius_m * np.array([np.cos(turn), np.sin(turn), 0.0])
            yield np.array(self.lamp_m) + offset, self.lamp_rgb / self.lamp_samples
        cos, sin = np.cos(np.radians(self.sky_tilt_deg)), np.sin(np.radians(self.sky_tilt_deg))
        for k in range(self.sky_samples):
            height = 0.25 + 0.75 * (k + 0.5) / self.sky_samples
            x, y = np.sqrt(1 - height**2) * np.array([np.cos(golden * k), np.sin(golden * k)])
            direction = np.array([x, cos * y - sin * height, sin * y + cos * height])
            yield np.array(self.aim_m) + _LIGHT_DISTANCE_M * direction, self.sky_rgb / self.sky_samples


def render_depth(model: Any) -> FloatMap:
    """Render the noise-free depth map (H, W) in metres. Pixels without a surface have a depth of about 8 m."""
    with _renderer(model, samples=0) as renderer:  # without anti-aliasing, which would average depth values
        return _depth(renderer, _at_rest(model))


def render_geoms(model: Any) -> npt.NDArray[np.int32]:
    """Render the number of the MuJoCo geom (part of an object) at each pixel (H, W), -1 for the background."""
    with _renderer(model, samples=0) as renderer:
        return _geoms(renderer, _at_rest(model))


def render_light(model: Any, lighting: Lighting) -> FloatArray:
    """Render the anti-aliased colour image (H, W, 3) in linear RGB, with supersampling.

    Shadows in a single rendering are sharp. Soft shadows result from the average of many renderings with point lights
    at different positions.
    """
    height, width = _size(model)
    shape = (height, SUPERSAMPLING, width, SUPERSAMPLING, 3)
    light = np.zeros((height, width, 3))
    with _renderer(model, samples=4, supersampling=SUPERSAMPLING) as renderer:
        for colour in _lit(renderer, model, lighting):
            light += colour * (renderer.render() / 255.0).reshape(shape).mean(axis=(1, 3))
    return light


@dataclass(frozen=True)
class Rendering:
    """Rendered images of a scene, without noise."""

    light: FloatArray
    """Colour image (H, W, 3), linear RGB."""
    lamp_light: FloatArray
    """Colour image (H, W, 3) of the scene in the lighting `lamp`, which is an argument of `render_all`. Linear RGB."""
    depth_m: FloatMap
    """Depth map (H, W), metres."""
    geoms: npt.NDArray[np.int32]
    """Number of the MuJoCo geom (part of an object) at each pixel (H, W), -1 = background."""


def render_all(model: Any, lighting: Lighting, lamp: Lighting) -> Rendering:
    """Render the depth map, the geom number of each pixel, and two colour images, one for each lighting.

    The images are rendered without supersampling, as by the function `render_quickly`.
    """
    with _renderer(model, samples=0) as renderer:
        light, lamp_light = (_quick_light(renderer, model, one) for one in (lighting, lamp))
        depth_m = _depth(renderer, _at_rest(model))
        renderer.disable_depth_rendering()
        return Rendering(light, lamp_light, depth_m, _geoms(renderer, _at_rest(model)))


def render_quickly(model: Any, lighting: Lighting) -> tuple[FloatArray, FloatMap]:
    """Render the colour image and the depth map ten times faster than `render_light` and `render_depth`, without
    supersampling.

    The colour image is the sum of one image per point light. For anti-aliasing, the image of each point light is
    shifted by a different fraction of a pixel.
    """
    with _renderer(model, samples=0) as renderer:
        return _quick_light(renderer, model, lighting), _depth(renderer, _at_rest(model))


def _quick_light(renderer: Any, model: Any, lighting: Lighting) -> FloatArray:
    light = np.zeros((*_size(model), 3))
    for k, colour in enumerate(_lit(renderer, model, lighting), start=1):
        _move_image(renderer, *(np.array([0.7549, 0.5698]) * k % 1 - 0.5))  # shifts that cover the pixel evenly
        light += colour / 255.0 * renderer.render()
    return light


def _renderer(model: Any, samples: int, supersampling: int = 1) -> Any:
    mujoco = load_mujoco()
    model.vis.quality.offsamples = samples
    height, width = _size(model)
    return mujoco.Renderer(model, supersampling * height, supersampling * width)


def _size(model: Any) -> tuple[int, int]:
    """Return the height and width of the camera image in pixels."""
    width, height = model.cam_resolution[0]
    return int(height), int(width)


def _at_rest(model: Any) -> Any:
    mujoco = load_mujoco()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return data


def _depth(renderer: Any, data: Any) -> FloatMap:
    renderer.update_scene(data, camera="robot")
    renderer.enable_depth_rendering()
    return np.array(renderer.render(), dtype=np.float32)


def _geoms(renderer: Any, data: Any) -> npt.NDArray[np.int32]:
    renderer.update_scene(data, camera="robot")
    renderer.enable_segmentation_rendering()
    return np.array(renderer.render(), np.int32)[..., 0]


def _lit(renderer: Any, model: Any, lighting: Lighting) -> Iterator[FloatArray]:
    """Light the scene with one point light after the other, and yield the brightness of each point light."""
    aim_m = np.array(lighting.aim_m)
    for position_m, colour in lighting.points():
        model.light_pos[0] = position_m
        model.light_dir[0] = (aim_m - position_m) / np.linalg.norm(aim_m - position_m)
        renderer.update_scene(_at_rest(model), camera="robot")
        yield colour


def _move_image(renderer: Any, right_px: float, up_px: float) -> None:
    """Shift the next rendered image by a fraction of a pixel."""
    for camera in renderer.scene.camera:
        camera.frustum_center += right_px * 2 * camera.frustum_width / renderer.width
        up_m = up_px * (camera.frustum_top - camera.frustum_bottom) / renderer.height
        camera.frustum_top += up_m
        camera.frustum_bottom += up_m


def developed(light: FloatArray) -> npt.NDArray[np.uint8]:
    """Convert linear RGB to 8-bit sRGB. Values above 0.7 are compressed, so that highlights are not clipped."""
    knee = 0.7
    bright = knee + (1 - knee) * np.tanh((light - knee) / (1 - knee))
    toned = np.where(light > knee, bright, light)
    return np.round(255 * np.clip(_linear_to_srgb(toned), 0, 1)).astype(np.uint8)


def _linear_to_srgb(value: FloatArray) -> FloatArray:
    return np.where(value <= 0.0031308, 12.92 * value, 1.055 * np.maximum(value, 1e-9) ** (1 / 2.4) - 0.055)
