"""Sources: the same frames from folders, data sets and bags, with everything counted that is not a frame."""

from __future__ import annotations

import shutil
import struct
import subprocess
import sys
import tracemalloc
import zlib
from pathlib import Path
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

import naive
import spigolo as sp
from bags import COLOR, DEPTH, INFO, KINDS, START_NS, STEP_NS, Bag, usual_bag
from spigolo.errors import FileError, FrameError
from spigolo.sources.base import SizedSource
from spigolo.sources.pairing import pair_stamps
from spigolo.sources.ros_images import color_of, depth_of

SCENE = Path(sp.__file__).parent / "demo_scene"
K = [150.0, 0, 79.5, 0, 150.0, 59.5, 0, 0, 1]


@pytest.fixture(scope="module")
def frame() -> sp.Frame:
    """The demo scene at a quarter of its size. Depth is in whole millimetres."""
    whole = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    depth = np.round(whole.depth[::4, ::4] * 1000).astype(np.uint16)
    return sp.Frame(whole.color[::4, ::4], depth, K, depth_scale=0.001)


def millimetres(frame: sp.Frame) -> np.ndarray:
    return np.round(frame.depth * 1000).astype(np.uint16)


# --- folders and data sets ------------------------------------------------------------------------------------


def test_a_folder_and_two_files_are_sources_of_one_frame() -> None:
    for uri in (SCENE, str(SCENE), [SCENE / "rgb.png", SCENE / "depth.png"]):
        with sp.open_source(uri) as source:
            (found,) = source
            assert source.count == 1 and source.intrinsics.endswith("camera.json") and not source.live
        assert found.camera is not None and found.camera.fx == 525 and found.shape == (480, 640)


def test_a_broken_frame_of_a_folder_is_counted_and_the_others_come(tmp_path: Path) -> None:
    for name in ("a", "b", "c"):
        shutil.copytree(SCENE, tmp_path / name)
    (tmp_path / "b" / "depth.png").write_bytes(b"\x89PNG")
    source = sp.open_source(tmp_path)
    assert isinstance(source, SizedSource) and len(source) == 3 and source[2].name == "c"
    with pytest.warns(UserWarning, match=r"b: expected an image in .*depth\.png"):
        assert [f.name for f in source] == ["a", "c"]
    assert source.report() == sp.Report(frames=2, broken=1)
    told = []
    source.on_broken = lambda name, error: told.append((name, type(error)))
    assert len(list(source)) == 2 and told == [("b", FileError)]


def test_tum_lists_pair_by_time_whatever_the_names(tmp_path: Path) -> None:
    for folder, late in (("rgb", 0.0), ("depth", 0.005)):
        (tmp_path / folder).mkdir()
        names = [f"{k / 30 + late:.6f}.png" for k in range(3)]
        for name in names:
            shutil.copy(SCENE / f"{folder}.png", tmp_path / folder / name)
        (tmp_path / f"{folder}.txt").write_text("".join(f"{n[:-4]} {folder}/{n}\n" for n in names))
    source = sp.open_source(tmp_path)
    first, *_ = frames = list(source)
    assert len(frames) == source.count == 3 and source.intrinsics == "from the data set (Tum)"
    assert isinstance(source, SizedSource) and source[1].name == frames[1].name
    assert first.unit_m == pytest.approx(1 / 5000)
    (other, *_) = sp.open_source(f"dataset:{tmp_path}", "60deg", depth_scale=1 / 1000)
    assert other.camera is not None and other.camera.fx == pytest.approx(320 / np.tan(np.radians(30)))
    np.testing.assert_allclose(other.depth, first.depth * 5, rtol=1e-5)


