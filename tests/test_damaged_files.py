"""Files of every kind, damaged: they are read, or refused in a sentence of ours, and nothing else happens."""

from __future__ import annotations

import gzip
import json
import random
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import spigolo as sp
from spigolo.frames.files import read_camera, read_color, write_png
from spigolo.lab.datasets import guess
from spigolo.lab.datasets.meshes import read_model, write_model
from spigolo.lab.evaluation import read_rows
from spigolo.lab.experiments import evaluate, make_methods
from spigolo.lab.fitting import read_search
from test_datasets import BOOK, WRITTEN, cloud, images, pcd, put_camera, read_all, write_image

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")
WORDS = [b"", b"0", b"-1", b"1e999", b"NaN", b"null", b"true", b'""', b"[]", b"{}", b"99999999999", b"\x00", b"\xff"]


CAMERAS = {
    "camera.json": json.dumps(
        {"fx": 60, "fy": 61.5, "cx": 31, "cy": 23, "width": 64, "height": 48, "depth_scale": 0.001}
    ),
    "realsense.json": json.dumps({"ppx": 31, "ppy": 23, "fx": 60, "fy": 60, "coeffs": [0.1, 0, 0, 0, 0]}),
    "open3d.json": json.dumps({"width": 64, "height": 48, "intrinsic_matrix": [60, 0, 0, 0, 60, 0, 31, 23, 1]}),
    "info.yaml": "image_width: 64\nimage_height: 48\ndistortion_model: plumb_bob\n"
    "camera_matrix: {rows: 3, cols: 3, data: [60, 0, 31, 0, 60, 23, 0, 0, 1]}\n"
    "distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n",
    "echo.yaml": "header: {frame_id: a}\nheight: 48\nwidth: 64\nk: [60, 0, 31, 0, 60, 23, 0, 0, 1]\n"
    "d: [0.1, 0, 0, 0, 0]\n---\n",
}


@dataclass(frozen=True)
class Damage:
    """What happens to a file; seen with the seed when a test fails."""

    way: str
    seed: int

    def of(self, data: bytes) -> bytes:
        """The damaged bytes."""
        rng = random.Random(self.seed)
        start, end = sorted(rng.randrange(len(data) + 1) for _ in range(2))
        if self.way == "cut":
            return data[:start]
        if self.way == "hole":
            return data[:start] + data[min(end, start + 40) :]
        if self.way == "twice":
            return data[:end] + data[start:]
        if self.way == "word":
            found = list(re.finditer(rb"-?[0-9][0-9.eE+-]*|[A-Za-z_]+", data[:4000]))
            one = rng.choice(found) if found else re.match(rb"", data)
            assert one is not None
            return data[: one.start()] + rng.choice(WORDS) + data[one.end() :]
        flipped = bytearray(data)
        for _ in range(rng.choice([1, 3, 30]) if data else 0):
            flipped[rng.randrange(min(len(data), rng.choice([64, 10**6])))] = rng.randrange(256)
        return bytes(flipped)


damages = st.builds(Damage, st.sampled_from(["cut", "hole", "twice", "word", "flip"]), st.integers(0, 2**32 - 1))


@contextmanager
def damaged(path: Path, damage: Damage) -> Iterator[None]:
    """The file is damaged within."""
    whole = path.read_bytes()
    path.write_bytes(damage.of(whole))
    read_model.cache_clear()
    try:
        yield
    finally:
        path.write_bytes(whole)


def refusal(read: Callable[[], Any]) -> str:
    """The sentence that refuses it, "" where it is read."""
    try:
        read()
    except sp.SpigoloError as error:
        return str(error)
    return ""


def files(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.is_file())


def mosd(folder: Path) -> None:
    labels = images()[2]
    for k, form in enumerate(("ascii", "binary", "binary_compressed")):
        (folder / f"learn{k}.pcd").write_bytes(pcd(cloud(labels), form))


