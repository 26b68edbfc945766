"""ROS messages from hand-made bytes, pairs of stamps and parameters: all that the node does without rclpy."""

from __future__ import annotations

import array
import struct
import sys
import threading
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import spigolo as sp
from spigolo.cli.ros import ros
from spigolo.errors import ConfigError, FrameError, SpigoloError
from spigolo.ros import answers
from spigolo.ros.kinds import Kinds, find_kinds
from spigolo.ros.messages import fill_image, quaternion
from spigolo.ros.node import _frame_of
from spigolo.ros.pairing import Pair, Waiting
from spigolo.ros.parameters import Options, changed, descriptions, first_state, values_of
from spigolo.sources.pairing import KEPT, StampMatcher
from spigolo.sources.ros_images import color_of, depth_of, stamp_ns
from test_objects import scene

CONFIG = sp.TABLE.replace(rejection={"max_lambda1_px2": 20000.0, "max_lambda2_px2": 15000.0})
HEADER = SimpleNamespace(stamp=SimpleNamespace(sec=12, nanosec=345), frame_id="camera_color_optical_frame")


def image(encoding: str, height: int, width: int, data: bytes, step: int, big: int = 0) -> Any:
    return SimpleNamespace(
        header=HEADER,
        encoding=encoding,
        height=height,
        width=width,
        step=step,
        is_bigendian=big,
        data=array.array("B", data),
    )


# --- images in ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("encoding", "red"),
    [
        ("rgb8", b"\xff\x00\x01"),
        ("bgr8", b"\x01\x00\xff"),
        ("rgba8", b"\xff\x00\x01\x09"),
        ("bgra8", b"\x01\x00\xff\x09"),
    ],
)
def test_colour_is_rgb_in_every_encoding(encoding: str, red: bytes) -> None:
    pixels = color_of(image(encoding, 2, 3, red * 6, 3 * len(red)))
    assert pixels.shape == (2, 3, 3) and pixels.dtype == np.uint8
    assert (pixels == (255, 0, 1)).all()


def test_grey_becomes_three_channels() -> None:
    np.testing.assert_array_equal(color_of(image("mono8", 1, 2, b"\x05\x07", 2)), [[[5, 5, 5], [7, 7, 7]]])


def test_the_padding_of_rows_is_left_out() -> None:
    padded = image("16UC1", 2, 2, struct.pack("<2H2x2H2x", 1, 2, 3, 4), 6)
    np.testing.assert_array_equal(depth_of(padded), [[1, 2], [3, 4]])
    rows = image("rgb8", 2, 1, b"\x01\x02\x03\xee\x04\x05\x06\xee", 4)
    np.testing.assert_array_equal(color_of(rows), [[[1, 2, 3]], [[4, 5, 6]]])


@pytest.mark.parametrize(("big", "order"), [(0, "<"), (1, ">")])
def test_depth_is_read_in_both_orders_of_bytes(big: int, order: str) -> None:
    whole = image("mono16", 1, 3, struct.pack(order + "3H", 0, 500, 65000), 6, big)
    np.testing.assert_array_equal(depth_of(whole), [[0, 500, 65000]])
    assert depth_of(whole).dtype == np.dtype(np.uint16)
    metres = image("32FC1", 1, 2, struct.pack(order + "2f", 0.5, float("nan")), 8, big)
    np.testing.assert_array_equal(depth_of(metres), np.array([[0.5, np.nan]], np.float32))


@pytest.mark.parametrize(
    ("read", "message", "told"),
    [
        (color_of, image("bayer_rggb8", 2, 2, bytes(4), 2), "'bayer_rggb8'"),
        (color_of, image("16UC1", 1, 2, bytes(4), 4), "expected colour as"),
        (depth_of, image("rgb8", 1, 2, bytes(6), 6), "expected depth as"),
        (depth_of, image("8UC1", 1, 2, bytes(2), 2), "name another depth topic"),
        (depth_of, image("16UC1", 2, 2, bytes(7), 4), "got 7 bytes"),
        (depth_of, image("16UC1", 2, 2, bytes(8), 2), "got 8 bytes"),
        (color_of, image("rgb8", 0, 0, b"", 0), "0x0"),
    ],
)
def test_what_is_no_image_is_refused_in_one_line(read: Any, message: Any, told: str) -> None:
    with pytest.raises(FrameError, match=r"^expected .*") as caught:
        read(message)
    assert told in str(caught.value) and "\n" not in str(caught.value)


