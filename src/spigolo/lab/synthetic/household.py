"""Household objects for rendered scenes, with their meshes and stable poses."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt

from spigolo.errors import ConfigError
from spigolo.lab.datasets.sample import Model
from spigolo.lab.synthetic import packages, turned
from spigolo.lab.synthetic.meshes import joined
from spigolo.lab.synthetic.scene import Part

__all__ = ["FLAT_KINDS", "KINDS", "Product", "Rest", "household", "kind_of"]

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Rest:
    """Stable orientation of an object on a plane."""

    tilt_deg: float = 0.0
    """Angle between the object's z axis and the vertical, in degrees."""
    roll_deg: float | None = None
    """Rotation about the object's z axis before the tilt, in degrees. None means that the object is stable at any angle
    of this rotation.
    """


@dataclass(frozen=True)
class Product:
    """Household object with the meshes of its parts. In its own coordinate frame, the object stands on z = 0."""

    name: str
    parts: tuple[Part, ...]
    rests: tuple[Rest, ...]
    """Stable orientations of the object on a plane, most likely first."""

    @property
    def points_m(self) -> FloatArray:
        """Return the vertices (N, 3) of all parts, metres."""
        return np.concatenate([part.mesh.vertices_m for part in self.parts])

    def model(self) -> Model:
        """Merge all parts into one model. The vertex colours are taken from the textures."""
        mesh = joined([part.mesh for part in self.parts])
        colours = np.concatenate([_vertex_colours(part) for part in self.parts])
        return Model(self.name, mesh.vertices_m, mesh.triangles.astype(np.int32), colours)


Make = Callable[[np.random.Generator], tuple[Part, ...]]
_UPRIGHT, _ON_ITS_SIDE = Rest(), Rest(90.0)
_BOX = Rest(0.0, 0.0), Rest(90.0, 90.0), Rest(90.0, 0.0)

KINDS: Mapping[str, tuple[Make, tuple[Rest, ...]]] = {
    "soda_can": (turned.soda_can, (_UPRIGHT, _ON_ITS_SIDE)),
    "coffee_mug": (turned.coffee_mug, (_UPRIGHT,)),
    "cap": (packages.cap, (_UPRIGHT,)),
    "bowl": (turned.bowl, (_UPRIGHT, Rest(180.0))),
    "flashlight": (turned.flashlight, (Rest(turned.FLASHLIGHT_TILT_DEG),)),
    "cereal": (packages.cereal_box, _BOX),
    "Milk": (packages.milk, _BOX),
    "Coffee_Cup": (turned.coffee_cup, (_UPRIGHT, Rest(turned.CUP_TILT_DEG))),
    "Shampoo": (turned.shampoo, (Rest(0.0, 0.0), Rest(90.0, 90.0))),
    "Camera": (packages.camera, (Rest(0.0, 0.0), Rest(90.0, -90.0))),
    "box": (packages.small_box, _BOX),
    "carton": (packages.bottle_carton, _BOX),
    "book": (packages.book, (Rest(90.0, 90.0), Rest(0.0, 0.0))),
    "pouch": (packages.pouch, (Rest(90.0, 90.0),)),
    "glue": (turned.glue_bottle, (Rest(0.0, 0.0), Rest(90.0, 90.0))),
}
"""Function that creates the parts of an object, and stable orientations of the object, indexed by the kind of object.
"""
FLAT_KINDS = frozenset({"cereal", "Milk", "box", "carton", "book"})
"""Kinds of objects on which other objects can stand. Some kinds of objects must lie down to carry another object."""


@cache
def household(name: str) -> Product:
    """Create the object `name`. The name is a kind of object (a key of `KINDS`), optionally with a number: soda_can or
    soda_can_4.

    The size and the textures of the object depend only on its name. Raises ConfigError for an unknown kind of object.
    """
    kind = kind_of(name)
    if kind not in KINDS:
        raise ConfigError(
            f"unknown object {name!r}: expected one of {', '.join(KINDS)}, optionally with a number, such as soda_can_4"
        )
    make, rests = KINDS[kind]
    return Product(name, make(np.random.default_rng(zlib.crc32(name.encode()))), rests)


def kind_of(name: str) -> str:
    """Return the kind of object from its name, such as soda_can for soda_can_4."""
    return name if name in KINDS else name.rpartition("_")[0]


def _vertex_colours(part: Part) -> npt.NDArray[np.uint8]:
    height, width = part.texture.shape[:2]
    x, y = (part.mesh.uv * [width - 1, height - 1]).round().astype(np.intp).T
    return np.asarray(part.texture[np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)], np.uint8)