def frames(folder: Path) -> None:
    color, depth, labels = images()
    for name in ("f0", "f1"):
        for file, image in zip(("rgb.png", "depth.png", "label.png"), (color, depth, labels), strict=True):
            write_image(folder / "shop" / name / file, image)
        (folder / "shop" / name / "camera.json").write_text(CAMERAS["camera.json"])
        (folder / "shop" / name / "info.json").write_text('{"fully_labelled": true, "ignore_label": 255}')
    (folder / "splits.json").write_text('{"near_duplicate_groups": [["shop/f0", "shop/f1"]]}')


def tum(folder: Path) -> None:
    color, depth, _ = images(1 / 5000)
    write_image(folder / "rgb" / "1.0.png", color)
    write_image(folder / "depth" / "1.01.png", depth)
    (folder / "rgb.txt").write_text("# colour\n1.0 rgb/1.0.png\n")
    (folder / "depth.txt").write_text("1.01 depth/1.01.png\n")
    put_camera(folder)


LAYOUTS: dict[str, Callable[[Path], Any]] = {
    **{name: write for name, (write, _) in WRITTEN.items()},
    "mosd": mosd,
    "frames": frames,
    "tum": tum,
}


@pytest.fixture(scope="module", params=sorted(LAYOUTS))
def layout(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp(request.param)
    LAYOUTS[request.param](folder)
    read_all(folder)
    return folder


@given(damage=damages, which=st.integers(0, 2**16))
def test_a_data_set_with_a_damaged_file_is_read_or_refused(layout: Path, damage: Damage, which: int) -> None:
    every = files(layout)
    with damaged(every[which % len(every)], damage):
        assert "\n" not in refusal(lambda: read_all(layout))


@pytest.fixture(scope="module")
def singles(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[Path, Callable[[Path], Any]]]:
    """A file of each kind that is read by itself, and what reads it."""
    folder = tmp_path_factory.mktemp("singles")
    color, depth, _ = images()
    found: dict[str, tuple[Path, Callable[[Path], Any]]] = {}
    for name, text in CAMERAS.items():
        (folder / name).write_text(text)
        found[name] = folder / name, lambda path: read_camera(path, 64, 48)
    (folder / "mine.toml").write_text(sp.OBJECTS.to_toml())
    (folder / "based.toml").write_text(
        'base = "TABLE"\n[partition]\ngamma = 0.002\n[rejection]\nmax_missing = "none"\n'
    )
    for name in ("mine.toml", "based.toml"):
        found[name] = folder / name, sp.preset
    write_png(folder / "rgb.png", color)
    found["rgb.png"] = folder / "rgb.png", read_color
    write_png(folder / "depth.png", depth)
    np.save(folder / "depth.npy", depth)
    for name in ("depth.png", "depth.npy"):
        found[f"frame of {name}"] = (
            folder / name,
            lambda path: sp.read_frame(folder / "rgb.png", path, folder / "camera.json"),
        )
    write_model(folder / "mesh.ply", BOOK)
    (folder / "mesh.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n")
    for name in ("mesh.ply", "mesh.obj"):
        found[name] = folder / name, read_model
    frames(folder)
    evaluate(guess(folder / "shop"), make_methods(["toscana2016"], [sp.TABLE]), folder / "rows.jsonl")
    found["rows.jsonl"] = folder / "rows.jsonl", read_rows
    packed = Path(__file__).parents[1] / "docs" / "data" / "trials-felzenszwalb2004.jsonl.gz"
    begun = b"".join(gzip.decompress(packed.read_bytes()).splitlines(keepends=True)[:6])
    (folder / "trials.jsonl").write_bytes(begun)
    (folder / "trials.jsonl.gz").write_bytes(gzip.compress(begun))
    for name in ("trials.jsonl", "trials.jsonl.gz"):
        found[name] = folder / name, read_search
    for path, read in found.values():
        read(path)
    return found


@given(damage=damages, which=st.integers(0, 2**16))
def test_a_damaged_file_is_read_or_refused(
    singles: dict[str, tuple[Path, Callable[[Path], Any]]], damage: Damage, which: int
) -> None:
    path, read = singles[sorted(singles)[which % len(singles)]]
    with damaged(path, damage):
        assert "\n" not in refusal(lambda: read(path))
