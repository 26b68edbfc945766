"""Simulation of an RGB-D camera that records a scene, with exact ground truth.

World frame: x to the right, y away from the camera, z up. Objects stand on z = 0. Lengths are in metres.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Frame
from spigolo.lab.datasets.entry import MILLIMETRES
from spigolo.lab.datasets.sample import Instance, Sample
from spigolo.lab.synthetic.rendering import Lighting, developed, render_all
from spigolo.lab.synthetic.scene import Part, SceneObject, View, compile_scene
from spigolo.lab.synthetic.structured_light import StructuredLight, simulate_structured_light

__all__ = ["Recording", "Stage", "record"]

FloatArray = npt.NDArray[np.float64]

LEAST_VISIBLE_PX = 150
"""Minimum number of visible pixels of a labelled object.

Objects with fewer than `LEAST_VISIBLE_PX` visible pixels are labelled as background.
"""
_SHADOW_PX = 1024
_WINDOW_PX = 2.0
_VEIL, _HALO, _DARKER_CORNERS, _COLOUR_PX = 0.05, 0.06, 0.3, 1.6


@dataclass(frozen=True)
class Stage:
    """Scene to record: objects, background, lighting, and settings of the simulated camera."""

    objects: tuple[SceneObject, ...]
    """Objects that are labelled 1..N."""
    surroundings: tuple[Part, ...]
    """Meshes of the background, such as tables and walls, which are not labelled."""
    view: View
    lighting: Lighting
    sensor: StructuredLight
    """Model of the depth camera and its noise."""
    bystanders: tuple[SceneObject, ...] = ()
    """Additional objects that are not labelled."""
    grey: float = 110.0
    """Median grey level of the colour image, 0..255. The exposure of the simulated camera is adjusted so that the image
    has about this median grey level.
    """
    noise_levels: float = 1.5
    """Standard deviation of the colour noise, in grey levels 0..255."""
    blur_px: float = 0.6
    """Standard deviation of the blur of the colour image, in pixels."""
    sharpening: float = 0.5
    """Strength of the image sharpening, 0 = no sharpening."""
    contrast: float = 1.2
    """Exponent applied to the linear brightness. Larger values increase the contrast."""
    saturation: float = 0.8
    """Factor by which the colour saturation is multiplied, 1 = unchanged."""


@dataclass(frozen=True)
class Recording:
    """Simulated frame with its ground truth (`sample`), and the noise-free depth map (`ideal_m`, (H, W), in metres)."""

    sample: Sample
    ideal_m: npt.NDArray[np.float32]


def record(stage: Stage, name: str, rng: np.random.Generator) -> Recording:
    """Render a scene, simulate the noise of colour camera and depth camera, and return the frame with its ground truth.

    Depth is rounded to whole millimetres.
    """
    bodies = {"surroundings": SceneObject("surroundings", (0.0, 0.0, 0.0), 0.0, stage.surroundings)}
    bodies |= {f"bystander {k}": _renamed(thing, f"bystander {k}") for k, thing in enumerate(stage.bystanders)}
    bodies |= {f"object {k}": _renamed(thing, f"object {k}") for k, thing in enumerate(stage.objects)}
    model = compile_scene(name, bodies, stage.view, _SHADOW_PX)
    drawn = render_all(model, stage.lighting, _projector(stage.view))
    # The depth camera has its own light. The image is blurred, because depth is measured in windows.
    seen = cv2.GaussianBlur(developed(drawn.lamp_light), (0, 0), _WINDOW_PX)
    depth_m = simulate_structured_light(
        drawn.depth_m, np.asarray(seen, np.uint8), stage.view.camera.fx, rng, stage.sensor, _gloss(model, drawn.geoms)
    )
    stored = np.round(depth_m / MILLIMETRES).astype(np.uint16)
    colour = _photographed(drawn.light, stage, rng)
    frame = Frame(colour, stored, stage.view.camera, name=name, depth_scale=MILLIMETRES)
    sample = _labelled(frame, _objects(model, drawn.geoms, len(stage.objects)), stage)
    return Recording(sample, drawn.depth_m)


def _projector(view: View) -> Lighting:
    """Create the lighting by the projector of the depth camera: a point light at the position of the camera."""
    return Lighting(view.look_at_m, tuple(view.position_m), 0.0, np.ones(3), np.zeros(3), lamp_samples=1, sky_samples=0)


def _labelled(frame: Frame, indices: npt.NDArray[np.int32], stage: Stage) -> Sample:
    """Number the visible objects from 1, and return the frame with labels and poses.

    indices: index of the object at each pixel (H, W).
    """
    labels = np.zeros(indices.shape, np.int32)
    instances: list[Instance] = []
    for k, thing in enumerate(stage.objects):
        seen = indices == k
        if seen.sum() >= LEAST_VISIBLE_PX:
            labels[seen] = len(instances) + 1
            instances.append(Instance(len(instances) + 1, thing.name, _pose(thing, stage.view)))
    return Sample(frame, labels, tuple(instances))


def _pose(thing: SceneObject, view: View) -> FloatArray:
    to_world = np.eye(4)
    to_world[:3, :3], to_world[:3, 3] = thing.rotation, thing.position_m
    return view.world_to_camera @ to_world


def _objects(model: Any, geoms: npt.NDArray[np.int32], count: int) -> npt.NDArray[np.int32]:
    """Return the index of the object at each pixel (H, W), -1 for pixels without an object."""
    of_geom = np.full(model.ngeom + 1, -1, np.int32)  # the last entry is for geom -1, the background
    for k in range(count):
        of_geom[:-1][model.geom_bodyid == model.body(f"object {k}").id] = k
    return of_geom[geoms]


def _gloss(model: Any, geoms: npt.NDArray[np.int32]) -> FloatArray:
    """Return the gloss of the surface at each pixel (H, W): 0 = matt, 1 = mirror.

    Surfaces with a specular value of at most 0.4 count as matt.
    """
    specular = np.append(model.mat_specular[model.geom_matid], 0.0)
    return np.clip((specular[geoms] - 0.4) / 0.6, 0.0, 1.0)


def _photographed(light: FloatArray, stage: Stage, rng: np.random.Generator) -> npt.NDArray[np.uint8]:
    """Simulate a colour camera: stray light of the lens, exposure, blur, sharpening and noise.

    light: rendered image (H, W, 3), linear RGB.
    """
    toned = (light / max(float(np.median(light)), 1e-4)) ** stage.contrast
    soft = cv2.GaussianBlur(developed((stage.grey / 255) ** 2.2 * _through_lens(toned)), (0, 0), stage.blur_px)
    luma, red, blue = cv2.split(cv2.cvtColor(soft.astype(np.float32) / 255, cv2.COLOR_RGB2YCrCb))
    crisp = luma + stage.sharpening * (luma - cv2.GaussianBlur(luma, (0, 0), 1.5))
    noise = stage.noise_levels / 255
    noisy = [crisp + noise * _grain(luma.shape, 0.6, rng)]
    noisy += [
        0.5 + stage.saturation * (cv2.GaussianBlur(colour, (0, 0), _COLOUR_PX) - 0.5)
        + noise * _grain(luma.shape, _COLOUR_PX, rng)
        for colour in (red, blue)
    ]  # fmt: skip
    picture = 255 * cv2.cvtColor(np.stack(noisy, axis=-1), cv2.COLOR_YCrCb2RGB)
    return np.asarray(np.clip(np.round(picture), 0, 255), np.uint8)


def _through_lens(light: FloatArray) -> FloatArray:
    """Simulate a lens: darken the image corners, and add stray light. light: image (H, W, 3), linear RGB."""
    height, width = light.shape[:2]
    y, x = np.mgrid[-1 : 1 : height * 1j, -1 : 1 : width * 1j]
    bright = np.minimum(light, 4.0).astype(np.float32)
    veil = _HALO * cv2.GaussianBlur(bright, (0, 0), 12.0) + _VEIL * bright.mean(axis=(0, 1))
    return np.asarray((1 - _DARKER_CORNERS * (x**2 + y**2)[..., None] / 2) * ((1 - _HALO - _VEIL) * light + veil))


def _grain(shape: tuple[int, ...], radius_px: float, rng: np.random.Generator) -> npt.NDArray[np.float32]:
    """Return spatially correlated noise (H, W) with unit variance.

    radius_px: standard deviation of the Gaussian filter that smooths the noise, in pixels.
    """
    grain = cv2.GaussianBlur(np.asarray(rng.standard_normal(shape), np.float32), (0, 0), radius_px)
    return np.asarray(grain / grain.std(), np.float32)


def _renamed(thing: SceneObject, name: str) -> SceneObject:
    """Return a copy of the object with another name. MuJoCo requires a unique name for each object."""
    return SceneObject(name, thing.position_m, thing.yaw_deg, thing.parts, thing.tilt_deg, thing.roll_deg)
