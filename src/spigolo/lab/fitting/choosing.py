"""Choice of the best parameter values of a random search, and scoring on held-out frames."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from spigolo.errors import SpigoloError
from spigolo.lab.evaluation.resampling import Split, folds, leave_one_set_out
from spigolo.lab.evaluation.rows import Row
from spigolo.lab.fitting.trials import Search, Trial


@dataclass(frozen=True, slots=True)
class HeldOut:
    """Result of a cross-validation."""

    rows: tuple[Row, ...]
    """Score of every frame. The parameter values were chosen on the folds or data sets that do not contain the frame.
    """
    chosen: tuple[Trial, ...]
    """Trial (set of parameter values) chosen for each held-out fold or data set."""


def goodness(rows: Sequence[Row]) -> float:
    """Return the value that fitting maximises: the share of objects found (IoU above 0.7), plus the mean overlap F.

    The overlap F is averaged over fully labelled frames only. Each group of near-identical frames has the weight of one
    frame.
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
    """Return the trial (set of parameter values) with the highest `goodness`.

    frames: indices of the frames to score, by default all.
    """
    return max(trials, key=lambda trial: goodness(trial.rows if frames is None else [trial.rows[i] for i in frames]))


def check_folds(groups: Sequence[str], count: int) -> None:
    """Raise SpigoloError if there are fewer groups of near-identical frames than folds.

    count: number of folds, at least 2.
    """
    distinct = len(set(groups))
    if not 2 <= count <= distinct:
        raise SpigoloError(
            f"expected from 2 folds to as many folds as distinct labelled frames ({distinct}), got {count}: give"
            " another --folds, or label more frames"
        )


def hold_out(search: Search, count: int = 5, seed: int = 0, with_start: bool = True) -> HeldOut:
    """Score every frame by cross-validation, with the parameter values that are best on the folds without this frame.

    Near-identical frames are in the same fold.

    Raises SpigoloError if there are fewer groups of near-identical frames than folds.

    Parameters
    ----------
    search
        Result of a parameter search: all tested parameter values with their scores.
    count
        Number of folds.
    seed
        Random seed of the split into folds.
    with_start
        True if the initial parameter values may be chosen too. Use False if the initial values were fitted to the same
        frames as the search.

    """
    groups = [place.group for place in search.subject.places]
    check_folds(groups, count)
    return _score_outside(search, folds(groups, count, seed), with_start)


def hold_out_sets(search: Search, with_start: bool = True, source_of: Callable[[str], str] = str) -> HeldOut:
    """Score every data set with the parameter values that are best on the data sets of other sources.

    The scores estimate the accuracy with another camera or in another environment. The trials (sets of parameter
    values) in the field `chosen` are sorted by the name of the source.

    Raises SpigoloError if `set_splits` finds no cross-validation splits.

    Parameters
    ----------
    search
        Result of a parameter search: all tested parameter values with their scores.
    with_start
        True if the initial parameter values may be chosen too.
    source_of
        Function that returns the source of a data set, given its name. Data sets of one camera and place have the same
        source and are held out together. By default, every data set is a source.

    """
    splits = set_splits(search, source_of)
    if not splits:
        names = ", ".join(sorted({place.data_set for place in search.subject.places}))
        raise SpigoloError(
            f"expected frames of at least two different data sets, got {names}: label frames of another place"
        )
    return _score_outside(search, splits, with_start)


def set_splits(search: Search, source_of: Callable[[str], str] = str) -> list[Split]:
    """Return one cross-validation split per source, which is a data set or several data sets with the same value of the
    function `source_of`.

    The list of splits is empty if there is only one source, or if a split has no frames for the choice of parameters.
    """
    sources = [source_of(place.data_set) for place in search.subject.places]
    if len(set(sources)) < 2:
        return []
    splits = leave_one_set_out(sources, [place.group for place in search.subject.places])
    return splits if all(split.inside.size for split in splits) else []


def _score_outside(search: Search, splits: Sequence[Split], with_start: bool) -> HeldOut:
    trials = search.trials if with_start else search.trials[1:]
    chosen = tuple(best_trial(trials, split.inside.tolist()) for split in splits)
    rows = {i: best.rows[i] for best, split in zip(chosen, splits, strict=True) for i in split.outside.tolist()}
    return HeldOut(tuple(rows[i] for i in sorted(rows)), chosen)
