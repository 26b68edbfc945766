"""Camera files and arrays of every form, damaged: they are read, or refused in a sentence of ours."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spigolo.frames.files import read_camera, read_color, read_depth, read_labels
from test_camera_forms import COLMAP, COLUMNS, DEXYCB, KALIBR, OPENCV, ORB_SLAM, ROWS, K
from test_damaged_files import Damage, damages, refusal
from test_input_files import COLOR, DEPTH, chunk, png
from test_labels_and_lists import LABELS, PALETTE, packed

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")


def saved(write: Callable[[Any], None]) -> bytes:
    file = io.BytesIO()
    write(file)
    return file.getvalue()


def meta_mat() -> bytes:
    scipy_io = pytest.importorskip("scipy.io")
    return saved(lambda file: scipy_io.savemat(file, {"intrinsic_matrix": K, "factor_depth": [[1000]]}))


def camera(path: Path) -> Any:
    return read_camera(path, 640, 480, image="000001")


FILES: dict[str, tuple[Callable[[Path], Any], Callable[[], bytes]]] = {
    "opencv.yml": (camera, OPENCV.encode),
    "kalibr.yaml": (camera, KALIBR.encode),
    "orb.yaml": (camera, ORB_SLAM.encode),
    "dexycb.yml": (camera, DEXYCB.encode),
    "open3d.json": (camera, f'{{"intrinsic_matrix": {COLUMNS}, "depth_scale": 1000}}'.encode),
    "scene_camera.json": (camera, f'{{"1": {{"cam_K": {ROWS}, "depth_scale": 0.1}}}}'.encode),
    "info.json": (
        camera,
        (
            f'{{"k": {ROWS}, "d": [], "width": 640, "height": 480, "binning_x": 2, "binning_y": 2, "roi":'
            ' {"x_offset": 2, "y_offset": 0, "width": 600, "height": 400}, "p": [1,0,1,0,0,1,1,0,0,0,1,0]}'
        ).encode,
    ),
    "cameras.txt": (camera, COLMAP.encode),
    "cam_K.txt": (camera, lambda: "\n".join(" ".join(map(str, row)) for row in K.tolist()).encode()),
    "camK.npy": (camera, lambda: saved(lambda file: np.save(file, K))),
    "calib.npz": (camera, lambda: saved(lambda file: np.savez(file, mtx=K, dist=np.zeros(5)))),
    "meta.mat": (camera, meta_mat),
    "depth.npz": (read_depth, lambda: saved(lambda file: np.savez_compressed(file, depth=DEPTH))),
    "rgb.npz": (read_color, lambda: saved(lambda file: np.savez(file, rgb=COLOR))),
    "indexed.png": (read_labels, lambda: png(4, 2, 4, 3, packed(LABELS, 4), chunk(b"PLTE", PALETTE[:48]))),
    "grey.png": (read_color, lambda: png(4, 2, 16, 0, b"\0" + b"\3\1" * 4 + b"\0" + b"\2\7" * 4)),
}


@pytest.mark.parametrize("name", FILES)
@given(damage=damages)
def test_a_damaged_file_is_read_or_refused(tmp_path_factory: pytest.TempPathFactory, name: str, damage: Damage) -> None:
    read, make = FILES[name]
    path = tmp_path_factory.mktemp("damaged", numbered=True) / name
    path.write_bytes(damage.of(make()))
    sentence = refusal(lambda: read(path))
    assert "\n" not in sentence


@pytest.mark.parametrize("name", FILES)
def test_whole_files_are_read(tmp_path: Path, name: str) -> None:
    read, make = FILES[name]
    (tmp_path / name).write_bytes(make())
    if name == "info.json":
        assert "binning_x 2" in refusal(lambda: read(tmp_path / name))
    else:
        assert refusal(lambda: read(tmp_path / name)) == ""


@given(st.text(max_size=60))
def test_any_text_is_a_camera_or_refused(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    path = tmp_path_factory.mktemp("text", numbered=True) / "k.txt"
    path.write_text(text, encoding="utf-8", errors="replace")
    assert refusal(lambda: camera(path)) != "" or len(text.split()) in (1, 4, 9, 12, 16) or "," in text or ":" in text
