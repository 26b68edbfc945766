"""Three families of rendered scenes, after the three data sets of the paper, with exact masks and poses.

`shelf`: products in a bin seen from the front, as the Rutgers APC set; `table`: table-tops with several categories,
as RGB-D Scenes; `multi`: three instances of one object among clutter, as the set of Tejani et al.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from spigolo.datasets.sample import Model, Sample
from spigolo.errors import ConfigError
from spigolo.synthetic.bins import PRODUCTS, VIEWS, shelf_stage
from spigolo.synthetic.household import household
from spigolo.synthetic.staging import Recording, Stage, record
from spigolo.synthetic.tables import INSTANCES, TABLES, multi_stage, table_stage

__all__ = ["FAMILIES", "Family", "family_models", "record_family", "render_family"]


@dataclass(frozen=True)
class Family:
    """scenes: their names, which frames take in turn; objects: names of what may be labelled in them.

    fully_labelled: whether everything that stands there is labelled.
    """

    stage: Callable[[str, np.random.Generator], Stage]
    scenes: tuple[str, ...]
    objects: tuple[str, ...]
    fully_labelled: bool


FAMILIES: Mapping[str, Family] = {
    "shelf": Family(shelf_stage, tuple(VIEWS), PRODUCTS, True),
    "table": Family(table_stage, tuple(TABLES), tuple(sorted({name for t in TABLES.values() for name in t})), True),
    "multi": Family(multi_stage, INSTANCES, INSTANCES, False),
}


def render_family(family: str, number: int, seed: int = 0) -> Sample:
    """One frame of a family, of `FAMILIES`, and its truth: frame.name is its scene and the number in it, from 1.

    number: counts the frames of a seed from 0; the scenes have their turns. Equal numbers and seeds give equal
    frames. Raises ConfigError for a family that is not known.
    """
    return record_family(family, number, seed).sample


def record_family(family: str, number: int, seed: int = 0) -> Recording:
    """The same with the depth that a perfect camera would have measured."""
    chosen = _family(family)
    scene = chosen.scenes[number % len(chosen.scenes)]
    rng = np.random.default_rng([list(FAMILIES).index(family), seed, number])
    name = f"{scene}_{number // len(chosen.scenes) + 1}"
    while True:
        recording = record(chosen.stage(scene, rng), name, rng)
        if recording.sample.instances:  # else everything was hidden or out of view: another arrangement
            return recording


def family_models(family: str) -> tuple[Model, ...]:
    """The models that the instances of a family name. Raises ConfigError for a family that is not known."""
    return tuple(household(name).model() for name in _family(family).objects)


def _family(name: str) -> Family:
    if name not in FAMILIES:
        raise ConfigError(f"unknown family {name!r}: expected one of {', '.join(FAMILIES)}")
    return FAMILIES[name]
