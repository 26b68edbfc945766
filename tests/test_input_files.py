"""Files as users have them: 16-bit colour, hidden files, previews, arrays, folders with one camera, damaged headers."""

from __future__ import annotations

import json
import struct
import zlib
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from spigolo import Frame
from spigolo.errors import FileError, FrameError
from spigolo.frames.files import read_color, read_depth, read_frame, write_png
from spigolo.frames.listing import best_of_each, listed, natural_order
from spigolo.sources.paths import find_frames

H, W = 48, 64
COLOR = np.random.default_rng(0).integers(0, 255, (H, W, 3), dtype=np.uint8)
DEPTH = np.full((H, W), 800, np.uint16)
CAMERA = {"fx": 60, "fy": 60, "cx": 31.5, "cy": 23.5}
SIDECAR = b"\0\5\26\7\0\2\0\0Mac OS X        " + b"\0" * 40


def put(folder: Path, color: str = "rgb.png", depth: str = "depth.png", camera: bool = False) -> Path:
    for name, image in ((color, COLOR), (depth, DEPTH)):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        write_png(folder / name, image)
    if camera:
        (folder / "camera.json").write_text(json.dumps(CAMERA))
    return folder


def chunk(kind: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def png(width: int, height: int, bits: int, kind: int, rows: bytes, *more: bytes) -> bytes:
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, kind, 0, 0, 0))
    body = chunk(b"IDAT", zlib.compress(rows))
    return b"\x89PNG\r\n\x1a\n" + header + b"".join(more) + body + chunk(b"IEND", b"")


# --- colour ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("bits", [8, 10, 12, 14, 16])
@pytest.mark.parametrize("channels", [1, 3, 4])
def test_colour_of_more_bits_is_scaled_by_what_is_stored(tmp_path: Path, bits: int, channels: int) -> None:
    eight = np.random.default_rng(1).integers(0, 256, (H, W, channels), dtype=np.uint8)
    eight[0, 0] = 255
    eight = eight[..., 0] if channels == 1 else eight
    cv2.imwrite(str(tmp_path / "c.png"), eight.astype(np.uint16) << (bits - 8))
    if channels == 1:
        with pytest.warns(UserWarning, match=f"one channel of 16 bits and is read as a grey image of {bits} bits"):
            color = read_color(tmp_path / "c.png")
        wanted = np.repeat(eight[..., None], 3, axis=2)
    else:
        color, wanted = read_color(tmp_path / "c.png"), eight[..., 2::-1]
    np.testing.assert_array_equal(color, wanted)


def test_swapped_images_are_reported(tmp_path: Path) -> None:
    put(tmp_path)
    with pytest.raises(FrameError, match="colour first and depth second, got them swapped"):
        read_frame(tmp_path / "depth.png", tmp_path / "rgb.png", None, 0.001)
    cv2.imwrite(str(tmp_path / "rgb.jpg"), COLOR)
    with pytest.raises(FrameError, match="got them swapped"):
        read_frame(tmp_path / "depth.png", tmp_path / "rgb.jpg", None, 0.001)
    np.save(tmp_path / "depth.npy", DEPTH)
    with pytest.raises(FrameError, match="got them swapped"):
        read_frame(tmp_path / "depth.npy", tmp_path / "rgb.png", None, 0.001)
    with pytest.raises(FrameError, match="give colour first and depth second"):
        Frame(DEPTH, COLOR, None, depth_scale=0.001)


# --- decoders -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("read", [read_color, read_depth])
@pytest.mark.parametrize(
    "data",
    [
        png(0, 0, 16, 0, b""),
        b"P5\n99999 99999\n65535\n",
        b"II*\0\xff\xff\xff\xff",
        b"BM" + b"\xff" * 60,
        b"\xff\xd8\xff\xe0" + b"\0" * 40,
    ],
    ids=["no pixels", "PGM", "TIFF", "BMP", "JPEG"],
)
def test_no_decoders_exception_gets_through(tmp_path: Path, read: Any, data: bytes) -> None:
    (tmp_path / "x.png").write_bytes(data)
    with pytest.raises(FileError, match=r"expected an image in .*x\.png") as caught:
        read(tmp_path / "x.png")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("read", [read_color, read_depth])
