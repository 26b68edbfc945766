"""Report on the accuracy and CPU time of segmentation methods."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from spigolo.frames.files import write_bytes
from spigolo.lab.datasets import Entry
from spigolo.lab.evaluation.resampling import DRAWS, SEED
from spigolo.lab.evaluation.rows import Row
from spigolo.lab.experiments.contenders import Contender, find_references, pair_up
from spigolo.lab.experiments.limitations import limitations
from spigolo.lab.experiments.pictures import Tell, draw_worst
from spigolo.lab.experiments.tables import FEW_GROUPS, change_table, pooled_table, rejection_table, set_table
from spigolo.lab.page import Block, Gallery, Heading, Items, Page, Paragraph, to_html, to_markdown
from spigolo.methods import METHODS

HTML, MARKDOWN = "index.html", "report.md"


def write_report(
    contenders: Sequence[Contender],
    out: Path,
    frames: Sequence[Entry] = (),
    against: str | None = None,
    tell: Tell | None = None,
) -> None:
    """Write a report as index.html and report.md into the folder `out`, with images of the frames that have the lowest
    scores.

    Raises ConfigError if no method matches `against`. Raises FileError if a file cannot be written.

    Parameters
    ----------
    contenders
        Scores of the methods to compare.
    out
        Folder to write to.
    frames
        Frames to show as images in the report. Without frames, the report has no images.
    against
        Name of the reference method, see `find_references`.
    tell
        Progress callback. The arguments of the callback are the number of finished images and the number of all images
        of one method.

    """
    references = find_references(contenders, against)
    rows = [row for contender in contenders for row in contender.rows]
    blocks = [
        *_opening(contenders, rows),
        *_accuracy(contenders),
        *_differences(contenders, references),
        *_rejections(contenders),
        *_worst(contenders, frames, out, tell),
        Heading("How to read this"),
        Items(_explanations()),
        Heading("Limitations"),
        Items(limitations(contenders)),
    ]
    page = Page("Objects found in labelled RGB-D frames", blocks)
    write_bytes(out / HTML, to_html(page).encode())
    write_bytes(out / MARKDOWN, to_markdown(page).encode())


def _preset(contender: Contender) -> str:
    name = contender.rows[0].preset
    return f" with preset {name}" if name else ""


def _opening(contenders: Sequence[Contender], rows: Sequence[Row]) -> list[Block]:
    frames = {(row.data_set, row.frame) for row in rows}
    sets = {data_set for data_set, _ in frames}
    what = [f"{c.label}: {c.rows[0].method}{_preset(c)}, digest {c.rows[0].digest}" for c in contenders]
    machines = sorted({f"spigolo {row.version} on {row.machine}" for row in rows})
    return [Paragraph(f"{len(frames)} frames of {len(sets)} data sets."), Items([*what, *machines])]


def _accuracy(contenders: Sequence[Contender]) -> list[Block]:
    pooled = pooled_table(contenders)
    together: list[Block] = [Heading("Accuracy and time, all data sets together"), pooled] if pooled.rows else []
    return [*together, Heading("Accuracy and time, by data set"), set_table(contenders)]


def _differences(contenders: Sequence[Contender], references: Sequence[Contender]) -> list[Block]:
    pairs = pair_up(contenders, references)
    table = change_table(pairs)
    if not table.rows:
        return []
    return [
        Heading(f"Differences to {' and '.join(c.label for c in references)}"),
        Paragraph(
            "Differences on the frames that both methods have, with a paired 95 % interval. Bold: the interval does not"
            f" include zero, on at least {FEW_GROUPS} distinct frames. Among many intervals, some exclude zero by"
            " chance."
        ),
        table,
    ]


def _rejections(contenders: Sequence[Contender]) -> list[Block]:
    table = rejection_table(contenders)
    return [Heading("Rejected regions per frame, by reason"), table] if len(table.head) > 1 else []


def _worst(contenders: Sequence[Contender], frames: Sequence[Entry], out: Path, tell: Tell | None) -> list[Block]:
    if not frames:
        return []
    folders = {(frame.data_set, frame.name): frame for frame in frames}
    galleries: list[Block] = []
    for contender in contenders:
        pictures = draw_worst(contender, folders, out, tell)
        if pictures:
            unfolded = not any(isinstance(block, Gallery) for block in galleries)
            galleries.append(Gallery(f"{contender.label}: the {len(pictures)} worst frames", pictures, unfolded))
        else:
            galleries.append(Paragraph(f"{contender.label}: no images, because {_why_none(contender, folders)}."))
    return [
        Heading("Worst frames"),
        Paragraph(
            "Frames with the lowest overlap F if every object is labelled, otherwise with the lowest overlap recall. Of"
            " near-identical frames, only the worst is shown. Left: the predicted objects. Right: the labelled objects,"
            " green if a predicted object has IoU above 0.7, otherwise red. Hatched: ignored pixels."
        ),
        *galleries,
    ]


def _why_none(contender: Contender, folders: dict[tuple[str, str], Entry]) -> str:
    if any((row.data_set, row.frame) in folders and row.score is not None for row in contender.rows):
        if contender.rows[0].method not in METHODS:
            return f"{contender.rows[0].method} is not in spigolo.METHODS and cannot be run again"
        return "this version of spigolo has no method with the digest of the results"
    return "the given folders contain none of the labelled frames"


def _explanations() -> list[str]:
    return [
        "Overlap: predicted and labelled objects are paired one to one, so that the sum of F is largest. P is the share"
        " of the predicted pixels inside the pairs, R the share of the labelled pixels. Boundary F: boundary pixels"
        " match within 0.003 of the image diagonal, rounded up to whole pixels. Both are means over frames. F@.75:"
        " share of the labelled objects with F above 0.75 in their pair, mean over frames.",
        "Found: share of all labelled objects with a predicted object of IoU above 0.7, with the count and Wilson's"
        " 95 % interval. In the regions: the same share before regions are rejected. False: predicted objects without a"
        " labelled object of IoU above 0.7.",
        "Near-identical frames count once: each frame has the weight 1 / (number of frames in its group), in means of"
        " scores and in counts of objects, but not in times.",
        f"Intervals of F and of differences: bootstrap over groups of near-identical frames, {DRAWS} draws with"
        f" replacement, seed {SEED}, percentiles 2.5 and 97.5. A single group has no interval.",
        "CPU time: time of one thread for one frame. The median over frames, and below the mean.",
        "– : the value cannot be measured on these frames.",
    ]
