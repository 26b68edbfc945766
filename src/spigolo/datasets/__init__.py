"""Labelled frames as data sets keep them on disk: one small class a layout, its docstring is the format.

for entry in guess("rgbd-scenes"):
    frame, truth = entry.read_both()
"""

from __future__ import annotations

from spigolo.datasets.bop import Bop
from spigolo.datasets.entry import FULL_SETS, DataSet, Entry, Truth
from spigolo.datasets.folders import Folders
from spigolo.datasets.guessing import READERS, find_labelled_frames, guess
from spigolo.datasets.labelled_images import Ocid, Osd
from spigolo.datasets.mosd import Mosd
from spigolo.datasets.rutgers import Rutgers
from spigolo.datasets.sample import Instance, Model, Sample
from spigolo.datasets.tejani import Tejani
from spigolo.datasets.tum import Tum
from spigolo.datasets.uw_scenes import UwScenes
from spigolo.datasets.uw_scenes_v2 import UwScenesV2
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
    "FULL_SETS",
    "READERS",
    "Bop",
    "DataSet",
    "Entry",
    "Folders",
    "Instance",
    "Model",
    "Mosd",
    "Ocid",
    "Osd",
    "Rutgers",
    "Sample",
    "Tejani",
    "Truth",
    "Tum",
    "UwScenes",
    "UwScenesV2",
    "find_labelled_frames",
    "guess",
    "rutgers_name",
    "tejani_name",
    "uw_scenes_name",
    "write_bop",
    "write_rutgers",
    "write_tejani",
    "write_uw_scenes",
]