def info(frame: sp.Frame, **changes: Any) -> Any:
    k = frame.camera
    assert k is not None
    P = np.hstack([k.matrix, np.zeros((3, 1))])
    fields = {"width": k.width, "height": k.height, "k": k.matrix.ravel(), "p": P.ravel(), "d": array.array("d")}
    return SimpleNamespace(**fields | {"distortion_model": "plumb_bob"} | changes)


def pair_of(frame: sp.Frame) -> Pair:
    height, width = frame.shape
    millimetres = np.round(frame.depth * 1000).astype("<u2")
    color = image("rgb8", height, width, frame.color.tobytes(), width * 3)
    return Pair(color, image("16UC1", height, width, millimetres.tobytes(), width * 2), 0.0)


def test_a_pair_and_its_camera_make_the_frame() -> None:
    frame = scene()
    made = _frame_of(pair_of(frame), info(frame), Options())
    np.testing.assert_array_equal(made.color, frame.color)
    np.testing.assert_allclose(made.depth, frame.depth, atol=6e-4)
    assert made.camera == frame.camera and made.stamp_ns == stamp_ns(pair_of(frame).color) == 12_000_000_345
    tenths = _frame_of(pair_of(frame), info(frame), Options(depth_scale=0.0001))
    np.testing.assert_allclose(tenths.depth, made.depth / 10, rtol=1e-6)


@pytest.mark.parametrize(("factor", "scale"), [(1, 0.0), (1000, 0.001)])
def test_floating_point_depth_is_in_metres_unless_a_scale_is_given(factor: int, scale: float) -> None:
    frame = scene()
    height, width = frame.shape
    depth = image("32FC1", height, width, (frame.depth * factor).astype("<f4").tobytes(), width * 4)
    made = _frame_of(Pair(pair_of(frame).color, depth, 0.0), info(frame), Options(depth_scale=scale))
    np.testing.assert_allclose(made.depth, frame.depth, rtol=1e-5)


def test_rectified_images_are_not_undistorted_again() -> None:
    frame = scene()
    bent = info(frame, d=array.array("d", [0.1, 0, 0, 0, 0]), k=np.diag([999.0, 999.0, 1.0]).ravel())
    made = _frame_of(pair_of(frame), bent, Options(rectified=True))
    assert made.camera == frame.camera and not made.undistorted
    assert len(bent.d) == 5  # the message stays as it came
    assert _frame_of(pair_of(frame), info(frame, d=bent.d), Options()).undistorted


# --- answers out ----------------------------------------------------------------------------------------------


def bag() -> Any:
    """A message whose fields are made when they are first read."""

    class Bag(SimpleNamespace):
        ADD, DELETEALL, CUBE, TEXT_VIEW_FACING = 0, 3, 1, 9

        def __getattr__(self, name: str) -> Any:
            if name.startswith("__"):
                raise AttributeError(name)
            value = Bag()
            setattr(self, name, value)
            return value

    return Bag


@pytest.fixture(scope="module")
def kinds() -> Kinds:
    one = bag()
    sensor = SimpleNamespace(Image=one, PointCloud2=one, PointField=one)
    visualization = SimpleNamespace(Marker=one, MarkerArray=one)
    vision = SimpleNamespace(Detection3D=one, ObjectHypothesisWithPose=one, Detection3DArray=one)
    return Kinds(None, None, sensor, None, None, visualization, vision)


@pytest.fixture(scope="module")
def result() -> sp.Segmentation:
    return sp.segment(scene(), CONFIG)


def test_labels_keep_their_header_and_are_mono16(kinds: Kinds, result: sp.Segmentation) -> None:
    message = answers.label_image(kinds, HEADER, result)
    assert message.header is HEADER
    assert (message.encoding, message.height, message.width, message.step) == ("mono16", 120, 160, 320)
    np.testing.assert_array_equal(np.frombuffer(message.data, "<u2").reshape(120, 160), result.labels)
    np.testing.assert_array_equal(depth_of(message), result.labels)  # and back


