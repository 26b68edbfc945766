"""Frames of data sets with poses and models but without masks. Masks are rendered on request."""

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
    """Frame with a file of poses (4, 4) of one object. Both files are None without poses.

    read_poses: module-level function that reads the file of poses.
    """

    object_name: str
    poses: Path | None
    model: Path | None
    read_poses: Callable[[Path], Sequence[Pose]]

    @property
    def files(self) -> tuple[Path, ...]:
        """Paths of colour and depth, and of poses and model if there are any."""
        return tuple(path for path in (self.color, self.depth, self.poses, self.model) if path is not None)

    def read_truth(self) -> Truth | None:
        """Return the visible masks of the objects. None without poses or camera. Raises FileError."""
        if self.model is None or self.camera is None:
            return None
        instances = self.read_instances()
        depth, _, _ = depth_in_metres(read_depth(self.depth), self.depth_scale)
        labels = visible_labels(instances, [read_model(self.model)] * len(instances), depth, self.camera)
        return Truth(labels, np.zeros(labels.shape, np.bool_), {i.label: self.object_name for i in instances})

    def read_instances(self) -> tuple[Instance, ...]:
        """Return the objects with their poses. Raises FileError."""
        poses = () if self.poses is None else self.read_poses(self.poses)
        return tuple(Instance(label, self.object_name, pose) for label, pose in enumerate(poses, start=1))
