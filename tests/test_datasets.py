"""Each layout is written small and read back; what is half there is refused in one sentence."""

from __future__ import annotations

import pickle
import re
import shutil
import struct
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

import spigolo as sp
from spigolo.errors import CameraError, FileError, FrameError
from spigolo.lab.datasets import (
    Bop,
    DataSet,
    Folders,
    Instance,
    Model,
    Mosd,
    Ocid,
    Osd,
    Rutgers,
    Sample,
    Tejani,
    Tum,
    UwScenes,
    UwScenesV2,
    find_labelled_frames,
    guess,
    rutgers_name,
    tejani_name,
    uw_scenes_name,
    write_bop,
    write_rutgers,
    write_tejani,
    write_uw_scenes,
)
from spigolo.lab.datasets.boxes import box_of
from spigolo.lab.datasets.meshes import read_model, write_model
from spigolo.lab.datasets.rutgers import read_pose
from spigolo.lab.datasets.uw_scenes import UwFrame, labels_of
from spigolo.lab.datasets.visibility import render_depth, visible_mask
from spigolo.lab.experiments import evaluate, make_methods

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


# --- what the layouts say in particular -----------------------------------------------------------------------


def test_a_group_is_a_position_a_video_or_a_scene(tmp_path: Path) -> None:
    for layout, (write, _) in WRITTEN.items():
        write(tmp_path / layout)
    groups = {layout: [entry.group for entry in guess(tmp_path / layout)] for layout in WRITTEN}
    assert groups["rutgers"] == ["rutgers-apc-rendered/book-K-2-1"] * 2 + ["rutgers-apc-rendered/soap-A-0-0"]
    assert groups["uw"] == ["uw-scenes-v1-rendered/desk_1"] + ["uw-scenes-v1-rendered/table_small_1"] * 2
    assert groups["tejani"] == ["tejani-rendered/scene_06"] * 2
    assert groups["bop"] == ["bop-rendered/000001", "bop-rendered/000002"]


def test_a_set_that_is_named_is_fully_labelled(tmp_path: Path) -> None:
    bop(tmp_path)
    assert {entry.labelling for entry in guess(tmp_path, ["*-rendered"])} == {"full"}


def test_originals_have_the_camera_known_for_them_and_no_mark(tmp_path: Path) -> None:
    rutgers(tmp_path)
    for name in ("rendered.json", "camera.json"):
        (tmp_path / name).unlink()
    found = Rutgers(tmp_path)
    assert not found.rendered
    assert {entry.data_set for entry in found} == {"rutgers-apc"}
    assert found[0].camera == sp.Camera(572.41140, 573.57043, 325.26110, 242.04899, 640, 480)


def test_boxes_of_uw_scenes_go_around_the_masks(tmp_path: Path) -> None:
    samples = {sample.frame.name: sample for sample in uw(tmp_path)}
    for entry in UwScenes(tmp_path):
        assert isinstance(entry, UwFrame)
        sample = samples[entry.name]
        wanted = [
            box_of(*{"coffee_mug_5": ("coffee_mug", 5), "bowl_2": ("bowl", 2)}[i.model], sample.labels == i.label)
            for i in sample.instances
            if i.model != "vase"
        ]
        assert list(entry.read_boxes()) == wanted


def test_strange_colours_of_a_mask_are_ignored() -> None:
    picture = np.zeros((2, 3, 3), np.uint8)
    picture[0, 0], picture[1, 2] = (0, 128, 0), (1, 2, 3)
    truth = labels_of(picture)
    assert truth.names == {12: "coffee_mug_5"}
    assert np.argwhere(truth.labels).tolist() == [[0, 0]] and np.argwhere(truth.ignore).tolist() == [[1, 2]]


