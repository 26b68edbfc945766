"""The commands export and view on a bag, each result read back."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

import spigolo as sp
from bags import usual_bag

SCENE = Path(sp.__file__).parent / "demo_scene"


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    return usual_bag("ros2-mcap", frame, 2, 0, 0).write(tmp_path_factory.mktemp("bag"))


def run(*words: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "spigolo", *map(str, words)], capture_output=True, text=True, check=False, timeout=300
    )


def test_every_format_of_a_bag_is_what_segment_finds(tmp_path: Path, bag: Path) -> None:
    results = [sp.segment(frame) for frame in sp.open_source(bag)]
    formats = ("coco", "yolo", "labels", "contact-graspnet", "workspace-mask", "ply", "pcd")
    for name in formats:
        done = run("export", bag, "--format", name, "--out", tmp_path / name)
        assert done.returncode == 0, done.stderr
        assert "2 frames, 0 unmatched images" in done.stdout
    assert len(json.loads((tmp_path / "coco").read_text())["annotations"]) == sum(map(len, results))
    for result in results:
        name = result.frame.name
        stored = cv2.imread(str(tmp_path / "labels" / f"{name}.png"), cv2.IMREAD_UNCHANGED)
        np.testing.assert_array_equal(stored, result.labels)
        mask = cv2.imread(str(tmp_path / "workspace-mask" / f"{name}.png"), cv2.IMREAD_UNCHANGED)
        np.testing.assert_array_equal(mask > 0, result.labels > 0)
        with np.load(tmp_path / "contact-graspnet" / f"{name}.npz") as arrays:
            np.testing.assert_array_equal(arrays["segmap"], result.labels)
            assert arrays["K"][0, 0] == 525
        assert len((tmp_path / "yolo" / f"{name}.txt").read_text().splitlines()) == len(result)
        for kind in ("ply", "pcd"):
            assert len(list((tmp_path / kind / name).glob(f"*.{kind}"))) == len(result)


def test_a_single_frame_goes_to_the_file_that_is_named(tmp_path: Path) -> None:
    done = run("export", SCENE, "--format", "contact-graspnet", "--out", tmp_path / "scene.npz")
    assert done.returncode == 0 and (tmp_path / "scene.npz").is_file(), done.stderr
    assert done.stdout.splitlines()[0].endswith("demo_scene: 1 frame")
    assert "objects of 1 frame written to" in done.stdout
    refused = run("export", SCENE, "--format", "bop", "--out", tmp_path / "bop.json")
    assert refused.returncode == 2 and "SCENE/IMAGE" in refused.stderr


def test_a_report_counts_in_words_and_leaves_out_what_did_not_happen() -> None:
    assert str(sp.Report(1)) == "1 frame"
    assert str(sp.Report(2, broken=1)) == "2 frames, 1 broken"
    assert str(sp.Report(0, 1, 0, tolerance_ms=20)) == "0 frames, 1 unmatched image (no partner within 20 ms)"


def test_segment_takes_a_bag_and_reports_it(tmp_path: Path, bag: Path) -> None:
    done = run("segment", bag, "--ids", "--frames", 2, "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert "2 of 2 frames written" in done.stdout and "frames/s, latency" in done.stdout
    ids = [{o["id"] for o in json.loads((tmp_path / n / "objects.json").read_text())["objects"]}
           for n in ("000000", "000001")]  # fmt: skip
    assert ids[0] and len(ids[0] & ids[1]) >= 0.8 * len(ids[0])


def test_view_writes_a_recording_that_rerun_verifies(tmp_path: Path, bag: Path) -> None:
    pytest.importorskip("rerun")
    done = run("view", bag, "--out", tmp_path / "x.rrd")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "x.rrd").stat().st_size > 100_000
    rerun = Path(sys.executable).with_name("rerun")
    checked = subprocess.run([rerun, "rrd", "verify", tmp_path / "x.rrd"], capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stderr


def test_a_box_of_the_view_is_turned_as_the_object_is() -> None:
    from spigolo.view.rerun import quaternion

    rng = np.random.default_rng(0)
    for _ in range(200):
        R = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        R *= np.sign(np.linalg.det(R))
        x, y, z, w = quaternion(R)
        turned = np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
        )
        np.testing.assert_allclose(turned, R, atol=1e-9)


def test_clouds_of_an_earlier_result_are_removed_and_other_files_stay(tmp_path: Path) -> None:
    for name in ("object_99.ply", "object_a.ply", "other.ply"):
        (tmp_path / name).write_bytes(b"ply")
    done = run("export", SCENE, "--format", "ply", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert {p.name for p in tmp_path.iterdir()} == {
        *(f"object_{k}.ply" for k in range(1, 10)),
        "object_a.ply",
        "other.ply",
    }


@pytest.mark.parametrize(("format", "file"), [("labels", "depth.png"), ("coco", "rgb.png"), ("labels", "labels.jpg")])
def test_no_input_is_overwritten_and_the_suffix_fits(tmp_path: Path, format: str, file: str) -> None:
    place = shutil.copytree(SCENE, tmp_path / "scene")
    before = {p.name: p.read_bytes() for p in place.iterdir()}
    done = run("export", place, "--format", format, "--out", place / file)
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1
    assert {p.name: p.read_bytes() for p in place.iterdir()} == before


@pytest.mark.parametrize(("command", "file"), [("export", "old.json"), ("view", "old.rrd")])
def test_a_good_file_stays_if_no_frame_can_be_segmented(tmp_path: Path, command: str, file: str) -> None:
    place = shutil.copytree(SCENE, tmp_path / "scene")
    (place / "depth.png").write_bytes(b"junk")
    (tmp_path / file).write_text("good")
    done = run(command, place, *(("--format", "coco") if command == "export" else ()), "--out", tmp_path / file)
    assert done.returncode == 2 and "no frame of" in done.stderr
    assert (tmp_path / file).read_text() == "good"
    assert {p.name for p in tmp_path.iterdir()} == {"scene", file}


def test_results_of_a_distorted_camera_come_with_the_image_they_belong_to(tmp_path: Path) -> None:
    place = shutil.copytree(SCENE, tmp_path / "scene")
    camera = json.loads((place / "camera.json").read_text())
    (place / "camera.json").write_text(json.dumps(camera | {"distortion": [-0.2, 0.05, 0, 0, 0]}))
    done = run("export", place, "--format", "labels", "--out", tmp_path / "labels.png")
    assert "1 frame with lens distortion: the results belong to the images in" in done.stdout, done.stderr
    drawn = cv2.imread(str(tmp_path / "undistorted" / "scene.png"))[:, :, ::-1]
    frame = sp.read_frame(place / "rgb.png", place / "depth.png", place / "camera.json")
    assert np.array_equal(drawn, frame.color)
    read = cv2.imread(str(tmp_path / "labels.png"), cv2.IMREAD_UNCHANGED)
    assert np.array_equal(read, sp.segment(frame).labels)


@pytest.mark.parametrize("words", [("--frames", 0), ("--frames", -2), ("--trim-m", -1)])
def test_numbers_out_of_range_are_refused_in_one_line(tmp_path: Path, words: tuple[object, ...]) -> None:
    done = run("export", SCENE, "--format", "ply", *words, "--out", tmp_path / "out")
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1 and "Must be >=" in done.stderr
    assert not (tmp_path / "out").exists()


def test_frames_that_can_all_not_be_written_end_with_an_error(tmp_path: Path) -> None:
    for name in ("a", "b"):
        place = shutil.copytree(SCENE, tmp_path / "lab" / name)
        (place / "camera.json").unlink()
    done = run(
        "export", tmp_path / "lab", "--depth-scale", 0.001, "--format", "contact-graspnet", "--out", tmp_path / "x"
    )
    assert done.returncode == 2 and "no frame of" in done.stderr.splitlines()[-1]


@pytest.mark.parametrize(("format", "suffix"), [("labels", "png"), ("yolo", "txt"), ("contact-graspnet", "npz")])
def test_a_folder_is_a_folder_whatever_the_number_of_frames(
    tmp_path: Path, bag: Path, format: str, suffix: str
) -> None:
    there = tmp_path / "there"
    there.mkdir()
    for out, frames in ((tmp_path / "new", "1"), (there, "1"), (tmp_path / "two", "2")):
        done = run("export", bag, "--format", format, "--out", out, "--frames", frames)
        assert done.returncode == 0, done.stderr
        assert len(list(out.glob(f"*.{suffix}"))) == int(frames)
    done = run("export", bag, "--format", format, "--out", tmp_path / f"x.{suffix}")
    assert done.returncode == 2 and "expected a folder as --out for several frames" in done.stderr
    done = run("export", bag, "--format", "coco", "--out", there)
    assert done.returncode == 2 and "expected a file name that ends in .json" in done.stderr


@pytest.mark.parametrize("words", [("export", "--format", "coco"), ("batch",), ("view",)])
def test_a_wrong_depth_unit_is_told_by_every_command(tmp_path: Path, words: tuple[str, ...]) -> None:
    out = tmp_path / {"export": "x.json", "batch": "x", "view": "x.rrd"}[words[0]]
    done = run(words[0], SCENE, *words[1:], "--depth-scale", 0.01, "--out", out)
    assert "scene: expected a median depth" in done.stderr


def test_bop_is_exported_from_the_folder_of_the_split(tmp_path: Path) -> None:
    scene = tmp_path / "set" / "test" / "000003"
    for folder in ("rgb", "depth"):
        (scene / folder).mkdir(parents=True)
        shutil.copy(SCENE / f"{folder}.png", scene / folder / "000007.png")
    camera = {"7": {"cam_K": [525, 0, 319.5, 0, 525, 239.5, 0, 0, 1], "depth_scale": 1.0}}
    (scene / "scene_camera.json").write_text(json.dumps(camera))
    for place in (tmp_path / "set", tmp_path / "set" / "test"):
        done = run("export", place, "--format", "bop", "--out", tmp_path / "bop.json")
        assert done.returncode == 0, done.stderr
        assert {(row["scene_id"], row["image_id"]) for row in json.loads((tmp_path / "bop.json").read_text())} == {
            (3, 7)
        }


def test_the_warning_about_the_support_ends_once_up_is_given(tmp_path: Path) -> None:
    place = shutil.copytree(SCENE, tmp_path / "scene")
    for name in ("rgb.png", "depth.png"):
        cv2.imwrite(str(place / name), cv2.rotate(cv2.imread(str(place / name), cv2.IMREAD_UNCHANGED), cv2.ROTATE_180))
    told = run("segment", place, "--out", tmp_path / "a").stderr
    assert "expected a plane that faces up in the image" in told
    up = told.partition("with the normal ")[2].partition(":")[0]
    for command in (("segment",), ("export", "--format", "coco"), ("batch",)):
        out = tmp_path / f"{command[0]}.json"
        done = run(*command, place, "--additions.support.facing.up", up, "--out", out)
        assert "faces up" not in done.stderr and done.returncode == 0, done.stderr
