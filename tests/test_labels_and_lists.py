"""Label images and lists as other tools write them."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from spigolo.errors import CameraError, FileError
from spigolo.frames.files import read_labels
from spigolo.lab.datasets import Ocid, guess
from test_datasets import images, write_image
from test_input_files import chunk, png

LABELS = np.array([[0, 1, 1, 0], [0, 2, 2, 3]], np.uint8)
PALETTE = bytes((k * step) % 256 for k in range(256) for step in (37, 91, 17))


def packed(labels: np.ndarray, bits: int) -> bytes:
    """The rows of an image in `bits` a pixel, each behind its filter of 0."""
    each = [np.unpackbits(labels[..., None], axis=2)[..., 8 - bits :].reshape(len(labels), -1)]
    return b"".join(b"\0" + np.packbits(row).tobytes() for row in each[0])


@pytest.mark.parametrize("bits", [2, 4, 8])
@pytest.mark.parametrize("kind", [0, 3])
def test_an_indexed_or_packed_image_is_read_by_its_numbers(tmp_path: Path, bits: int, kind: int) -> None:
    more = (chunk(b"PLTE", PALETTE[: 3 * 2**bits]), chunk(b"tRNS", b"\0")) if kind == 3 else ()
    (tmp_path / "l.png").write_bytes(png(4, 2, bits, kind, packed(LABELS, bits), *more))
    np.testing.assert_array_equal(read_labels(tmp_path / "l.png"), LABELS)


def test_other_labels_stay_as_they_are(tmp_path: Path) -> None:
    for kind in (np.uint8, np.uint16):
        cv2.imwrite(str(tmp_path / "l.png"), (LABELS * 60).astype(kind))
        np.testing.assert_array_equal(read_labels(tmp_path / "l.png"), LABELS * 60)
    (tmp_path / "cut.png").write_bytes(png(4, 2, 8, 3, packed(LABELS, 8), chunk(b"PLTE", PALETTE))[:60])
    (tmp_path / "no bits.png").write_bytes(png(4, 2, 0, 3, packed(LABELS, 8), chunk(b"PLTE", PALETTE)))
    for name in ("cut.png", "no bits.png"):
        with pytest.raises(FileError):
            read_labels(tmp_path / name)


def own_frame(folder: Path, labels: np.ndarray) -> None:
    color, depth, _ = images()
    for name, image in (("rgb", color), ("depth", depth), ("label", labels)):
        write_image(folder / "set" / "f0" / f"{name}.png", image)
    (folder / "set" / "camera.json").write_text('{"fx": 60, "fy": 61, "cx": 31.2, "cy": 23.7, "depth_scale": 0.001}')


def test_a_mask_of_0_and_255_is_reported(tmp_path: Path) -> None:
    labels = images()[2]
    own_frame(tmp_path, np.where(labels > 0, 255, 0).astype(np.uint8))
    (entry,) = guess(tmp_path)
    with pytest.warns(UserWarning, match="holds only 0 and 255, and 255 is the ignored label"):
        entry.read_truth()
    (tmp_path / "set" / "f0" / "info.json").write_text('{"ignore_label": 254}')
    (entry,) = guess(tmp_path)
    truth = entry.read_truth()
    assert truth is not None and set(np.unique(truth.labels)) == {0, 255}


def test_the_camera_of_a_set_of_own_frames_may_lie_above_them(tmp_path: Path) -> None:
    own_frame(tmp_path, images()[2])
    (entry,) = guess(tmp_path)
    assert entry.read().camera.cx == 31.2  # type: ignore[union-attr]
    assert tmp_path / "set" / "camera.json" in entry.files


# --- published sets -------------------------------------------------------------------------------------------


def ocid(folder: Path, place: str) -> Path:
    color, depth, labels = images()
    for kind, image in (("rgb", color), ("depth", depth), ("label", labels)):
        write_image(folder / place / "seq01" / kind / "a.png", image)
    return folder


@pytest.mark.parametrize(
    ("place", "opened", "background"),
    [
        ("OCID/ARID20/table/top", "OCID", (1, 2)),
        ("OCID/ARID20/floor/bottom", "OCID", (1,)),
        ("table/OCID/ARID20/floor/bottom", "table/OCID", (1,)),
        ("on the table/ARID20/floor/bottom", "on the table/ARID20", (1,)),
        ("table/ARID10/floor/bottom", "table/ARID10/floor", (1,)),
        ("floor/YCB10/table/top", "floor/YCB10/table/top", (1, 2)),
        ("table/mine/bottom", "table/mine", (1,)),
    ],
)
def test_ocid_does_not_depend_on_folders_above(
    tmp_path: Path, place: str, opened: str, background: tuple[int, ...]
) -> None:
    (entry,) = Ocid(ocid(tmp_path, place) / opened)
    assert entry.background == background  # type: ignore[attr-defined]


def test_a_sets_own_depth_scale_counts(tmp_path: Path) -> None:
    ocid(tmp_path, "ARID20/floor/bottom")
    pinhole = {"fx": 60, "fy": 61, "cx": 31.2, "cy": 23.7, "width": 64, "height": 48}
    path = tmp_path / "camera.json"

    def farthest_m() -> float:
        return float(guess(tmp_path)[0].read().depth.max())

    path.write_text(json.dumps(pinhole))
    usual_m = farthest_m()
    path.write_text(json.dumps({**pinhole, "depth_scale": 0.0001}))
    assert farthest_m() == pytest.approx(usual_m / 10)
    path.write_text(json.dumps({**pinhole, "depth_scale": 1000}))
    with pytest.raises(CameraError, match=r"camera\.json as metres per unit"):
        guess(tmp_path)
    path.write_text(json.dumps({**pinhole, "scale": 1000}))
    with pytest.raises(CameraError, match=r"replace the field with depth_scale 0\.001"):
        guess(tmp_path)


# --- TUM ------------------------------------------------------------------------------------------------------


LINE = "{t} {k}/{t}.png\n"


def tum(folder: Path, colors: list[str], depths: list[str], encoding: str = "utf-8", line: str = LINE) -> Path:
    color, depth, _ = images(1 / 5000)
    for kind, times, image in (("rgb", colors, color), ("depth", depths, depth)):
        for time in times:
            write_image(folder / kind / f"{time}.png", image)
        text = "# time file\n" + "".join(line.format(t=time, k=kind) for time in times)
        (folder / f"{kind}.txt").write_bytes(text.encode(encoding))
    return folder


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("line", ["{t} {k}/{t}.png\n", "{t},{k}/{t}.png\r\n", "{t}\t{k}\\{t}.png\r\n"])
def test_lists_of_other_editors_are_read(tmp_path: Path, encoding: str, line: str) -> None:
    assert len(guess(tum(tmp_path / "seq", ["1.00", "2.00"], ["1.01", "2.01"], encoding, line))) == 2


@pytest.mark.parametrize("unit", ["s", "ms", "us", "ns"])
def test_stamps_may_count_parts_of_a_second(tmp_path: Path, unit: str) -> None:
    start, per_s = 1_305_031_453, {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}[unit]

    def stamps(offset_ms: int) -> list[str]:
        times = [(start * 1000 + 40 * k + offset_ms) for k in range(3)]
        return [f"{t / 1000:.3f}" if unit == "s" else str(t * per_s // 1000) for t in times]

    assert len(guess(tum(tmp_path / "near", stamps(0), stamps(15)))) == 3
    with pytest.raises(FileError, match="got the nearest 25 ms apart: all 3 colour images have no partner"):
        guess(tum(tmp_path / "far", stamps(0), stamps(-25)[:1]))


def test_a_clock_that_starts_at_0_may_count_nanoseconds(tmp_path: Path) -> None:
    colors, depths = ["0", "33333333", "66666666"], ["5000000", "38333333", "71666666"]
    assert len(guess(tum(tmp_path / "seq", colors, depths))) == 3


def test_lists_that_do_not_meet_say_how_far_they_are_apart(tmp_path: Path) -> None:
    with pytest.raises(FileError, match=r"within 20 ms .* got the nearest 40 ms apart: all 2 colour images"):
        guess(tum(tmp_path / "a", ["10.00", "10.10"], ["10.04", "10.14"]))
    with pytest.raises(FileError, match="got the nearest 1000 s apart"):
        guess(tum(tmp_path / "b", ["10.00"], ["1010.00"]))
    colors = ["1.0", "2.0", "3.0", "4.0"]
    with pytest.warns(UserWarning, match="3 of 4 colour images have no depth within 20 ms"):
        assert len(guess(tum(tmp_path / "c", colors, ["1.0", "7.0"]))) == 1
    with pytest.raises(FileError, match=r"expected `time file` in line 2"):
        guess(tum(tmp_path / "d", ["nan"], ["1.0"]))
