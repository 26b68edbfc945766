"""Readers and writers of labelled RGB-D data sets, with one class per file layout.

The docstring of each class or of its module describes the file layout that the class reads or writes.

Read all frames of a data set with their ground truth::

    for entry in guess("rgbd-scenes"):
        frame, truth = entry.read_both()
"""

from __future__ import annotations

from spigolo.lab.datasets.bop import Bop
from spigolo.lab.datasets.entry import DataSet, Entry, Truth
from spigolo.lab.datasets.folders import Folders
from spigolo.lab.datasets.guessing import READERS, find_labelled_frames, guess
from spigolo.lab.datasets.labelled_images import Ocid, Osd
from spigolo.lab.datasets.mosd import Mosd
from spigolo.lab.datasets.rutgers import Rutgers
from spigolo.lab.datasets.sample import Instance, Model, Sample
from spigolo.lab.datasets.tejani import Tejani
from spigolo.lab.datasets.tum import Tum
from spigolo.lab.datasets.uw_scenes import UwScenes
from spigolo.lab.datasets.uw_scenes_v2 import UwScenesV2
from spigolo.lab.datasets.writing import (
    rutgers_name,
    tejani_name,
    uw_scenes_name,
    write_bop,
    write_rutgers,
    write_tejani,
    write_uw_scenes,
)
from spigolo.lab.labelled import FULL_SETS

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