def test_ids_are_the_numbers_of_every_message(kinds: Kinds, result: sp.Segmentation) -> None:
    ids = {o.label: one for o, one in zip(result, (7, 65536, *range(100, 200)), strict=False)}
    tracked = replace(result, objects=tuple(replace(o, id=ids[o.label]) for o in result))
    wanted = [ids[o.label] if ids[o.label] < 65536 else 1 for o in result]  # 65536 begins again
    seen = depth_of(answers.label_image(kinds, HEADER, tracked))
    for o, number in zip(result, wanted, strict=True):
        np.testing.assert_array_equal(seen == number, o.mask)
    texts = [m for m in answers.markers(kinds, HEADER, tracked).markers[1:] if m.type == 9]
    assert [(m.id, m.text) for m in texts] == [(n, str(n)) for n in wanted]
    assert [d.id for d in answers.detections(kinds, HEADER, tracked).detections] == list(map(str, wanted))
    packed = bytes(answers.cloud(kinds, HEADER, tracked).data)
    assert {struct.unpack_from("<I", packed, k + 16)[0] for k in range(0, len(packed), 20)} == set(wanted)
    assert (tracked.overlay() != result.overlay()).any()


def test_an_overlay_and_a_mask_are_images(kinds: Kinds, result: sp.Segmentation) -> None:
    np.testing.assert_array_equal(color_of(answers.overlay_image(kinds, HEADER, result)), result.overlay())
    mask = answers.mask_image(kinds, HEADER, result[1])
    assert mask.encoding == "mono8" and isinstance(mask.data, array.array)
    np.testing.assert_array_equal(color_of(mask)[..., 0], result[1].mask * 255)


def test_an_image_from_a_slice_is_stored_in_its_own_order() -> None:
    pixels = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)[:, ::2, ::-1]
    np.testing.assert_array_equal(color_of(fill_image(bag()(), HEADER, pixels, "rgb8")), pixels)


def test_a_cloud_has_every_measured_point_with_colour_and_label(kinds: Kinds, result: sp.Segmentation) -> None:
    message = answers.cloud(kinds, HEADER, result)
    names = [(f.name, f.offset, f.datatype, f.count) for f in message.fields]
    assert names == [("x", 0, 7, 1), ("y", 4, 7, 1), ("z", 8, 7, 1), ("rgb", 12, 7, 1), ("label", 16, 6, 1)]
    assert message.point_step * message.width == message.row_step == len(message.data) and message.height == 1
    first = struct.unpack("<3fII", bytes(message.data[:20]))
    o = result[0]
    np.testing.assert_allclose(first[:3], o.points_m()[0])
    red, green, blue = map(int, result.frame.color[o.mask & (result.frame.depth > 0)][0])
    assert first[3:] == (red << 16 | green << 8 | blue, 1)
    sizes = [m.width for m in answers.object_clouds(kinds, HEADER, result)]
    assert sizes == [len(o.points_m()) for o in result] and sum(sizes) == message.width


def test_markers_are_boxes_and_numbers_after_the_old_ones_are_gone(kinds: Kinds, result: sp.Segmentation) -> None:
    clear, *drawn = answers.markers(kinds, HEADER, result).markers
    assert clear.action == 3 and [m.type for m in drawn] == [1, 9] * len(result)
    box = result[0].oriented_box()
    assert box is not None
    solid, text = drawn[:2]
    p, s, q = solid.pose.position, solid.scale, solid.pose.orientation
    np.testing.assert_allclose([p.x, p.y, p.z], box.center_m)
    np.testing.assert_allclose([s.x, s.y, s.z], box.size_m)
    np.testing.assert_allclose(rotation(q.x, q.y, q.z, q.w), box.R_camera_box, atol=1e-6)
    assert (text.text, text.id, solid.color.a) == ("1", 1, answers.OPACITY)


def test_detections_have_box_score_and_label(kinds: Kinds, result: sp.Segmentation) -> None:
    found = answers.detections(kinds, HEADER, result).detections
    assert [d.id for d in found] == [str(o.label) for o in result if o.oriented_box() is not None]
    assert found[0].results[0].hypothesis.class_id == "object"
    assert found[0].results[0].hypothesis.score == pytest.approx(result[0].score)
    assert found[0].results[0].pose.pose.position.z == found[0].bbox.center.position.z


def test_without_intrinsics_there_are_masks_but_no_points(kinds: Kinds) -> None:
    flat = sp.segment(sp.Frame(scene().color, scene().depth, None), CONFIG)
    assert len(flat) and answers.cloud(kinds, HEADER, flat).width == 0
    assert len(answers.markers(kinds, HEADER, flat).markers) == 1


