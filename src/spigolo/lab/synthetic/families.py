"""Three families of rendered scenes, after the three data sets of the paper, with exact masks and poses.

`shelf`: products in a bin seen from the front, as the Rutgers APC set. `table`: table-tops with several categories,
as RGB-D Scenes. `multi`: three instances of one object among clutter, as the set of Tejani et al.
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
"""Minimum IoU between the mask that a reader draws at an object's pose and the exact one."""


@dataclass(frozen=True)
class Family:
    """scenes: their names, which frames take in turn. objects: names of what may be labelled in them.

    fully_labelled: whether everything that stands there is labelled. first_alone: whether the data set that it stands
    in for labels one object a frame, the first.
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
    """One frame of a family, of `FAMILIES`, and its truth: frame.name is its scene and the number in it, from 1.

    number: counts the frames of a seed from 0. The scenes have their turns. Equal numbers and seeds give equal
    frames. Raises ConfigError for a family that is not known.
    """
    return record_family(family, number, seed).sample


def record_family(family: str, number: int, seed: int = 0) -> Recording:
    """The same with the depth that a perfect camera would have measured."""
    return next(made for made in arrangements(family, number, seed) if is_told_by_poses(family, made.sample))


def arrangements(family: str, number: int, seed: int = 0) -> Iterator[Recording]:
    """One after another, without end, what `record_family` takes the first of that will do."""
    chosen = _family(family)
    scene = chosen.scenes[number % len(chosen.scenes)]
    rng = np.random.default_rng([list(FAMILIES).index(family), seed, number])
    name = f"{scene}_{number // len(chosen.scenes) + 1}"
    while True:
        yield record(chosen.stage(scene, rng), name, rng)


def is_told_by_poses(family: str, sample: Sample) -> bool:
    """True if any object is in view, and readers that draw masks at the poses get the exact ones, or nearly so.

    If something hides an object and returns no depth they cannot tell.
    """
    ious = drawn_iou(family, sample, sample.frame.depth)
    return bool(ious.size and ious.min() >= LEAST_IOU)


def drawn_iou(family: str, sample: Sample, measured: DepthMap, tolerance_m: float = TOLERANCE_M) -> FloatArray:
    """Intersection over union (N,) of each exact mask of a family's frame with that which a reader draws at the pose.

    measured: depth (H, W) in metres by which it is judged what is visible. If the set labels the first object alone,
    that one counts as it is drawn without the others, if that is worse.
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
    """The models that the instances of a family name. Raises ConfigError for a family that is not known."""
    return tuple(household(name).model() for name in _family(family).objects)


def _family(name: str) -> Family:
    if name not in FAMILIES:
        raise ConfigError(f"unknown family {name!r}: expected one of {', '.join(FAMILIES)}")
    return FAMILIES[name]
