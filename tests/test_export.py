"""Each export, read back by the library that it is for."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

import spigolo as sp
from spigolo.errors import FrameError
from spigolo.export.instances import run_lengths

pytestmark = pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")  # pycocotools

DEMO = Path(sp.__file__).parent / "demo_scene"


@pytest.fixture(scope="module")
def result() -> sp.Segmentation:
    return sp.segment(sp.read_frame(DEMO / "rgb.png", DEMO / "depth.png", DEMO / "camera.json"))


@pytest.fixture(scope="module")
def empty() -> sp.Segmentation:
    plain = np.full((48, 64, 3), 90, np.uint8)
    return sp.segment(sp.Frame(plain, np.full((48, 64), 1.0, np.float32), "60deg", name="000001/000002"))


def test_coco_refuses_two_frames_of_one_name(result: sp.Segmentation, tmp_path: Path) -> None:
    with pytest.raises(FrameError, match="expected a different name for each frame, got 'demo_scene' twice"):
        sp.export.coco([result, result], tmp_path / "instances.json")
    assert not (tmp_path / "instances.json").exists()


def test_coco_is_read_by_pycocotools_and_scores_one_against_itself(
    result: sp.Segmentation, empty: sp.Segmentation, tmp_path: Path
) -> None:
    from pycocotools.coco import COCO
    from pycocotools.cocoeval import COCOeval

    sp.export.coco([result, empty], tmp_path / "instances.json")
    read = COCO(str(tmp_path / "instances.json"))
    assert [image["file_name"] for image in read.loadImgs([1, 2])] == ["demo_scene.png", "000001/000002.png"]
    annotations = read.loadAnns(read.getAnnIds(imgIds=[1]))
    assert len(annotations) == len(result)
    for o, annotation in zip(result, annotations, strict=True):
        assert np.array_equal(read.annToMask(annotation), o.mask)
        x, y, width, height = annotation["bbox"]
        assert (y, x, y + height, x + width) == o.box_px
    scored = COCOeval(read, read.loadRes([{k: a[k] for k in ("image_id", "category_id", "segmentation", "score")}
                                          for a in annotations]), "segm")  # fmt: skip
    scored.evaluate()
    scored.accumulate()
    scored.summarize()
    assert scored.stats[0] == pytest.approx(1.0)


def test_run_lengths_are_those_of_pycocotools() -> None:
    from pycocotools import mask as coco_mask

    rng = np.random.default_rng(0)
    for share in (0.0, 0.2, 0.8, 1.0):
        mask = rng.random((13, 17)) < share
        lengths = run_lengths(mask)
        assert sum(lengths["counts"]) == mask.size
        assert np.array_equal(coco_mask.decode(coco_mask.frPyObjects(lengths, 13, 17)), mask)


def test_bop_names_scene_and_image_and_keeps_the_mask(result: sp.Segmentation, tmp_path: Path) -> None:
    from pycocotools import mask as coco_mask

    frame = result.frame
    named = sp.segment(sp.Frame(frame.color, frame.depth, frame.camera, name="000003/000042"))
    sp.export.bop([named], tmp_path / "bop.json")
    records = json.loads((tmp_path / "bop.json").read_text())
    assert {(r["scene_id"], r["image_id"], r["category_id"], r["time"]) for r in records} == {(3, 42, 1, -1)}
    for o, record in zip(named, records, strict=True):
        rle = coco_mask.frPyObjects(record["segmentation"], *named.labels.shape)
        assert np.array_equal(coco_mask.decode(rle), o.mask)
    with pytest.raises(sp.errors.FrameError, match="SCENE/IMAGE"):
        sp.export.bop([result], tmp_path / "bop.json")


def test_sam_records_and_supervision_agree(result: sp.Segmentation, empty: sp.Segmentation) -> None:
    import supervision

    records, found = sp.export.sam(result), sp.export.detections(result)
    assert len(records) == len(found) == len(result)
    assert np.array_equal(found.mask, [record["segmentation"] for record in records])
    assert found.data["label"].tolist() == [o.label for o in result]
    for xyxy, record in zip(found.xyxy, records, strict=True):
        x, y, width, height = record["bbox"]
        assert xyxy.tolist() == [x, y, x + width, y + height]
    assert len(supervision.Detections.from_sam(records)) == len(result)
    assert len(sp.export.detections(empty)) == 0
    assert sp.export.sam(empty) == []


def test_contact_graspnet_gets_keys_types_and_units(result: sp.Segmentation, tmp_path: Path) -> None:
    sp.export.contact_graspnet(result, tmp_path / "scene.npz")
    with np.load(tmp_path / "scene.npz", allow_pickle=False) as read:
        assert set(read) == {"depth", "K", "rgb", "segmap"}
        assert (read["depth"].dtype, read["K"].shape, read["rgb"].dtype) == (np.float32, (3, 3), np.uint8)
        assert 0.2 < np.median(read["depth"][read["depth"] > 0]) < 5
        assert np.array_equal(read["segmap"], result.labels)
    without = sp.segment(sp.Frame(result.frame.color, result.frame.depth, None))
    with pytest.raises(sp.errors.CameraError, match="intrinsics"):
        sp.export.contact_graspnet(without, tmp_path / "scene.npz")


def test_the_workspace_mask_is_read_as_bool_by_pillow(result: sp.Segmentation, tmp_path: Path) -> None:
    from PIL import Image

    sp.export.workspace_mask(result, tmp_path / "workspace_mask.png")
    mask = np.array(Image.open(tmp_path / "workspace_mask.png"))
    assert mask.dtype == bool
    assert np.array_equal(mask, result.labels > 0)
    assert (mask & (result.frame.depth > 0)).dtype == bool  # as GraspNet combines them


def test_clouds_are_read_back(result: sp.Segmentation, tmp_path: Path) -> None:
    import trimesh

    from spigolo.lab.datasets.pcd import read_pcd

    written = sp.export.ply(result, tmp_path)
    assert [path.name for path in written] == [f"object_{o.label}.ply" for o in result]
    for o, path in zip(result, written, strict=True):
        cloud = trimesh.load(path)
        assert np.allclose(cloud.vertices, o.points_m())
        assert np.array_equal(cloud.colors[:, :3], result.frame.color[o.mask & (result.frame.depth > 0)])
    for o, path in zip(result, sp.export.pcd(result, tmp_path), strict=True):
        read = read_pcd(path)
        points = np.stack([read[name] for name in "xyz"], axis=-1).reshape(-1, 3)
        assert np.allclose(points, o.points_m())


def test_trimmed_clouds_lie_in_the_boxes(result: sp.Segmentation, tmp_path: Path) -> None:
    import trimesh

    sizes = []
    for o, path in zip(result, sp.export.ply(result, tmp_path, trim_m=0.005), strict=True):
        box, cloud = o.oriented_box(), trimesh.load(path)
        assert box is not None and box.contains(np.asarray(cloud.vertices), 0.006).all()
        assert np.allclose(cloud.vertices, o.points_m(trim_m=0.005))
        sizes.append(len(cloud.vertices) / len(o.points_m()))
    assert 0.85 < min(sizes) < 1
    assert len(sp.export.pcd(result, tmp_path, trim_m=0.005)) == len(result)


def test_yolo_outlines_cover_the_masks(result: sp.Segmentation, tmp_path: Path) -> None:
    sp.export.yolo(result, tmp_path / "rgb.txt")
    lines = (tmp_path / "rgb.txt").read_text().splitlines()
    height, width = result.labels.shape
    for o, line in zip(result, lines, strict=True):
        kind, *numbers = line.split()
        points = np.array(numbers, float).reshape(-1, 2)
        assert kind == "0"
        assert ((points >= 0) & (points <= 1)).all()
        drawn = np.zeros((height, width), np.uint8)
        cv2.fillPoly(drawn, [np.rint(points * (width, height) - 0.5).astype(np.int32)], 1)
        assert np.count_nonzero((drawn > 0) & o.mask) > 0.9 * np.count_nonzero((drawn > 0) | o.mask)


def test_labels_are_read_unchanged(result: sp.Segmentation, tmp_path: Path) -> None:
    sp.export.labels(result, tmp_path / "labels.png")
    read = cv2.imread(str(tmp_path / "labels.png"), cv2.IMREAD_UNCHANGED)
    assert read.dtype == np.uint16
    assert np.array_equal(read, result.labels)


def test_a_missing_library_names_the_pip_line(result: sp.Segmentation, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "supervision", None)
    with pytest.raises(sp.SpigoloError, match=r'pip install "spigolo\[export\]"'):
        sp.export.detections(result)


def test_detections_keep_the_ids(result: sp.Segmentation) -> None:
    with_ids = sp.Segmenter(sp.OBJECTS, ids=True)(result.frame)
    assert sp.export.detections(with_ids).tracker_id.tolist() == [o.id for o in with_ids]
    assert sp.export.detections(result).tracker_id is None
