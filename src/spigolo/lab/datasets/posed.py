"""Frames of data sets that have object poses and models but no masks. The masks are rendered from models and poses when
they are needed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from spigolo.frames.files import read_depth
from spigolo.frames.frame import depth_in_metres
from spigolo.lab.datasets.entry import ImageEntry, Truth
from spigolo.lab.datasets.meshes import read_model
from spigolo.lab.datasets.sample import Instance
from spigolo.lab.datasets.visibility import visible_labels

Pose = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class PosedImage(ImageEntry):
    """Frame with the poses of one or more instances of the same object."""

    object_name: str
    poses: Path | None
    """File with the object poses (4, 4), or None if the frame has no poses."""
    model: Path | None
    """File with the triangle mesh of the object, or None if the frame has no poses."""
    read_poses: Callable[[Path], Sequence[Pose]]
    """Function that reads the poses (4, 4) from the file `poses`. The function `read_poses` must be picklable."""

    @property
    def files(self) -> tuple[Path, ...]:
        """Paths of the colour image and the depth image, and of the poses and the model if they exist."""
        return tuple(path for path in (self.color, self.depth, self.poses, self.model) if path is not None)

    def read_truth(self) -> Truth | None:
        """Return the visible mask of each instance, rendered from its model and pose.

        Return None if the frame has no poses or no camera. Raises FileError if a file cannot be read.
        """
        if self.model is None or self.camera is None:
            return None
        instances = self.read_instances()
        depth, _, _ = depth_in_metres(read_depth(self.depth), self.depth_scale)
        labels = visible_labels(instances, [read_model(self.model)] * len(instances), depth, self.camera)
        return Truth(labels, np.zeros(labels.shape, np.bool_), {i.label: self.object_name for i in instances})

    def read_instances(self) -> tuple[Instance, ...]:
        """Read the instances of the object with their poses. Raises FileError if a file cannot be read."""
        poses = () if self.poses is None else self.read_poses(self.poses)
        return tuple(Instance(label, self.object_name, pose) for label, pose in enumerate(poses, start=1))
