"""Three families of rendered scenes with exact masks and poses, modelled on the three data sets of the paper.

`shelf`: products in a bin seen from the front, as in the Rutgers APC set. `table`: table-tops with several categories,
as in RGB-D Scenes. `multi`: three instances of one object among clutter, as in the set of Tejani et al.
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
"""Minimum IoU between the exact mask and the mask that a reader renders at an object's pose."""


@dataclass(frozen=True)
class Family:
    """Family of scenes. scenes: names, one per frame in turn. objects: names of the objects that may be labelled.

    fully_labelled: True if every object is labelled. first_alone: True if the original data set labels only one object
    per frame, the first one.
    """

    stage: Callable[[str, np.random.Generator], Stage]
    scenes: tuple[str, ...]
    objects: tuple[str, ...]
    fully_labelled: bool
    first_alone: bool = False


FAMILIES: Mapping[str, Family] = {
    "shelf": Family(shelf_stage, tuple(VIEWS), PRODUCTS, True, True),
    "table": Family(table_stage, tuple(TABLES), tuple(sorted({name for t in TABLES.values() for name in t})), True),
    "multi": Family(multi_stage, INSTANCES, INSTANCES, False),
}


def render_family(family: str, number: int, seed: int = 0) -> Sample:
    """Return one frame of a family in `FAMILIES` with its ground truth.

    frame.name is the name of its scene and its number in the scene, from 1.

    number: index of the frame, from 0. The scenes alternate. Equal numbers and seeds give equal frames. Raises
    ConfigError for an unknown family.
    """
    return record_family(family, number, seed).sample


def record_family(family: str, number: int, seed: int = 0) -> Recording:
    """Return the same frame as `render_family`, with the depth of an ideal camera in addition."""
    return next(made for made in arrangements(family, number, seed) if is_told_by_poses(family, made.sample))


def arrangements(family: str, number: int, seed: int = 0) -> Iterator[Recording]:
    """Yield random arrangements without end. `record_family` uses the first one that is valid."""
    chosen = _family(family)
    scene = chosen.scenes[number % len(chosen.scenes)]
    rng = np.random.default_rng([list(FAMILIES).index(family), seed, number])
    name = f"{scene}_{number // len(chosen.scenes) + 1}"
    while True:
        yield record(chosen.stage(scene, rng), name, rng)


def is_told_by_poses(family: str, sample: Sample) -> bool:
    """Return True if an object is in view, and masks rendered at the poses agree with the exact ones.

    Masks cannot agree if something without measured depth hides an object.
    """
    ious = drawn_iou(family, sample, sample.frame.depth)
    return bool(ious.size and ious.min() >= LEAST_IOU)


def drawn_iou(family: str, sample: Sample, measured: DepthMap, tolerance_m: float = TOLERANCE_M) -> FloatArray:
    """Return the IoU (N,) between each exact mask and the mask that a reader renders at the object's pose.

    measured: depth (H, W) in metres that decides visibility. If the data set labels only the first object, its mask is
    also rendered without the other objects. The smaller IoU counts.
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
    """Return the models of all instances in a family. Raises ConfigError for an unknown family."""
    return tuple(household(name).model() for name in _family(family).objects)


def _family(name: str) -> Family:
    if name not in FAMILIES:
        raise ConfigError(f"unknown family {name!r}: expected one of {', '.join(FAMILIES)}")
    return FAMILIES[name]