@pytest.mark.parametrize("size", [(40000, 40000), (2**31 - 1, 1)])
def test_too_many_pixels_are_refused_before_they_are_decoded(tmp_path: Path, read: Any, size: tuple[int, int]) -> None:
    (tmp_path / "x.png").write_bytes(png(*size, 16, 0, b"\0" * 99))
    with pytest.raises(FrameError, match="expected at most 16000000 pixels"):
        read(tmp_path / "x.png")


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("d.bag", "The file is a recording: read the frames with sp.open_source or `spigolo segment RECORDING`"),
        ("d.exr", "EXR needs an OpenCV build with EXR"),
        ("d.raw", r"numpy\.fromfile"),
        ("d.png", r"Supported: PNG, TIFF"),
    ],
)
def test_messages_name_what_is_read(tmp_path: Path, name: str, words: str) -> None:
    (tmp_path / name).write_bytes(b"#ROSBAG V2.0\n" + b"\0" * 99)
    with pytest.raises(FileError, match=words):
        read_depth(tmp_path / name)


# --- arrays ---------------------------------------------------------------------------------------------------


def test_one_npz_file_is_a_frame(tmp_path: Path) -> None:
    K = np.array([[60, 0, 31.5], [0, 60, 23.5], [0, 0, 1]])
    np.savez(tmp_path / "f.npz", rgb=COLOR, depth=DEPTH / 1000, K=K)
    np.savez(tmp_path / "g.npz", color_image=COLOR, depth_image=DEPTH, intrinsic=K, depth_scale=0.001)
    for paths in find_frames([str(tmp_path / "f.npz"), *[str(tmp_path / "g.npz")] * 2]):
        frame = read_frame(paths.color, paths.depth, paths.camera)
        assert frame.camera is not None and frame.camera.fx == 60
        assert frame.depth[0, 0] == pytest.approx(0.8)
        np.testing.assert_array_equal(frame.color, COLOR)
    assert [paths.name for paths in find_frames([str(tmp_path)])] == ["f", "g"]


def test_arrays_by_name_or_alone(tmp_path: Path) -> None:
    np.savez(tmp_path / "d.npz", depth=DEPTH)
    np.savez(tmp_path / "one.npz", anything=DEPTH)
    np.savez(tmp_path / "two.npz", a=DEPTH, b=DEPTH)
    for name in ("d.npz", "one.npz"):
        np.testing.assert_array_equal(read_depth(tmp_path / name), DEPTH)
    with pytest.raises(FileError, match=r"a depth array as depth .* got the arrays a, b: rename an array"):
        read_depth(tmp_path / "two.npz")
    np.save(tmp_path / "dict.npy", {"depth": DEPTH}, allow_pickle=True)  # type: ignore[arg-type]
    with pytest.raises(FileError, match=r"pickled Python objects, such as a dict: save arrays with numpy\.savez"):
        read_depth(tmp_path / "dict.npy")
    with pytest.raises(FileError, match=r"A single \.npz file is a frame if it holds the arrays rgb and depth"):
        find_frames([str(tmp_path / "d.npz")])
    (tmp_path / "x.mcap").write_bytes(b"x")
    with pytest.raises(FileError, match=r"got the recording .*x\.mcap: read the frames with sp\.open_source"):
        find_frames([str(tmp_path / "x.mcap")])


# --- folders --------------------------------------------------------------------------------------------------


