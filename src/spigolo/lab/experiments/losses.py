"""Labelled objects that a method did not find, grouped by cause."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from spigolo.lab.datasets import Entry
from spigolo.lab.evaluation.causes import Cause, Fate, find_fates
from spigolo.lab.page import Table, cells
from spigolo.methods import Method


@dataclass(frozen=True, slots=True)
class Loss:
    """Labelled object, and the reason if the object was not found."""

    data_set: str
    """Name of the data set."""
    frame: str
    """Name of the frame."""
    fate: Fate
    """Reason why the object was not found. The reason is determined from one region (`fate.region`)."""
    why: str
    """Rule that rejected the region `fate.region`, empty if the region was not rejected."""


def find_losses(entries: Iterable[Entry], method: Method, tell: Callable[[int], None] | None = None) -> list[Loss]:
    """Segment frames, and determine for every labelled object whether the object was found, and the reason if it was
    not found.

    tell: progress callback with the number of finished frames.
    """
    losses: list[Loss] = []
    for done, entry in enumerate(entries, start=1):
        frame, truth = entry.read_both()
        if truth is not None:
            result = method(frame)
            why = {region.region: region.why for region in result.rejected}
            fates = find_fates(truth.labels, result.labels, result.regions.labels, truth.ignore)
            losses += [Loss(entry.data_set, entry.name, fate, why.get(fate.region, "")) for fate in fates]
        if tell is not None:
            tell(done)
    return losses


def loss_table(losses: Sequence[Loss]) -> Table:
    """Return a table with the number of labelled objects per data set and cause, such as `found` or `merged`."""
    counts: dict[str, Counter[Cause]] = defaultdict(Counter)
    for loss in losses:
        counts[loss.data_set][loss.fate.cause] += 1
    counts["all"] = Counter(loss.fate.cause for loss in losses)
    head = ("data set", "objects", *(cause.value for cause in Cause))
    rows = [
        (name, str(row.total()), *(str(row[cause]) if row[cause] else "-" for cause in Cause))
        for name, row in counts.items()
    ]
    return Table(head, cells(rows))


def lost_objects(losses: Sequence[Loss]) -> Table:
    """Return a table of all objects that were not found. The columns of the table are the cause, the IoU and the reason
    for rejection.

    IoU and reason for rejection are those of the region (`Fate.region`) from which the cause was determined.
    """
    lost = [loss for loss in losses if loss.fate.cause is not Cause.FOUND]
    rows = [
        (f"{x.data_set}/{x.frame}", str(x.fate.label), x.fate.cause.value, f"{x.fate.iou:.2f}", x.why) for x in lost
    ]
    return Table(("frame", "object", "cause", "IoU", "reason for rejection"), cells(rows), names=5)
