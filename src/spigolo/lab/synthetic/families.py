"""Three families (kinds) of rendered scenes with exact masks and poses, similar to the three data sets of the paper.

The exact mask of an object contains the pixels at which the renderer shows the object.

The family `shelf` shows products in a shelf bin, as in the data set Rutgers APC. The family `table` shows different
objects on tables, as in the data set UW RGB-D Scenes. The family `multi` shows three instances of one object among
other objects, as in the data set of Tejani et al.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from spigolo.errors import ConfigError
from spigolo.frames.frame import DepthMap
from spigolo.lab.datasets.sample import Instance, Model, Sample
from spigolo.lab.datasets.visibility import TOLERANCE_M, visible_labels
from spigolo.lab.synthetic.bins import PRODUCTS, VIEWS, shelf_stage
from spigolo.lab.synthetic.household import household
from spigolo.lab.synthetic.staging import Recording, Stage, record
from spigolo.lab.synthetic.tables import INSTANCES, TABLES, multi_stage, table_stage

__all__ = [
    "FAMILIES",
    "LEAST_IOU",
    "Family",
    "arrangements",
    "drawn_iou",
    "family_models",
    "is_told_by_poses",
    "record_family",
    "render_family",
]

FloatArray = npt.NDArray[np.float64]

LEAST_IOU = 0.98
"""Minimum IoU between the exact mask of an object and the mask rendered from its model and pose. A scene is discarded
if the IoU of an object is below `LEAST_IOU`.
"""


@dataclass(frozen=True)
class Family:
    """Family (kind) of rendered scenes."""

    stage: Callable[[str, np.random.Generator], Stage]
    """Function that creates a random scene from a scene name and a random number generator."""
    scenes: tuple[str, ...]
    """Names of the scenes in the family. Consecutive frames of a family show consecutive scenes in the order of
    `scenes`.
    """
    objects: tuple[str, ...]
    """Names of all objects that may be labelled in the family's scenes."""
    fully_labelled: bool
    """True if every object in a frame is labelled."""
    first_alone: bool = False
    """True if the corresponding real data set labels only one object per frame."""


FAMILIES: Mapping[str, Family] = {
    "shelf": Family(shelf_stage, tuple(VIEWS), PRODUCTS, True, True),
    "table": Family(table_stage, tuple(TABLES), tuple(sorted({name for t in TABLES.values() for name in t})), True),
    "multi": Family(multi_stage, INSTANCES, INSTANCES, False),
}


def render_family(family: str, number: int, seed: int = 0) -> Sample:
    """Render one frame with its ground truth.

    The frame is named SCENE_NUMBER: the name of its scene, and a number that is counted from 1.

    Raises ConfigError for an unknown family.

    Parameters
    ----------
    family
        Kind of scene, a key of `FAMILIES`.
    number
        Index of the frame, counted from 0. Equal values of `family`, `number` and `seed` always give the same frame.
    seed
        Random seed of the frames.

    """
    return record_family(family, number, seed).sample


def record_family(family: str, number: int, seed: int = 0) -> Recording:
    """Render the same frame as the function `render_family`. Return the frame, its ground truth and its noise-free
    depth map.
    """
    return next(made for made in arrangements(family, number, seed) if is_told_by_poses(family, made.sample))


def arrangements(family: str, number: int, seed: int = 0) -> Iterator[Recording]:
    """Yield an endless sequence of rendered random scenes for one frame.

    The function `record_family` returns the first scene for which `is_told_by_poses` returns True.
    """
    chosen = _family(family)
    scene = chosen.scenes[number % len(chosen.scenes)]
    rng = np.random.default_rng([list(FAMILIES).index(family), seed, number])
    name = f"{scene}_{number // len(chosen.scenes) + 1}"
    while True:
        yield record(chosen.stage(scene, rng), name, rng)


def is_told_by_poses(family: str, sample: Sample) -> bool:
    """Return True if at least one object is visible, and all masks rendered from models and poses match the exact
    masks.

    The masks do not match if a surface without measured depth, such as a robot gripper, hides a part of an object.
    """
    ious = drawn_iou(family, sample, sample.frame.depth)
    return bool(ious.size and ious.min() >= LEAST_IOU)


def drawn_iou(family: str, sample: Sample, measured: DepthMap, tolerance_m: float = TOLERANCE_M) -> FloatArray:
    """Return the IoU (N,) between the exact mask of each object and the mask rendered from its model and pose.

    If the family labels only one object per frame (`first_alone`), the mask of the first object is rendered twice: with
    and without the other objects. For the first object, the smaller IoU of the two rendered masks is returned.

    Parameters
    ----------
    family
        Kind of scene, a key of `FAMILIES`.
    sample
        Frame with exact masks and poses.
    measured
        Depth map (H, W) in metres, which determines the visible pixels of a model.
    tolerance_m
        Maximum distance of a visible model behind the surface in `measured`, metres. Pixels of a model with a larger
        distance count as hidden.

    """
    ious = _ious(sample, sample.instances, measured, tolerance_m)
    if _family(family).first_alone:
        ious[:1] = np.minimum(ious[:1], _ious(sample, sample.instances[:1], measured, tolerance_m))
    return ious


def _ious(sample: Sample, shown: tuple[Instance, ...], measured: DepthMap, tolerance_m: float) -> FloatArray:
    assert sample.frame.camera is not None
    models = [household(instance.model).model() for instance in shown]
    drawn = visible_labels(shown, models, measured, sample.frame.camera, tolerance_m)
    pairs = [(sample.labels == one.label, drawn == one.label) for one in shown]
    return np.array([np.sum(exact & here) / np.sum(exact | here) for exact, here in pairs])


def family_models(family: str) -> tuple[Model, ...]:
    """Return the models of all objects that are labelled in a family of scenes.

    Raises ConfigError for an unknown family.
    """
    return tuple(household(name).model() for name in _family(family).objects)


def _family(name: str) -> Family:
    if name not in FAMILIES:
        raise ConfigError(f"unknown family {name!r}: expected one of {', '.join(FAMILIES)}")
    return FAMILIES[name]
