"""Images of the frames with the lowest scores: prediction and ground truth side by side."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import cv2

from spigolo.errors import FileError, SpigoloError
from spigolo.frames.files import write_bytes
from spigolo.frames.frame import Color
from spigolo.lab.datasets import Entry, Truth
from spigolo.lab.evaluation.measures import FOUND_SHARE
from spigolo.lab.evaluation.rows import Row, RowScore, score_row
from spigolo.lab.experiments.contenders import Contender
from spigolo.lab.experiments.methods import remake
from spigolo.lab.page import Picture
from spigolo.methods import Method
from spigolo.objects.segmentation import Segmentation
from spigolo.view.overlay import tile
from spigolo.view.truth import truth_picture

WORST = 10
PICTURE_WIDTH_PX = 640
JPEG_QUALITY = 85
SAME_F = 1e-6
"""Two results of a frame count as equal if their overlap F differs by less than `SAME_F`."""

Tell = Callable[[int, int], None]


def goodness(row: Row) -> float:
    """Return the measure by which frames are sorted: overlap F for fully labelled frames, overlap recall for all other
    frames.
    """
    assert row.score is not None
    return row.score.overlap_f if row.labelling == "full" else row.score.overlap_recall


def worst_rows(rows: Sequence[Row]) -> list[Row]:
    """Return the evaluation results of the ten labelled frames with the lowest scores.

    Only one frame per group of near-identical frames is returned. Frames with an error are left out.
    """
    scored = (row for row in rows if row.score is not None and row.error is None)
    chosen: dict[str, Row] = {}
    for row in sorted(scored, key=lambda row: (goodness(row), row.key)):
        chosen.setdefault(row.group, row)
    return list(chosen.values())[:WORST]


def draw_worst(
    contender: Contender, folders: Mapping[tuple[str, str], Entry], out: Path, tell: Tell | None = None
) -> list[Picture]:
    """Segment the frames with the lowest scores again, and write images of prediction and ground truth to
    `out`/pictures.

    Parameters
    ----------
    contender
        Segmentation method with its scores.
    folders
        Frames, indexed by data set and name. Frames that are not in `folders` are left out. No images are written if
        this version of spigolo does not have the method or the parameters of `contender`.
    out
        Folder of the report.
    tell
        Progress callback. The arguments of the callback are the number of finished images and the number of all images.

    """
    rows = [row for row in worst_rows(contender.rows) if (row.data_set, row.frame) in folders]
    method = remake(rows[0]) if rows else None
    if method is None:
        return []
    pictures = []
    for number, row in enumerate(rows, start=1):
        pictures += _draw(number, row, method, folders[row.data_set, row.frame], contender.label, out)
        if tell is not None:
            tell(number, len(rows))
    return pictures


def _draw(number: int, row: Row, method: Method, folder: Entry, label: str, out: Path) -> list[Picture]:
    try:
        frame, truth = folder.read_both()
        result = method(frame)
    except SpigoloError:  # unreadable files give no picture
        return []
    if truth is None or row.score is None:
        return []
    score = score_row(truth.labels, result.labels, None, truth.ignore)
    name = f"pictures/{_file_name(label)}-{number:02d}-{_file_name(f'{row.data_set}-{row.frame}')}.jpg"
    _write_jpeg(out / name, _side_by_side(frame.color, result, truth, score))
    return [Picture(name, _caption(row, row.score, score))]


def _side_by_side(color: Color, result: Segmentation, truth: Truth, score: RowScore) -> Color:
    labels = sorted({int(k) for k in truth.labels.flat if k}) if truth.labels.size else []
    found = {label for label, iou in zip(labels, score.best_iou, strict=True) if iou > FOUND_SHARE}
    true = truth_picture(color, truth.labels, found, truth.ignore)
    pair = {
        f"predicted: {len(result)}": _scaled(result.overlay()),
        f"labelled: {len(labels)}, green = found": _scaled(true),
    }
    return tile(pair, columns=2)


def _scaled(picture: Color) -> Color:
    height = round(picture.shape[0] * PICTURE_WIDTH_PX / picture.shape[1])
    return cv2.resize(picture, (PICTURE_WIDTH_PX, height), interpolation=cv2.INTER_AREA)  # type: ignore[return-value]


def _caption(row: Row, then: RowScore, now: RowScore) -> str:
    figure = f"F {then.overlap_f:.2f}" if row.labelling == "full" else f"recall {then.overlap_recall:.2f}"
    found = f"{then.true_positives} of {then.n_objects} objects found"
    false = f", {then.false_positives} false" if row.labelling == "full" else ""
    changed = (
        ""
        if abs(then.overlap_f - now.overlap_f) < SAME_F
        else ". The image shows a new result, which differs from the scored result"
    )
    return f"{row.data_set}/{row.frame}: {figure}, {found}{false}{changed}"


def _write_jpeg(path: Path, picture: Color) -> None:
    done, data = cv2.imencode(
        ".jpg", cv2.cvtColor(picture, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY]
    )
    if not done:
        raise FileError(f"could not encode a picture of shape {picture.shape} for {path}")
    write_bytes(path, data.tobytes())


def _file_name(text: str) -> str:
    return re.sub(r"[^A-Za-z0-9]+", "-", text).strip("-")
