"""Frames with labels, object poses and object models, as read from a data set.

Letters in array shapes: H, W = image height and width, V = number of vertices, T = number of triangles.
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
    """Object model: a triangle mesh in its own frame."""

    name: str
    vertices_m: npt.NDArray[np.float64]
    """Vertex positions (V, 3), metres."""
    triangles: npt.NDArray[np.int32]
    """Indices of the vertices of each triangle (T, 3)."""
    colors: npt.NDArray[np.uint8] | None = None
    """RGB colour of each vertex (V, 3), or None for a mesh without colours."""


@dataclass(frozen=True, slots=True, eq=False)
class Instance:
    """Labelled object in a frame."""

    label: int
    """Value of the object's pixels in `Sample.labels`."""
    model: str
    """Name of the object's `Model`."""
    pose: npt.NDArray[np.float64]
    """Transform (4, 4) from the model's frame to the camera frame (X right, Y down, Z forward), metres."""


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """Frame with ground truth."""

    frame: Frame
    labels: npt.NDArray[np.integer[Any]]
    """Label image (H, W), 0 = background, 1..N = objects."""
    instances: tuple[Instance, ...] = ()
    """Labelled objects with their poses, empty if the data set has no poses."""
