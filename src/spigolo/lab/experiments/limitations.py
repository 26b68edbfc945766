"""Limitations of an evaluation, as sentences for the report."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from spigolo.lab.evaluation.rows import Labelling, Row
from spigolo.lab.experiments.contenders import Contender
from spigolo.lab.experiments.tables import FEW_GROUPS

MOST = 0.5
"""Maximum share of all frames that one data set may have. If a data set has a larger share of the frames, the report
warns that this data set dominates the mean.
"""


def limitations(contenders: Sequence[Contender]) -> list[str]:
    """Return sentences about the limitations of an evaluation, most important first."""
    rows = [row for contender in contenders for row in contender.rows]
    groups = {row.group: row.data_set for row in rows if row.score is not None}
    methods = sorted({row.method for row in rows})
    return [
        *_labelling(rows),
        *_size(groups),
        *_coverage(contenders, rows),
        *_failures(contenders),
        "The report does not know which frames a preset was fitted to. The values on these frames are too good. Only"
        " held-out frames show the quality on new frames.",
        f"The report does not compare with learned methods. It contains only {_list(methods)}.",
        "The interval of the found share assumes that objects are independent. The objects of one frame share light,"
        " view and camera, so the interval is too narrow.",
        "Times are CPU times of one run per frame, after one run that was not timed. Other programs may have run at the"
        " same time.",
        *_mixed(rows),
    ]


def _labelling(rows: Sequence[Row]) -> list[str]:
    part, none = _sets(rows, "part"), _sets(rows, "none")
    told = []
    if part:
        told.append(
            f"{_list(part)}: only some objects are labelled. Precision cannot be measured, because a segment on an"
            " unlabelled object is not wrong. Overlap P and F, boundary F and false objects are left out."
        )
    if none:
        told.append(f"{_list(none)}: no labels. Only the time and the number of predicted objects are measured.")
    return told


def _size(groups: dict[str, str]) -> list[str]:
    if not groups:
        return ["No frame has labels: the report does not measure accuracy."]
    count = Counter(groups.values())
    few = sorted(name for name, n in count.items() if n < FEW_GROUPS)
    biggest, most = count.most_common(1)[0]
    told = [
        f"{len(groups)} distinct labelled frames of {len(count)} data sets show only a few rooms, cameras and objects."
    ]
    if few:
        told.append(f"Fewer than {FEW_GROUPS} distinct frames in {_list(few)}: these values are only examples.")
    if len(count) > 1 and most > MOST * len(groups):
        told.append(
            f"{biggest} has {most} of the {len(groups)} distinct frames, so this data set dominates the pooled values."
        )
    return told


def _coverage(contenders: Sequence[Contender], rows: Sequence[Row]) -> list[str]:
    every = {(row.data_set, row.frame) for row in rows}
    lacking = {c.label: len(every) - len(c.rows) for c in contenders}
    short = [f"{label} lacks {n}" for label, n in lacking.items() if n]
    if not short:
        return []
    return [f"Not every method ran on all {len(every)} frames ({'; '.join(short)}): use the table of differences."]


def _failures(contenders: Sequence[Contender]) -> list[str]:
    told = []
    for contender in contenders:
        failed = [row for row in contender.rows if row.error is not None]
        if failed:
            told.append(
                f"{contender.label} failed on {len(failed)} frames. They are scored as frames without predicted"
                " objects, or left out if the labels could not be read. First:"
                f" {failed[0].data_set}/{failed[0].frame}: {failed[0].error}"
            )
    return told


def _mixed(rows: Sequence[Row]) -> list[str]:
    told = []
    if len({row.machine for row in rows}) > 1:
        told.append("The results come from several machines or library versions: do not compare the times.")
    if len({row.version for row in rows}) > 1:
        told.append("The results come from several versions of spigolo.")
    return told


def _sets(rows: Sequence[Row], labelling: Labelling) -> list[str]:
    return sorted({row.data_set for row in rows if row.labelling == labelling})


def _list(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