def test_masks_may_be_next_to_the_frames_or_named_or_absent(tmp_path: Path) -> None:
    uw(tmp_path / "set")
    shutil.move(tmp_path / "set" / "quickfind_mask_data", tmp_path / "elsewhere")
    assert {entry.labelling for entry in UwScenes(tmp_path / "set")} == {"none"}
    assert {entry.read_truth() for entry in UwScenes(tmp_path / "set")} == {None}
    named = UwScenes(tmp_path / "set", masks=tmp_path / "elsewhere")
    shutil.copytree(tmp_path / "elsewhere", tmp_path / "quickfind_mask_data")
    beside = UwScenes(tmp_path / "set")
    assert {entry.labelling for data_set in (named, beside) for entry in data_set} == {"part"}


def test_masks_of_bop_are_rendered_where_there_are_none(tmp_path: Path) -> None:
    samples = {sample.frame.name: sample for sample in bop(tmp_path)}
    for scene in (tmp_path / "test").iterdir():
        shutil.rmtree(scene / "mask_visib")
    for entry in Bop(tmp_path):
        truth = entry.read_truth()
        assert truth is not None and np.array_equal(truth.labels, samples[entry.name].labels)


def test_a_stored_mask_of_bop_is_taken_as_it_is(tmp_path: Path) -> None:
    bop(tmp_path)
    mask = np.zeros((48, 64), np.uint8)
    mask[5, 6] = 255
    cv2.imwrite(str(tmp_path / "test" / "000001" / "mask_visib" / "000004_000001.png"), mask)
    truth = Bop(tmp_path)[0].read_truth()
    assert truth is not None and np.argwhere(truth.labels == 2).tolist() == [[5, 6]]


def test_a_pixel_is_visible_up_to_15_mm_behind_the_surface_and_where_nothing_was_measured() -> None:
    drawn = np.full((1, 4), 1.0, np.float32)
    measured = np.array([[0, 1.2, 0.986, 0.984]], np.float32)
    camera = sp.Camera(1e6, 1e6, 0, 0, 4, 1)
    assert visible_mask(drawn, measured, camera).tolist() == [[True, True, True, False]]
    assert not visible_mask(drawn * 0, measured, camera).any()
    slanted = sp.Camera(1.0, 1.0, -1.0, 0.0, 1, 1)  # the ray is sqrt 2 as long as its depth
    assert visible_mask(drawn[:, :1], np.array([[0.9895]], np.float32), slanted).all()
    assert not visible_mask(drawn[:, :1], np.array([[0.9885]], np.float32), slanted).any()


def test_a_sphere_is_drawn_where_geometry_has_it() -> None:
    angle, height = np.meshgrid(np.linspace(0, 2 * np.pi, 97)[:-1], np.linspace(-1, 1, 61))
    ring = np.sqrt(1 - height**2)
    vertices = 0.2 * np.stack([ring * np.cos(angle), ring * np.sin(angle), height], -1).reshape(-1, 3)
    quads = [(96 * i + j, 96 * i + (j + 1) % 96, 96 * (i + 1) + (j + 1) % 96, 96 * (i + 1) + j)
             for i in range(60) for j in range(96)]  # fmt: skip
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], np.int32)
    pose = pose_at(0.1, -0.05, 0.9)
    depth = render_depth(Model("ball", vertices, triangles), pose, CAMERA)
    y, x = np.mgrid[:48, :64]
    ray = np.stack([(x - CAMERA.cx) / CAMERA.fx, (y - CAMERA.cy) / CAMERA.fy, np.ones(x.shape)], -1)
    along, center = (ray**2).sum(-1), pose[:3, 3]
    half = ray @ center
    root = half**2 - along * (center @ center - 0.2**2)
    wanted = np.where(root > 0, (half - np.sqrt(np.maximum(root, 0))) / along, 0)
    both = (depth > 0) & (wanted > 0)
    assert both.sum() > 300 and (depth > 0).sum() == pytest.approx((wanted > 0).sum(), rel=0.03)
    assert np.abs(depth - wanted)[both].max() < 0.02 and np.abs(depth - wanted)[both].mean() < 0.001


