"""The command line as a user meets it."""

from __future__ import annotations

import inspect
import json
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import cv2
import numpy as np
import pytest

import spigolo as sp
from spigolo.cli.commands import app
from spigolo.cli.inputs import configure
from spigolo.sources.paths import find_frames

SCENE = Path(sp.__file__).parent / "demo_scene"


def spigolo(*words: object, env: dict[str, str] | None = None) -> subprocess.CompletedProcess[str]:
    line = [sys.executable, "-c", "from spigolo.cli import main; main()", *map(str, words)]
    own = os.environ | (env or {})
    return subprocess.run(line, capture_output=True, text=True, check=False, timeout=300, env=own)


def test_demo_finds_its_objects_and_draws_them(tmp_path: Path) -> None:
    done = spigolo("demo", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    truth = cv2.imread(str(SCENE / "label.png"), cv2.IMREAD_UNCHANGED)
    labels = cv2.imread(str(tmp_path / "labels.png"), cv2.IMREAD_UNCHANGED)
    assert labels.dtype == np.uint16
    found = 0
    for k in range(1, truth.max() + 1):
        best = max(
            np.count_nonzero((truth == k) & (labels == n)) / np.count_nonzero((truth == k) | (labels == n))
            for n in range(1, labels.max() + 1)
        )
        found += best > 0.7
    assert found >= 8, f"{found} of {truth.max()}"
    assert labels.max() <= truth.max() + 4
    answer = json.loads((tmp_path / "objects.json").read_text())
    assert len(answer["objects"]) == labels.max()
    assert answer["preset"] == sp.OBJECTS.name
    assert cv2.imread(str(tmp_path / "demo.png")).shape[1] > 1000


def test_segment_writes_its_three_files(tmp_path: Path) -> None:
    out = tmp_path / "new" / "folder"
    done = spigolo(
        "segment", SCENE / "rgb.png", SCENE / "depth.png", "--camera", SCENE / "camera.json", "--preset", "table",
        "--out", out,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert sorted(p.name for p in out.iterdir()) == ["labels.png", "objects.json", "overlay.png"]
    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    labels = cv2.imread(str(out / "labels.png"), cv2.IMREAD_UNCHANGED)
    assert np.array_equal(labels, sp.segment(frame, sp.TABLE).labels)
    assert "TABLE" in done.stdout


def test_the_largest_rejected_regions_are_printed(tmp_path: Path) -> None:
    done = spigolo("segment", SCENE, "--partition.min_size_px2", "20", "--preset", "table", "--out", tmp_path)
    rejected = len(json.loads((tmp_path / "objects.json").read_text())["rejected"])
    printed = [int(line.split()[1]) for line in done.stdout.splitlines() if line.startswith("  rejected")]
    assert printed == sorted(printed, reverse=True)
    assert len(printed) == 10 < rejected
    assert f"and {rejected - 10} smaller regions" in done.stdout


def test_depth_in_millimetres_is_reported_once(tmp_path: Path) -> None:
    depth = cv2.imread(str(SCENE / "depth.png"), cv2.IMREAD_UNCHANGED)
    np.save(tmp_path / "depth.npy", depth.astype(np.float32))
    frame = [SCENE / "rgb.png", tmp_path / "depth.npy", "--camera", SCENE / "camera.json", "--out", tmp_path / "out"]
    for more in ([], ["--no-check"]):
        done = spigolo("segment", *frame, *more)
        assert done.stderr.count("depth_scale") == 1, done.stderr


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["segment", "none.png", SCENE / "depth.png", "--camera", SCENE / "camera.json"], "none.png"),
        (["segment", SCENE / "rgb.png", SCENE / "depth.png", "--camera", "none.json"], "none.json"),
        (
            ["segment", SCENE / "rgb.png", SCENE / "rgb.png", "--camera", SCENE / "camera.json"],
            "not a colour image of the depth",
        ),
        (
            ["segment", SCENE / "rgb.png", SCENE / "depth.png", "--camera", SCENE / "camera.json", "--preset", "tabel"],
            "unknown preset 'tabel'",
        ),
        (["segment", SCENE / "rgb.png", "--camera", SCENE / "camera.json"], "in pairs"),
        (["segment", "--camera", SCENE / "camera.json"], "got nothing"),
        (
            ["segment", SCENE, "--camera", SCENE / "camera.json", "--partition.gama", "1"],
            "did you mean --partition.gamma",
        ),
        (
            ["segment", SCENE, "--camera", SCENE / "camera.json", "--partition.gamma", "-1"],
            "greater than or equal to 0",
        ),
        (["segment", SCENE, "--camera", SCENE / "camera.json", "--partition.gamma"], "expected a value after"),
        (["segment", SCENE, "--camera", "kinect-7", "--depth-scale", "0.001"], "kinect-v1"),
        (["segment", SCENE, "--camera", SCENE / "camera.json", "--roi", "0", "0", "999", "9"], "inside 480 rows"),
        (["segment", SCENE, "--camera", SCENE / "camera.json", "--nonsense"], "nonsense"),
    ],
)
def test_wrong_input_ends_with_2_one_sentence_and_no_files(tmp_path: Path, words: list, sentence: str) -> None:
    done = spigolo(*words, *(["--out", tmp_path / "out"] if "--camera" in words else []))
    assert done.returncode == 2
    assert sentence in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()


