"""Evaluation in two steps: rows that go on where they stopped, and the page made of them."""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import spigolo as sp
from spigolo.batch import dask_local
from spigolo.batch.engine import one_thread
from spigolo.errors import ConfigError, FileError, FrameError, SpigoloError
from spigolo.lab.evaluation import (
    Row,
    RowFile,
    RowScore,
    bootstrap,
    compare,
    folds,
    leave_one_set_out,
    pool,
    read_rows,
    row_to_json,
    score_frame,
    score_row,
    summarise,
    wilson_interval,
)
from spigolo.lab.experiments import (
    Toscana2016,
    evaluate,
    find_labelled_frames,
    find_references,
    gather,
    make_methods,
    read_contenders,
    remake,
    write_report,
)
from spigolo.lab.experiments.contenders import pair_up
from spigolo.lab.experiments.limitations import limitations
from spigolo.lab.experiments.pictures import WORST, worst_rows
from spigolo.lab.page import Cell, Gallery, Page, Picture, Table, to_html, to_markdown, to_text
from spigolo.view.truth import FOUND, MISSED, truth_picture
from test_objects import scene

SETS = ("osd-small", "shop")
LARGE = {"max_lambda1_px2": 20000.0, "max_lambda2_px2": 15000.0}
BOXES = sp.TABLE.replace(name="BOXES", rejection=LARGE)
"""Finds both boxes; TABLE rejects them as too large."""


class Counting:
    """A method that counts its runs; it answers as ours does."""

    name, preset, digest = "counting", "", "0"
    parameters: Mapping[str, Any] = {}

    def __init__(self) -> None:
        self.runs: list[str] = []
        self.fails_on: set[int] = set()

    def __call__(self, frame: sp.Frame) -> sp.Segmentation:
        self.runs.append(frame.name)
        if int(frame.depth[0, 0] * 1000) in self.fails_on:
            raise FrameError("expected a frame to like, got this one")
        return sp.segment(frame, BOXES)


class Deadly(Counting):
    """Kills its process on a frame."""

    def __call__(self, frame: sp.Frame) -> sp.Segmentation:
        if int(frame.depth[0, 0] * 1000) == 903:
            os.kill(os.getpid(), signal.SIGKILL)
        return super().__call__(frame)


@pytest.fixture
def counting(monkeypatch: pytest.MonkeyPatch) -> Counting:
    method = Counting()
    monkeypatch.setitem(sp.METHODS, "counting", method)
    return method


def write_frame(folder: Path, shift: int, truth: bool = True) -> None:
    frame = scene()
    folder.mkdir(parents=True)
    color, depth = np.roll(frame.color, shift, axis=1), np.roll(frame.depth, shift, axis=1)
    stored = np.round(depth * 1000).astype(np.uint16)
    stored[0, 0] = 900 + shift
    cv2.imwrite(str(folder / "rgb.png"), color[..., ::-1])
    cv2.imwrite(str(folder / "depth.png"), stored)
    if truth:
        labels = np.zeros(frame.shape, np.uint8)
        labels[30:80, 20:60], labels[40:90, 90:140] = 1, 7
        labels = np.roll(labels, shift, axis=1)
        labels[:4] = 255
        cv2.imwrite(str(folder / "label.png"), labels)
    k = frame.camera
    camera = {n: getattr(k, n) for n in ("fx", "fy", "cx", "cy", "width", "height")} | {"depth_scale": 0.001}
    (folder / "camera.json").write_text(json.dumps(camera))


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """Two sets of three frames; two of the second are near-identical, one there has no labels."""
    folder = tmp_path / "frames"
    for k in range(3):
        write_frame(folder / SETS[0] / f"f{k}", 3 * k)
        write_frame(folder / SETS[1] / f"f{k}", 3 * k + 1, truth=k < 2)
    (folder / "splits.json").write_text(json.dumps({"near_duplicate_groups": [["shop/f0", "shop/f1"]]}))
    return folder


def row(frame: str = "a", **changes: Any) -> Row:
    """A row of two objects, one of them found."""
    score = RowScore(
        overlap_precision=0.5, overlap_recall=0.6, overlap_f=0.55, boundary_precision=0.3, boundary_recall=0.4,
        boundary_f=0.35, f75=0.5, n_objects=2, n_segments=3, best_iou=(0.9, 0.2), best_iou_of_regions=(0.9, 0.8),
        true_positives=1, false_positives=2, false_negatives=1, found_70_recall=2, found_70_both=1, pieces=3, leaks=0.5,
    )  # fmt: skip
    values: dict[str, Any] = {
        "data_set": "s", "frame": frame, "group": f"s/{frame}", "labelling": "full", "method": "m", "preset": "P",
        "digest": "d", "parameters": {}, "version": "1", "machine": "one", "cpu_s": 0.1, "wall_s": 0.2,
        "n_predicted": 3, "rejected": {"dark": 1}, "score": score,
    }  # fmt: skip
    score_changes = {key: changes.pop(key) for key in list(changes) if key in RowScore.__dataclass_fields__}
    return Row(**(values | {"score": replace(score, **score_changes)} | changes))


# --- frames -------------------------------------------------------------------------------------------------


def test_a_root_a_set_and_a_frame_are_all_found(root: Path) -> None:
    frames = find_labelled_frames([root])
    assert [(f.data_set, f.name) for f in frames] == [(s, f"f{k}") for s in SETS for k in range(3)]
    assert [f.labelling for f in frames] == ["full"] * 3 + ["part", "part", "none"]
    assert [f.group for f in frames[3:]] == ["shop/f0", "shop/f0", "shop/f2"]
    assert find_labelled_frames([root / "shop"]) == frames[3:]
    assert find_labelled_frames([root / "shop" / "f1", root / "shop"]) == frames[3:]
    assert [f.labelling for f in find_labelled_frames([root / "shop"], full=["sh*"])] == ["full", "full", "none"]
    truth = frames[0].read_truth()
    assert truth is not None and truth.ignore[:4].all() and not truth.ignore[4:].any()
    assert np.unique(truth.labels).tolist() == [0, 1, 7]