@pytest.mark.parametrize("kind", [".ply", ".obj", ".stl"])
def test_a_model_reads_back_from_each_format(kind: str, tmp_path: Path) -> None:
    path = tmp_path / f"book{kind}"
    if kind == ".ply":
        write_model(path, BOOK, 0.001)
    elif kind == ".obj":
        vertices = [f"v {x} {y} {z}" for x, y, z in BOOK.vertices_m * 1000]
        faces = ["f {} {} {}".format(*(triangle + 1)) for triangle in BOOK.triangles]
        path.write_text("\n".join([*vertices, *faces, ""]))
    else:
        records = [np.array([[0, 0, 0], *BOOK.vertices_m[t] * 1000], "<f4").tobytes() + b"\0\0" for t in BOOK.triangles]
        path.write_bytes(bytes(80) + struct.pack("<I", len(records)) + b"".join(records))
    model = read_model(path, 0.001)
    assert model.name == "book" and model.triangles.dtype == np.int32
    np.testing.assert_allclose(model.vertices_m[model.triangles], BOOK.vertices_m[BOOK.triangles], atol=1e-6)
    if kind == ".ply":
        assert model.colors is not None and np.array_equal(model.colors, BOOK.colors)


def test_a_mesh_with_faces_of_missing_corners_is_refused(tmp_path: Path) -> None:
    """A kernel that draws it would read beside the array."""
    for number, (corners, faces) in enumerate([(3, "3 0 1 3"), (3, "3 0 1 -1"), (2, "3 0 1 2")]):
        path = tmp_path / f"book{number}.ply"
        header = (
            f"ply\nformat ascii 1.0\nelement vertex {corners}\nproperty float x\nproperty float y\nproperty float z\n"
        )
        rows = "\n".join(f"{k} 0 1" for k in range(corners))
        path.write_text(
            f"{header}element face 1\nproperty list uchar int vertex_indices\nend_header\n{rows}\n{faces}\n"
        )
        with pytest.raises(
            FileError, match=r"expected a triangle mesh in .*(corners that do not exist|cannot be read)"
        ):
            read_model(path)


@pytest.mark.parametrize("far", [1e12, 1e300, np.inf, np.nan])
def test_what_lies_nowhere_near_the_image_is_not_drawn(far: float) -> None:
    """A loop over its pixels would not end."""
    vertices = np.array([[far, 0, 1], [far, 0.1, 1], [far, 0, 1.1], [0, 0, 1], [0.1, 0, 1], [0, 0.1, 1]])
    triangles = np.array([[0, 1, 2], [0, 3, 4]], np.int32)
    assert not render_depth(Model("far", vertices, triangles), np.eye(4), CAMERA).any()
    near = np.array([*triangles.tolist(), [3, 4, 5]], np.int32)
    assert render_depth(Model("both", vertices, near), np.eye(4), CAMERA).any()


@pytest.mark.parametrize(("written", "spoilt"), [("rows: 3", "rows: 99999999999"), ("cols: 3", "cols: 0")])
def test_sizes_of_a_pose_that_ended_the_process_are_not_believed(written: str, spoilt: str, tmp_path: Path) -> None:
    """OpenCV's own reader corrupts memory over them."""
    rutgers(tmp_path)
    path = tmp_path / "book-pose-K-2-1-0.yml"
    expected = read_pose(path)
    path.write_text(path.read_text().replace(written, spoilt))
    assert np.array_equal(read_pose(path), expected)


@pytest.mark.parametrize("number", [".nan", ".inf", "one", "[1]", "1, 1"])
def test_a_pose_of_other_than_twelve_finite_numbers_is_refused(number: str, tmp_path: Path) -> None:
    rutgers(tmp_path)
    path = tmp_path / "book-pose-K-2-1-0.yml"
    path.write_text(re.sub(r"data: \[ [^,]+", f"data: [ {number}", path.read_text()))
    with pytest.raises(FileError, match="object_rotation_wrt_camera as an OpenCV matrix"):
        read_pose(path)


