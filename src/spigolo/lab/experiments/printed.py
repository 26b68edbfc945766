"""Values printed in Tables I to III of the paper, and the assignment of objects to table cells."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

Place = tuple[str, str]
"""Table cell, given by the name of its line and the name of its column."""


@dataclass(frozen=True, slots=True)
class Figure:
    """Value in a cell of the paper's table."""

    found: str
    """Printed share of found objects, per cent."""
    beside: str = ""
    """Value that is printed in parentheses. The text is empty if the paper prints no value in parentheses."""
    objects: int = 0
    """Printed number of objects, 0 if not printed."""


@dataclass(frozen=True, slots=True)
class Printed:
    """Table of the paper (Toscana & Rosa 2016)."""

    number: str
    """Number of the table, such as "II"."""
    about: str
    """Title of the data set in the table."""
    data_set: str
    """Name of the data set in `spigolo.lab.datasets`."""
    preset: str
    """Name of the preset with the parameters that the paper used for the table."""
    figures: Mapping[Place, Figure]
    """Printed values, indexed by line and column. Cells that are empty in the paper are left out."""
    place: Callable[[str, str], Place]
    """Function that returns the table cell of an object.

    The arguments are the name of the frame and the name of the object.
    """
    beside: str = ""
    """Name of the method whose values are printed in parentheses. The name is empty if no values are in parentheses."""
    note: str = ""

    @property
    def lines(self) -> Sequence[str]:
        """Names of the table's lines, from top to bottom."""
        return list(dict.fromkeys(line for line, _ in self.figures))

    @property
    def columns(self) -> Sequence[str]:
        """Names of the table's columns, from left to right."""
        return list(dict.fromkeys(column for _, column in self.figures))


ALL = "objects"
CATEGORIES = {
    "soda_can": "Soda can", "coffee_mug": "Coffee mug", "cap": "Cap", "bowl": "Bowl", "flashlight": "Flashlight",
    "cereal": "Cereal box",
}  # fmt: skip


def _run(frame: str, name: str) -> Place:
    """Return the cell of Table I for an object of a Rutgers APC frame.

    The names of frames have the form OBJECT-BIN-CLUTTER-POSITION-SHOT. Table I has one line per run. The number of the
    run is CLUTTER + 1, where CLUTTER is a number in the frame name.
    """
    found = re.fullmatch(r".+-[A-L]-(\d+)-\d+-\d+", frame)
    return (f"Run_{int(found[1]) + 1}" if found else ""), ALL


def _scene(frame: str, name: str) -> Place:
    """Return the cell of Table II for an object in UW RGB-D Scenes.

    The names of frames have the form SCENE_K_N, and the names of objects have the form CATEGORY_NUMBER.
    """
    return frame.rpartition("_")[0].capitalize(), CATEGORIES.get(name.rpartition("_")[0], "")


def _object(frame: str, name: str) -> Place:
    return name, ALL


def _scene_figures(scene: str, found: str, beside: str) -> dict[Place, Figure]:
    cells = zip(CATEGORIES.values(), found.split(), beside.split(), strict=False)
    return {(scene, column): Figure(f"{share} %", f"{other} %") for column, share, other in cells}


TABLES = (
    Printed(
        "I",
        "Rutgers APC",
        "rutgers-apc",
        "SHELF",
        {
            ("Run_1", ALL): Figure("87.9", objects=80),
            ("Run_2", ALL): Figure("92.3", objects=120),
            ("Run_3", ALL): Figure("75.6", objects=121),
        },
        _run,
        note="The number of a run is the number of objects in the bin. The data set gives the pose of one object per"
        " frame, and only this object counts.",
    ),
    Printed(
        "II",
        "UW RGB-D Scenes v1",
        "uw-scenes-v1",
        "TABLE",
        {
            **_scene_figures("Table_1", "90.6 100 80.1 85.5 98.1 72", "100 83.6 93.6 90.3 98.1 97.8"),
            **_scene_figures("Desk_1", "100 100 74.2", "93.7 92.5 100"),
            **_scene_figures("Kitchen_small_1", "98.6 100 86.5 100 100 77.6", "74.8 70.1 97.3 90 88.5 84.4"),
        },
        _scene,
        beside="mishra2012",
        note="In parentheses: Mishra et al. 2012. Their printed values require 50 % coverage and use the camera's pose."
        " The measured values require 50 %, too, and do not use the pose.",
    ),
    Printed(
        "III",
        "Tejani et al., several instances",
        "tejani",
        "CLUTTER",
        {
            ("Milk", ALL): Figure("66.6", objects=2589),
            ("Coffee_Cup", ALL): Figure("87.2", objects=2127),
            ("Shampoo", ALL): Figure("99.6", objects=2118),
            ("Camera", ALL): Figure("96.3", objects=894),
        },
        _object,
        note="Only the instances of the one object of each scene count.",
    ),
)