def test_info_says_what_is_labelled_and_ignored(root: Path) -> None:
    (root / "shop" / "f0" / "info.json").write_text('{"fully_labelled": true, "ignore_label": 1}')
    frame = find_labelled_frames([root / "shop" / "f0"])[0]
    assert (frame.labelling, frame.ignore_label) == ("full", 1)


@pytest.mark.parametrize(
    ("info", "words"),
    [
        ('{"fully_labelled": "no"}', "expected true or false as fully_labelled in .*, got 'no'"),
        ('{"ignore_label": true}', "expected a label as ignore_label in .*, got True"),
    ],
)
def test_info_of_another_type_is_refused(root: Path, info: str, words: str) -> None:
    (root / "shop" / "f0" / "info.json").write_text(info)
    with pytest.raises(FileError, match=words):
        find_labelled_frames([root])


def test_info_may_ignore_the_background_and_begin_with_a_byte_order_mark(root: Path) -> None:
    (root / "shop" / "f0" / "info.json").write_text('{"ignore_label": 0}', encoding="utf-8-sig")
    assert find_labelled_frames([root / "shop" / "f0"])[0].ignore_label == 0


def test_groups_of_missing_frames_are_reported(root: Path) -> None:
    for name in ("f1", "shop/f9"):
        (root / "splits.json").write_text(json.dumps({"near_duplicate_groups": [["shop/f0", name]]}))
        with pytest.warns(UserWarning, match=f"names {name}, but there is no such frame"):
            find_labelled_frames([root])
    (root / "splits.json").write_text(json.dumps({"near_duplicate_groups": [["elsewhere/f0", "elsewhere/f1"]]}))
    assert find_labelled_frames([root])[0].group == "osd-small/f0"  # of a set that was not copied


def test_labels_are_undistorted_as_the_images_are(root: Path) -> None:
    """They are drawn on the image as it is stored: seen through the same lens they fit the frame again."""
    entry = find_labelled_frames([root / "shop" / "f0"])[0]
    straight = entry.read_truth()
    camera = json.loads((entry.folder / "camera.json").read_text()) | {"distortion": [3.0, 0, 0, 0]}
    (entry.folder / "camera.json").write_text(json.dumps(camera))
    frame, truth = entry.read_both()
    assert frame.undistorted and straight is not None and truth is not None
    lens = sp.Camera(**{k: v for k, v in camera.items() if k != "depth_scale"})
    stored = cv2.imread(str(entry.folder / "label.png"), cv2.IMREAD_UNCHANGED)
    seen = lens.undistort(np.ones(stored.shape, np.uint8), nearest=True) > 0
    bent = lens.undistort(stored, nearest=True)
    assert np.array_equal(truth.ignore, ~seen | (bent == 255)) and not seen.all()
    assert np.array_equal(truth.labels, np.where(truth.ignore, 0, bent))
    assert not np.array_equal(truth.labels, straight.labels)


def test_folders_that_hold_no_frames_are_refused(root: Path, tmp_path: Path) -> None:
    with pytest.raises(FileError, match="there is no folder"):
        find_labelled_frames([tmp_path / "nowhere"])
    (tmp_path / "empty").mkdir()
    with pytest.raises(FileError, match="got none: give a root"):
        find_labelled_frames([tmp_path / "empty"])
    write_frame(tmp_path / "other" / "shop" / "f0", 0)
    with pytest.raises(FileError, match="rename one of the data sets"):
        find_labelled_frames([root, tmp_path / "other"])
    (root / "splits.json").write_text("{")
    with pytest.raises(FileError, match="expected JSON in"):
        find_labelled_frames([root])


def test_labels_of_another_size_are_refused(root: Path) -> None:
    cv2.imwrite(str(root / "shop" / "f0" / "label.png"), np.zeros((5, 7), np.uint8))
    entry = find_labelled_frames([root / "shop" / "f0"])[0]
    camera = json.loads((entry.folder / "camera.json").read_text())
    for more in ({}, {"distortion": [0.1, 0, 0, 0]}):
        (entry.folder / "camera.json").write_text(json.dumps(camera | more))
        with pytest.raises(FrameError, match=r"expected labels of \d+ x \d+ pixels .* got 7 x 5"):
            entry.read_both()


# --- rows ---------------------------------------------------------------------------------------------------


def test_a_row_reads_back_as_it_was_written(tmp_path: Path) -> None:
    rows = [row("a"), row("b", score=None, error="why", cpu_s=None), row("c", rejected={})]
    with RowFile(tmp_path / "new" / "rows.jsonl") as file:
        for one in rows:
            file.append(one)
            assert read_rows(file.path)[-1] == one  # on the disk at once
    assert read_rows(tmp_path / "new" / "rows.jsonl") == rows
    assert all(json.loads(row_to_json(one))["data_set"] == "s" for one in rows)


def test_a_line_keeps_its_form_so_that_files_of_old_can_be_gone_on_with() -> None:
    assert row_to_json(row()) == (
        '{"data_set":"s","frame":"a","group":"s/a","labelling":"full","method":"m","preset":"P","digest":"d",'
        '"parameters":{},"version":"1","machine":"one","cpu_s":0.1,"wall_s":0.2,"n_predicted":3,"rejected":{"dark":1},'
        '"score":{"overlap_precision":0.5,"overlap_recall":0.6,"overlap_f":0.55,"boundary_precision":0.3,'
        '"boundary_recall":0.4,"boundary_f":0.35,"f75":0.5,"n_objects":2,"n_segments":3,"best_iou":[0.9,0.2],'
        '"best_iou_of_regions":[0.9,0.8],"true_positives":1,"false_positives":2,"false_negatives":1,'
        '"found_70_recall":2,"found_70_both":1,"pieces":3,"leaks":0.5,"covered":[],"covered_by_regions":[],'
        '"names":[]},"error":null,"content":""}'
    )