def test_tum_lists_keep_stamps_and_take_the_users_camera_and_scale(tmp_path: Path) -> None:
    for folder in ("rgb", "depth"):
        (tmp_path / folder).mkdir()
        shutil.copy(SCENE / f"{folder}.png", tmp_path / folder / "a.png")
        (tmp_path / f"{folder}.txt").write_text(f"1305031102.175304 {folder}/a.png\n")
    (tmp_path / "intrinsics.txt").write_text("600 600 319.5 239.5")
    (first,) = sp.open_source(tmp_path)
    assert first.stamp_ns == 1_305_031_102_175_304_000
    assert first.camera is not None and first.camera.fx == 600
    mine = tmp_path.parent / "mine.json"
    mine.write_text('{"fx": 500, "fy": 500, "cx": 319.5, "cy": 239.5, "depth_scale": 0.001}')
    (other,) = sp.open_source(tmp_path, mine)
    assert other.camera is not None and other.camera.fx == 500
    np.testing.assert_allclose(other.depth, first.depth * 5, rtol=1e-5)
    (third,) = sp.open_source(tmp_path, mine, depth_scale=0.002)
    np.testing.assert_allclose(third.depth, first.depth * 10, rtol=1e-5)


# --- bags -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
def test_a_bag_gives_all_pairs_and_counts_the_rest(tmp_path: Path, frame: sp.Frame, kind: str) -> None:
    path = usual_bag(kind, frame).write(tmp_path)
    with sp.open_source(path) as source:
        assert source.count == 60 and source.intrinsics == f"topic {INFO}"
        with pytest.warns(UserWarning, match=rf"{DEPTH}, message 60: the Image message cannot be read"):
            found = list(source)
        report = source.report()
    assert (report.frames, report.unmatched, report.broken) == (60, 3, 1)
    assert str(report) == "60 frames, 3 unmatched images (no partner within 20 ms), 1 broken"
    for number, one in enumerate(found):
        assert one.stamp_ns == START_NS + number * STEP_NS
        assert one.camera == frame.camera
        np.testing.assert_array_equal(one.color, np.roll(frame.color, number, axis=1))
        np.testing.assert_allclose(one.depth, np.roll(frame.depth, number, axis=1), atol=1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_a_frame_of_a_bag_is_read_by_its_number(tmp_path: Path, frame: sp.Frame, kind: str) -> None:
    bag = usual_bag(kind, frame, pairs=12)
    bag.add_image(DEPTH, START_NS + 12 * STEP_NS, millimetres(frame), "16UC1", cut=100)  # the partner of an image
    bag.add_image(COLOR, START_NS + 12 * STEP_NS, frame.color, "rgb8")
    source = sp.open_source(bag.write(tmp_path))
    assert isinstance(source, SizedSource) and len(source) == 13
    source.on_broken = lambda *_: None
    inorder = list(source)
    assert len(inorder) == 12
    for number in (7, 0, 11, -2):
        one = source[number]
        same = inorder[number if number >= 0 else 11]
        assert (one.name, one.stamp_ns) == (same.name, same.stamp_ns)
        assert np.array_equal(one.color, same.color) and np.array_equal(one.depth, same.depth)
    with pytest.raises(FrameError):
        source[12]
    with pytest.raises(IndexError):
        source[13]


@pytest.mark.parametrize("name", ["ros2-mcap", "ros2-sqlite"])
def test_the_storage_file_of_a_ros_2_bag_serves_alone_and_so_does_its_folder(
    tmp_path: Path, frame: sp.Frame, name: str
) -> None:
    path = usual_bag(name, frame, 4, 0, 0).write(tmp_path)
    (file,) = (p for p in path.iterdir() if p.suffix in (".mcap", ".db3"))
    alone = shutil.copy(file, tmp_path / f"alone{file.suffix}")
    (tmp_path / "around").mkdir()
    shutil.copy(file, tmp_path / "around")
    for uri in (path, alone, tmp_path / "around"):
        assert len(list(sp.open_source(uri))) == 4


def test_a_corrupt_message_with_a_partner_costs_its_pair_alone(tmp_path: Path, frame: sp.Frame) -> None:
    bag = usual_bag("ros2-mcap", frame, 5, 0, 0)
    bag.add_image(COLOR, START_NS + 9 * STEP_NS, frame.color, "rgb8")
    bag.add_image(DEPTH, START_NS + 9 * STEP_NS, millimetres(frame), "16UC1", cut=300)
    bag.messages.append((START_NS + 20 * STEP_NS, COLOR, "sensor_msgs/msg/Image", b"\0\1"))
    with sp.open_source(bag.write(tmp_path)) as source, pytest.warns(UserWarning, match="message"):
        assert [f.name for f in source] == [f"{k:06d}" for k in range(5)]
    report = source.report()
    assert (report.frames, report.unmatched, report.broken) == (5, 0, 2)


def test_topics_are_guessed_or_named(tmp_path: Path, frame: sp.Frame) -> None:
    bag = Bag("ros2-mcap")
    for k in range(3):
        stamp = START_NS + k * STEP_NS
        bag.add_image("/camera/infra1/image_rect_raw", stamp, frame.color[..., 0], "mono8")
        bag.add_image("/camera/depth/image_rect_raw", stamp, millimetres(frame)[::2, ::2], "16UC1")
        bag.add_image(DEPTH, stamp, millimetres(frame), "16UC1")
        bag.add_image(COLOR, stamp, frame.color, "rgb8")
        bag.add_info("/camera/depth/camera_info", stamp, [75, 0, 39.5, 0, 75, 29.5, 0, 0, 1], (60, 80))
        bag.add_info(INFO, stamp, K, frame.shape)
    path = bag.write(tmp_path)
    (first, *_) = sp.open_source(path)
    np.testing.assert_array_equal(first.color, frame.color)
    assert first.camera == frame.camera
    infra = sp.open_source(f"{path}?color=/camera/infra1/image_rect_raw&info={INFO}&tolerance_ms=1")
    (one, *_) = infra
    np.testing.assert_array_equal(one.color[..., 2], frame.color[..., 0])
    with pytest.raises(FileError, match=r"there is no color topic /rgb in ros2-mcap\. Topics: "):
        sp.open_source(path, color="/rgb")
    with pytest.raises(FileError, match="unknown option colour"):
        sp.open_source(path, colour="/rgb")


ENCODINGS = ("rgb8", "bgr8", "rgba8", "bgra8", "jpeg", "png", "rgb8", "rgb8")
DEPTHS = (
    "16UC1",
    "mono16",
    "32FC1",
    "compressedDepth png",
    "compressedDepth 32FC1",
    "png",
    "compressedDepth rvl",
    "compressedDepth rvl 32FC1",
)


@pytest.mark.parametrize("kind", ["ros1.bag", "ros2-mcap"])
def test_every_encoding_gives_the_same_frame(tmp_path: Path, frame: sp.Frame, kind: str) -> None:
    """Red stays red, and a metre a metre."""
    rgb, mm, metres = frame.color, millimetres(frame), np.where(frame.depth > 0, frame.depth, np.nan)
    bgr, alpha = rgb[..., ::-1], np.full((*frame.shape, 1), 255, np.uint8)
    images = {"rgb8": rgb, "bgr8": bgr, "rgba8": np.dstack([rgb, alpha]), "bgra8": np.dstack([bgr, alpha])}
    for k, (color, depth) in enumerate(zip(ENCODINGS, DEPTHS, strict=True)):
        bag, stamp = Bag(kind), START_NS
        if color in images:
            bag.add_image("/rgb/image", stamp, images[color], color, pad=7 * k)
        else:
            suffix = {"jpeg": ".jpg", "png": ".png"}[color]
            bag.add_compressed("/rgb/image/compressed", stamp, bgr, f"rgb8; {color} compressed bgr8", suffix)
        if depth in ("16UC1", "mono16"):
            bag.add_image("/depth/image", stamp, mm, depth, pad=2)
        elif depth == "32FC1":
            bag.add_image("/depth/image", stamp, metres.astype(np.float32), depth)
        elif depth.endswith("32FC1"):
            inverse = np.where(frame.depth > 0, 100 / np.maximum(frame.depth, 0.01), 0)
            quantised = np.round(inverse * 1).astype(np.uint16)
            bag.add_compressed("/depth/image/compressedDepth", stamp, quantised, f"32FC1; {depth[:-6]}")
        else:
            bag.add_compressed("/depth/image/compressedDepth", stamp, mm, f"16UC1; {depth}")
        folder = tmp_path / f"{k}"
        folder.mkdir()
        with sp.open_source(bag.write(folder), K) as source:
            (one,) = source
        near = 60 if color == "jpeg" else 0
        assert np.abs(one.color.astype(int) - rgb).mean() <= near / 10, color
        rough = 0.02 if "32FC1" in depth and "compressed" in depth else 1e-6
        np.testing.assert_allclose(one.depth, frame.depth, rtol=rough, atol=1e-6, err_msg=depth)


def packed(data: bytes, told: str) -> SimpleNamespace:
    return SimpleNamespace(format=told, data=data)


RVL = struct.pack("<i2f2i", 0, 100, 0, 8, 6) + naive.pack_rvl(np.arange(48).astype(np.uint16))


@pytest.mark.parametrize(
    ("data", "text"),
    [
        (RVL[:19], "expected at least 20 bytes of RVL depth, got 19"),
        (RVL[:-4], "the RVL depth of 8x6 is damaged or cut off"),
        (RVL[:20], "the RVL depth of 8x6 is damaged or cut off"),
        (RVL[:12] + struct.pack("<2i", 0, 6) + RVL[20:], "expected the size of RVL depth in its header, got 0x6"),
        (RVL[:12] + struct.pack("<2i", -8, -6) + RVL[20:], "expected the size of RVL depth in its header, got -8x-6"),
        (
            RVL[:12] + struct.pack("<2i", 10**6, 10**6) + RVL[20:],
            "expected at most 16000000 pixels, got 1000000x1000000",
        ),
    ],
)
def test_damaged_rvl_is_told_and_takes_no_memory(data: bytes, text: str) -> None:
    np.testing.assert_array_equal(depth_of(packed(RVL, "16UC1; compressedDepth rvl")).ravel(), np.arange(48))
    tracemalloc.start()
    with pytest.raises(FrameError, match=text):
        depth_of(packed(data, "16UC1; compressedDepth rvl"))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 1_000_000


def test_a_small_png_of_many_pixels_is_refused_before_it_is_decoded() -> None:
    header = struct.pack(">2I5B", 60_000, 60_000, 16, 0, 0, 0, 0)
    data = b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + b"IHDR" + header + struct.pack(">I", zlib.crc32(header))
    for read in (depth_of, color_of):
        with pytest.raises(FrameError, match="expected at most 16000000 pixels, got 60000x60000"):
            read(packed(data, "16UC1; compressedDepth png"))


def test_a_rectified_topic_takes_the_projection_and_no_distortion(tmp_path: Path, frame: sp.Frame) -> None:
    names = {
        "image_raw": True,
        "image_rect_color": False,
        "rectified/image": False,
        "unrectified": True,
        "direct": True,
    }
    for name, undistorted in names.items():
        bag = Bag("ros2-mcap")
        bag.add_info("/rgb/camera_info", START_NS, K, frame.shape, D=[0.1, -0.05, 0, 0, 0])
        bag.add_image(f"/rgb/{name}", START_NS, frame.color, "rgb8")
        bag.add_image("/depth_registered/image", START_NS, millimetres(frame), "16UC1")
        (tmp_path / name).mkdir(parents=True)
        (one,) = sp.open_source(bag.write(tmp_path / name))
        assert one.undistorted is undistorted and one.camera is not None and one.camera.fx == 150


def test_what_is_no_bag_or_has_no_depth_is_told(tmp_path: Path, frame: sp.Frame) -> None:
    for name in ("x.bag", "x.db3", "x.mcap"):
        (tmp_path / name).write_bytes(b"nothing of the kind" * 9)
        with pytest.raises(FileError, match=rf"{name}: not a readable ROS bag"):
            sp.open_source(tmp_path / name)
    bag = Bag("ros2-mcap")
    bag.add_image(COLOR, START_NS, frame.color, "rgb8")
    with pytest.raises(FileError, match="expected a topic with depth as 16UC1, mono16 or 32FC1"):
        sp.open_source(bag.write(tmp_path))
    with pytest.raises(FileError, match=r"expected a recording, but there is no .*none\.mcap"):
        sp.open_source(tmp_path / "none.mcap")


def test_a_bag_that_was_cut_off_is_refused_with_one_line(tmp_path: Path, frame: sp.Frame) -> None:
    path = usual_bag("ros2-sqlite", frame, 20, 0, 0).write(tmp_path)
    (file,) = path.glob("*.db3")
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    with pytest.raises(FileError, match="not a readable ROS bag") as caught:
        sp.open_source(path)
    assert "\n" not in str(caught.value)


# --- pairing --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(20))
def test_pairs_are_one_to_one_within_the_tolerance_and_nearest_first(seed: int) -> None:
    rng = np.random.default_rng(seed)
    colors, depths = (rng.integers(0, 2000, rng.integers(0, 40)).tolist() for _ in range(2))
    pairs = pair_stamps(colors, depths, 30)
    for side in zip(*pairs, strict=True):
        assert len(set(side)) == len(side)
    assert all(abs(colors[c] - depths[d]) <= 30 for c, d in pairs)
    free = set(range(len(colors))) - {c for c, _ in pairs}, set(range(len(depths))) - {d for _, d in pairs}
    assert not [(c, d) for c in free[0] for d in free[1] if abs(colors[c] - depths[d]) <= 30]
    assert [colors[c] for c, _ in pairs] == sorted(colors[c] for c, _ in pairs)


# --- extras ---------------------------------------------------------------------------------------------------

WITHOUT = """
import sys
for name in ("rosbags", "rosbags.highlevel", "pyrealsense2", "rerun"):
    sys.modules[name] = None
sys.argv = ["spigolo", *sys.argv[1:]]
from spigolo.cli import main
main()
"""


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["segment", "x.mcap"], 'pip install "spigolo[bags]"'),
        (["segment", "realsense:"], 'pip install "spigolo[realsense]"'),
        (["doctor", "realsense:x.db3"], 'pip install "spigolo[realsense]"'),
        (["view", str(SCENE)], 'pip install "spigolo[view]"'),
    ],
)
def test_with_the_core_alone_a_command_names_the_line_that_mends_it(
    tmp_path: Path, words: list[str], line: str
) -> None:
    for name in ("x.mcap", "x.db3"):
        (tmp_path / name).write_bytes(b"x")
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT, *words], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2 and line in done.stderr and len(done.stderr.splitlines()) == 1, done.stderr


