"""RealSense through the production code, fed by the software device of the SDK."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import spigolo as sp
from spigolo.errors import FileError
from spigolo.sources.live import Mailbox

pytest.importorskip("pyrealsense2")

from realsense_device import FPS, Device, record
from spigolo.sources import realsense

pytestmark = pytest.mark.alone
SCENE = Path(sp.__file__).parent / "demo_scene"


@pytest.fixture(scope="module")
def frame() -> sp.Frame:
    return sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A device that sends nothing more counts as lost after two seconds."""
    monkeypatch.setattr(realsense, "PATIENCE_S", 2.0)


def until_it_ends(source: sp.Source, work: Callable[[sp.Frame], object] = id) -> list[sp.Frame]:
    """The frames of a device, which is lost at the end."""
    found = []
    try:
        for one in source:
            found.append(one)
            work(one)
    except FileError as error:
        if "no frame for 2 s" not in str(error):
            raise
    return found


def test_sixty_frames_come_through_the_pipeline_and_none_waits(frame: sp.Frame) -> None:
    device = Device(frame)
    with sp.open_source("realsense:", device=device.device) as source:
        feeder = device.feed(60)
        found = until_it_ends(source)
        feeder.join()
    report = source.report()
    assert source.live and source.count is None and source.intrinsics == "the device"
    assert report.unmatched == report.broken == 0
    assert report.frames + report.dropped == 60 and len(found) == report.frames >= 30


def test_a_slow_reader_gets_the_newest_frame_and_the_others_are_counted(frame: sp.Frame) -> None:
    device = Device(frame)
    segmenter = sp.Segmenter(sp.TABLE, ids=True)
    segmenter(frame)
    late = []
    with sp.open_source("realsense:", device=device.device) as source:
        device.feed(60)

        def work(one: sp.Frame) -> None:
            number = round((one.stamp_ns / 1e9 - 1) * FPS)
            late.append(time.perf_counter() - device.sent_s[number])
            np.testing.assert_array_equal(one.color, np.roll(frame.color, number, axis=1))
            assert one.camera == frame.camera and one.unit_m == pytest.approx(0.001)
            segmenter(one)

        until_it_ends(source, work)
    report = source.report()
    assert report.frames + report.dropped == 60
    assert report.frames >= 2 and report.broken == report.unmatched == 0
    assert report.pace is not None and len(report.pace) == report.frames
    assert report.pace.latency_ms(50) >= segmenter.pace.latency_ms(0)
    assert np.median(late) < 0.5  # no queue: the age of a frame does not grow
    assert "frames/s, latency" in str(report)


@pytest.mark.parametrize("form", ["{}", "realsense:{}"])
def test_a_recording_of_the_sdk_plays_every_pair_once(tmp_path: Path, frame: sp.Frame, form: str) -> None:
    record(frame, tmp_path / "x.db3", 30)
    with sp.open_source(form.format(tmp_path / "x.db3")) as source:
        found = list(source)
    assert [one.name for one in found] == [f"{k:06d}" for k in range(len(found))]
    assert 28 <= len(found) <= 30
    numbers = [round((one.stamp_ns / 1e9 - 1) * FPS) for one in found]
    assert numbers == sorted(set(numbers))
    for one, number in zip(found, numbers, strict=True):
        np.testing.assert_array_equal(one.color, np.roll(frame.color, number, axis=1))
        valid = (one.depth > 0) & (np.roll(frame.depth, number, axis=1) > 0)
        assert np.abs(one.depth - np.roll(frame.depth, number, axis=1))[valid].mean() < 0.005


def test_filters_run_and_unknown_ones_are_told(tmp_path: Path, frame: sp.Frame) -> None:
    record(frame, tmp_path / "x.db3", 10)
    plain = next(iter(sp.open_source(tmp_path / "x.db3")))
    filled = next(iter(sp.open_source(f"{tmp_path / 'x.db3'}?filters=spatial,temporal,holes")))
    assert np.count_nonzero(filled.depth) > np.count_nonzero(plain.depth)
    with pytest.raises(FileError, match="there is no filter median: expected one or more of decimation"):
        sp.open_source(f"realsense:{tmp_path / 'x.db3'}?filters=median")


def test_a_camera_that_is_not_there_is_told() -> None:
    with pytest.raises(FileError, match="no RealSense camera is connected"):
        sp.open_source("realsense:")


def test_a_mailbox_keeps_the_newest_and_tells_why_it_ended() -> None:
    box: Mailbox[int] = Mailbox()
    for k in range(5):
        box.put(k)
    assert box.take() == 4 and box.dropped == 4
    box.put(7)
    box.end(FileError("gone"))
    assert box.take() == 7
    with pytest.raises(FileError, match="gone"):
        box.take()
    done: Mailbox[int] = Mailbox()
    done.end()
    assert done.take() is None


def test_a_mailbox_with_places_drops_the_oldest() -> None:
    box: Mailbox[int] = Mailbox(3)
    for k in range(5):
        box.put(k)
    box.end()
    assert [box.take() for _ in range(4)] == [2, 3, 4, None] and box.dropped == 2


def test_frames_wait_in_the_queue_of_a_slow_caller(frame: sp.Frame) -> None:
    """Twelve frames arrive while the caller sleeps. Those that fit in the queue are kept, in their order."""
    device = Device(frame)
    with sp.open_source("realsense:", device=device.device, queue=4) as source:
        device.feed(12)
        frames = iter(source)
        stamps = [next(frames).stamp_ns]
        time.sleep(1.5)
        stamps += [next(frames).stamp_ns for _ in range(4)]
        assert source.report().dropped == 7
    numbers = [round((stamp / 1e9 - 1) * FPS) for stamp in stamps]
    assert numbers[0] == 0 and numbers[1:] == [8, 9, 10, 11]


@pytest.mark.parametrize("queue", [0, 2.5, "5", True])
def test_a_queue_that_is_no_number_of_frames_is_refused(queue: object) -> None:
    with pytest.raises(FileError, match="expected a queue of at least one frame, got queue="):
        sp.open_source("realsense:", queue=queue)
