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
    """Object model: a triangle mesh in its own frame.

    vertices_m: vertex positions (V, 3), metres. triangles: vertex indices (T, 3). colors: RGB colour of each vertex (V,
    3) or None.
    """

    name: str
    vertices_m: npt.NDArray[np.float64]
    triangles: npt.NDArray[np.int32]
    colors: npt.NDArray[np.uint8] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Instance:
    """Labelled object in a frame.

    label: value of the object's pixels in `Sample.labels`. model: name of the object's `Model`.

    pose: transform (4, 4) from the model's frame to the camera frame (X right, Y down, Z forward), metres.
    """

    label: int
    model: str
    pose: npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """Frame with ground truth.

    labels: label image (H, W), 0 = background, 1..N = objects. instances: objects with poses.
    """

    frame: Frame
    labels: npt.NDArray[np.integer[Any]]
    instances: tuple[Instance, ...] = ()