def test_importing_spigolo_and_opening_a_folder_load_no_extra() -> None:
    code = f"import sys, spigolo as sp; list(sp.open_source({str(SCENE)!r})); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"rosbags", "pyrealsense2", "rerun", "supervision"} & set(done.stdout.split())
    assert cv2.__name__ in done.stdout.split()


def test_a_scale_holds_for_floating_point_depth_and_is_positive(tmp_path: Path, frame: sp.Frame) -> None:
    bag = Bag("ros2-mcap")
    bag.add_image(COLOR, START_NS, frame.color, "rgb8")
    bag.add_image(DEPTH, START_NS, frame.depth * np.float32(1000), "32FC1")
    bag.add_info(INFO, START_NS, K, frame.shape)
    path = bag.write(tmp_path)
    for source in (sp.open_source(path, depth_scale=0.001), sp.open_source(f"{path}?depth_scale=0.001")):
        np.testing.assert_allclose(next(iter(source)).depth, frame.depth, rtol=1e-5)
    for scale in (0, -0.001, float("nan")):
        with pytest.raises(FileError, match="expected depth_scale as positive metres per unit"):
            sp.open_source(path, depth_scale=scale)


def test_intrinsics_of_another_image_are_not_taken(tmp_path: Path, frame: sp.Frame) -> None:
    bag = Bag("ros2-mcap")
    bag.add_image(COLOR, START_NS, frame.color, "rgb8")
    bag.add_image(DEPTH, START_NS, millimetres(frame), "16UC1")
    bag.add_info("/camera/infra1/camera_info", START_NS, K, frame.shape)
    path = bag.write(tmp_path)
    with pytest.warns(UserWarning, match=f"no CameraInfo for {COLOR}, and /camera/infra1/camera_info belongs"):
        source = sp.open_source(path)
    assert next(iter(source)).camera is None and not source.intrinsics
    assert next(iter(sp.open_source(path, info="/camera/infra1/camera_info"))).camera == frame.camera
