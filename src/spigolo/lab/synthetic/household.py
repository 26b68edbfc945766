"""Household objects by name: what they look like, how they rest, and their meshes as models."""

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
    """A way to rest: how far the object's own z leans over after a turn about it. No turn is as good as any."""

    tilt_deg: float = 0.0
    roll_deg: float | None = None


@dataclass(frozen=True)
class Product:
    """An object that stands on z = 0 of its own axes, the ways it rests, the likeliest first."""

    name: str
    parts: tuple[Part, ...]
    rests: tuple[Rest, ...]

    @property
    def points_m(self) -> FloatArray:
        """Vertices (N, 3) of all its parts."""
        return np.concatenate([part.mesh.vertices_m for part in self.parts])

    def model(self) -> Model:
        """All parts as one mesh, coloured by the textures at its vertices."""
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
"""Makers and rests of each kind."""
FLAT_KINDS = frozenset({"cereal", "Milk", "box", "carton", "book"})
"""Those on which other things stay, some only when they lie."""


@cache
def household(name: str) -> Product:
    """The object of that name: one of `KINDS`, alone or with a number that tells it from others: soda_can_4.

    One name is one object, of its own size and print. Raises ConfigError for a kind that is not known.
    """
    kind = kind_of(name)
    if kind not in KINDS:
        raise ConfigError(f"unknown object {name!r}: expected one of {', '.join(KINDS)}, and a number, as soda_can_4")
    make, rests = KINDS[kind]
    return Product(name, make(np.random.default_rng(zlib.crc32(name.encode()))), rests)


def kind_of(name: str) -> str:
    """The kind that a name begins with: soda_can of soda_can_4."""
    return name if name in KINDS else name.rpartition("_")[0]


def _vertex_colours(part: Part) -> npt.NDArray[np.uint8]:
    height, width = part.texture.shape[:2]
    x, y = (part.mesh.uv * [width - 1, height - 1]).round().astype(np.intp).T
    return np.asarray(part.texture[np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)], np.uint8)
