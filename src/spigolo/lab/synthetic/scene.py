"""Scenes with textured meshes, and conversion of scenes to MuJoCo models.

World frame: x to the right, y away from the camera, z up. Lengths are in metres.
"""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any
from xml.sax.saxutils import quoteattr

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.errors import FileError
from spigolo.frames.frame import Camera
from spigolo.lab.synthetic.meshes import Mesh

__all__ = ["CAMERA", "SUPERSAMPLING", "Part", "SceneObject", "View", "compile_scene", "load_mujoco"]

FloatArray = npt.NDArray[np.float64]

# The principal point is the centre of the image. Coordinates refer to the centre of the first pixel.
CAMERA = Camera(fx=525.0, fy=525.0, cx=319.5, cy=239.5, width=640, height=480)
SUPERSAMPLING = 2


@dataclass(frozen=True)
class Part:
    """Part of an object: mesh, texture and material."""

    mesh: Mesh
    texture: npt.NDArray[np.uint8]
    specular: float = 0.15
    shininess: float = 0.3


@dataclass(frozen=True)
class SceneObject:
    """Object in a scene, with its pose and the meshes of its parts."""

    name: str
    position_m: tuple[float, float, float]
    yaw_deg: float
    """Third rotation of the object, about the vertical world axis, in degrees."""
    parts: tuple[Part, ...]
    tilt_deg: float = 0.0
    """Second rotation of the object, about the y axis, in degrees."""
    roll_deg: float = 0.0
    """First rotation of the object, about the z axis, in degrees."""

    @property
    def rotation(self) -> FloatArray:
        """Return the rotation matrix (3, 3) from the object's frame to the world frame."""
        return _about_z(self.yaw_deg) @ _about_y(self.tilt_deg) @ _about_z(self.roll_deg)


@dataclass(frozen=True)
class View:
    """Position and direction of the camera in a scene, with its intrinsics."""

    look_at_m: tuple[float, float, float]
    """Point (x, y, z) on the optical axis of the camera, in the world frame, metres."""
    distance_m: float
    """Distance of the camera from the point `look_at_m`, metres."""
    pitch_deg: float
    """Angle of the optical axis below the horizontal, in degrees."""
    yaw_deg: float = 0.0
    """Rotation of the camera about the vertical axis through `look_at_m`, anticlockwise seen from above, in degrees."""
    roll_deg: float = 0.0
    """Rotation of the camera about its optical axis, anticlockwise seen from behind the camera, in degrees."""
    camera: Camera = CAMERA
    """Camera intrinsics without distortion."""

    @property
    def position_m(self) -> FloatArray:
        """Return the position (3,) of the camera in the world frame, metres."""
        pitch, yaw = np.radians([self.pitch_deg, self.yaw_deg])
        back = np.array([np.sin(yaw) * np.cos(pitch), -np.cos(yaw) * np.cos(pitch), np.sin(pitch)])
        return np.array(self.look_at_m) + self.distance_m * back

    @property
    def axes(self) -> FloatArray:
        """Return two unit vectors (2, 3) in the world frame: to the right and to the top of the image."""
        pitch, yaw, roll = np.radians([self.pitch_deg, self.yaw_deg, self.roll_deg])
        right = np.array([np.cos(yaw), np.sin(yaw), 0.0])
        up = np.array([-np.sin(yaw) * np.sin(pitch), np.cos(yaw) * np.sin(pitch), np.cos(pitch)])
        return np.array([np.cos(roll) * right + np.sin(roll) * up, np.cos(roll) * up - np.sin(roll) * right])

    @property
    def world_to_camera(self) -> FloatArray:
        """Return the transform (4, 4) from the world frame to the camera frame (X right, Y down, Z forward), metres."""
        right, up = self.axes
        matrix = np.eye(4)
        matrix[:3, :3] = right, -up, np.cross(up, right)
        matrix[:3, 3] = -matrix[:3, :3] @ self.position_m
        return matrix


def load_mujoco() -> Any:
    """Import the module `mujoco`. On Linux without a display, EGL is used for rendering.

    Raises FileError if mujoco is not installed.
    """
    if sys.platform == "linux" and not os.environ.get("DISPLAY"):
        os.environ.setdefault("MUJOCO_GL", "egl")
    try:
        return importlib.import_module("mujoco")
    except ImportError:
        raise FileError(
            'expected mujoco to render scenes, but it is missing: pip install "spigolo[synthetic]"'
        ) from None


