"""Segmenters: the same answers, kept buffers, several at once."""

from __future__ import annotations

import gc
import os
import platform
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import spigolo as sp
from spigolo.errors import FileError, FrameError
from test_objects import scene


def variant(k: int) -> sp.Frame:
    """Another scene for every k, some of another size."""
    frame = scene()
    depth = np.roll(frame.depth, 3 * k, axis=1)
    color = np.roll(frame.color, 3 * k, axis=1)
    if k % 3 == 2:
        half = sp.Camera(500, 500, 39.5, 59.5, 80, 120)
        return sp.Frame(color[:, :80], depth[:, :80], half)
    return sp.Frame(color, depth, frame.camera)


@pytest.mark.parametrize("name", sorted(sp.PRESETS))
def test_a_segmenter_answers_as_segment_does_whatever_it_saw_before(name: str) -> None:
    segmenter = sp.Segmenter(sp.PRESETS[name])
    for k in range(6):
        frame = variant(k)
        assert np.array_equal(segmenter(frame).labels, sp.segment(frame, sp.PRESETS[name]).labels)


@pytest.mark.parametrize("name", [*sorted(sp.PRESETS), *sorted(sp.METHODS)])
def test_nothing_of_a_frame_waits_for_the_garbage_collector(name: str) -> None:
    """What only the collector frees piles up between its visits, and fresh memory is dear."""
    segment = sp.Segmenter(sp.PRESETS[name]) if name in sp.PRESETS else sp.METHODS[name]
    segment(scene())
    gc.collect()
    gc.disable()
    try:
        segment(scene())
        assert gc.collect() == 0
    finally:
        gc.enable()


def test_answers_share_no_memory_with_the_workspace() -> None:
    segmenter = sp.Segmenter(sp.TABLE)
    answers = [segmenter(variant(k)) for k in range(3)]
    copies = [answer.labels.copy() for answer in answers]
    for array in segmenter.workspace._memory.values():
        for answer in answers:
            assert not np.shares_memory(array, answer.labels)
            assert not np.shares_memory(array, answer.regions.labels)
            assert not np.shares_memory(array, answer.scene.contour)
    segmenter(variant(4))
    assert all(np.array_equal(a.labels, c) for a, c in zip(answers, copies, strict=True))


def test_a_workspace_keeps_its_memory() -> None:
    segmenter = sp.Segmenter(sp.TABLE)
    segmenter(variant(0))
    size = segmenter.workspace.size_bytes
    segmenter(variant(2))
    segmenter(variant(1))
    assert segmenter.workspace.size_bytes == size


COUNT_FAULTS = """
import resource, sys
from pathlib import Path
import spigolo as sp
folder = Path(sp.__file__).parent / "demo_scene"
frame = sp.read_frame(folder / "rgb.png", folder / "depth.png", folder / "camera.json")
segmenter = sp.Segmenter(sp.PRESETS[sys.argv[1]])
for k in range(15):
    if k == 5:
        before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    segmenter(frame)
print((resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before) / 10)
"""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="memory is freed as glibc does it")
@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="whole frames need compiled kernels")
@pytest.mark.parametrize("name", ["TABLE", "SHELF", "OBJECTS"])
def test_a_frame_asks_the_system_for_no_memory(name: str) -> None:
    """In a process of its own, as it depends on what was freed before. A frame has 15 MB, which are 3800 pages."""
    run = subprocess.run([sys.executable, "-c", COUNT_FAULTS, name], capture_output=True, text=True, check=True)
    assert float(run.stdout) < 200