def test_hidden_files_are_no_frames(tmp_path: Path) -> None:
    put(tmp_path / "a", "rgb/000.png", "depth/000.png")
    for hidden in ("rgb/._000.png", "depth/._000.png", "rgb/.DS_Store", "depth/Thumbs.db"):
        (tmp_path / "a" / hidden).write_bytes(SIDECAR)
    assert [f.name for f in find_frames([str(tmp_path / "a")])] == ["000"]
    put(tmp_path / "b" / "f0")
    for hidden in (".cache", "__MACOSX", ".f0"):
        put(tmp_path / "b" / hidden)
    (tmp_path / "b" / "f0" / "._rgb.png").write_bytes(SIDECAR)
    assert [f.name for f in find_frames([str(tmp_path / "b")])] == ["f0"]


def test_a_lossless_file_wins_over_a_preview(tmp_path: Path) -> None:
    put(tmp_path / "a")
    for name in ("rgb.jpg", "rgb.bmp", "depth.jpg"):
        cv2.imwrite(str(tmp_path / "a" / name), COLOR)
    (frame,) = find_frames([str(tmp_path / "a")])
    assert (frame.color.name, frame.depth.name) == ("rgb.png", "depth.png")
    np.save(tmp_path / "a" / "depth.npy", DEPTH)
    assert find_frames([str(tmp_path / "a")])[0].depth.name == "depth.npy"
    put(tmp_path / "b", "color/7.png", "depth/7.png")
    cv2.imwrite(str(tmp_path / "b" / "color" / "7.jpg"), COLOR)
    cv2.imwrite(str(tmp_path / "b" / "depth" / "7.jpg"), COLOR)
    assert [(f.color.name, f.depth.name) for f in find_frames([str(tmp_path / "b")])] == [("7.png", "7.png")]
    assert [p.name for p in best_of_each([Path("x.jpg"), Path("x.tiff"), Path("y.jpg")])] == ["x.tiff", "y.jpg"]


def test_the_order_is_natural(tmp_path: Path) -> None:
    for k in (10, 9, 100, 1):
        put(tmp_path / "a", f"rgb/{k}.png", f"depth/{k}.png")
        put(tmp_path / "b" / f"frame{k}")
    assert [f.name for f in find_frames([str(tmp_path / "a")])] == ["1", "9", "10", "100"]
    assert [f.name for f in find_frames([str(tmp_path / "b")])] == ["frame1", "frame9", "frame10", "frame100"]
    assert [p.name for p in listed(tmp_path / "a" / "rgb")] == ["1.png", "9.png", "10.png", "100.png"]
    mixed = [Path(name) for name in ("a10", "b", "a2", "a02", "2")]
    assert [p.name for p in sorted(mixed, key=natural_order)] == ["2", "a02", "a2", "a10", "b"]


def test_a_camera_file_of_a_folder_holds_for_its_subfolders(tmp_path: Path) -> None:
    top = tmp_path / "in"
    for k in range(2):
        put(top / str(k))
    (top / "camera.json").write_text(json.dumps(CAMERA))
    put(top / "own", camera=True)
    found = {f.name: f.camera for f in find_frames([str(top)])}
    assert found == {"0": top / "camera.json", "1": top / "camera.json", "own": top / "own" / "camera.json"}
    assert find_frames([str(top / "0")])[0].camera == (top / "camera.json").resolve()
    files = [str(top / "0" / name) for name in ("rgb.png", "depth.png")]
    assert find_frames(files)[0].camera == (top / "camera.json").resolve()
    put(tmp_path / "rec", "color/0.png", "depth/0.png")
    (tmp_path / "rec" / "intrinsic.json").write_text("{}")
    assert find_frames([str(tmp_path / "rec")])[0].camera == tmp_path / "rec" / "intrinsic.json"
    pair = [str(tmp_path / "rec" / kind / "0.png") for kind in ("color", "depth")]
    assert find_frames(pair)[0].camera == tmp_path / "rec" / "intrinsic.json"


def test_portable_grey_maps_are_depth(tmp_path: Path) -> None:
    put(tmp_path, "color/1.png", "depth/2.png")
    (tmp_path / "depth" / "2.png").unlink()
    cv2.imwrite(str(tmp_path / "depth" / "1.pgm"), DEPTH)
    (frame,) = find_frames([str(tmp_path)])
    np.testing.assert_array_equal(read_depth(frame.depth), DEPTH)


