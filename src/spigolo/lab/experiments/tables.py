"""Tables of the evaluation report: accuracy, CPU time, differences and reasons for rejection."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence

from spigolo.lab.evaluation.pooling import Difference, Pooled, compare, pool
from spigolo.lab.evaluation.resampling import Estimate
from spigolo.lab.evaluation.rows import Row
from spigolo.lab.experiments.contenders import Contender
from spigolo.lab.page import Cell, Table

Scope = tuple[str, Callable[[Row], bool]]
"""Subset of the frames: its name, and a function that returns True if an evaluation result belongs to a frame of the
subset.
"""

EVERY_OBJECT = "every object labelled"
ALL_LABELLED = "all labelled frames"
FOUND = "found (IoU\N{NO-BREAK SPACE}>\N{NO-BREAK SPACE}0.7)"
NONE = "–"
MINUS = "−"
FEW_GROUPS = 10
"""Minimum number of groups of near-identical frames for a reliable bootstrap interval."""


FIGURES = (
    "frames", "objects", "overlap P", "overlap R", "overlap F", "boundary F", "F@.75", FOUND,
    "in the regions", "false", "predicted per frame", "CPU time",
)  # fmt: skip
BRIEF = ("frames", "overlap F", "boundary F", "F@.75", FOUND, "CPU time")
"""Columns of the short table for a terminal."""


def pooled_table(contenders: Sequence[Contender]) -> Table:
    """Return a table of accuracy and CPU time over all data sets together."""
    return _accuracy("all data sets", contenders, pooled_scopes(contenders))


def brief_table(contenders: Sequence[Contender]) -> Table:
    """Return a table of accuracy and CPU time over all data sets together, with fewer columns for a terminal."""
    table = pooled_table(contenders)
    columns = [k for k, title in enumerate(table.head) if k < table.names or title in BRIEF]
    noted = [table.head.index("overlap F"), table.head.index(FOUND)]
    rows = [[row[k] if k in noted else Cell(row[k].text) for k in columns] for row in table.rows]
    return Table([table.head[k] for k in columns], rows, table.names)


def set_table(contenders: Sequence[Contender]) -> Table:
    """Return a table of accuracy and CPU time per data set."""
    return _accuracy("data set", contenders, set_scopes(contenders))


def change_table(pairs: Sequence[tuple[Contender, Contender]]) -> Table:
    """Return a table of the differences between pairs of methods, second minus first, per data set and over all data
    sets.
    """
    every = [c for pair in pairs for c in pair]
    several = len({first.label for first, _ in pairs}) > 1
    rows = []
    for name, within in [*pooled_scopes(every), *_labelled_sets(every)]:
        for first, other in pairs:
            before, after = (list(filter(within, c.rows)) for c in (first, other))
            if before and after and (difference := compare(before, after)).n_frames:
                method = Cell(other.label, f"to {first.label}" if several else "")
                rows.append([Cell(name), method, *_change_cells(difference)])
    return Table(("data set", "method", *BRIEF), rows, names=2)


def rejection_table(contenders: Sequence[Contender]) -> Table:
    """Return a table with the number of rejected regions per frame, with one column per reason for rejection."""
    totals = {c.label: sum((Counter(row.rejected) for row in c.rows), Counter[str]()) for c in contenders}
    reasons = sorted(set().union(*totals.values()), key=lambda r: -max(t[r] for t in totals.values()))
    rows = [
        [Cell(c.label), *(Cell(_number(totals[c.label][reason] / len(c.rows))) for reason in reasons)]
        for c in contenders
    ]
    return Table(("method", *reasons), rows)


def pooled_scopes(contenders: Iterable[Contender]) -> list[Scope]:
    """Return the subsets of frames over all data sets: fully labelled frames, and all labelled frames."""
    kinds = {row.labelling for c in contenders for row in c.rows}
    scopes: list[Scope] = [(EVERY_OBJECT, lambda row: row.labelling == "full")] if "full" in kinds else []
    if "part" in kinds:
        scopes.append((ALL_LABELLED, lambda row: row.labelling != "none"))
    return scopes


def set_scopes(contenders: Iterable[Contender]) -> list[Scope]:
    """Return one subset of frames for each data set. The data sets are sorted by name."""
    names = sorted({row.data_set for c in contenders for row in c.rows})
    return [(name, lambda row, name=name: row.data_set == name) for name in names]  # type: ignore[misc]


def _labelled_sets(contenders: Sequence[Contender]) -> list[Scope]:
    rows = [row for c in contenders for row in c.rows if row.score is not None]
    return [scope for scope in set_scopes(contenders) if any(map(scope[1], rows))]


def _accuracy(title: str, contenders: Sequence[Contender], scopes: Sequence[Scope]) -> Table:
    rows = []
    for name, within in scopes:
        for contender in contenders:
            held = list(filter(within, contender.rows))
            if held:
                rows.append([Cell(name), Cell(contender.label), *_cells(pool(held))])
    return Table((title, "method", *FIGURES), rows, names=2)


def _cells(p: Pooled) -> list[Cell]:
    groups = f"{p.n_groups} distinct" if p.n_groups < p.n_frames else ""
    failed = f"{p.n_failed} failed" if p.n_failed else ""
    return [
        Cell(str(p.n_frames), ", ".join(filter(None, (groups, failed)))),
        Cell(_number(p.n_objects)),
        Cell(_share(p.overlap_precision)),
        Cell(_share(p.overlap_recall)),
        Cell(_share(p.overlap_f.value), _interval(p.overlap_f), strong=True),
        Cell(_share(p.boundary_f)),
        Cell(_share(p.f75)),
        Cell(_percent(p.found.value), _found_note(p), strong=True),
        Cell(_percent(p.found_in_regions)),
        Cell(_number(p.false_positives)),
        Cell(f"{p.n_predicted:.1f}"),
        Cell(_milliseconds(p.cpu_median_s), f"mean {_milliseconds(p.cpu_mean_s)}", strong=True),
    ]


def _change_cells(d: Difference) -> list[Cell]:
    many = d.n_groups >= FEW_GROUPS
    shares = [_change(e, "{:+.3f}", many) for e in (d.overlap_f, d.boundary_f, d.f75)]
    ratio = NONE if math.isnan(d.cpu_ratio) else f"× {d.cpu_ratio:.2f}"
    groups = f"{d.n_groups} distinct" if d.n_groups < d.n_frames else ""
    return [Cell(str(d.n_frames), groups), *shares, _change(d.found, "{:+.1%}", many), Cell(ratio)]


def _change(estimate: Estimate, form: str, many: bool) -> Cell:
    """Format a difference with its interval as a table cell.

    many: True if there are at least `FEW_GROUPS` groups of near-identical frames. The text of the cell is bold if
    `many` is True and the confidence interval does not include zero.
    """
    value, low, high = estimate
    if math.isnan(value):
        return Cell(NONE)
    if math.isnan(low):
        return Cell(_signed(value, form))
    return Cell(
        _signed(value, form), f"{_signed(low, form)} to {_signed(high, form)}", strong=many and (low > 0 or high < 0)
    )


def _signed(value: float, form: str) -> str:
    text = form.format(value).replace("%", " %")
    zero = not any(c in "123456789" for c in text)
    return text.lstrip("+-") if zero else text.replace("-", MINUS)


def _found_note(p: Pooled) -> str:
    if math.isnan(p.found.value):
        return ""
    low, high = (f"{100 * end:.0f}" for end in (p.found.low, p.found.high))
    return f"{_number(p.true_positives)} of {_number(p.n_objects)}; {low} to {high} %"


def _interval(estimate: Estimate) -> str:
    return "" if math.isnan(estimate.low) else f"{_share(estimate.low)} to {_share(estimate.high)}"


def _share(value: float) -> str:
    return NONE if math.isnan(value) else f"{value:.3f}"


def _percent(value: float) -> str:
    return NONE if math.isnan(value) else f"{100 * value:.0f} %"


def _milliseconds(value: float) -> str:
    return NONE if math.isnan(value) else f"{1e3 * value:.0f} ms"


def _number(value: float) -> str:
    """Format a number with one decimal, or without decimals if it is an integer. NaN becomes a dash."""
    return NONE if math.isnan(value) else f"{value:.1f}".removesuffix(".0")