def test_a_half_written_line_is_dropped_and_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "rows.jsonl"
    path.write_text(f"{row_to_json(row('a'))}\n{row_to_json(row('b'))[:40]}")
    assert [one.frame for one in read_rows(path)] == ["a"]
    with RowFile(path) as file:
        file.append(row("c"))
    assert [one.frame for one in read_rows(path)] == ["a", "c"]


@pytest.mark.parametrize("content", ["hello\n", '{"data_set": 3}\n', "[1]\n", "\n"])
def test_a_file_of_something_else_is_refused_and_left_alone(tmp_path: Path, content: str) -> None:
    path = tmp_path / "rows.jsonl"
    path.write_text(f"{row_to_json(row())}\n{content}half")
    before = path.read_bytes()
    with pytest.raises(FileError, match=r"expected a row .* in line 2 of .*: "):
        RowFile(path)
    assert path.read_bytes() == before


def test_a_row_has_the_score_of_score_frame_and_counts_of_regions() -> None:
    truth = np.zeros((20, 20), int)
    truth[2:10, 2:10], truth[2:10, 12:18] = 1, 5
    regions = truth + 1
    prediction = np.where(truth == 5, 3, 0)
    prediction[15:, :] = 4
    ignore = np.zeros(truth.shape, bool)
    ignore[18:] = True
    score, frame = score_row(truth, prediction, regions, ignore), score_frame(truth, prediction, ignore)
    assert (score.overlap_f, score.boundary_f, score.f75) == (frame.overlap_f, frame.boundary_f, frame.f75)
    assert score.best_iou == (0, 1) and score.best_iou_of_regions == (1, 1)
    assert (score.true_positives, score.false_positives, score.false_negatives) == (1, 1, 1)


# --- running ------------------------------------------------------------------------------------------------


def test_nothing_is_evaluated_twice_and_a_cut_run_goes_on(root: Path, tmp_path: Path, counting: Counting) -> None:
    frames, path = find_labelled_frames([root]), tmp_path / "rows.jsonl"
    told: list[tuple[int, int]] = []
    rows = evaluate(frames, [counting], path, tell=lambda done, total, _: told.append((done, total)))
    assert told == [(k, 6) for k in range(7)]
    assert len(counting.runs) == 7  # the first once more, before it is timed
    assert read_rows(path) == rows and len(rows) == 6
    assert evaluate(frames, [counting], path) == rows
    assert len(counting.runs) == 7
    whole = path.read_bytes()
    path.write_bytes(whole[:-30])
    again = evaluate(frames, [counting], path)
    assert len(counting.runs) == 9
    assert [one.key for one in again] == [one.key for one in rows]
    assert path.read_bytes().splitlines()[:5] == whole.splitlines()[:5] and len(read_rows(path)) == 6


def test_rows_of_another_version_are_computed_again(root: Path, tmp_path: Path, counting: Counting) -> None:
    frames, path = find_labelled_frames([root]), tmp_path / "rows.jsonl"
    rows = evaluate(frames, [counting], path)
    path.write_text(path.read_text().replace(f'"version":"{sp.__version__}"', '"version":"0.0.1"', 2))
    before = len(counting.runs)
    assert [row.version for row in evaluate(frames, [counting], path)] == [sp.__version__] * len(rows)
    assert len(counting.runs) == before + 3  # the first once more, before it is timed
    assert len(read_rows(path)) == len(rows)


def test_rows_of_another_frame_of_that_name_are_not_taken(root: Path, tmp_path: Path) -> None:
    frames, path = find_labelled_frames([root / "osd-small"]), tmp_path / "rows.jsonl"
    evaluate(frames, make_methods(["felzenszwalb2004"], []), path)
    label = frames[0].files[-1]
    cv2.imwrite(str(label), 0 * cv2.imread(str(label), cv2.IMREAD_UNCHANGED))
    with pytest.raises(FileError, match="got another frame of that name, or another ignored label: give another --out"):
        evaluate(frames, make_methods(["rao2010"], []), path)


def test_rows_scored_with_another_ignored_label_are_not_taken(root: Path, tmp_path: Path, counting: Counting) -> None:
    path, info = tmp_path / "rows.jsonl", root / "shop" / "f0" / "info.json"
    rows = evaluate(find_labelled_frames([root / "shop" / "f0"]), [counting], path)
    info.write_text('{"ignore_label": 255, "notes": "the usual"}')
    assert evaluate(find_labelled_frames([root / "shop" / "f0"]), [counting], path) == rows
    info.write_text('{"ignore_label": 1}')
    with pytest.raises(FileError, match="got another frame of that name, or another ignored label: give another --out"):
        evaluate(find_labelled_frames([root / "shop" / "f0"]), [counting], path)


def test_the_error_of_a_frame_that_is_gone_stays(root: Path, tmp_path: Path, counting: Counting) -> None:
    path, depth = tmp_path / "rows.jsonl", root / "osd-small" / "f2" / "depth.png"
    depth.write_bytes(b"")
    frames = find_labelled_frames([root / "osd-small"])
    rows = evaluate(frames, [counting], path)
    depth.unlink()
    assert evaluate(frames, [counting], path)[:2] == rows[:2]
    assert [one.error is None for one in read_rows(path)] == [True, True, False]


