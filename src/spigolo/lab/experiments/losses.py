"""Lost objects on labelled frames, grouped by cause."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from spigolo.lab.datasets import Entry
from spigolo.lab.evaluation.causes import Cause, Fate, find_fates
from spigolo.lab.page import Table, cells
from spigolo.methods import Method


@dataclass(frozen=True, slots=True)
class Loss:
    """Labelled object and its outcome."""

    data_set: str
    """Name of the data set."""
    frame: str
    """Name of the frame."""
    fate: Fate
    """Outcome of the object."""
    why: str
    """Rule that rejected the object's region. Empty for a returned region."""


def find_losses(entries: Iterable[Entry], method: Method, tell: Callable[[int], None] | None = None) -> list[Loss]:
    """Return the outcomes of all labelled objects of some frames with one method."""
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
    """Return the number of objects for each data set and cause."""
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
    """Return one row for each lost object: its cause, the IoU of its region, and the rule that rejected the region."""
    lost = [loss for loss in losses if loss.fate.cause is not Cause.FOUND]
    rows = [
        (f"{x.data_set}/{x.frame}", str(x.fate.label), x.fate.cause.value, f"{x.fate.iou:.2f}", x.why) for x in lost
    ]
    return Table(("frame", "object", "cause", "IoU", "region rejected as"), cells(rows), names=5)


def share_found(losses: Sequence[Loss]) -> float:
    """Return the share of objects that were found."""
    return float(np.mean([loss.fate.cause is Cause.FOUND for loss in losses])) if losses else 0.0
