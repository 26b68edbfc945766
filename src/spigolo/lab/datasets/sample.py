"""Content of a data set after reading: frames with labels and, if the set has them, poses and models.

Letters used in shapes: H, W = image, V = vertices, T = triangles.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Frame

__all__ = ["Instance", "Model", "Sample"]


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """Triangle mesh in its own axes. vertices_m (V, 3), triangles (T, 3) int32, colors (V, 3) uint8 RGB or None."""

    name: str
    vertices_m: npt.NDArray[np.float64]
    triangles: npt.NDArray[np.int32]
    colors: npt.NDArray[np.uint8] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Instance:
    """Object in a frame. label: its value in `Sample.labels`. model: name of its `Model`.

    pose (4, 4): from the model's axes to the camera's (X right, Y down, Z forward), metres.
    """

    label: int
    model: str
    pose: npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """Frame with ground truth. labels (H, W): 0 = background, 1..N = objects."""

    frame: Frame
    labels: npt.NDArray[np.integer[Any]]
    instances: tuple[Instance, ...] = ()