def test_rows_follow_the_group_and_labelling_of_their_frames(root: Path, tmp_path: Path, counting: Counting) -> None:
    path, runs = tmp_path / "rows.jsonl", 0
    for full, labelling in ((["osd-*"], "part"), (["osd-*", "shop"], "full")):
        rows = evaluate(find_labelled_frames([root], full), [counting], path)
        assert [one.labelling for one in rows[3:]] == [labelling, labelling, "none"]
        assert read_rows(path) == rows
        runs = runs or len(counting.runs)
    (root / "splits.json").write_text(json.dumps({"near_duplicate_groups": [["shop/f0", "shop/f2"]]}))
    rows = evaluate(find_labelled_frames([root]), [counting], path)
    assert [one.group for one in read_rows(path)[3:]] == ["shop/f0", "shop/f1", "shop/f0"]
    unchanged = path.stat().st_ino
    evaluate(find_labelled_frames([root]), [counting], path)
    assert path.stat().st_ino == unchanged
    assert len(counting.runs) == runs  # nothing was run again


def test_rows_without_a_checksum_are_kept_and_stay_unscored(root: Path, tmp_path: Path, counting: Counting) -> None:
    """As older versions wrote them: whether their frame had labels is not known, nor whether it is another one."""
    frames, path = find_labelled_frames([root / "shop" / "f0"]), tmp_path / "rows.jsonl"
    (made,) = evaluate(frames, [counting], path)
    old = replace(made, content="", labelling="none", score=None, group="elsewhere")
    path.write_text(f"{row_to_json(old)}\n")
    runs = len(counting.runs)
    assert evaluate(frames, [counting], path) == [replace(old, group=made.group)] == read_rows(path)
    assert len(counting.runs) == runs


def test_a_frame_that_was_mended_is_evaluated_again(root: Path, tmp_path: Path, counting: Counting) -> None:
    path, depth = tmp_path / "rows.jsonl", root / "osd-small" / "f2" / "depth.png"
    whole = depth.read_bytes()
    depth.write_bytes(b"")
    frames = find_labelled_frames([root / "osd-small"])
    for done in (3, 0):
        told: list[int] = []
        rows = evaluate(frames, [counting], path, tell=lambda _, total, __, told=told: told.append(total))  # type: ignore[misc]
        assert [one.error is None for one in rows] == [True, True, False]
        assert set(told) == {done}
    runs = len(counting.runs)
    depth.write_bytes(whole)
    assert [one.error for one in evaluate(frames, [counting], path)] == [None] * 3 == [r.error for r in read_rows(path)]
    assert len(counting.runs) == runs + 2  # once untimed


def test_a_method_that_answers_with_labels_alone_is_reported(
    root: Path, tmp_path: Path, counting: Counting, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Counting, "__call__", lambda self, frame: np.zeros(frame.shape, int))
    (one,) = evaluate(find_labelled_frames([root / "shop" / "f0"]), [counting], tmp_path / "rows.jsonl")
    assert one.error == "expected a Segmentation from counting, got ndarray: build one"


def test_a_frame_that_is_gone_is_not_another_one(root: Path, tmp_path: Path, counting: Counting) -> None:
    frames = find_labelled_frames([root / "osd-small"])
    evaluate(frames, [counting], tmp_path / "rows.jsonl")
    frames[0].files[0].unlink()
    with pytest.raises(FileError, match=r"expected .*rgb.png, but the file cannot be read"):
        evaluate(frames, [counting], tmp_path / "rows.jsonl")


def test_a_row_says_what_was_found(root: Path, tmp_path: Path) -> None:
    frames = find_labelled_frames([root])
    made = make_methods(["toscana2016", "toscana2016"], [BOXES, sp.TABLE, BOXES])
    rows = evaluate(frames, made, tmp_path / "rows.jsonl")
    assert len(rows) == 12
    assert {(one.method, one.preset) for one in rows} == {("toscana2016", "BOXES"), ("toscana2016", "TABLE")}
    for one in rows:
        frame, truth = next(f for f in frames if (f.data_set, f.name) == one.key[:2]).read_both()
        config = sp.Config(**one.parameters)
        assert config.digest == one.digest
        result = sp.segment(frame, config)
        assert one.n_predicted == len(result) and sum(one.rejected.values()) == len(result.rejected)
        assert one.cpu_s is not None and one.cpu_s >= 0 and one.wall_s is not None and one.wall_s > 0
        assert one.error is None and one.version == sp.__version__ and "python" in one.machine
        if truth is None:
            assert one.score is None
        else:
            assert one.score is not None
            expected = score_frame(truth.labels, result.labels, truth.ignore)
            assert one.score.overlap_f == expected.overlap_f
            assert one.score.true_positives == (2 if one.preset == "BOXES" else 0)
            assert one.score.best_iou == tuple(expected.best_iou)
            assert all(r >= o for r, o in zip(one.score.best_iou_of_regions, one.score.best_iou, strict=True))


def test_worker_processes_give_the_same_rows_in_the_same_order(root: Path, tmp_path: Path) -> None:
    frames, made = find_labelled_frames([root]), make_methods(["toscana2016"], [BOXES, sp.TABLE])
    one, two = (evaluate(frames, made, tmp_path / f"{jobs}.jsonl", jobs) for jobs in (1, 2))
    untimed = [[replace(r, cpu_s=None, wall_s=None) for r in rows] for rows in (one, two)]
    assert untimed[0] == untimed[1]
    assert [r.key for r in read_rows(tmp_path / "2.jsonl")] == [r.key for r in one]


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGKILL")
def test_a_task_that_kills_its_worker_becomes_a_row_that_is_tried_again(
    root: Path, tmp_path: Path, counting: Counting
) -> None:
    frames, out = find_labelled_frames([root / "osd-small"]), tmp_path / "rows.jsonl"
    first, lost, last = evaluate(frames, [Deadly()], out, jobs=2)
    assert first.error is None and last.error is None
    assert lost.error is not None and "worker process died" in lost.error
    assert lost.score is not None and lost.score.true_positives == 0 < lost.score.n_objects
    again = evaluate(frames, [counting], out)
    assert len(counting.runs) == 2  # once to warm up, once timed
    assert again[0] == first and again[1].error is None and again[2] == last


