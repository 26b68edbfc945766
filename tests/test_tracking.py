"""Ids that last: on a scene that moves, through frames in which an object is not found."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

import spigolo as sp
from spigolo.lab.datasets.sample import Instance, Sample
from spigolo.lab.studies import tracking
from spigolo.objects.tracking import KEPT_FRAMES, match

CAMERA = sp.Camera(200, 200, 79.5, 59.5, 160, 120)
TINTS = ((200, 40, 40), (40, 180, 40), (40, 60, 210))


def moved(step: int, hidden: tuple[int, ...] = (), drift: int = 0) -> sp.Frame:
    """Three boxes before a wall. The first moves right, the second left, the third stands; drift moves all."""
    color, depth = np.full((120, 160, 3), 150, np.uint8), np.full((120, 160), 1.0, np.float32)
    places = ((15, 10 + step), (50, 125 - step), (85, 60))
    for k, ((y, first), tint) in enumerate(zip(places, TINTS, strict=True)):
        if k not in hidden:
            x = first + drift
            color[y : y + 24, x : x + 24], depth[y : y + 24, x : x + 24] = tint, 0.8
    return sp.Frame(color, depth, CAMERA)


def ids_of(result: sp.Segmentation) -> dict[int, int]:
    """The id of each box by the channel that is brightest in it."""
    return {int(result.frame.color[o.mask].mean(axis=0).argmax()): o.id for o in result}


@pytest.fixture
def segmenter() -> sp.Segmenter:
    return sp.Segmenter(sp.TABLE, ids=True)


def test_ids_stay_while_objects_pass_each_other(segmenter: sp.Segmenter) -> None:
    seen = [ids_of(segmenter(moved(step))) for step in range(0, 100, 4)]
    assert all(len(set(ids.values())) == 3 for ids in seen)
    assert all(ids == seen[0] for ids in seen)


def test_ids_follow_a_fast_camera(segmenter: sp.Segmenter) -> None:
    seen = [ids_of(segmenter(moved(0, drift=d))) for d in (0, 5, 10, 4, -2, -8)]
    assert all(ids == seen[0] for ids in seen)


def test_an_object_that_was_not_found_for_a_while_gets_its_id_back(segmenter: sp.Segmenter) -> None:
    first = ids_of(segmenter(moved(0)))
    for _ in range(KEPT_FRAMES):
        hidden = ids_of(segmenter(moved(0, hidden=(1,))))
        assert hidden == {k: one for k, one in first.items() if k != 1}
    assert ids_of(segmenter(moved(0))) == first
    for _ in range(KEPT_FRAMES + 1):
        segmenter(moved(0, hidden=(1,)))
    assert ids_of(segmenter(moved(0)))[1] not in first.values()


def test_ids_are_in_the_answer_and_survive_corrections(segmenter: sp.Segmenter) -> None:
    result = segmenter(moved(0))
    assert {row["id"] for row in result.to_dict()["objects"]} == {o.id for o in result} == {1, 2, 3}
    assert result.table()["id"] == [o.id for o in result]
    left = result.drop(result[0])
    assert [o.id for o in left] == [o.id for o in result[1:]]
    assert "id" not in sp.segment(moved(0), sp.TABLE).to_dict()["objects"][0]
    assert pickle.loads(pickle.dumps(segmenter)).ids


def test_frames_without_objects_or_of_another_size_are_no_trouble(segmenter: sp.Segmenter) -> None:
    segmenter(moved(0, hidden=(0, 1, 2)))
    assert len(segmenter(moved(0))) == 3
    half = moved(0)
    segmenter(sp.Frame(half.color[:100], half.depth[:100], None))
    assert len(segmenter.pace) == 3 and segmenter.pace.latency_ms(99) >= segmenter.pace.latency_ms(50) > 0


def test_matching_is_one_to_one_and_leaves_out_what_has_no_affinity() -> None:
    affinity = np.array([[0.9, 0.8], [0.95, 0.0], [0.0, 0.0]])
    assert match(affinity) == {1: 0, 0: 1}
    assert match(np.zeros((0, 3))) == {}


def sample_of(frame: sp.Frame) -> Sample:
    """The truth of `moved`: the box of each tint."""
    labels = np.zeros(frame.shape, np.int32)
    for k, tint in enumerate(TINTS, start=1):
        labels[(frame.color == tint).all(axis=2)] = k
    return Sample(frame, labels, tuple(Instance(k, f"box {k}", None) for k in (1, 2, 3) if (labels == k).any()))


def test_changes_of_ids_are_counted() -> None:
    frames = [moved(step, hidden=(1,) if step == 8 else ()) for step in range(0, 40, 4)]
    samples, results = [sample_of(one) for one in frames], [sp.segment(one, sp.TABLE) for one in frames]
    followed, took_ms = tracking.follow(results)
    assert took_ms > 0
    found = tracking.count(samples, followed)
    assert found == tracking.Count(objects=3, present=29, found=29, again=26, switches=0, ids=3)
    swapped = [*followed[:5], *(relabelled(one, {1: 2, 2: 1, 3: 9}) for one in followed[5:])]
    assert tracking.count(samples, swapped).switches == 3
    assert tracking.count(samples, swapped).share == 3 / 26
    assert tracking.count(samples, results, by_label=True).ids <= 3


def relabelled(result: sp.Segmentation, ids: dict[int, int]) -> sp.Segmentation:
    return replace(result, objects=tuple(replace(o, id=ids[o.id or 0]) for o in result))


@pytest.mark.parametrize("step", [1, 2])
def test_a_hidden_object_moves_along_with_the_camera(segmenter: sp.Segmenter, step: int) -> None:
    first = ids_of(segmenter(moved(0)))
    for k in range(1, 13):
        segmenter(moved(0, hidden=(1,), drift=step * k))
    assert ids_of(segmenter(moved(0, drift=step * 13))) == first
