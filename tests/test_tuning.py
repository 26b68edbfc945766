"""The tuning session without a browser: controls from fields, values, frames, corrections, the worker."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

import spigolo as sp
from bags import START_NS, STEP_NS, Bag
from spigolo.cli.opening import opened
from spigolo.settings.presets import from_toml
from spigolo.view import tuning_scene as scene
from spigolo.view.tuning_fields import MAIN, Leaf, controls_of, leaves, range_of
from spigolo.view.tuning_session import Reel, Session, inner_pixel
from spigolo.view.tuning_values import SHOWN, Values
from spigolo.view.tuning_worker import Latest

SCENE = Path(sp.__file__).parent / "demo_scene"
TABLE, BALL, MUG = (440, 150), (325, 545), (285, 420)
HEIGHT = "additions.support.min_height_m"
PAIRED = ("edges.canny_low", "edges.canny_high", "edges.contact_low_deg", "edges.contact_high_deg")
"""Thresholds of which the low one may not be above the high one."""

compiled = pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="whole frames need compiled kernels")


@pytest.fixture(scope="module")
def frame() -> sp.Frame:
    return sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")


def test_every_field_has_a_control_with_help() -> None:
    controls = list(leaves(controls_of()))
    assert len({leaf.key for leaf in controls}) == len(controls) > 120
    for leaf in controls:
        assert leaf.help.endswith("."), leaf.key
        assert leaf.label
    assert set(MAIN) <= {leaf.path for leaf in controls}


@pytest.mark.parametrize("name", sp.PRESETS)
def test_the_controls_hold_a_preset_and_give_it_back(name: str) -> None:
    values = Values(sp.PRESETS[name])
    assert values.config() == sp.PRESETS[name]
    for leaf in leaves(values.tree):
        if leaf.kind in ("number", "integer"):
            value = values.of[leaf.key]
            span = range_of(leaf, value)
            assert span.low <= value <= span.high, leaf.key
            assert span.step > 0
            count = (value - (span.low - leaf.above * span.step)) / span.step
            assert abs(count - round(count)) < 1e-3, leaf.key


@pytest.mark.parametrize("base", SHOWN)
@pytest.mark.parametrize("name", sp.PRESETS)
def test_a_saved_preset_holds_only_what_differs(name: str, base: str) -> None:
    text = sp.PRESETS[name].to_toml(sp.PRESETS[base])
    assert from_toml(text).digest == sp.PRESETS[name].digest
    if sp.PRESETS[name].digest == sp.PRESETS[base].digest:
        assert text.strip() == f'base = "{sp.PRESETS[base].name}"'


def test_ends_of_a_range_are_allowed() -> None:
    values = Values(sp.OBJECTS)
    for leaf in leaves(values.tree):
        if leaf.kind in ("number", "integer") and leaf.key == leaf.path and values.on[leaf.key]:
            before = values.of[leaf.key]
            span = range_of(leaf, before)
            for end in (span.low, span.high):
                values.set(leaf.key, int(end) if leaf.kind == "integer" else end)
                with contextlib.suppress(sp.SpigoloError) if leaf.key in PAIRED else contextlib.nullcontext():
                    values.config()
            values.set(leaf.key, before)
            values.load(sp.OBJECTS)


def test_stages_and_rules_switch_off_and_on_with_their_values() -> None:
    values = Values(sp.OBJECTS)
    assert values.set("additions.joining", False)
    assert values.config().additions.joining is None  # type: ignore[union-attr]
    assert not values.active("additions.joining.cap.max_gap_m")
    values.set("additions.joining", True)
    assert values.config() == sp.OBJECTS
    values.set("rejection.max_distance_m", None)
    assert values.config().rejection.max_distance_m is None
    values.set("additions.support", False)
    with pytest.raises(sp.SpigoloError, match=r"joining, .* require additions"):
        values.config()
    values.load(sp.OBJECTS)
    values.set("cost", "auto")
    assert values.config().partition.gamma_shadows == sp.SHELF.partition.gamma
    with pytest.raises(sp.SpigoloError, match="unknown control"):
        values.set("no.such", 1)


@compiled
def test_a_session_sets_corrects_and_saves(frame: sp.Frame, tmp_path: Path) -> None:
    session = Session(frame)
    assert session.preset == "OBJECTS"
    first = session.run()
    assert np.array_equal(first.result.labels, sp.segment(frame).labels)
    assert first.wall_s > 0
    assert "partition" in first.stages_s
    assert session.set(HEIGHT, 0.05)
    assert not session.set(HEIGHT, 0.05)
    found = len(session.run().result)
    session.correct("keep", TABLE)
    assert len(session.answer.result) == found + 1  # type: ignore[union-attr]
    session.set(HEIGHT, 0.01)
    assert isinstance(session.run().result.at(TABLE), sp.ObjectMask)  # corrections stay
    session.correct("merge", TABLE, MUG)
    session.correct("drop", BALL)
    now = session.at(BALL)
    assert isinstance(now, sp.RejectedRegion)
    assert now.reason is sp.Reason.BY_HAND
    session.undo(everything=True)
    session.load("OBJECTS")
    assert np.array_equal(session.run().result.labels, first.result.labels)
    session.set(HEIGHT, 0.02)
    session.save(tmp_path / "mine.toml")
    assert (tmp_path / "mine.toml").read_text().split() == (
        ["base", "=", '"OBJECTS_2"', "[additions.support]", "min_height_m", "=", "0.02"]
    )
    assert sp.preset(tmp_path / "mine.toml").additions.support.min_height_m == 0.02  # type: ignore[union-attr]
    with pytest.raises(sp.SpigoloError, match=r"ends in \.toml"):
        session.save(tmp_path / "mine.txt")
    again = Session(frame, sp.preset(tmp_path / "mine.toml"))
    assert again.preset == "mine (yours)"
    assert again.toml().startswith('base = "OBJECTS_2"')


@compiled
def test_the_innermost_pixel_names_a_region(frame: sp.Frame) -> None:
    result = sp.segment(frame)
    for region in (*result.objects, *result.rejected):
        assert result.at(inner_pixel(region)).region == region.region


@compiled
@pytest.mark.parametrize("name", ["OBJECTS", "SHELF"])
def test_every_stage_has_a_picture(frame: sp.Frame, name: str) -> None:
    answer = Session(frame, sp.PRESETS[name]).run()
    chosen = answer.result.at(TABLE)
    for stage in scene.STAGES:
        drawn = scene.picture(answer, stage)
        assert drawn.shape == frame.color.shape
        assert drawn.dtype == np.uint8
        assert (scene.picture(answer, stage, chosen) != drawn).any()
    stand = scene.stand_of(frame)
    assert scene.cloud_colors(answer, stand, chosen).shape == stand.points.shape
    ends, colors = scene.box_lines([o.oriented_box() for o in answer.result])
    assert ends.shape == colors.shape == (12 * len(answer.result), 2, 3)


def test_a_ray_finds_its_pixel_on_the_picture_and_in_the_cloud(frame: sp.Frame) -> None:
    stand = scene.stand_of(frame)
    eye = stand.board - [0, 0, 2]
    corner = stand.board + np.array([*stand.size, 0]) * [-0.4999, -0.4999, 0]
    assert stand.pixel_at(eye, stand.board - eye) == (240, 320)
    assert stand.pixel_at(eye, corner - eye) == (0, 0)
    k = len(stand.points) // 2
    eye = np.zeros(3)
    found = stand.pixel_at(eye, stand.points[k].astype(float))
    assert found is not None
    assert abs(found[0] - stand.rows[k]) + abs(found[1] - stand.columns[k]) < 16
    assert stand.pixel_at(eye, np.array([0, 0, -1.0])) is None
    bare = scene.stand_of(sp.Frame(frame.color, frame.depth, None))
    assert bare.pixel_at(np.zeros(3), np.array([0, 0, 1.0])) == (240, 320)
    for view in ("picture", "both", "cloud"):
        for aspect in (0.46, 1.2, 2.0):
            position, target = stand.look(view, aspect)
            assert target[2] > position[2]


def test_a_reel_goes_to_and_fro(frame: sp.Frame) -> None:
    for frames in ([frame] * 3, iter([frame] * 3)):
        reel = Reel(frames)
        moves = [reel.move(step) for step in (-1, 1, 1, 1, -1, -1, -1)]
        assert moves == [False, True, True, False, True, True, False]
        assert reel.position == 0
    with pytest.raises(sp.SpigoloError, match="at least one frame"):
        Reel([])
    with pytest.raises(sp.SpigoloError, match="at least one frame"):
        Reel(iter([]))

    def endless() -> Iterator[sp.Frame]:
        while True:
            yield frame

    stream = Reel(endless())
    assert stream.count is None
    assert all(stream.move(1) for _ in range(40))
    assert sum(stream.move(-1) for _ in range(40)) == 29
    assert not stream.go(35)


def test_a_frame_is_read_once_while_the_reel_stands_there(frame: sp.Frame) -> None:
    class Counted:
        read: ClassVar[list[int]] = []

        def __len__(self) -> int:
            return 3

        def __getitem__(self, number: int) -> sp.Frame:
            self.read.append(number)
            if number == 1:
                raise sp.SpigoloError("broken")
            return frame

    reel = Reel(Counted())
    assert reel.current() is reel.current() is frame
    assert reel.go(1)
    with pytest.raises(sp.SpigoloError, match="broken"):
        reel.current()
    assert reel.move(1) and reel.current() is reel.current()
    assert Counted.read == [0, 1, 2]


def test_of_many_requests_the_last_one_counts() -> None:
    done, gate = [], threading.Event()
    wanted = 0

    def work() -> bool:
        gate.wait(10)
        done.append(wanted)
        return False

    worker = Latest(work)
    for k in range(100):
        wanted = k
        worker.ask()
    gate.set()
    assert worker.idle(10)
    worker.close()
    assert len(done) <= 2
    assert done[-1] == 99


def test_without_the_extra_one_sentence_says_so() -> None:
    code = (
        "import sys; sys.modules['viser'] = None; sys.argv = ['spigolo', 'tune', sys.argv[1], '--no-browser'];"
        "from spigolo.cli import main; main()"
    )
    done = subprocess.run([sys.executable, "-c", code, SCENE], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.strip() == 'spigolo: the tuning page needs viser: pip install "spigolo[tune]"'


def test_a_label_names_the_unit() -> None:
    labels = {leaf.path: leaf.label for leaf in leaves(controls_of()) if isinstance(leaf, Leaf)}
    assert labels[HEIGHT] == "min. height (m)"
    assert labels["edges.contact_low_deg"] == "contact low (°)"


def test_the_verb_goes_through_a_bag_and_reads_files_by_number(tmp_path: Path) -> None:
    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    depth = np.round(frame.depth * 1000).astype(np.uint16)
    bag = Bag("ros2-mcap")
    bag.add_info("/camera/color/camera_info", START_NS, frame.camera.matrix.ravel(), frame.shape)
    for k in range(3):
        bag.add_image("/camera/color/image_raw", START_NS + k * STEP_NS, np.roll(frame.color, 9 * k, axis=1), "rgb8")
        bag.add_image("/camera/depth_registered/image", START_NS + k * STEP_NS, np.roll(depth, 9 * k, axis=1), "16UC1")
    path = str(bag.write(tmp_path))
    with opened([path]) as source:
        session = Session(source)
        seen = [session.reel.current().name, *(session.move(1) and session.reel.current().name for _ in range(3))]
        assert seen == ["000000", "000001", "000002", False]
        assert session.move(-1) and session.reel.current().name == "000001"
        assert session.go(0) and not session.go(0) and session.reel.current().name == "000000"
        assert session.go(99) and session.reel.position == 2 and session.reel.count == 3
    with opened([str(SCENE)]) as source:
        assert Session(source).reel.count == 1