@pytest.mark.filterwarnings("default")
def test_a_cluster_gives_the_same_rows(root: Path, tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    frames, made = find_labelled_frames([root]), make_methods(["toscana2016"], [BOXES])
    engines = {"here": None, "cluster": dask_local(1)}
    one, two = (evaluate(frames, made, tmp_path / name, engine=engine) for name, engine in engines.items())
    assert [replace(r, cpu_s=None, wall_s=None) for r in one] == [replace(r, cpu_s=None, wall_s=None) for r in two]


def test_a_method_that_fails_has_found_nothing(root: Path, tmp_path: Path, counting: Counting) -> None:
    counting.fails_on = {903}
    (root / "osd-small" / "f2" / "depth.png").write_bytes(b"")
    rows = evaluate(find_labelled_frames([root / "osd-small"]), [counting], tmp_path / "rows.jsonl")
    assert [one.error and one.error.split(",")[0] for one in rows][:2] == [None, "expected a frame to like"]
    failed, unread = rows[1], rows[2]
    assert failed.score is not None and failed.score.overlap_f == 0 and failed.score.true_positives == 0
    assert failed.score.n_objects == failed.score.false_negatives == 2
    assert (failed.n_predicted, failed.cpu_s, failed.rejected) == (0, None, {})
    assert unread.error is not None and "0 bytes" in unread.error
    assert unread.score is not None and unread.score.true_positives == 0 < unread.score.n_objects
    assert pool(rows).n_failed == 2


@pytest.mark.parametrize("name", ["label.png", "rgb.png", "camera.json"])
def test_a_frame_that_cannot_be_read_becomes_a_row(name: str, root: Path, tmp_path: Path, counting: Counting) -> None:
    entries = find_labelled_frames([root / "osd-small"])
    file = root / "osd-small" / "f2" / name
    file.unlink()
    file.mkdir()  # neither read nor summed up
    row = evaluate(entries, [counting], tmp_path / "rows.jsonl")[2]
    assert row.error is not None and row.content == ""
    assert (row.score is None) == (name == "label.png")


def test_jobs_and_methods_that_cannot_be_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="unknown method 'nothing': expected one of toscana2016"):
        make_methods(["nothing"], [])
    with pytest.raises(SpigoloError, match="at least one job, got 0"):
        evaluate([], [], tmp_path / "rows.jsonl", jobs=0)


def test_a_method_is_made_again_from_its_row_or_not_at_all(root: Path, tmp_path: Path) -> None:
    config = sp.TABLE.replace(partition={"gamma": 0.01})
    one = evaluate(find_labelled_frames([root / "shop" / "f0"]), [Toscana2016(config)], tmp_path / "rows.jsonl")[0]
    again = remake(one)
    assert again is not None and again.digest == config.digest
    assert remake(replace(one, digest="0")) is None
    assert remake(replace(one, method="gone")) is None
    assert remake(replace(one, parameters={"gone": 1})) is None


# --- pooling ------------------------------------------------------------------------------------------------


def test_pooled_figures_are_those_worked_by_hand() -> None:
    alike = {"group": "g"}
    rows = [
        row("a", overlap_f=0.9, n_objects=4, true_positives=4, false_positives=0, cpu_s=0.1),
        row("b", overlap_f=0.2, n_objects=2, true_positives=0, false_positives=3, cpu_s=0.2, **alike),
        row("c", overlap_f=0.4, n_objects=2, true_positives=1, false_positives=1, cpu_s=0.6, **alike),
    ]
    total = pool(rows)
    assert (total.n_frames, total.n_groups, total.n_failed, total.n_predicted) == (3, 2, 0, 3)
    assert total.overlap_f.value == pytest.approx((0.9 + 0.3) / 2)
    assert total.overlap_f.low == pytest.approx(0.3) and total.overlap_f.high == pytest.approx(0.9)
    assert (total.n_objects, total.true_positives, total.false_positives) == (6, 4.5, 2)
    assert total.found.value == 0.75
    assert (total.found.low, total.found.high) == wilson_interval(4.5, 6)
    assert total.best_iou == pytest.approx((1.1 + 1.1) / 6)
    assert total.found_in_regions == pytest.approx((2 + 2) / 6)
    assert total.cpu_median_s == 0.2 and total.cpu_mean_s == pytest.approx(0.3)


def test_frames_unlike_all_others_pool_as_summarise_does() -> None:
    rng = np.random.default_rng(0)
    pairs = [rng.integers(0, 4, (2, 6, 6)) for _ in range(5)]
    rows = [row(str(k), score=score_row(*pair)) for k, pair in enumerate(pairs)]
    ours, theirs = pool(rows), summarise([score_frame(*pair) for pair in pairs])
    assert ours.overlap_f.value == pytest.approx(theirs.overlap_f)
    assert ours.boundary_precision == pytest.approx(theirs.boundary_precision)
    assert ours.f75 == pytest.approx(theirs.f75) and ours.best_iou == pytest.approx(theirs.best_iou)
    assert ours.found.value == pytest.approx(theirs.found_iou_70) and ours.n_objects == theirs.n_objects


def test_partly_labelled_frames_show_no_precision_and_unlabelled_ones_nothing() -> None:
    part = pool([row("a"), row("b", labelling="part")])
    assert math.isnan(part.overlap_precision) and math.isnan(part.overlap_f.value) and math.isnan(part.boundary_f)
    assert math.isnan(part.false_positives)
    assert (part.overlap_recall, part.f75, part.found.value) == (0.6, 0.5, 0.5)
    none = pool([row("a", labelling="none", score=None)])
    assert math.isnan(none.found.value) and math.isnan(none.f75) and none.n_objects == 0
    assert none.n_predicted == 3 and none.cpu_median_s == 0.1