def rotation(x: float, y: float, z: float, w: float) -> np.ndarray:
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def test_a_quaternion_is_its_rotation_at_every_angle() -> None:
    rng = np.random.default_rng(0)
    turns = [np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in range(100)]
    half_turns = [np.diag(d) for d in ([1.0, -1, -1], [-1.0, 1, -1], [-1.0, -1, 1], [1.0, 1, 1])]
    for R in [t * np.sign(np.linalg.det(t)) for t in turns] + half_turns:
        np.testing.assert_allclose(rotation(*quaternion(R)), R, atol=1e-9)


# --- pairs ----------------------------------------------------------------------------------------------------

MS = 1_000_000


def fed(matcher: StampMatcher, *messages: tuple[str, float]) -> list[tuple[str, str] | None]:
    """What each message completes. Messages are their own names."""
    return [matcher.add(topic, round(ms * MS), f"{topic[0]}{ms:g}") for topic, ms in messages]


def test_equal_and_near_stamps_pair_in_any_order() -> None:
    matcher = StampMatcher(20 * MS)
    assert fed(matcher, ("color", 0), ("depth", 0)) == [None, ("c0", "d0")]
    assert fed(matcher, ("depth", 103), ("color", 100)) == [None, ("c100", "d103")]
    assert fed(matcher, ("color", 200), ("depth", 221)) == [None, None]
    assert matcher.unmatched == 0
    assert fed(matcher, ("depth", 300), ("color", 305))[1] == ("c305", "d300")
    assert matcher.unmatched == 2


def test_the_nearest_stamp_is_taken() -> None:
    matcher = StampMatcher(20 * MS)
    assert fed(matcher, ("depth", 90), ("depth", 101), ("depth", 112), ("color", 100))[3] == ("c100", "d101")
    assert matcher.unmatched == 1  # 112 may still find its colour
    assert fed(matcher, ("color", 110)) == [("c110", "d112")]


def test_a_message_pairs_once_and_late_ones_are_counted() -> None:
    matcher = StampMatcher(5 * MS)
    assert fed(matcher, ("color", 100), ("depth", 100), ("depth", 100.0), ("color", 50)) == [
        None,
        ("c100", "d100"),
        None,
        None,
    ]
    assert matcher.unmatched == 1


def test_one_topic_alone_fills_no_memory() -> None:
    matcher = StampMatcher(MS)
    fed(matcher, *(("color", 33 * k) for k in range(1000)))
    assert matcher.unmatched == 1000 - KEPT


def test_time_may_start_again() -> None:
    matcher = StampMatcher(MS)
    fed(matcher, ("color", 9000), ("depth", 9000))
    assert fed(matcher, ("color", 0), ("depth", 0)) == [None, ("c0", "d0")]


@pytest.mark.parametrize("count", [5, 8, 36])
def test_every_pair_of_a_short_loop_is_found(count: int) -> None:
    matcher = StampMatcher(15 * MS)
    loop = [(topic, 100.0 * k) for k in range(count) for topic in ("color", "depth")]
    assert [sum(found is not None for found in fed(matcher, *loop)) for _ in range(4)] == [count] * 4
    assert matcher.unmatched == 0


def test_a_message_that_overtakes_another_is_no_restart() -> None:
    matcher = StampMatcher(5 * MS)
    fed(matcher, ("color", 100), ("color", 233))
    assert fed(matcher, ("color", 133), ("depth", 100), ("depth", 133), ("depth", 233)) == [
        None,
        ("c100", "d100"),
        ("c133", "d133"),
        ("c233", "d233"),
    ]


def test_sixty_pairs_with_three_gaps_are_all_found() -> None:
    matcher = StampMatcher(10 * MS)
    stamps = [33.3 * k for k in range(63)]
    messages = [(t, s) for k, s in enumerate(stamps) for t in ("color", "depth") if not (t == "depth" and k % 25 == 5)]
    assert sum(found is not None for found in fed(matcher, *messages)) == 60
    assert matcher.unmatched == 3


def test_a_new_pair_pushes_the_oldest_out() -> None:
    waiting = Waiting(2)
    pairs = [Pair(k, k, 0.0) for k in range(5)]
    for pair in pairs:
        waiting.put(pair)
    assert waiting.dropped == 3
    assert [waiting.take(0.01), waiting.take(0.01), waiting.take(0.01)] == [pairs[3], pairs[4], None]