def test_eight_at_once_answer_as_one_after_the_other() -> None:
    frames = [variant(k) for k in range(24)]
    serial = [sp.segment(frame).labels for frame in frames]
    local = threading.local()

    def run(frame: sp.Frame) -> np.ndarray:
        if not hasattr(local, "segmenter"):
            local.segmenter = sp.Segmenter()
        return local.segmenter(frame).labels

    with ThreadPoolExecutor(8) as pool:
        for ours, theirs in zip(pool.map(run, frames), serial, strict=True):
            assert np.array_equal(ours, theirs)


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_a_map_on_threads_answers_as_a_loop_does(threads: int) -> None:
    """Same order, labels and ids, twice with one segmenter."""
    frames = [variant(k) for k in (0, 1, 0, 2, 4, 1, 0)]
    loop, mapped = sp.Segmenter(ids=True), sp.Segmenter(ids=True)
    for _ in range(2):
        results = list(mapped.map(iter(frames), threads=threads))
        assert [r.frame for r in results] == frames
        for ours, theirs in zip(results, map(loop, frames), strict=True):
            assert np.array_equal(ours.labels, theirs.labels)
            assert [o.id for o in ours] == [o.id for o in theirs]
    assert len(mapped.pace) == len(loop.pace) == 2 * len(frames)
    assert list(mapped.map([], threads=threads)) == []


def test_a_map_takes_no_frame_before_a_thread_is_free() -> None:
    taken = []

    def frames() -> Iterator[sp.Frame]:
        for k in range(8):
            taken.append(k)
            yield variant(0)

    for k, _ in enumerate(sp.Segmenter(sp.TABLE).map(frames(), threads=2)):
        time.sleep(0.05)
        assert len(taken) <= k + 3  # this one was answered, its workspace serves the next, and one is being segmented


def test_a_map_gives_the_frames_before_a_failure_and_then_fails() -> None:
    def frames() -> Iterator[sp.Frame]:
        yield from (variant(0), variant(1))
        raise FileError("the cable is out")

    segmenter = sp.Segmenter(sp.TABLE)
    results = segmenter.map(frames())
    next(results)
    next(results)
    with pytest.raises(FileError, match="the cable is out"):
        next(results)
    with pytest.raises(FrameError):
        list(segmenter.map([variant(0), "no frame", variant(1)]))  # type: ignore[list-item]
    with pytest.raises(sp.SpigoloError, match="expected at least one thread, got threads=0"):
        segmenter.map([variant(0)], threads=0)
    assert len(list(segmenter.map([variant(0)]))) == 1


def test_a_map_that_is_left_early_frees_its_segmenter() -> None:
    segmenter = sp.Segmenter(sp.TABLE)
    before = threading.active_count()
    results = segmenter.map(variant(0) for _ in range(1000))
    next(results)
    with pytest.raises(sp.SpigoloError, match="one thread at a time"):
        segmenter(variant(0))
    results.close()
    segmenter(variant(0))
    assert threading.active_count() == before


def test_two_threads_in_one_segmenter_are_told_so() -> None:
    segmenter = sp.Segmenter(sp.TABLE)
    with segmenter._busy, pytest.raises(sp.SpigoloError, match="one Segmenter per thread"):
        segmenter(variant(0))
    segmenter(variant(0))


def test_warm_up_leaves_nothing_to_compile() -> None:
    code = """
import importlib, json, spigolo as sp
from pathlib import Path
sp.warm_up()
def signatures():
    found = {}
    for path in sorted((Path(sp.__file__).parent / "kernels").glob("[a-z]*.py")):
        module = importlib.import_module(f"spigolo.kernels.{path.stem}")
        found |= {f"{path.stem}.{k}": len(v.signatures) for k, v in vars(module).items() if hasattr(v, "signatures")}
    return found
before = signatures()
scene = Path(sp.__file__).parent / "demo_scene"
frame = sp.read_frame(scene / "rgb.png", scene / "depth.png", scene / "camera.json")
for config in sp.PRESETS.values():
    sp.segment(frame, config)
print(json.dumps({k: (before[k], v) for k, v in signatures().items() if v != before[k]}))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "{}"


def test_a_map_refuses_what_is_no_frame_wherever_it_comes() -> None:
    answers = sp.Segmenter(sp.TABLE).map([variant(0), None, variant(1)])  # type: ignore[list-item]
    assert len(next(answers)) >= 0
    with pytest.raises(FrameError, match="expected a Frame"):
        list(answers)