def test_rows_of_several_methods_do_not_pool() -> None:
    with pytest.raises(ValueError, match="one row per frame, got 2 of s/a: "):
        pool([row("a"), row("a", digest="e")])
    with pytest.raises(ValueError, match="got none: "):
        pool([])


def test_a_comparison_is_paired_and_over_groups() -> None:
    before = [row(str(k), overlap_f=0.1 * k, true_positives=0) for k in range(6)]
    after = [row(str(k), overlap_f=0.1 * k + 0.05, cpu_s=0.05) for k in range(1, 8)]
    change = compare(before, after)
    assert (change.n_frames, change.n_groups) == (5, 5)
    assert tuple(change.overlap_f) == pytest.approx((0.05, 0.05, 0.05))  # the same everywhere, whatever is drawn
    assert tuple(change.found) == pytest.approx((0.5, 0.5, 0.5))
    assert change.cpu_ratio == pytest.approx(0.5)
    alike = [replace(one, group="g") if one.frame in "12" else one for one in after]
    assert compare(before, alike).n_groups == 4
    assert math.isnan(compare(before, [replace(one, labelling="part") for one in after]).overlap_f.value)


# --- intervals and splits -----------------------------------------------------------------------------------


def test_wilson_interval_of_counts_that_are_not_whole() -> None:
    assert wilson_interval(81, 263) == pytest.approx((0.2553, 0.3662), abs=5e-5)
    assert wilson_interval(4, 6)[0] < wilson_interval(4.5, 6)[0] < wilson_interval(5, 6)[0]


def test_a_bootstrap_knows_its_mean_and_its_spread() -> None:
    values = np.random.default_rng(1).normal(0.5, 0.1, 400)
    estimate = bootstrap(values)
    assert estimate.value == pytest.approx(values.mean())
    assert estimate.high - estimate.low == pytest.approx(2 * 1.96 * 0.1 / 20, rel=0.15)
    assert bootstrap(values) == estimate and bootstrap(values, seed=1) != estimate
    assert bootstrap([1, 0], [3, 1]).value == 0.75
    assert bootstrap([1, 0], [1, 0]).value == 1
    assert bootstrap([0.3]).value == 0.3 and math.isnan(bootstrap([0.3]).low)
    assert math.isnan(bootstrap([]).value)
    with pytest.raises(ValueError, match="one value and one weight"):
        bootstrap([1, 2], [1])


@given(groups=st.lists(st.integers(0, 9), min_size=2, max_size=40), k=st.integers(2, 5), seed=st.integers(0, 3))
def test_folds_keep_groups_together_and_leave_each_frame_out_once(groups: list[int], k: int, seed: int) -> None:
    if len(set(groups)) < k:
        with pytest.raises(ValueError, match=r"expected 2 to .* folds .*: "):
            folds(groups, k, seed)
        return
    splits = folds(groups, k, seed)
    assert len(splits) == k and all(len(split.outside) for split in splits)
    assert sorted(np.concatenate([split.outside for split in splits])) == list(range(len(groups)))
    for split in splits:
        assert not {groups[i] for i in split.inside} & {groups[i] for i in split.outside}
        assert len(split.inside) + len(split.outside) == len(groups)


def test_folds_are_alike_in_size_and_follow_the_seed() -> None:
    assert sorted(len(split.outside) for split in folds(range(23), 5)) == [4, 4, 5, 5, 5]
    first, again, other = (folds(range(23), 5, seed)[0].outside.tolist() for seed in (0, 0, 1))
    assert first == again != other


def test_a_set_left_out_takes_frames_like_its_own_with_it() -> None:
    splits = leave_one_set_out(["b", "a", "a", "b"], ["1", "1", "2", "3"])
    assert [split.name for split in splits] == ["a", "b"]
    assert [split.outside.tolist() for split in splits] == [[1, 2], [0, 3]]
    assert [split.inside.tolist() for split in splits] == [[3], [2]]
    assert leave_one_set_out(["b", "a"])[0].inside.tolist() == [0]
    with pytest.raises(ValueError, match="two data sets"):
        leave_one_set_out(["a"])
    with pytest.raises(ValueError, match="one group per frame"):
        leave_one_set_out(["a", "b"], ["1"])


# --- contenders ---------------------------------------------------------------------------------------------


def test_files_of_the_same_frames_are_two_contenders_of_other_frames_one() -> None:
    old, new, more = [row("a"), row("b")], [row("a"), row("b")], [row("c")]
    both = gather({"runs/before.jsonl": old, "runs/after.jsonl": new})
    assert [c.label for c in both] == ["P before", "P after"]
    assert find_references(both, "after") == [both[1]] and find_references(both, "before.jsonl") == [both[0]]
    joined = gather({"x.jsonl": old, "y.jsonl": more})
    assert [(c.label, len(c.rows)) for c in joined] == [("P", 3)]


def test_labels_are_as_short_as_distinct_names_allow() -> None:
    rows = [row(), row(preset="Q", digest="e"), row(digest="f")]
    found = gather({"x": rows})
    assert [c.label for c in found] == ["P d", "Q", "P f"]
    assert find_references(found, "f") == [found[2]] and find_references(found, "q") == [found[1]]
    assert find_references(found) == [found[0]]
    with pytest.raises(ConfigError, match=r"got 'p', which matches 2 of the methods: P d \(d\); "):
        find_references(found, "p")
    with pytest.raises(ConfigError, match=r"got 'x', which matches none of the methods"):
        find_references(found, "x")
    assert [c.label for c in gather({"x": [row(), row(method="n", preset="", digest="e")]})] == ["m P", "n"]


