"""Writer of the results of a parameter search: a report, and a TOML file with the fitted parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from spigolo.frames.files import write_bytes
from spigolo.lab.experiments.contenders import Contender
from spigolo.lab.experiments.tables import FEW_GROUPS, NONE, brief_table, change_table, set_table
from spigolo.lab.fitting.choosing import HeldOut, best_trial, hold_out_sets, set_splits
from spigolo.lab.fitting.spaces import apply
from spigolo.lab.fitting.trials import Search
from spigolo.lab.page import Cell, Items, Page, Paragraph, Table, to_markdown
from spigolo.methods import Method, Toscana2016


def fitted(search: Search, start: Method) -> Method:
    """Return the method with the parameter values that are best over all frames. start: method with initial values."""
    method = apply(best_trial(search.trials).setting, start)
    return method.replace(name=f"{start.preset}_FITTED") if isinstance(method, Toscana2016) else method


def score_table(search: Search, held: HeldOut) -> Table:
    """Return a table of the scores with initial and fitted parameters, on all frames and on held-out frames."""
    return brief_table([contender for contender, _ in _lines(search, held)])


def write_fit(search: Search, held: HeldOut, start: Method, folder: Path) -> tuple[Path, Path]:
    """Write the fitted parameters as a TOML file, and the report as report.md. Return the paths of the two written
    files.

    Raises FileError if a file cannot be written.

    For the method `toscana2016`, the TOML file is a preset. For any other method, the TOML file holds the parameters of
    the method.
    """
    method = fitted(search, start)
    preset, page = folder / f"{(method.preset or method.name).lower()}.toml", folder / "report.md"
    texts = {preset: _toml(method), page: to_markdown(make_page(search, held, start))}
    for path, text in texts.items():
        write_bytes(path, text.encode())
    return preset, page


def make_page(search: Search, held: HeldOut, start: Method) -> Page:
    """Return the report of a parameter search as a page."""
    lines = _lines(search, held)
    first, last = lines[0][0], lines[2][0]
    return Page(
        f"{start.name} {start.preset}".rstrip() + ", fitted",
        [
            Paragraph(
                f"{len(search.trials) - 1} random settings, seed {search.subject.seed}, each tested on"
                f" {len(search.subject.places)} labelled frames."
            ),
            score_table(search, held),
            Items([f"{contender.label}: {meaning}" for contender, meaning in lines]),
            *_of_each_set(search, lines),
            Paragraph("Held-out scores minus the scores of the start:"),
            change_table([(first, last)]),
            Items(list(_remarks(search, held))),
            Paragraph("Changed parameters:"),
            _changes(start, fitted(search, start)),
        ],
    )


def _lines(search: Search, held: HeldOut) -> list[tuple[Contender, str]]:
    best = best_trial(search.trials)
    lines = [
        (Contender("start", "", search.start.rows), "parameters at the start of the search."),
        (
            Contender("fitted", "", best.rows),
            "parameters in the TOML file, scored on the frames that chose them. New frames have lower scores.",
        ),
        (
            Contender("held out", "", held.rows),
            f"cross-validation over {len(held.chosen)} folds. Each fold is scored with the setting that is best on the"
            " other folds. Expect these scores on new frames of the same kind.",
        ),
    ]
    if set_splits(search):
        means = (
            "each data set is scored with the setting that is best on the other data sets. Expect these scores with"
            " another camera or at another place."
        )
        lines.append((Contender("set held out", "", hold_out_sets(search).rows), means))
    return lines


def _of_each_set(search: Search, lines: Sequence[tuple[Contender, str]]) -> list[Paragraph | Table]:
    if not set_splits(search):
        return []
    return [Paragraph("Scores per data set:"), set_table([contender for contender, _ in lines])]


def _remarks(search: Search, held: HeldOut) -> Iterator[str]:
    chosen = ", ".join(str(trial.number) for trial in held.chosen)
    yield (
        f"Best trial over all frames: {best_trial(search.trials).number}. Best trials in the folds: {chosen}. Trial 0"
        " is the start. The best trial has the highest sum of the share of found objects (IoU > 0.7) and the mean"
        " overlap F on fully labelled frames."
    )
    groups = len({place.group for place in search.subject.places})
    if groups < FEW_GROUPS:
        yield f"{groups} distinct frames are too few to compare settings: label more frames."
    if not set_splits(search):
        yield "The scores do not show the quality with another camera or at another place."


def _changes(before: Method, after: Method) -> Table:
    old, new = dict(_flat(before.parameters)), dict(_flat(after.parameters))
    names = [name for name in {**old, **new} if old.get(name) != new.get(name) and name != "name"]
    rows = [[Cell(name), Cell(_text(old.get(name))), Cell(_text(new.get(name)))] for name in names]
    return Table(("parameter", "start", "fitted"), rows)


def _flat(values: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in values.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def _text(value: Any) -> str:
    return NONE if value is None else f"{value}"


def _toml(method: Method) -> str:
    if isinstance(method, Toscana2016):
        return method.config.to_toml()
    import tomli_w

    return tomli_w.dumps(_without_none(method.parameters))


def _without_none(values: Mapping[str, Any]) -> dict[str, Any]:
    return {k: _without_none(v) if isinstance(v, Mapping) else v for k, v in values.items() if v is not None}
