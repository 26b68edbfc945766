"""Labelled frames as data sets keep them on disk: one small class a layout, its docstring is the format."""

from __future__ import annotations

from spigolo.datasets.bop import Bop
from spigolo.datasets.entry import DataSet, Entry, Truth
from spigolo.datasets.rutgers import Rutgers
from spigolo.datasets.sample import Instance, Model, Sample
from spigolo.datasets.tejani import Tejani
from spigolo.datasets.uw_scenes import UwScenes
from spigolo.datasets.writing import (
    rutgers_name,
    tejani_name,
    uw_scenes_name,
    write_bop,
    write_rutgers,
    write_tejani,
    write_uw_scenes,
)

__all__ = [
    "Bop",
    "DataSet",
    "Entry",
    "Instance",
    "Model",
    "Rutgers",
    "Sample",
    "Tejani",
    "Truth",
    "UwScenes",
    "rutgers_name",
    "tejani_name",
    "uw_scenes_name",
    "write_bop",
    "write_rutgers",
    "write_tejani",
    "write_uw_scenes",
]