def test_output_that_cannot_be_written_ends_with_2(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    done = spigolo(
        "segment", SCENE / "rgb.png", SCENE / "depth.png", "--camera", SCENE / "camera.json",
        "--out", tmp_path / "file",
    )  # fmt: skip
    assert done.returncode == 2
    assert "could not write" in done.stderr


def test_every_out_says_whether_it_is_a_folder_or_a_file() -> None:
    found = 0
    for name in app:
        function = app[name].default_command
        if function is None or "out" not in inspect.signature(function).parameters:
            continue
        help_text = inspect.cleandoc(function.__doc__ or "")
        text = re.search(r"^out\n((?: {4}.*\n?)+)", help_text, flags=re.MULTILINE)
        assert text is not None, name
        assert re.search(r"\b([Ff]older|[Ff]ile)\b", text[1]), name
        found += 1
    assert found > 10


def test_help_loads_neither_numba_nor_opencv() -> None:
    code = """
import sys
sys.argv = ["spigolo", "segment", "--help"]
from spigolo.cli import main
try:
    main()
except SystemExit:
    pass
print({"numba", "cv2"} & set(sys.modules), file=sys.stderr)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "set()"
    assert "INPUTS" in done.stdout


def copy_scene(folder: Path, camera: bool = True) -> Path:
    folder.mkdir(parents=True)
    for name in ("rgb.png", "depth.png", *(["camera.json"] if camera else [])):
        (folder / name).write_bytes((SCENE / name).read_bytes())
    return folder


def test_a_folder_of_frames_gives_a_folder_of_answers_and_a_bad_one_does_not_stop_the_rest(tmp_path: Path) -> None:
    for name in ("a", "b"):
        copy_scene(tmp_path / "in" / name)
    (copy_scene(tmp_path / "in" / "c") / "depth.png").write_bytes(b"")
    done = spigolo("segment", tmp_path / "in", "--no-check", "--out", tmp_path / "out")
    assert done.returncode == 1
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["a", "b"]
    assert "2 of 3 frames" in done.stdout
    assert "c:" in done.stderr
    assert "0 bytes" in done.stderr


def test_folders_of_equally_named_files_are_frames(tmp_path: Path) -> None:
    for kind, name in (("rgb", "rgb.png"), ("depth", "depth.png")):
        (tmp_path / kind).mkdir()
        for k in ("1", "2"):
            (tmp_path / kind / f"{k}.png").write_bytes((SCENE / name).read_bytes())
    done = spigolo("segment", tmp_path, "--camera", SCENE / "camera.json", "--no-check", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["1", "2"]


def test_any_field_of_the_preset_is_a_flag(tmp_path: Path) -> None:
    done = spigolo(
        "segment", SCENE, "--no-check", "--preset", "TABLE", "--partition.gamma", "0.01", "--edges.blur-px=9",
        "--rejection.max-distance-m", "none", "--depth.inpainting", "none", "--additions.support.min-above", "0.5",
        "--out", tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    config = sp.TABLE.replace(
        partition={"gamma": 0.01}, edges={"blur_px": 9}, depth={"inpainting": None},
        rejection={"max_distance_m": None},
        additions={"support": {"min_above": 0.5}},
    )  # fmt: skip
    assert json.loads((tmp_path / "objects.json").read_text())["digest"] == config.digest


def test_without_intrinsics_it_says_what_it_left_out(tmp_path: Path) -> None:
    folder = copy_scene(tmp_path / "in", camera=False)
    done = spigolo("segment", folder, "--depth-scale", "0.001", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert "left out, because no intrinsics were given: contact boundary, support plane" in done.stdout
    assert "--camera 60deg" in done.stdout
    guessed = spigolo("segment", folder, "--depth-scale", "0.001", "--camera", "60deg", "--out", tmp_path / "guessed")
    assert guessed.returncode == 0, guessed.stderr
    assert "left out" not in guessed.stdout


def test_what_a_terminal_cannot_show_costs_no_result(tmp_path: Path) -> None:
    done = spigolo("segment", SCENE, "--no-check", "--out", tmp_path / "é", env={"PYTHONIOENCODING": "ascii"})
    assert done.returncode == 0, done.stderr
    assert "?/labels.png" in done.stdout


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no full device")
def test_an_output_that_takes_nothing_is_said_in_one_sentence() -> None:
    code = "from spigolo.cli import main; main()"
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-c", code, "presets"], stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert done.returncode == 2
    assert done.stderr.splitlines() == ["spigolo: [Errno 28] No space left on device"]


def test_a_closed_output_is_no_fault() -> None:
    code = "import sys; sys.stdout = None; from spigolo.cli import main; sys.argv = ['spigolo', 'presets']; main()"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_interrupted_work_says_so(tmp_path: Path) -> None:
    code = (
        "from unittest.mock import patch; from spigolo.cli import main\n"
        "with patch('spigolo.frames.files.read_frame', side_effect=KeyboardInterrupt): main()"
    )
    words = [sys.executable, "-c", code, "segment", str(SCENE), "--out", str(tmp_path)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, "spigolo: interrupted\n")


def test_a_region_of_interest_leaves_fewer_objects(tmp_path: Path) -> None:
    everywhere = spigolo("segment", SCENE, "--no-check", "--out", tmp_path / "a")
    left = spigolo("segment", SCENE, "--no-check", "--roi", 0, 0, 480, 250, "--out", tmp_path / "b")
    near = spigolo("segment", SCENE, "--no-check", "--roi-box", -1, -1, 0, 0, 1, 2, "--out", tmp_path / "c")
    counts = [len(json.loads((tmp_path / k / "objects.json").read_text())["objects"]) for k in "abc"]
    assert [done.returncode for done in (everywhere, left, near)] == [0, 0, 0]
    assert counts[0] > counts[1] > 0
    assert counts[0] > counts[2] > 0


def test_commands_take_the_same_region_of_interest(tmp_path: Path) -> None:
    region = ("--roi", 0, 0, 480, 250)
    spigolo("segment", SCENE, "--no-check", *region, "--out", tmp_path / "one")
    expected = cv2.imread(str(tmp_path / "one" / "labels.png"), cv2.IMREAD_UNCHANGED)
    spigolo("export", SCENE, "--format", "labels", *region, "--out", tmp_path / "exported.png")
    spigolo("batch", SCENE, *region, "--workers", 1, "--out", tmp_path / "many")
    for written in ("exported.png", "many/labels/demo_scene.png"):
        assert np.array_equal(cv2.imread(str(tmp_path / written), cv2.IMREAD_UNCHANGED), expected)
    assert "1 kept" in spigolo("batch", SCENE, *region, "--workers", 1, "--out", tmp_path / "many").stdout
    other = spigolo("batch", SCENE, "--roi", 0, 0, 480, 251, "--workers", 1, "--out", tmp_path / "many")
    assert "1 computed" in other.stdout


def test_equal_frame_names_of_several_sets_do_not_overwrite_each_other(tmp_path: Path) -> None:
    for data_set in ("left", "right"):
        shutil.copytree(SCENE, tmp_path / "lab" / data_set / "000")
    names = ["left_000", "right_000"]
    spigolo("segment", tmp_path / "lab", "--no-check", "--out", tmp_path / "a")
    spigolo("export", tmp_path / "lab", "--format", "labels", "--out", tmp_path / "b")
    spigolo("batch", tmp_path / "lab", "--workers", 1, "--out", tmp_path / "c")
    assert sorted(p.name for p in (tmp_path / "a").iterdir()) == names
    assert sorted(p.stem for p in (tmp_path / "b").iterdir()) == names
    assert sorted(p.stem for p in (tmp_path / "c" / "labels").iterdir()) == names


@pytest.mark.parametrize("preset", ["OBJECTS", "SHELF"])
def test_trace_draws_seven_panels_and_writes_each_stage(tmp_path: Path, preset: str) -> None:
    done = spigolo("trace", SCENE, "--preset", preset, "--stages", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert cv2.imread(str(tmp_path / "trace.png")).shape[1] > 4 * 640
    stages = {p.stem for p in (tmp_path / "stages").iterdir()}
    assert {"depth", "smoothed_depth", "weights", "regions", "labels"} <= stages
    assert ("saliency" in stages) == (preset == "SHELF")
    assert np.load(tmp_path / "stages" / "weights.npy").shape == (
        sp.PRESETS[preset].partition.connectivity // 2,
        480,
        640,
    )


def test_doctor_is_content_with_the_scene_and_not_with_wrong_units(tmp_path: Path) -> None:
    done = spigolo("doctor", SCENE)
    assert done.returncode == 0, done.stdout
    assert "cost function" in done.stdout
    spoilt = spigolo("doctor", SCENE, "--depth-scale", "1")
    assert spoilt.returncode == 1
    assert "warning" in spoilt.stdout
    told = spigolo("segment", SCENE, "--depth-scale", "1", "--out", tmp_path)
    assert "warning" in told.stderr


def test_presets_are_listed_shown_and_written(tmp_path: Path) -> None:
    assert all(name in spigolo("presets").stdout for name in sp.PRESETS)
    shown = spigolo("presets", "table").stdout
    assert "--partition.gamma 0.0016" in shown
    path = tmp_path / "mine.toml"
    path.write_text(spigolo("presets", "CLUTTER", "--toml").stdout)
    assert sp.preset(path) == sp.CLUTTER
    assert spigolo("presets", "nothing").returncode == 2


def test_a_reader_that_stops_early_is_no_error() -> None:
    code = "from spigolo.cli import main; main()"
    run = subprocess.Popen(
        [sys.executable, "-c", code, "presets", "TABLE"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert run.stdout is not None
    assert run.stderr is not None
    run.stdout.close()
    assert run.stderr.read() == ""
    run.stderr.close()
    assert run.wait() == 0


def test_frames_of_one_name_keep_their_own_results(tmp_path: Path) -> None:
    for folder in ("a/f0", "b/f0", "c", "d/a_f0", "d/a_f0_2"):
        shutil.copytree(SCENE, tmp_path / folder)
    names = {
        ("a", "b"): ["a_f0", "b_f0"],
        ("a/f0", "a/f0", "c"): ["a_f0", "a_f0_2", "c"],
        ("a/f0", "a/f0", "d"): ["a_f0_3", "a_f0_4", "a_f0", "a_f0_2"],
        ("a/f0/rgb.png", "a/f0/depth.png", "c/rgb.png", "c/depth.png"): ["f0_rgb", "c_rgb"],
    }
    for words, expected in names.items():
        assert [f.name for f in find_frames([str(tmp_path / word) for word in words])] == expected


def test_images_without_depth_are_named(tmp_path: Path) -> None:
    shutil.copytree(SCENE, tmp_path / "set" / "f0")
    (tmp_path / "set" / "f1").mkdir()
    shutil.copy(SCENE / "rgb.png", tmp_path / "set" / "f1")
    with pytest.warns(UserWarning, match=r"1 colour images have no depth image of their name: .*f1"):
        assert [f.name for f in find_frames([str(tmp_path / "set")])] == ["f0"]
    for folder, numbers in (("rgb", "123"), ("depth", "3")):
        (tmp_path / "tum" / folder).mkdir(parents=True)
        for number in numbers:
            shutil.copy(SCENE / f"{folder}.png", tmp_path / "tum" / folder / f"{number}.png")
    with pytest.warns(UserWarning, match="2 colour images"):
        assert [f.name for f in find_frames([str(tmp_path / "tum")])] == ["3"]


def test_what_is_no_depth_is_no_depth_image(tmp_path: Path) -> None:
    for folder, names in (("rgb", ("1.png", "2.png")), ("depth", ("1.png", "1.json", "2.png", "2.npy", "3.png"))):
        (tmp_path / folder).mkdir()
        for name in names:
            (tmp_path / folder / name).touch()
    with pytest.warns(UserWarning, match=r"1 depth images have no colour image of their name: .*3.png"):
        assert [f.depth.name for f in find_frames([str(tmp_path)])] == ["1.png", "2.npy"]


def test_none_switches_off_what_may_be_off_and_stays_a_word_elsewhere() -> None:
    config = configure(
        "OBJECTS", {"additions.joining": "none", "edges.sign_rule": "none", "additions.rules.max_length_m": "NONE"}
    )
    assert config.additions is not None
    assert (config.additions.joining, config.edges.sign_rule, config.additions.rules.max_length_m) == (
        None,
        "none",
        None,
    )
    assert configure("OBJECTS", {"additions": "none"}).additions is None


def test_a_mistyped_flag_of_the_verb_is_recognised(tmp_path: Path) -> None:
    for wrong, right in (("--depthscale", "--depth-scale"), ("--roimask", "--roi-mask")):
        done = spigolo("segment", SCENE, wrong, "1", "--out", tmp_path)
        assert f"unknown flag {wrong} for preset OBJECTS_2: did you mean {right}?" in done.stderr


@pytest.mark.parametrize("kind", ["8", "16", "rgb"])
def test_a_mask_of_any_kind_says_where_objects_are_wanted(tmp_path: Path, kind: str) -> None:
    inside = np.zeros((480, 640), np.uint16)
    inside[:, :320] = 3
    image = {"8": inside.astype(np.uint8), "16": inside, "rgb": np.dstack([0 * inside] * 2 + [inside]).astype(np.uint8)}
    cv2.imwrite(str(tmp_path / "mask.png"), image[kind])
    done = spigolo("segment", SCENE, "--roi-mask", tmp_path / "mask.png", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    labels = cv2.imread(str(tmp_path / "out" / "labels.png"), cv2.IMREAD_UNCHANGED)
    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    assert labels.max() > 0 and np.array_equal(labels, sp.segment(frame, roi=inside > 0).labels)


def test_what_labels_fit_is_written_where_the_camera_distorts(tmp_path: Path) -> None:
    camera = json.loads((SCENE / "camera.json").read_text()) | {"distortion": [0.1, 0, 0, 0]}
    (tmp_path / "camera.json").write_text(json.dumps(camera))
    done = spigolo("segment", SCENE, "--camera", tmp_path / "camera.json", "--out", tmp_path / "out")
    assert "undistorted.png, not to the input image" in done.stdout
    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", tmp_path / "camera.json")
    assert np.array_equal(cv2.imread(str(tmp_path / "out" / "undistorted.png"))[..., ::-1], frame.color)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (
            ["--methods", "rao2010", "--partition.gamma", "1"],
            "expected the method toscana2016 with --partition.gamma, got only rao2010",
        ),
        (["--presets"], "expected at least one method, and at least one preset for toscana2016, got none"),
    ],
)
def test_an_evaluation_of_nothing_is_refused(tmp_path: Path, words: list[str], sentence: str) -> None:
    done = spigolo("evaluate", SCENE, *words, "--out", tmp_path / "rows.jsonl")
    assert done.returncode == 2 and sentence in done.stderr
    assert not (tmp_path / "rows.jsonl").exists()


def test_a_flag_takes_several_values() -> None:
    for text in ("12,24", "(12, 24)", "[12, 24]"):
        assert configure("SHELF", {"saliency.surrounds_px": text}).saliency.surrounds_px == (12, 24)


def test_the_package_runs_as_a_module() -> None:
    done = subprocess.run([sys.executable, "-m", "spigolo", "--version"], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == sp.__version__


def test_a_redirected_error_stream_gets_lines_of_progress(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn

    from spigolo.cli import progress

    monkeypatch.setattr(progress, "LINE_S", 0.02)
    with progress.progress(BarColumn(), MofNCompleteColumn(), TextColumn("{task.description}")) as bar:
        bar.update(bar.add_task("frames", total=20), completed=7)
        time.sleep(0.2)
    err = capsys.readouterr().err
    assert "7/20  frames" in err and len(err.splitlines()) >= 2


def test_an_index_counts_the_frames_of_the_folder(tmp_path: Path) -> None:
    for name in ("a", "b", "c"):
        shutil.copytree(SCENE, tmp_path / name)
    (tmp_path / "a" / "depth.png").write_bytes(b"junk")
    done = spigolo("doctor", tmp_path)
    assert done.returncode == 2 and "a/depth.png" in done.stderr
    done = spigolo("trace", tmp_path, "--index", "2", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    done = spigolo("doctor", tmp_path, "--index", "4")
    assert done.returncode == 2 and "there is no frame 4" in done.stderr