# --- names ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("colors", "depths"),
    [
        ("rgb/color_{}.png", "depth/depth_{}.png"),
        ("{}-color.png", "{}-depth.png"),
        ("frame-{}.color.png", "frame-{}.depth.png"),
        ("my_colour_{}.png", "my_depth_{}.png"),
        ("color/IMG_{}_rgb.png", "depth/IMG_{}_depth.png"),
        ("img_{}_color.png", "img_{}_depth.png"),
        ("image_{}_rgb.png", "image_{}_depth.png"),
        ("{}_rgb.png", "{}_depth_raw.png"),
        ("{}_color.png", "{}_aligned_depth_to_color.png"),
        ("rgb000{}.png", "depth000{}.png"),
        ("kinect2_color_{}.png", "kinect2_depth_{}.png"),
    ],
)
def test_names_that_differ_in_the_word_for_colour_and_depth_are_a_frame(
    tmp_path: Path, colors: str, depths: str
) -> None:
    for k in range(3):
        put(tmp_path, colors.format(k), depths.format(k), camera=True)
    found = find_frames([str(tmp_path)])
    assert [(p.color, p.depth) for p in found] == [
        (tmp_path / colors.format(k), tmp_path / depths.format(k)) for k in range(3)
    ]
    assert len({p.name for p in found}) == 3 and {p.camera for p in found} == {tmp_path / "camera.json"}
    words = [str(tmp_path / name.format(k)) for name in (colors, depths) for k in range(3)]  # as a shell lists them
    assert [(p.color, p.depth) for p in find_frames(words)] == [(p.color, p.depth) for p in found]


def test_names_that_do_not_say_colour_or_depth_stay_in_the_order_given(tmp_path: Path) -> None:
    for name in ("a", "b", "c", "d"):
        put(tmp_path, f"{name}.png", f"{name}.png")
    found = find_frames([str(tmp_path / f"{name}.png") for name in ("c", "d", "a", "b")])
    assert [(p.color.stem, p.depth.stem) for p in found] == [("c", "d"), ("a", "b")]
    with pytest.raises(FileError, match=r"expected rgb\.png and depth\.png"):
        find_frames([str(tmp_path)])


@pytest.mark.parametrize("lost", [["1_depth.png"], ["1_depth.png", "2_color.png"]])
def test_a_file_without_a_partner_is_named(tmp_path: Path, lost: list[str]) -> None:
    for k in range(3):
        put(tmp_path, f"{k}_color.png", f"{k}_depth.png")
    for name in lost:
        (tmp_path / name).unlink()
    left = "02" if len(lost) == 1 else "0"
    for words in ([str(tmp_path)], sorted(map(str, tmp_path.iterdir()))):
        with pytest.warns(UserWarning, match=r"images have no partner of their name: .*1_color\.png"):
            assert [p.name for p in find_frames(words)] == list(left)


def test_two_npz_files_are_two_frames(tmp_path: Path) -> None:
    for name, focal in (("a", 500.0), ("b", 600.0)):
        K = [[focal, 0, 31.5], [0, focal, 23.5], [0, 0, 1]]
        np.savez(tmp_path / f"{name}.npz", rgb=COLOR, depth=DEPTH / 1000, K=K)
    (tmp_path / "camera.json").write_text(json.dumps(CAMERA))
    a, b = (tmp_path / f"{name}.npz" for name in "ab")
    assert [(p.name, p.color, p.depth, p.camera) for p in find_frames([str(a), str(b)])] == [
        ("a", a, a, a),
        ("b", b, b, b),
    ]
    assert [p.name for p in find_frames([str(a), str(a)])] == ["a"]
    frame = read_frame(a, a)
    assert frame.camera is not None and frame.camera.fx == 500
    np.savez(tmp_path / "c.npz", depth=DEPTH)
    (pair,) = find_frames([str(a), str(tmp_path / "c.npz")])
    assert (pair.color, pair.depth) == (a, tmp_path / "c.npz")