def compile_scene(title: str, bodies: Mapping[str, SceneObject], view: View, shadow_px: int = 4096) -> Any:
    """Compile a scene to a ``mujoco.MjModel``.

    Parameters
    ----------
    title
        Name of the model.
    bodies
        Objects, indexed by the name of their body in the model.
    view
        Position, direction and intrinsics of the camera in the model.
    shadow_px
        Width and height of the shadow map, pixels.

    """
    mujoco = load_mujoco()
    assets: dict[str, bytes] = {}
    asset_xml: list[str] = []
    body_xml: list[str] = []
    for body_name, thing in bodies.items():
        geoms = []
        for k, part in enumerate(thing.parts):
            name = f"{thing.name} {k}"
            asset_xml.append(_part_xml(name, part))
            assets[f"{name}.png"] = _linear_png(part.texture)
            geoms.append(f'<geom type="mesh" mesh="{name}" material="{name}" contype="0" conaffinity="0"/>')
        body_xml.append(f'<body name="{body_name}" {_pose(thing)}>{"".join(geoms)}</body>')
    return mujoco.MjModel.from_xml_string(_scene_xml(title, asset_xml, body_xml, view, shadow_px), assets)


def _scene_xml(title: str, asset_xml: list[str], body_xml: list[str], view: View, shadow_px: int) -> str:
    """Return the scene in MuJoCo's XML format: meshes, bodies, camera, light and render settings."""
    axes = " ".join(f"{value:.9f}" for value in view.axes.ravel())
    return f"""<mujoco model={quoteattr(title)}>
  <compiler angle="degree" eulerseq="zyz" balanceinertia="true"/>
  <statistic extent="1" center="0 0 0"/>
  <visual>
    <global offwidth="{SUPERSAMPLING * view.camera.width}" offheight="{SUPERSAMPLING * view.camera.height}"/>
    <quality shadowsize="{shadow_px}" offsamples="4"/>
    <map znear="0.2" zfar="8" shadowscale="1"/>
    <headlight ambient="0.05 0.05 0.055" diffuse="0 0 0" specular="0 0 0"/>
  </visual>
  <asset>{"".join(asset_xml)}</asset>
  <worldbody>
    <camera name="robot" pos="{_numbers(view.position_m)}" xyaxes="{axes}" {_intrinsics(view.camera)}/>
    <light name="lamp" pos="0 0 3" dir="0 0 -1" castshadow="true" cutoff="65" exponent="0"
           ambient="0 0 0" diffuse="1 1 1" specular="1 1 1"/>
    {"".join(body_xml)}
  </worldbody>
</mujoco>"""


def _part_xml(name: str, part: Part) -> str:
    """Return the mesh, texture and material of one part in MuJoCo's XML format."""
    mesh = part.mesh
    return (
        f"<mesh name={quoteattr(name)} vertex={quoteattr(_numbers(mesh.vertices_m))}"
        f" normal={quoteattr(_numbers(mesh.normals))} texcoord={quoteattr(_numbers(mesh.uv))}"
        f' face={quoteattr(" ".join(map(str, mesh.triangles.ravel())))} inertia="shell"/>'
        f'<texture name={quoteattr(name)} type="2d" file="{name}.png"/>'
        f'<material name={quoteattr(name)} texture={quoteattr(name)} texuniform="false"'
        f' specular="{part.specular}" shininess="{part.shininess}"/>'
    )


def _pose(thing: SceneObject) -> str:
    """Return the position and orientation of an object as XML attributes of a MuJoCo body."""
    return f'pos="{_numbers(thing.position_m)}" euler="{thing.yaw_deg} {thing.tilt_deg} {thing.roll_deg}"'


def _intrinsics(camera: Camera) -> str:
    """Return the camera intrinsics as XML attributes of a MuJoCo camera.

    MuJoCo measures the principal point from the image centre.
    """
    middle = (camera.width - 1) / 2, (camera.height - 1) / 2
    return (
        f'resolution="{camera.width} {camera.height}" sensorsize="{1e-5 * camera.width:.9g} {1e-5 * camera.height:.9g}"'
        f' focalpixel="{camera.fx} {camera.fy}" principalpixel="{middle[0] - camera.cx} {middle[1] - camera.cy}"'
    )


def _about_z(angle_deg: float) -> FloatArray:
    cos, sin = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def _about_y(angle_deg: float) -> FloatArray:
    cos, sin = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    return np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])


def _numbers(values: npt.ArrayLike) -> str:
    return " ".join(f"{value:.7g}" for value in np.ravel(np.asarray(values, dtype=np.float64)))


def _linear_png(texture: npt.NDArray[np.uint8]) -> bytes:
    """Convert an sRGB texture to linear RGB, and encode the texture as a PNG file."""
    linear = np.round(255 * _srgb_to_linear(np.arange(256) / 255)).astype(np.uint8)[texture]
    return bytes(cv2.imencode(".png", linear[..., ::-1])[1].tobytes())


def _srgb_to_linear(value: FloatArray) -> FloatArray:
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
