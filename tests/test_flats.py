"""Objects of a few millimetres: patches of colour that lie higher than the surface around them."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

import spigolo as sp
from spigolo.additions.flats import find_flats, surface_heights
from spigolo.additions.plane import Plane
from spigolo.objects.verdicts import Reason

SHAPE = (240, 320)
CAMERA = sp.Camera(300.0, 300.0, 159.5, 119.5, 320, 240)
TABLE = Plane(np.array([0.0, 0.0, -1.0]), 0.6)
Y, X = np.mgrid[: SHAPE[0], : SHAPE[1]]
DISK = (Y - 120) ** 2 + (X - 150) ** 2 < 26**2
RULE = sp.settings.Flats()


def bent(noise_m: float = 0.001, bend_m: float = 0.0) -> np.ndarray:
    """Depth (H, W) of a table at 0.6 m that sinks towards the corners, with noise."""
    far = ((Y - 119.5) / 120) ** 2 + ((X - 159.5) / 160) ** 2
    depth = 0.6 + bend_m * far + noise_m * np.random.default_rng(0).normal(size=SHAPE)
    return np.asarray(depth, np.float32)


def outline(mask: np.ndarray) -> np.ndarray:
    """Edges along the outline of a mask."""
    return cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8)) > 0


def found_in(
    depth: np.ndarray, edges: np.ndarray, rule: sp.settings.Flats = RULE, free: np.ndarray | None = None
) -> np.ndarray:
    everywhere = np.ones(SHAPE, bool) if free is None else free
    return find_flats(everywhere, depth, CAMERA, TABLE, edges, rule)


def overlap(mask: np.ndarray, other: np.ndarray) -> float:
    return float(np.sum(mask & other) / np.sum(mask | other))


@pytest.mark.parametrize("bend_m", [0.0, 0.012])
@pytest.mark.parametrize(("thick_m", "is_found"), [(0.008, True), (0.002, False), (0.0, False)])
def test_a_disk_is_found_by_its_height_and_a_print_is_not(thick_m: float, is_found: bool, bend_m: float) -> None:
    depth = bent(bend_m=bend_m) - np.float32(thick_m) * DISK
    found = found_in(depth, outline(DISK))
    assert found.max() == int(is_found)
    if is_found:
        assert overlap(found == 1, DISK) > 0.8


def test_height_without_a_border_of_colour_is_no_object() -> None:
    depth = bent() - np.float32(0.008) * DISK
    assert not found_in(depth, np.zeros(SHAPE, bool)).any()


def test_the_limit_grows_with_the_noise_of_the_surface() -> None:
    depth = bent(noise_m=0.005) - np.float32(0.008) * DISK
    assert not found_in(depth, outline(DISK)).any()
    assert found_in(depth, outline(DISK), RULE.model_copy(update={"noise_factor": 0.0})).max() == 1


def test_a_patch_at_the_edge_of_the_table_or_image_is_left_out() -> None:
    """The right half of the surroundings lies 10 cm lower, as behind the edge of a table."""
    depth = bent() - np.float32(0.008) * DISK
    cliff = depth + np.float32(0.1) * (X > 160) * ~DISK
    assert not found_in(cliff, outline(DISK)).any()
    cut = np.roll(DISK, -140, axis=1)
    cut[:, 300:] = False
    assert not found_in(bent() - np.float32(0.008) * cut, outline(cut)).any()


def test_the_bottom_of_a_tray_belongs_to_it() -> None:
    inner = (Y - 120) ** 2 + (X - 150) ** 2 < 15**2
    depth = bent() - np.float32(0.012) * (DISK & ~inner)
    found = found_in(depth, outline(DISK) | outline(inner))
    assert found.max() == 1 and overlap(found == 1, DISK) > 0.8


def test_pixels_of_objects_are_never_taken() -> None:
    """A small object lies on the disk."""
    thing = (abs(Y - 120) < 8) & (abs(X - 150) < 8)
    found = found_in(bent() - np.float32(0.008) * DISK, outline(DISK), free=~thing)
    assert found.max() == 1 and not (found > 0)[thing].any()


def test_a_loop_does_not_take_what_it_surrounds() -> None:
    loop = ((Y - 120) ** 2 + (X - 150) ** 2 < 90**2) & ((Y - 120) ** 2 + (X - 150) ** 2 > 82**2)
    depth = bent() - np.float32(0.009) * (loop | DISK)
    found = found_in(depth, outline(loop) | outline(DISK))
    inside = found[120, 150]
    assert inside and overlap(found == inside, DISK) > 0.8


def test_too_few_pixels_near_the_plane_give_no_surface() -> None:
    heights = np.full((40, 40), 0.5, np.float32)
    assert surface_heights(heights, np.ones((40, 40), bool), 0.02) is None
    assert not find_flats(np.ones(SHAPE, bool), np.zeros(SHAPE, np.float32), CAMERA, TABLE, DISK, RULE).any()


def scene(thick_m: float) -> sp.Frame:
    """A blue disk on a white table."""
    color = np.full((*SHAPE, 3), 220, np.uint8)
    color[DISK] = (30, 60, 160)
    color += np.random.default_rng(1).integers(0, 6, color.shape, dtype=np.uint8)
    return sp.Frame(color, bent(noise_m=0.003) - np.float32(thick_m) * DISK, CAMERA)


def test_a_flat_object_is_returned_by_objects_alone() -> None:
    thick, printed = scene(0.007), scene(0.0)
    result = sp.segment(thick)
    assert len(result) == 1 and overlap(result[0].mask, DISK) > 0.8
    assert result.regions.labels.max() + 1 == result.regions.count
    assert len(sp.segment(printed)) == 0
    assert len(sp.segment(thick, sp.OBJECTS.replace(additions={"flats": None}))) == 0
    assert len(sp.segment(thick, sp.OBJECTS.replace(additions={"rules": {"max_length_m": 0.05}}))) == 0
    assert len(sp.segment(thick, roi=(0, 0, 60, 60))) == 0


@pytest.mark.parametrize("smaller", [1, 2])
def test_small_images_have_a_ring_too(smaller: int) -> None:
    """A disk is found in an image of any size, but not at the edge of a table."""
    some = np.s_[::smaller, ::smaller]
    camera = sp.Camera(300 / smaller, 300 / smaller, 159.5 / smaller, 119.5 / smaller, 320 // smaller, 240 // smaller)
    rule = sp.OBJECTS.at_size((240 // smaller, 320 // smaller)).additions.flats
    edges = outline(DISK[some])
    for cliff_m, count in ((0.0, 1), (0.1, 0)):
        depth = (bent() - np.float32(0.008) * DISK + np.float32(cliff_m) * (X > 160) * ~DISK)[some]
        found = find_flats(np.ones(depth.shape, bool), np.ascontiguousarray(depth), camera, TABLE, edges, rule)
        assert found.max() == count


def test_half_resolution_returns_one_object_for_one_disk() -> None:
    assert len(sp.segment(scene(0.007), sp.OBJECTS.replace(additions={"resolution": "half"}))) <= 1


def test_a_rejected_flat_object_has_its_reason() -> None:
    result = sp.segment(scene(0.007), sp.OBJECTS.replace(additions={"rules": {"max_length_m": 0.05}}))
    assert [r.reason for r in result.rejected if overlap(r.mask, DISK) > 0.8] == [Reason.TOO_LONG]