def test_a_pair_wakes_the_thread_that_waits() -> None:
    waiting, got = Waiting(1), []
    thread = threading.Thread(target=lambda: got.append(waiting.take(20)))
    thread.start()
    waiting.put(Pair("c", "d", 0.0))
    thread.join(10)
    assert got[0].color == "c"


# --- parameters -----------------------------------------------------------------------------------------------


def test_every_field_of_every_preset_is_a_parameter_with_a_meaning() -> None:
    told = descriptions()
    for name in ("partition.gamma", "cost.k_x", "cost.k_y", "cost.k_b", "additions.rules.wall", "preset", "queue"):
        assert told[name]
    assert len(told) > 120 and "name" not in told and "cost.kind" not in told
    assert set(values_of(first_state())) == set(told)


def test_values_are_of_types_that_ros_has() -> None:
    for name in sp.PRESETS:
        for value in values_of(first_state(name)).values():
            assert isinstance(value, bool | int | float | str) or all(isinstance(v, float) for v in value)


@pytest.mark.parametrize("name", list(sp.PRESETS))
def test_values_given_back_change_nothing(name: str) -> None:
    state = first_state(name)
    values = values_of(state)
    own = {field: value for field, value in values.items() if value != "none" and field != "preset"}
    again = changed(state, {k: array.array("d", v) if isinstance(v, list) else v for k, v in own.items()})
    assert again.config.digest == state.config.digest and again.options == state.options


def test_a_field_is_changed_and_a_stage_switched_off_and_on() -> None:
    state = changed(first_state(), {"partition.gamma": 1, "rejection.max_distance_m": "none"})
    assert state.config.partition.gamma == 1.0 and state.config.rejection.max_distance_m is None
    off = changed(state, {"additions.rules.wall": "none"})
    assert off.config.additions is not None and off.config.additions.rules.wall is None
    on = changed(off, {"additions.rules.wall": "on"})
    assert on.config == state.config
    assert changed(state, {"additions.support.facing.up": "0,-1,0"}).config.additions.support.facing.up == (0, -1, 0)


def test_a_preset_comes_first_and_the_fields_with_it_count() -> None:
    state = changed(first_state(), {"partition.gamma": 0.5, "preset": "shelf", "cost.k_s": 0.7})
    assert state.config == sp.SHELF.replace(**{"partition.gamma": 0.5, "cost.k_s": 0.7})
    assert values_of(state)["additions"] == "none" and values_of(state)["cost.k_b"] == "none"


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"partition.gamma": -1.0}, "greater than or equal to 0, got -1.0"),
        ({"partition.gamma": "much"}, "got 'much'"),
        ({"cost.k_s": 0.5}, "unknown parameter"),
        ({"partition.gama": 1.0}, "unknown parameter 'partition.gama'"),
        ({"preset": "NOPE"}, "expected one of OBJECTS"),
        ({"tolerance_s": float("inf")}, "tolerance_s"),
        ({"depth_scale": -1.0}, "depth_scale"),
        ({"additions.support": "none"}, "support"),
        ({"edges.contact_low_deg": [1.0, 2.0]}, "contact_low_deg"),
    ],
)
def test_a_wrong_value_is_refused_in_one_line(changes: dict[str, Any], told: str) -> None:
    with pytest.raises(ConfigError) as caught:
        changed(first_state(), changes)
    assert told in str(caught.value) and "\n" not in str(caught.value)


# --- without rclpy --------------------------------------------------------------------------------------------


def test_without_rclpy_one_sentence_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rclpy", None)
    with pytest.raises(SpigoloError, match="needs rclpy"):
        find_kinds()
    with pytest.raises(SpigoloError) as caught:
        ros("--queue", "3", "--partition.gamma", "0.01", color="/camera/color")
    told = str(caught.value)
    assert "source /opt/ros" in told and 'pip install "spigolo[ros]"' in told and "\n" not in told


def test_a_wrong_flag_is_refused_before_the_node_starts() -> None:
    with pytest.raises(ConfigError, match=r"did you mean --partition\.gamma"):
        ros("--partition.gama", "0.01")
    with pytest.raises(ConfigError, match="unknown preset"):
        ros(preset="NOPE")