# --- layouts that are only read -------------------------------------------------------------------------------


def write_image(path: Path, image: np.ndarray) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(path), image[..., ::-1] if image.ndim == 3 else image)


def images(unit_m: float = 0.001) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Colour, stored depth, labels 0..3 of a frame."""
    sample = sample_of("frame", [BOOK, SOAP, BOOK], [LEFT, RIGHT, BEHIND])
    return sample.frame.color, np.round(sample.frame.depth / unit_m).astype(np.uint16), sample.labels.astype(np.uint8)


def put_camera(folder: Path) -> None:
    (folder / "camera.json").write_text('{"fx": 60, "fy": 61, "cx": 31.2, "cy": 23.7, "width": 64, "height": 48}')


def check_frame(entry: Any, unit_m: float = 0.001) -> None:
    """The entry, sent to another process, reads what `images` made."""
    color, depth, _ = images(unit_m)
    frame = pickle.loads(pickle.dumps(entry)).read()
    assert frame.camera == CAMERA and frame.name == entry.name
    assert np.array_equal(frame.color, color)
    np.testing.assert_allclose(frame.depth, depth * np.float32(unit_m), atol=1e-6)


def test_a_published_set_takes_no_camera_with_distortion(tmp_path: Path) -> None:
    """Its labels would stay as they are drawn."""
    for folder, image in zip(("image_color", "disparity", "annotation"), images(), strict=True):
        write_image(tmp_path / folder / "learn2.png", image)
    put_camera(tmp_path)
    file = tmp_path / "camera.json"
    file.write_text(file.read_text().replace("}", ', "distortion": [0.1, 0, 0, 0]}'))
    with pytest.raises(FileError, match=r"expected a camera without distortion in .*camera.json"):
        guess(tmp_path)


def test_osd_reads_depth_from_its_folder_of_disparity(tmp_path: Path) -> None:
    for name in ("learn2", "learn10"):
        for folder, image in zip(("image_color", "disparity", "annotation"), images(), strict=True):
            write_image(tmp_path / folder / f"{name}.png", image)
    put_camera(tmp_path)
    found = guess(tmp_path)
    assert isinstance(found, Osd) and [entry.name for entry in found] == ["learn2", "learn10"]
    assert found[0].labelling == "full" and found[0].group != found[1].group
    check_frame(found[0])
    truth = found[0].read_truth()
    assert truth is not None and np.array_equal(truth.labels, images()[2]) and not truth.ignore.any()


def test_ocid_has_a_background_of_two_labels_on_tables(tmp_path: Path) -> None:
    for place in ("ARID20/table/top/seq01", "ARID20/floor/top/seq04"):
        for folder, image in zip(("rgb", "depth", "label"), images(), strict=True):
            write_image(tmp_path / place / folder / "result_1.png", image)
    put_camera(tmp_path)
    found = {entry.name.split("/")[1]: entry for entry in guess(tmp_path)}
    assert isinstance(guess(tmp_path), Ocid) and set(found) == {"table", "floor"}
    assert found["table"].group == "ocid/ARID20/table/top/seq01"
    for place, background in (("table", 2), ("floor", 1)):
        check_frame(found[place])
        truth, labels = found[place].read_truth(), images()[2]
        assert truth is not None and np.array_equal(truth.labels, np.where(labels > background, labels, 0))


def test_uw_scenes_v2_has_depth_in_tenths_of_millimetres(tmp_path: Path) -> None:
    color, depth, _ = images(0.0001)
    write_image(tmp_path / "imgs" / "scene_01" / "00490-color.png", color)
    write_image(tmp_path / "imgs" / "scene_01" / "00490-depth.png", depth)
    put_camera(tmp_path)
    (entry,) = guess(tmp_path)
    assert isinstance(guess(tmp_path), UwScenesV2)
    assert (entry.name, entry.group, entry.labelling) == ("scene_01/00490", "uw-scenes-v2/scene_01", "none")
    check_frame(entry, 0.0001)
    assert entry.read_truth() is None and entry.read_instances() == ()


def test_tum_pairs_images_by_time(tmp_path: Path) -> None:
    sequence = tmp_path / "rgbd_dataset_desk"
    color, depth, _ = images(1 / 5000)
    for time in ("1.000", "2.000", "3.000"):
        write_image(sequence / "rgb" / f"{time}.png", color)
    for time in ("1.015", "2.5", "2.999"):
        write_image(sequence / "depth" / f"{time}.png", depth)
    (sequence / "rgb.txt").write_text("# colour\n" + "".join(f"{t} rgb/{t}.png\n" for t in ("3.000", "1.000", "2.000")))
    (sequence / "depth.txt").write_text("".join(f"{t} depth/{t}.png\n" for t in ("1.015", "2.5", "2.999")))
    put_camera(sequence)
    found = guess(tmp_path)
    assert isinstance(found, Tum) and [entry.name for entry in found] == ["1.000", "3.000"]
    assert [entry.files[1].name for entry in found] == ["1.015.png", "2.999.png"]
    check_frame(found[0], 1 / 5000)
    assert found[0].data_set == found[0].group == "rgbd_dataset_desk"
    (sequence / "rgb.txt").write_text("now rgb/1.png\n")
    with pytest.raises(FileError, match=r"expected `time file` in line 1 of .*rgb.txt"):
        guess(tmp_path)


def cloud(labels: np.ndarray) -> np.ndarray:
    """An organised cloud of the frame that `images` makes."""
    color, stored, _ = images()
    z = np.where(stored > 0, stored / 1000, np.nan)
    y, x = np.mgrid[:48, :64]
    points = np.zeros(z.shape, [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("rgb", "<f4"), ("label", "<u4")])
    points["x"], points["y"], points["z"] = (x - 31.2) / 60 * z, (y - 23.7) / 61 * z, z
    points["rgb"] = (color.astype(np.uint32) @ np.array([65536, 256, 1], np.uint32)).view(np.float32)
    points["label"] = labels
    return points


def pcd(points: np.ndarray, form: str) -> bytes:
    """A cloud as a file of the Point Cloud Library, packed as literals alone."""
    height, width = points.shape
    header = (
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb label\nSIZE 4 4 4 4 4\nTYPE F F F F U\nCOUNT 1 1 1 1 1\n"
        f"WIDTH {width}\nHEIGHT {height}\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points.size}\nDATA {form}\n"
    ).encode()
    if form == "binary":
        return header + points.tobytes()
    if form == "ascii":
        rows = (" ".join(f"{value:.9g}" for value in point.tolist()) for point in points.ravel())
        return header + "\n".join(rows).encode()
    planes = b"".join(np.ascontiguousarray(points[name]).tobytes() for name in points.dtype.names or ())
    packed = b"".join(bytes([len(p) - 1]) + p for p in (planes[k : k + 32] for k in range(0, len(planes), 32)))
    return header + struct.pack("<II", len(packed), len(planes)) + packed


@pytest.mark.parametrize("form", ["ascii", "binary", "binary_compressed"])
def test_mosd_joins_parts_and_ignores_what_was_not_measured(form: str, tmp_path: Path) -> None:
    color, depth, labels = images()
    stored = np.array([1, 20, 30, 31], np.uint32)[labels] * (depth > 0)
    (tmp_path / "learn").mkdir()
    (tmp_path / "learn" / "learn3.pcd").write_bytes(pcd(cloud(stored), form))
    (entry,) = pickle.loads(pickle.dumps(list(guess(tmp_path))))
    assert isinstance(guess(tmp_path), Mosd) and (entry.name, entry.labelling) == ("learn3", "full")
    frame, truth = entry.read_both()
    assert np.array_equal(frame.color, color) or form == "ascii"  # text loses the bits of some floats
    np.testing.assert_allclose(frame.depth, depth / 1000, atol=1e-6)
    assert [getattr(frame.camera, k) for k in ("fx", "fy", "cx", "cy")] == pytest.approx([60, 61, 31.2, 23.7], abs=1e-3)
    assert truth is not None and np.array_equal(truth.ignore, depth == 0)
    assert np.array_equal(truth.labels, np.minimum(labels, 2) * (depth > 0))


def test_clouds_that_are_none_are_refused(tmp_path: Path) -> None:
    path, good = tmp_path / "learn0.pcd", pcd(cloud(np.zeros((48, 64))), "binary")
    for data, sentence in (
        (good[:-4], "expected a point cloud in .*learn0.pcd"),
        (good.replace(b"DATA binary", b"DATA zipped"), "DATA is zipped instead of ascii"),
        (good.replace(b"x y z rgb label", b"a y z rgb label"), "expected fields x, y, z in .*: x not found"),
        (good.replace(b"TYPE F F", b"TYPE Q F"), "cannot be read: 'Q4'"),
        (good.replace(b"WIDTH 64", b"WIDTH 9999999999"), "expected a point cloud in"),
        (pcd(cloud(np.zeros((48, 64))), "binary_compressed")[:-1], "expected a point cloud in"),
    ):
        path.write_bytes(data)
        with pytest.raises(FileError, match=sentence):
            Mosd(tmp_path)[0].read()
    bent = cloud(np.zeros((48, 64)))
    bent["x"] *= np.linspace(1, 2, 64)
    path.write_bytes(pcd(bent, "binary"))
    with pytest.raises(CameraError, match="expected an organised point cloud"):
        Mosd(tmp_path)[0].read()


# --- what is refused ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("layout", "lost", "told"),
    [
        ("rutgers", "book-depth-K-2-1-0.png", "frame book-K-2-1-0"),
        ("rutgers", "models/soap.ply", "frame soap-A-0-0-3"),
        ("uw", "desk/desk_1/desk_1_12_depth.png", "frame desk_1_12"),
        ("tejani", "test/scene_06/Depth/img_012.png", "frame scene_06/img_012"),
        ("tejani", "models/obj_06.ply", "2 missing files in all"),
        ("bop", "test/000002/rgb/000004.png", "frame 000002/000004"),
        ("bop", "test/000001/mask_visib/000004_000002.png", "frame 000001/000004"),
    ],
)
def test_what_is_half_downloaded_names_the_file_that_lacks(layout: str, lost: str, told: str, tmp_path: Path) -> None:
    WRITTEN[layout][0](tmp_path)
    (tmp_path / lost).unlink()
    with pytest.raises(FileError, match=f"expected .*{lost} .*{told}"):
        guess(tmp_path)


@pytest.mark.parametrize(
    ("layout", "spoilt", "told"),
    [
        ("rutgers", "book-pose-K-2-1-0.yml", "object_rotation_wrt_camera as an OpenCV matrix"),
        ("rutgers", "models/book.ply", "expected a triangle mesh in"),
        ("uw", "desk/desk_1.mat", "expected a MATLAB file with bboxes"),
        ("tejani", "annotation_new_models/scene_06/poses0.txt", "16 numbers for each"),
        ("bop", "test/000001/scene_gt.json", "expected JSON in|obj_id, nine numbers cam_R_m2c"),
    ],
)
@pytest.mark.parametrize("content", ["", "7\n", '{"4": [{"obj_id": 1}]}'])
def test_what_is_spoilt_is_named(layout: str, spoilt: str, told: str, content: str, tmp_path: Path) -> None:
    WRITTEN[layout][0](tmp_path)
    (tmp_path / spoilt).write_text(content)
    if layout == "bop" and content == "7\n":
        told = "expected an object with fields"
    with pytest.raises(FileError, match=told) as caught:
        read_all(tmp_path)
    assert Path(spoilt).name in str(caught.value)


def test_an_object_of_bop_has_a_finite_number(tmp_path: Path) -> None:
    bop(tmp_path)
    truth = tmp_path / "test" / "000001" / "scene_gt.json"
    truth.write_text(re.sub(r'"obj_id": \d+', '"obj_id": 1e999', truth.read_text()))
    with pytest.raises(FileError, match="got other content for image 4"):
        guess(tmp_path)


def read_all(folder: Path) -> None:
    for entry in guess(folder):
        entry.read_sample()
        if isinstance(entry, UwFrame):
            entry.read_boxes()


def test_guess_takes_the_one_set_in_a_folder_and_says_what_else_it_finds(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="there is no folder"):
        guess(tmp_path / "nowhere")
    with pytest.raises(FileError, match=r"got none: give a root .* a data set as it was published"):
        guess(tmp_path)
    bop(tmp_path / "a")
    assert isinstance(guess(tmp_path), Bop)
    tejani(tmp_path / "b")
    with pytest.raises(FileError, match=r"expected one data set in .*, got 2: give .*a or .*b"):
        guess(tmp_path)
    with pytest.raises(FileError, match=r"expected files OBJECT-image.* got none"):
        Rutgers(tmp_path)
    with pytest.raises(FileError, match=r"train/000001/scene_camera.json, got none"):
        Bop(tmp_path / "a", split="train")


def test_frame_folders_are_a_layout_like_others(tmp_path: Path) -> None:
    color, depth, labels = images()
    for name, image in (("rgb", color), ("depth", depth), ("label", labels)):
        write_image(tmp_path / "osd-own" / "one" / f"{name}.png", image)
    put_camera(tmp_path / "osd-own" / "one")
    (entry,) = guess(tmp_path)
    assert isinstance(guess(tmp_path), Folders)
    assert (entry.data_set, entry.name, entry.labelling) == ("osd-own", "one", "full")


def test_writers_refuse_what_a_layout_cannot_hold(tmp_path: Path) -> None:
    book = sample_of("book-K-0-0-0", [BOOK, BOOK], [LEFT, RIGHT])
    camera = sp.Camera(50, 50, 32, 24, 64, 48)
    other = Sample(sp.Frame(book.frame.color, book.frame.depth, camera, "table_1_2"), book.labels)
    cases: list[tuple[str, Callable[[], object]]] = [
        ("a frame named OBJECT-BIN", lambda: write_rutgers(tmp_path, [sample_of("one", [], [])], [BOOK], ABOUT)),
        ("one book in frame", lambda: write_rutgers(tmp_path, [book], [BOOK], ABOUT)),
        ("a model named book", lambda: write_rutgers(tmp_path, [book], [SOAP], ABOUT)),
        ("an instance of Milk", lambda: write_tejani(tmp_path, [sample_of("scene_06/img_000", [], [])], [MILK], ABOUT)),
        ("expected one of Coffee_Cup", lambda: tejani_name("Tea", 0)),
        (
            "each object once",
            lambda: write_uw_scenes(tmp_path, [sample_of("desk_1_1", [MUG] * 2, [LEFT, RIGHT])], ABOUT),
        ),
        ("one camera", lambda: write_uw_scenes(tmp_path, [sample_of("table_1_1", [], []), other], ABOUT)),
        ("a model named book", lambda: write_bop(tmp_path, [book], [SOAP], ABOUT)),
        ("once in its scene", lambda: write_bop(tmp_path, [sample_of("1/1", [], [])] * 2, [], ABOUT)),
    ]
    for sentence, call in cases:
        with pytest.raises(FrameError, match=sentence):
            call()


@pytest.mark.parametrize(
    ("layout", "library", "read"),
    [("tejani", "trimesh", lambda entry: entry.read_truth()), ("uw", "scipy.io", lambda entry: entry.read_boxes())],
)
def test_a_missing_extra_says_what_mends_it(
    layout: str, library: str, read: Callable[[Any], object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    WRITTEN[layout][0](tmp_path)
    entry = guess(tmp_path)[0]
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(FileError, match=r'but it is missing: pip install "spigolo\[datasets\]"'):
        read(entry)


def test_evaluate_takes_any_layout_and_sends_its_entries_to_workers(tmp_path: Path) -> None:
    tejani(tmp_path / "set")
    methods = make_methods(["felzenszwalb2004"], [sp.TABLE])
    found = find_labelled_frames([tmp_path / "set"])
    rows = evaluate(found, methods, tmp_path / "rows.jsonl", jobs=2)
    assert [(row.data_set, row.frame, row.labelling, row.error) for row in rows] == [
        ("tejani-rendered", name, "part", None) for name in ("scene_06/img_000", "scene_06/img_012")
    ]
    assert all(row.score is not None and row.score.n_objects == 3 for row in rows)


# --- the originals --------------------------------------------------------------------------------------------


@pytest.mark.frames
def test_the_mug_of_meeting_small_1_is_where_its_original_files_have_it(data: Path) -> None:
    frames = {entry.name: entry for entry in guess(data / "paper-datasets" / "rgbd-scenes")}
    assert set(frames) == {"desk_1_1", "meeting_small_1_1"}
    frame, truth = frames["meeting_small_1_1"].read_both()
    assert truth is not None
    px = {name: int((truth.labels == label).sum()) for label, name in truth.names.items()}
    assert px == {"coffee_mug_5": 3093, "bowl_3": 388, "bowl_2": 337, "soda_can_1": 96}
    mug = frame.depth[truth.labels == {name: label for label, name in truth.names.items()}["coffee_mug_5"]]
    assert (mug > 0).mean() >= 0.93
    assert np.median(mug[mug > 0]) == pytest.approx(0.871, abs=5e-4)
    empty = frames["desk_1_1"].read_truth()
    assert empty is not None and not empty.labels.any()


@pytest.mark.frames
def test_the_other_originals_are_read_in_place(data: Path) -> None:
    (shelf,) = guess(data / "paper-datasets" / "rutgers")
    assert (shelf.data_set, shelf.name, shelf.labelling) == ("rutgers-apc", "stanley_66_052-K-2-1-0", "none")
    depth = shelf.read().depth
    assert depth.max() == pytest.approx(2.993) and (depth > 0).mean() < 0.5
    (room,) = guess(data / "paper-datasets" / "rgbd-scenes-v2")
    assert room.name == "scene_01/00490" and room.read().depth.max() == pytest.approx(2.9842)
    with pytest.raises(FileError, match=r"expected one data set in .*, got 3"):
        guess(data / "paper-datasets")


@pytest.mark.parametrize(("times", "unit"), [((0, 33, 66), 1e-3), ((0, 15000, 30000), 1e-6), ((0, 0.033, 0.066), 1)])
def test_units_of_time_stamps_that_start_at_0(tmp_path: Path, times: tuple[float, ...], unit: float) -> None:
    (tmp_path / "camera.json").write_text('{"fx": 5, "fy": 5, "cx": 2, "cy": 1.5, "width": 5, "height": 4}')
    for folder in ("rgb", "depth"):
        (tmp_path / folder).mkdir()
        for k in range(3):
            cv2.imwrite(
                str(tmp_path / folder / f"{k}.png"), np.ones((4, 5), np.uint16 if folder == "depth" else np.uint8)
            )
        (tmp_path / f"{folder}.txt").write_text("".join(f"{t} {folder}/{k}.png\n" for k, t in enumerate(times)))
    stamps = [entry.read().stamp_ns for entry in Tum(tmp_path)]
    assert stamps == pytest.approx([t * unit * 1e9 for t in times], abs=1000)
