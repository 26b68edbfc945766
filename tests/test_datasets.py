"""Each layout is written small and read back; what is half there is refused in one sentence."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

import spigolo as sp
from spigolo.datasets import (
    Bop,
    DataSet,
    Instance,
    Model,
    Rutgers,
    Sample,
    Tejani,
    UwScenes,
    rutgers_name,
    tejani_name,
    uw_scenes_name,
    write_bop,
    write_rutgers,
    write_tejani,
    write_uw_scenes,
)
from spigolo.datasets.visibility import render_depth

CAMERA = sp.Camera(60.0, 61.0, 31.2, 23.7, 64, 48)
ABOUT = "Boxes before a wall."


def box(name: str, size_m: tuple[float, float, float]) -> Model:
    """A box around the origin, coloured by its corners."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * np.array(size_m) / 2
    triangles = [
        (0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4),
        (1, 5, 7), (1, 7, 3),
    ]  # fmt: skip
    colors = (127 + 128 * np.sign(corners)).clip(0, 255).astype(np.uint8)
    return Model(name, corners, np.array(triangles, np.int32), colors)


def pose_at(x: float, y: float, z: float, turn: float = 0.4) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3] = cv2.Rodrigues(np.array([0.3, turn, 0.1]))[0]
    pose[:3, 3] = x, y, z
    return pose


def sample_of(name: str, models: list[Model], poses: list[np.ndarray]) -> Sample:
    """Boxes before a wall at 1.2 m, with a stripe of missing depth."""
    depth = np.full((48, 64), 1.2, np.float32)
    labels = np.zeros((48, 64), np.int32)
    for label, (model, pose) in enumerate(zip(models, poses, strict=True), start=1):
        drawn = render_depth(model, pose, CAMERA)
        nearer = (drawn > 0) & (drawn < depth)
        depth[nearer], labels[nearer] = drawn[nearer], label
    depth = np.round(depth * 1000) / 1000
    depth[:, :3] = 0
    rng = np.random.default_rng(len(name))
    color = rng.integers(0, 256, (48, 64, 3), dtype=np.uint8)
    instances = tuple(Instance(k, m.name, p) for k, (m, p) in enumerate(zip(models, poses, strict=True), start=1))
    return Sample(sp.Frame(color, depth, CAMERA, name), labels, instances)


LEFT, RIGHT, BEHIND = pose_at(-0.15, 0, 0.7), pose_at(0.18, 0.05, 0.8, -0.6), pose_at(-0.05, 0, 0.95)
BOOK, SOAP = box("book", (0.2, 0.25, 0.1)), box("soap", (0.15, 0.1, 0.1))
MUG, BOWL, VASE = box("coffee_mug_5", (0.2, 0.25, 0.1)), box("bowl_2", (0.15, 0.1, 0.1)), box("vase", (0.1, 0.1, 0.1))
MILK = box("Milk", (0.15, 0.2, 0.1))


def rutgers(folder: Path) -> list[Sample]:
    samples = [sample_of(rutgers_name("book", "K", 2, 1, k), [BOOK], [LEFT]) for k in range(2)]
    samples.append(sample_of(rutgers_name("soap", "A", 0, 0, 3), [SOAP], [RIGHT]))
    assert write_rutgers(folder, samples, [BOOK, SOAP], ABOUT) == 3
    return samples


def uw(folder: Path) -> list[Sample]:
    samples = [
        sample_of(uw_scenes_name("table_small_1", 1), [MUG, BOWL, VASE], [LEFT, RIGHT, BEHIND]),
        sample_of(uw_scenes_name("table_small_1", 3), [BOWL], [LEFT]),
        sample_of(uw_scenes_name("desk_1", 12), [], []),
    ]
    assert write_uw_scenes(folder, samples, ABOUT) == 3
    return samples


def tejani(folder: Path) -> list[Sample]:
    samples = [sample_of(tejani_name("Milk", k), [MILK] * 3, [LEFT, RIGHT, BEHIND]) for k in (0, 12)]
    assert write_tejani(folder, samples, [MILK], ABOUT) == 2
    return samples


def bop(folder: Path) -> list[Sample]:
    samples = [sample_of(f"00000{s}/000004", [BOOK, SOAP, BOOK], [LEFT, RIGHT, BEHIND]) for s in (1, 2)]
    assert write_bop(folder, samples, [BOOK, SOAP], ABOUT) == 2
    return samples


WRITTEN: dict[str, tuple[Callable[[Path], list[Sample]], type[DataSet]]] = {
    "rutgers": (rutgers, Rutgers),
    "uw": (uw, UwScenes),
    "tejani": (tejani, Tejani),
    "bop": (bop, Bop),
}


@pytest.mark.parametrize("layout", WRITTEN)
def test_what_is_written_reads_back(layout: str, tmp_path: Path) -> None:
    write, reader = WRITTEN[layout]
    samples = {sample.frame.name: sample for sample in write(tmp_path / "set")}
    found = reader(tmp_path / "set")
    assert found.rendered and len(found) == len(samples)
    assert {entry.name for entry in found} == set(samples)
    for entry in pickle.loads(pickle.dumps(list(found))):
        wanted = samples[entry.name]
        read = entry.read_sample()
        assert read.frame.name == entry.name and read.frame.camera == CAMERA
        assert np.array_equal(read.frame.color, wanted.frame.color)
        np.testing.assert_allclose(read.frame.depth, wanted.frame.depth, atol=1e-6)
        truth = entry.read_truth()
        assert truth is not None and entry.labelling == "part"
        if layout == "uw":  # labels go by colours, and a vase has none
            names = {i.label: i.model for i in wanted.instances if i.model != "vase"}
            expected = np.array([0, *(names.get(k, "") for k in range(1, 4))], object)[wanted.labels]
            assert set(truth.names.values()) == set(names.values())
            for label, name in truth.names.items():
                assert np.array_equal(truth.labels == label, expected == name)
            continue
        assert np.array_equal(truth.labels, wanted.labels)
        for a, b in zip(read.instances, wanted.instances, strict=True):
            np.testing.assert_allclose(a.pose, b.pose, atol=1e-9)
            assert a.label == b.label
