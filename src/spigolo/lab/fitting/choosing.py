"""Choice of the best trial, and its score on held-out frames."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from spigolo.errors import SpigoloError
from spigolo.lab.evaluation.resampling import Split, folds, leave_one_set_out
from spigolo.lab.evaluation.rows import Row
from spigolo.lab.fitting.trials import Search, Trial


@dataclass(frozen=True, slots=True)
class HeldOut:
    """Rows of every frame with a trial chosen without its fold or set. chosen: trial of each fold or set."""

    rows: tuple[Row, ...]
    chosen: tuple[Trial, ...]


def goodness(rows: Sequence[Row]) -> float:
    """Return the goal of fitting: the share of labelled objects with IoU > 0.7, plus mean overlap F on fully labelled
    frames.

    Near-identical frames count once together.
    """
    size = Counter(row.group for row in rows)
    found = objects = overlap = whole = 0.0
    for row in rows:
        if row.score is None:
            continue
        weight = 1 / size[row.group]
        found += weight * row.score.true_positives
        objects += weight * row.score.n_objects
        if row.labelling == "full":
            overlap += weight * row.score.overlap_f
            whole += weight
    return (found / objects if objects else 0.0) + (overlap / whole if whole else 0.0)


def best_trial(trials: Sequence[Trial], frames: Sequence[int] | None = None) -> Trial:
    """Return the best trial on all rows, or on the rows with these indices. Among equal trials it is the first."""
    return max(trials, key=lambda trial: goodness(trial.rows if frames is None else [trial.rows[i] for i in frames]))


def check_folds(groups: Sequence[str], count: int) -> None:
    """Raise SpigoloError if there are fewer groups of labelled frames than folds."""
    distinct = len(set(groups))
    if not 2 <= count <= distinct:
        raise SpigoloError(
            f"expected 2 folds or more and no more than distinct labelled frames, of which there are {distinct}, got"
            f" {count}: give --folds, or label more frames"
        )


def hold_out(search: Search, count: int = 5, seed: int = 0, with_start: bool = True) -> HeldOut:
    """Score every frame with the trial that is best on the other folds. Near-identical frames share a fold.

    with_start: True if the start may be chosen too, which is valid only for a start that was not made on these frames.
    Raises SpigoloError if there are fewer distinct frames than folds.
    """
    groups = [place.group for place in search.subject.places]
    check_folds(groups, count)
    return _score_outside(search, folds(groups, count, seed), with_start)


def hold_out_sets(search: Search, with_start: bool = True) -> HeldOut:
    """Score every data set with the trial that is best on the other sets, to estimate the result with another camera.

    The sets are in the order of their names. Raises SpigoloError if `set_splits` returns None.
    """
    splits = set_splits(search)
    if not splits:
        names = ", ".join(sorted({place.data_set for place in search.subject.places}))
        raise SpigoloError(
            f"expected frames of several data sets that differ, got {names}: label those of another place"
        )
    return _score_outside(search, splits, with_start)


def set_splits(search: Search) -> list[Split]:
    """Return one split for each data set. None if there is only one set, or if other sets have only similar frames."""
    places = search.subject.places
    if len({place.data_set for place in places}) < 2:
        return []
    splits = leave_one_set_out([place.data_set for place in places], [place.group for place in places])
    return splits if all(split.inside.size for split in splits) else []


def _score_outside(search: Search, splits: Sequence[Split], with_start: bool) -> HeldOut:
    trials = search.trials if with_start else search.trials[1:]
    chosen = tuple(best_trial(trials, split.inside.tolist()) for split in splits)
    rows = {i: best.rows[i] for best, split in zip(chosen, splits, strict=True) for i in split.outside.tolist()}
    return HeldOut(tuple(rows[i] for i in sorted(rows)), chosen)
