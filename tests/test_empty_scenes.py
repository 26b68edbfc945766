"""Rendered tables, bins and shelves without any object, and that nothing is found there."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

import spigolo as sp
from spigolo.lab.synthetic import meshes
from spigolo.lab.synthetic.empty_scenes import FAMILIES, empty_scene, empty_scenes, scene_with_a_box
from spigolo.lab.synthetic.scene import CAMERA
from spigolo.lab.synthetic.surfaces import SURFACES, surface
from test_synthetic import need_renderer

MOST_OBJECTS = 8
"""In fifty scenes: pieces of shelves and of prints still come back."""


@pytest.fixture(scope="module")
def frames() -> list[sp.Frame]:
    """Fifty empty scenes, rendered once."""
    need_renderer()
    return list(empty_scenes(50))


def of_family(frames: list[sp.Frame], family: str) -> Iterator[sp.Frame]:
    return (frame for frame in frames if frame.name.startswith(family))


@pytest.mark.filterwarnings("ignore:the largest plane is covered with image edges", "ignore:no support plane")
def test_next_to_nothing_is_found_where_there_is_nothing(frames: list[sp.Frame]) -> None:
    found = {frame.name: len(sp.segment(frame, sp.OBJECTS)) for frame in frames}
    assert sum(found.values()) <= MOST_OBJECTS, found


@pytest.mark.parametrize("family", FAMILIES)
def test_a_box_is_found_where_it_stands_alone(family: str) -> None:
    need_renderer()
    found = []
    for seed in range(1, 5):
        frame, box = scene_with_a_box(family, seed)
        masks = [o.mask for o in sp.segment(frame, sp.OBJECTS)]
        found.append(max((np.sum(m & box) / np.sum(m | box) for m in masks), default=0.0) > 0.7)
    assert sum(found) >= 3, found


def test_each_family_has_its_turn(frames: list[sp.Frame]) -> None:
    assert [frame.name for frame in frames[:4]] == ["table-0", "bin-0", "shelf-0", "table-1"]
    assert len({frame.name for frame in frames}) == len(frames) == 50


def test_frames_are_those_of_the_camera_and_none_is_like_another(frames: list[sp.Frame]) -> None:
    for frame in frames:
        assert frame.camera == CAMERA
        assert (frame.color.shape, frame.color.dtype) == ((480, 640, 3), np.uint8)
        assert (frame.depth.shape, frame.depth.dtype) == ((480, 640), np.float32)
        assert frame.color.std() > 2
    assert len({frame.depth.tobytes() for frame in frames}) == len({frame.color.tobytes() for frame in frames}) == 50


def test_depth_is_that_of_a_structured_light_camera(frames: list[sp.Frame]) -> None:
    for frame in frames:
        seen_m = frame.depth[frame.depth > 0]
        assert seen_m.size > 0.5 * frame.depth.size
        assert seen_m.min() >= 0.4
        assert seen_m.max() <= 4.5
        assert 0.5 < np.median(seen_m) < 2.2
    missing = {family: [np.mean(f.depth == 0) for f in of_family(frames, family)] for family in FAMILIES}
    assert all(0.005 < np.mean(shares) < 0.35 for shares in missing.values())
    assert np.median(missing["shelf"]) > np.median(missing["table"])


def test_shelves_are_dark_and_tables_are_not(frames: list[sp.Frame]) -> None:
    table, shelf = (np.median([f.color.mean() for f in of_family(frames, name)]) for name in ("table", "shelf"))
    assert shelf < 0.75 * table


@pytest.mark.parametrize("family", FAMILIES)
def test_equal_seeds_give_equal_frames(frames: list[sp.Frame], family: str) -> None:
    first = next(of_family(frames, family))
    again = empty_scene(family, 0)
    np.testing.assert_array_equal(again.color, first.color)
    np.testing.assert_array_equal(again.depth, first.depth)


def test_an_unknown_family_is_refused() -> None:
    with pytest.raises(ValueError, match="expected one of table, bin, shelf"):
        empty_scene("kitchen", 0)


@pytest.mark.parametrize("kind", SURFACES)
def test_surfaces_are_seeded(kind: str) -> None:
    first, again, other = (surface(kind, np.random.default_rng(seed)) for seed in (4, 4, 5))
    np.testing.assert_array_equal(first, again)
    assert first.dtype == np.uint8 and first.shape[2] == 3 and first.shape[0] == first.shape[1]
    assert np.any(first != other)


def test_a_prism_encloses_its_volume_and_a_tub_what_its_wall_takes() -> None:
    outline, outward = meshes.rounded_rectangle((0.3, 0.2), 0.05, per_corner=40)
    np.testing.assert_allclose(np.linalg.norm(outward, axis=1), 1.0)
    area_m2 = 0.3 * 0.2 - (4 - np.pi) * 0.05**2
    assert volume_m3(meshes.prism(outline, -0.1, 0.3)) == pytest.approx(0.4 * area_m2, rel=0.001)
    wall = meshes.tub((0.3, 0.2), 0.05, [meshes.line((0.01, 0), (0.01, 0.1), (0, 0.1), (0, 0), (0.01, 0))])
    length_m = 2 * (0.2 + 0.1) + 2 * np.pi * 0.055
    assert volume_m3(wall) == pytest.approx(0.01 * 0.1 * length_m, rel=0.01)


def volume_m3(mesh: meshes.Mesh) -> float:
    a, b, c = np.moveaxis(mesh.vertices_m[mesh.triangles], 1, 0)
    return float(np.sum(a * np.cross(b, c)) / 6)