def test_before_and_after_are_compared_preset_by_preset(tmp_path: Path) -> None:
    files = {
        name: [row("a", overlap_f=f), row("a", preset="Q", digest="e", overlap_f=f + 0.1)]
        for name, f in (("before", 0.3), ("after", 0.5))
    }
    found = gather(files)
    assert find_references(found) == find_references(found, "before") == found[:2]
    pairs = pair_up(found, find_references(found, "before"))
    assert [(a.label, b.label) for a, b in pairs] == [("P before", "P after"), ("Q before", "Q after")]
    write_report(found, tmp_path)
    text = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert "## Differences to P before and Q before" in text
    assert "| every object labelled | Q after (to Q before) | 1 | +0.200 |" in text


def test_a_file_without_rows_makes_no_report(tmp_path: Path) -> None:
    (tmp_path / "rows.jsonl").write_text("")
    with pytest.raises(FileError, match="got none: run `spigolo evaluate` first"):
        read_contenders([tmp_path / "rows.jsonl"])


# --- report -------------------------------------------------------------------------------------------------


class Balanced(HTMLParser):
    """Fails where a tag closes another than the last one open."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.pictures: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.pictures += [value or "" for key, value in attrs if tag == "img" and key == "src"]
        if tag not in ("meta", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def balanced(path: Path) -> Balanced:
    parser = Balanced()
    parser.feed(path.read_text(encoding="utf-8"))
    assert not parser.open
    return parser


def test_the_report_has_tables_differences_pictures_and_limitations(root: Path, tmp_path: Path) -> None:
    frames, path, out = find_labelled_frames([root]), tmp_path / "rows.jsonl", tmp_path / "report"
    evaluate(frames, make_methods(["toscana2016"], [BOXES, sp.TABLE]), path)
    write_report(read_contenders([path]), out, frames)
    page, text = balanced(out / "index.html"), (out / "report.md").read_text(encoding="utf-8")
    assert len(page.pictures) == 8  # of the two methods: three frames, and one of the two that are near-identical
    for picture in page.pictures:
        assert cv2.imread(str(out / picture)).shape[1] > 1000
        assert picture in text
    html = (out / "index.html").read_text(encoding="utf-8")
    for place in (html, text):
        assert all(name in place for name in ("osd-small", "shop", "every object labelled", "all labelled frames"))
        assert "Precision cannot be measured" in place and "does not compare with learned methods" in place
        assert "Fewer than 10 distinct frames" in place and "Near-identical frames count once" in place
        assert sp.TABLE.digest in place and "numpy" in place
        assert "<script" not in place and "nan" not in place
    assert "Differences to BOXES" in html
    pooled = next(line for line in text.splitlines() if line.startswith("| every object labelled | BOXES"))
    expected = pool([r for r in read_rows(path) if r.labelling == "full" and r.digest == BOXES.digest])
    assert f"**{expected.overlap_f.value:.3f}**" in pooled
    assert "**100 %** (6 of 6; 61 to 100 %)" in pooled


def test_a_report_of_one_method_without_frames_has_neither_differences_nor_pictures(tmp_path: Path) -> None:
    write_report(gather({"x": [row("a"), row("b", error="boom")]}), tmp_path)
    html = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "Differences" not in html and "Worst" not in html and not (tmp_path / "pictures").exists()
    assert "P failed on 1 frames" in html and "boom" in html


@pytest.mark.parametrize(("large", "small", "mostly"), [(3, 1, True), (2, 2, False)])
def test_a_report_says_where_one_set_stands_for_most_of_the_figures(large: int, small: int, mostly: bool) -> None:
    sets = ["large"] * large + ["small"] * small
    told = limitations(gather({"x": [row(str(k), data_set=name, group=str(k)) for k, name in enumerate(sets)]}))
    assert any("large has 3 of the 4 distinct frames" in sentence for sentence in told) == mostly


def test_opencv_has_its_threads_again_after_a_time_was_taken() -> None:
    before = cv2.getNumThreads()
    cv2.setNumThreads(2)
    try:
        with one_thread():
            assert cv2.getNumThreads() == 1
        assert cv2.getNumThreads() == 2
    finally:
        cv2.setNumThreads(before)


def test_a_report_says_why_it_has_no_pictures(root: Path, tmp_path: Path) -> None:
    frames = find_labelled_frames([root / "osd-small"])
    gone = row("f0", data_set="osd-small", method="gone")
    write_report(gather({"x": [gone]}), tmp_path / "c", frames)
    assert "gone is not in spigolo.METHODS" in (tmp_path / "c" / "index.html").read_text(encoding="utf-8")
    gone = row("f0", data_set="osd-small", method="rao2010")
    write_report(gather({"x": [gone]}), tmp_path / "a", frames)
    assert "has no method with the digest" in (tmp_path / "a" / "index.html").read_text(encoding="utf-8")
    write_report(gather({"x": [row("elsewhere")]}), tmp_path / "b", frames)
    assert "contain none of the labelled frames" in (tmp_path / "b" / "index.html").read_text(encoding="utf-8")


def test_a_picture_that_shows_another_answer_than_the_row_says_so(root: Path, tmp_path: Path) -> None:
    frames = find_labelled_frames([root / "osd-small" / "f0"])
    rows = evaluate(frames, [Toscana2016(BOXES)], tmp_path / "rows.jsonl")
    assert rows[0].score is not None
    old = replace(rows[0], score=replace(rows[0].score, overlap_f=0.1))
    write_report(gather({"x": [old]}), tmp_path, frames)
    assert "differs from the scored result" in (tmp_path / "index.html").read_text(encoding="utf-8")


def test_the_worst_frames_come_first_one_of_each_group() -> None:
    rows = [
        row("a", overlap_f=0.9),
        row("b", overlap_f=0.1, group="g"),
        row("c", overlap_f=0.2, group="g"),
        row("d", labelling="part", overlap_recall=0.15),
        row("e", error="boom", overlap_f=0.0),
        row("f", score=None),
    ]
    assert [one.frame for one in worst_rows(rows)] == ["b", "d", "a"]
    assert len(worst_rows([replace(rows[0], group=str(k)) for k in range(WORST + 1)])) == WORST


def test_a_truth_picture_outlines_what_was_found_in_another_colour() -> None:
    labels = np.zeros((60, 80), np.uint8)
    labels[10:30, 10:30], labels[10:30, 50:70] = 1, 2
    ignore = np.zeros(labels.shape, bool)
    ignore[40:] = True
    color = np.full((60, 80, 3), 100, np.uint8)
    picture = truth_picture(color, labels, {2}, ignore)
    assert picture[20, 10].tolist() == list(MISSED) and picture[20, 69].tolist() == list(FOUND)
    assert picture[20, 20].tolist() == [100] * 3 and set(np.unique(picture[45:])) == {50, 150}
    assert (color == 100).all()


def test_a_page_is_escaped_in_both_forms() -> None:
    table = Table(("a|b", "n"), [[Cell("<x>"), Cell("1", "of 2", strong=True)]])
    page = Page("T & U", [table, Gallery("g", [Picture("p.jpg", "a_b")])])
    assert (
        "T &amp; U" in to_html(page) and "&lt;x&gt;" in to_html(page) and "<b>1</b><small>of 2</small>" in to_html(page)
    )
    assert r"| a\|b | n |" in to_markdown(page) and r"| \<x> | **1** (of 2) |" in to_markdown(page)
    assert "![a\\_b](p.jpg)" in to_markdown(page)
    assert to_text(table).splitlines() == ["a|b         n", "<x>  1 (of 2)"]


# --- the command line ---------------------------------------------------------------------------------------


def spigolo(*words: object) -> subprocess.CompletedProcess[str]:
    code = "from spigolo.cli import main; main()"
    return subprocess.run(
        [sys.executable, "-c", code, *map(str, words)], capture_output=True, text=True, check=False, timeout=300
    )


def test_two_commands_make_a_report(root: Path, tmp_path: Path) -> None:
    toml, rows, out = tmp_path / "mine.toml", tmp_path / "rows.jsonl", tmp_path / "report"
    toml.write_text('base = "TABLE"\n[partition]\ngamma = 0.003\n')
    words = ("evaluate", root, "--presets", "OBJECTS", toml, "-j", "2", "--partition.min-size-px2=400", "--out", rows)
    done = spigolo(*words)
    assert done.returncode == 0, done.stderr
    assert "12 rows, 0 of them from an earlier run" in done.stdout and "every object labelled" in done.stdout
    assert "12 rows, 12 of them from an earlier run" in spigolo(*words).stdout
    written = read_rows(rows)
    config = sp.TABLE.replace(partition={"gamma": 0.003, "min_size_px2": 400})
    assert {one.digest for one in written if one.preset == "mine"} == {config.digest}
    done = spigolo("report", rows, "--against", "mine", "--frames", root, "--out", out)
    assert done.returncode == 0, done.stderr
    assert "Differences to mine" in (out / "index.html").read_text(encoding="utf-8")
    assert len(balanced(out / "index.html").pictures) == 8


def test_a_frame_that_fails_ends_with_1_and_the_rest_is_done(root: Path, tmp_path: Path) -> None:
    (root / "shop" / "f0" / "rgb.png").write_bytes(b"")
    for _ in range(2):  # the second time nothing is left to do, and it is told again
        done = spigolo("evaluate", root / "shop", "--out", tmp_path / "rows.jsonl")
        assert done.returncode == 1
        assert "shop/f0 (toscana2016 OBJECTS_2): expected an image" in done.stderr
        assert len(read_rows(tmp_path / "rows.jsonl")) == 3


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["evaluate"], "give the folders before the flags"),
        (["evaluate", "nowhere"], "there is no folder nowhere"),
        (["evaluate", "nowhere", "--methods", "best"], "unknown method 'best'"),
        (["evaluate", "nowhere", "--presets", "tabel"], "unknown preset 'tabel'"),
        (["evaluate", "nowhere", "--partition.gama", "1"], "did you mean --partition.gamma"),
        (["report"], "give the files before the flags"),
        (["report", "nowhere.jsonl"], "expected rows in nowhere.jsonl"),
    ],
)
def test_wrong_input_ends_with_2_and_one_sentence(words: list[str], sentence: str) -> None:
    done = spigolo(*words)
    assert done.returncode == 2
    assert sentence in done.stderr and "Traceback" not in done.stderr


# --- real frames --------------------------------------------------------------------------------------------


@pytest.mark.frames
def test_rows_of_real_frames_hold_the_measures(data: Path, tmp_path: Path) -> None:
    folders = [data / "frames" / "osd-mosd" / "learn0", data / "frames" / "ycbv" / "0000_000010"]
    frames = find_labelled_frames(folders)
    rows = evaluate(frames, [Toscana2016(sp.OBJECTS)], tmp_path / "rows.jsonl")
    assert [(one.labelling, one.group) for one in rows] == [
        ("full", "osd-mosd/learn0"),
        ("part", "ycbv/0000_000001"),
    ]
    for folder, one in zip(folders, rows, strict=True):
        label = cv2.imread(str(folder / "label.png"), cv2.IMREAD_UNCHANGED)
        frame = sp.read_frame(folder / "rgb.png", folder / "depth.png", folder / "camera.json")
        score = score_frame(np.where(label == 255, 0, label), sp.segment(frame).labels, label == 255)
        assert one.score is not None
        for name in ("overlap_precision", "overlap_recall", "overlap_f", "boundary_f", "f75", "n_objects"):
            assert getattr(one.score, name) == getattr(score, name), name
        assert one.score.best_iou == tuple(score.best_iou)
        assert one.score.covered == tuple(score.covered)
        assert one.score.true_positives == np.count_nonzero(score.found_iou_70)
