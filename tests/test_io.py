"""Files in and out, frames refused at the door, presets, the package's own doors."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

import spigolo as sp
from spigolo.errors import FileError
from spigolo.frames import files as io
from spigolo.settings.presets import from_toml

CAMERA = {"fx": 50.0, "fy": 50.0, "cx": 15.5, "cy": 11.5, "width": 32, "height": 24}


@pytest.fixture
def files(tmp_path: Path) -> Path:
    color = np.zeros((24, 32, 3), np.uint8)
    color[..., 0] = 250  # red
    io.write_png(tmp_path / "rgb.png", color)
    io.write_png(tmp_path / "depth.png", np.full((24, 32), 1234, np.uint16))
    io.write_json(tmp_path / "camera.json", CAMERA | {"depth_scale": 0.001})
    io.write_json(tmp_path / "bare.json", CAMERA)
    return tmp_path


def test_a_red_picture_stays_red_and_millimetres_become_metres(files: Path) -> None:
    frame = sp.read_frame(files / "rgb.png", files / "depth.png", files / "camera.json")
    assert frame.color[0, 0].tolist() == [250, 0, 0]
    assert frame.depth[0, 0] == pytest.approx(1.234)
    assert frame.name == files.name
    assert cv2.imread(str(files / "rgb.png"))[0, 0].tolist() == [0, 0, 250]


def test_the_camera_file_near_the_images_is_found(files: Path, tmp_path: Path) -> None:
    frame = sp.read_frame(files / "rgb.png", files / "depth.png")
    assert frame.camera == sp.read_frame(files / "rgb.png", files / "depth.png", files / "camera.json").camera
    inner = tmp_path / "rgb"
    inner.mkdir()
    (files / "rgb.png").rename(inner / "0001.png")
    found = sp.read_frame(inner / "0001.png", files / "depth.png")
    assert found.camera == frame.camera and found.name == "0001"
    (files / "camera.json").unlink()
    with pytest.raises(FileError, match=r"expected a camera, or a camera file such as camera.json near .*0001.png"):
        sp.read_frame(inner / "0001.png", files / "depth.png")
    assert sp.read_frame(inner / "0001.png", files / "depth.png", None, depth_scale=0.001).camera is None


def test_an_orientation_in_the_metadata_turns_nothing(tmp_path: Path) -> None:
    """Depth has none, and both are of one camera."""
    color = np.zeros((16, 32, 3), np.uint8)
    color[:8] = 255
    data = cv2.imencode(".jpg", color)[1].tobytes()
    exif = b"Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0"  # turn by 90 degrees
    (tmp_path / "a.jpg").write_bytes(data[:2] + b"\xff\xe1" + (len(exif) + 2).to_bytes(2, "big") + exif + data[2:])
    assert cv2.imread(str(tmp_path / "a.jpg")).shape == (32, 16, 3)  # as OpenCV would
    assert io.read_color(tmp_path / "a.jpg").shape == (16, 32, 3)


def test_a_mask_is_all_that_is_not_black(tmp_path: Path) -> None:
    clear = np.zeros((2, 3, 4), np.uint8)
    clear[..., 3], clear[0, 0, 1] = 255, 1
    cv2.imwrite(str(tmp_path / "clear.png"), clear)
    assert io.read_mask(tmp_path / "clear.png").tolist() == [[True, False, False], [False] * 3]


def test_the_scale_given_beats_the_scale_of_the_file(files: Path) -> None:
    frame = sp.read_frame(files / "rgb.png", files / "depth.png", files / "camera.json", depth_scale=0.0002)
    assert frame.depth[0, 0] == pytest.approx(0.2468)


def test_depth_may_be_an_array_of_metres(files: Path) -> None:
    np.save(files / "depth.npy", np.full((24, 32), 0.5))
    frame = sp.read_frame(files / "rgb.png", files / "depth.npy", sp.Camera(**CAMERA))
    assert frame.depth[0, 0] == 0.5


@pytest.mark.parametrize(
    ("spoil", "error", "words"),
    [
        (lambda f: f / "none.png", sp.errors.FileError, "cannot be read"),
        (lambda f: write(f / "empty.png", b""), sp.errors.FileError, "0 bytes"),
        (
            lambda f: write(f / "cut.png", (f / "depth.png").read_bytes()[:60]),
            sp.errors.FileError,
            "bytes that OpenCV cannot read",
        ),
        (lambda f: image(f / "8bit.png", np.ones((24, 32), np.uint8)), sp.errors.FrameError, "8 bits"),
        (
            lambda f: image(f / "colors.png", np.ones((24, 32, 3), np.uint8)),
            sp.errors.FrameError,
            "colour image of the depth",
        ),
        (
            lambda f: image(f / "colors.png", np.ones((24, 32, 3), np.uint16)),
            sp.errors.FrameError,
            "colour image of the depth",
        ),
        (lambda f: image(f / "small.png", np.ones((24, 31), np.uint16)), sp.errors.FrameError, "32x24, got 31x24"),
        (lambda f: write(f / "depth.jpg", b"x"), sp.errors.FrameError, "JPEG"),
        (lambda f: write(f / "depth.npy", b"x"), sp.errors.FileError, "cannot be read"),
        (
            lambda f: write(f / "depth.npy", b"\x93NUMPY\x01\x00\x08\x00{'a': [\n"),
            sp.errors.FileError,
            "expected a depth array in",
        ),
    ],
)
def test_bad_depth_is_refused_with_one_sentence(files: Path, spoil, error, words) -> None:
    with pytest.raises(error, match=words) as caught:
        sp.read_frame(files / "rgb.png", spoil(files), files / "camera.json")
    assert "\n" not in str(caught.value)


def write(path: Path, data: bytes) -> Path:
    path.write_bytes(data)
    return path


def image(path: Path, pixels: np.ndarray) -> Path:
    io.write_png(path, pixels)
    return path


def test_a_colour_file_of_16_bits_is_read_as_one_of_8(files: Path) -> None:
    pixels = np.full((24, 32, 3), 40_000, np.uint16)
    frame = sp.read_frame(image(files / "deep.png", pixels), files / "depth.png", files / "camera.json")
    assert set(frame.color.ravel().tolist()) == {40_000 >> 8}


def test_integer_depth_wants_its_scale(files: Path) -> None:
    with pytest.raises(sp.errors.FrameError, match="depth_scale"):
        sp.read_frame(files / "rgb.png", files / "depth.png", files / "bare.json")


def test_cameras_that_cannot_be(files: Path) -> None:
    for values, words in (
        (CAMERA | {"fx": 0}, "focal"),
        (CAMERA | {"fy": -3.0}, "focal"),
        (CAMERA | {"width": 0}, "size"),
        ({"fx": 1}, "fy, cx, cy, width, height not found"),
        ([1], "got list"),
    ):
        io.write_json(files / "bad.json", values)
        with pytest.raises(sp.errors.CameraError, match=words):
            io.read_camera(files / "bad.json")
    write(files / "bad.json", b"{")
    with pytest.raises(sp.errors.FileError, match="JSON"):
        io.read_camera(files / "bad.json")


def test_a_camera_of_another_size_is_refused(files: Path) -> None:
    with pytest.raises(sp.errors.FrameError, match="camera of the images' size 32x24, got 64x24"):
        sp.read_frame(files / "rgb.png", files / "depth.png", sp.Camera(**(CAMERA | {"width": 64})), 0.001)


def test_negative_depth_is_counted_and_warned_of() -> None:
    depth = np.ones((24, 32), np.float32)
    depth[0, :3] = -1
    with pytest.warns(UserWarning, match="3 pixels have negative depth"):
        frame = sp.Frame(np.zeros((24, 32, 3), np.uint8), depth, sp.Camera(**CAMERA))
    assert frame.negative_depth == 3
    assert frame.depth[0, 0] == 0


def test_a_frame_owns_its_arrays() -> None:
    color, depth = np.zeros((24, 32, 3), np.uint8), np.ones((24, 32), np.float32)
    frame = sp.Frame(color, depth, sp.Camera(**CAMERA))
    color[:], depth[:] = 9, 9
    assert not frame.color.any()
    assert (frame.depth == 1).all()


def test_nothing_half_written_is_left_where_writing_fails(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    with pytest.raises(sp.errors.FileError, match="could not write"):
        io.write_bytes(tmp_path / "folder", b"x")
    assert [p.name for p in tmp_path.iterdir()] == ["folder"]


@pytest.mark.parametrize("name", sorted(sp.PRESETS))
def test_presets_survive_toml(name: str) -> None:
    config = sp.PRESETS[name]
    assert from_toml(config.to_toml()) == config
    assert sp.preset(name.lower()) is config


def test_the_values_of_numbered_presets_and_of_the_papers_presets_stay() -> None:
    """A result names its preset and a hash of its values. Other values need another number, such as OBJECTS_3."""
    assert {name: config.digest for name, config in sp.PRESETS.items()} == {
        "OBJECTS": "4d465d8c",
        "OBJECTS_1": "61d63624",
        "OBJECTS_2": "4d465d8c",
        "SHELF": "6c8784e7",
        "TABLE": "bc24c184",
        "CLUTTER": "89976ca1",
    }


def test_the_papers_numbers_stand_as_printed() -> None:
    assert (sp.SHELF.partition.gamma, sp.SHELF.cost) == (5, sp.settings.SaliencyCost(k_x=1.05, k_y=1.5, k_s=0.5))
    assert (sp.TABLE.partition.gamma, sp.TABLE.cost) == (0.0016, sp.settings.BoundaryCost(k_x=7.5, k_b=0.66))
    assert (sp.CLUTTER.partition.gamma, sp.CLUTTER.cost) == (0.001, sp.settings.BoundaryCost(k_x=1.2, k_b=0.05))
    for config in (sp.SHELF, sp.TABLE, sp.CLUTTER):
        assert (config.color.k_dv, config.color.k_ds, config.saliency.power) == (4.5, 0.1, 4)
        assert config.additions is None
    assert (sp.SHELF.rejection.max_missing, sp.SHELF.rejection.max_dark, sp.SHELF.depth.inpainting) == (0.3, 0.3, None)
    for config in (sp.TABLE, sp.CLUTTER):
        assert (config.rejection.max_missing, config.rejection.max_dark) == (None, None)
        assert config.depth.inpainting is not None


def test_a_preset_file_starts_from_a_preset(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text('base = "table"\n[partition]\ngamma = 0.01\n')
    config = sp.preset(path)
    assert config == sp.TABLE.replace(name="mine", partition={"gamma": 0.01})


def test_a_preset_file_that_says_half_must_say_half_of_what(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    for text in ("", "[rejection]\nmax_distance_m = 1.5\n"):
        path.write_text(text)
        with pytest.raises(sp.errors.ConfigError, match=r'mine\.toml: expected base = "OBJECTS"'):
            sp.preset(path)
    for name, whole in sp.PRESETS.items():
        path.write_text(whole.to_toml())
        assert sp.preset(path) == whole, name


def test_a_preset_file_may_switch_off_and_begin_with_a_byte_order_mark(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text('base = "OBJECTS"\n[additions]\njoining = "none"\nrefinement = "none"\n', encoding="utf-8-sig")
    config = sp.preset(path)
    assert config == sp.OBJECTS.replace(name="mine", additions={"joining": None, "refinement": None})


def test_a_changed_copy_leaves_the_callers_values_alone() -> None:
    mine: dict[str, object] = {"vessel": {}}
    ours = {"additions.support": {}, "additions.joining": mine, "additions.joining.vessel.sure_contrast": 0.2}
    changed = sp.TABLE.replace(**ours)
    assert changed.additions is not None and changed.additions.joining is not None and mine == {"vessel": {}}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[partition]\ngama = 1", "unknown parameter 'gama' in Partition: did you mean 'gamma'"),
        ("colour = 1", "unknown parameter 'colour' in Config: did you mean 'color'"),
        ("gamma = 1", "unknown parameter 'gamma' in Config: did you mean 'partition.gamma'"),
        ("kx = 1", "unknown parameter 'kx' in Config: did you mean 'cost.k_x'"),
        ("[partition]\ngamma = -1", "gamma: Input should be greater than or equal to 0, got -1"),
        ("[partition]\nconnectivity = 6", "connectivity"),
        ('[cost]\nkind = "boundary"\nk_s = 1', "unknown parameter 'k_s' in BoundaryCost"),
        ('base = "nothing"', "unknown preset 'nothing' as base: expected one of OBJECTS"),
        ("gamma", "expected TOML"),
    ],
)
def test_a_wrong_preset_file_is_refused_by_the_name_of_its_fault(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text(text)
    with pytest.raises(sp.errors.ConfigError, match=words) as caught:
        sp.preset(path)
    assert "\n" not in str(caught.value)


def test_a_cost_cannot_carry_another_ones_parameter() -> None:
    with pytest.raises(sp.errors.ConfigError, match="k_s"):
        sp.settings.BoundaryCost(k_s=1)  # type: ignore[call-arg]
    with pytest.raises(sp.errors.ConfigError, match="gamma_shadows"):
        sp.TABLE.replace(cost=sp.settings.AutoCost())


def test_importing_the_package_loads_nothing_heavy() -> None:
    code = "import sys, spigolo; print({'numba', 'cv2', 'pydantic'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


def test_every_public_name_is_there() -> None:
    for name in sp.__all__:
        assert getattr(sp, name) is not None
    with pytest.raises(AttributeError, match="segmentt"):
        _ = sp.segmentt


def test_the_camera_file_of_the_bundled_scene_is_ours() -> None:
    scene = Path(sp.__file__).parent / "demo_scene"
    assert set(json.loads((scene / "camera.json").read_text())) == set(CAMERA) | {"depth_scale"}


def test_a_scale_that_is_given_holds_for_floating_point_too(tmp_path: Path) -> None:
    np.save(tmp_path / "depth.npy", np.full((8, 8), 900.0, np.float32))
    cv2.imwrite(str(tmp_path / "rgb.png"), np.zeros((8, 8, 3), np.uint8))
    for scale, metres in ((0.001, 0.9), (None, 900.0)):
        frame = sp.read_frame(tmp_path / "rgb.png", tmp_path / "depth.npy", None, scale)
        np.testing.assert_allclose(frame.depth, metres, rtol=1e-6)


def test_what_is_no_configuration_is_refused() -> None:
    with pytest.raises(sp.errors.ConfigError, match=r"expected a Config .* got 'TABLE'"):
        sp.segment(sp.Frame(np.zeros((8, 8, 3), np.uint8), np.ones((8, 8), np.float32), None), "TABLE")


@pytest.mark.parametrize("base", [sp.TABLE, sp.SHELF, sp.OBJECTS])
@pytest.mark.parametrize(
    "name", ["additions.refinement.min_solidity", "additions.rules.wall.max_cut_ratio", "additions.support.min_things"]
)
def test_a_rule_that_is_off_stays_off_in_a_file_with_a_base(base: sp.Config, name: str) -> None:
    config = sp.OBJECTS.replace(**{name: None})
    assert from_toml(config.to_toml(base)).digest == config.digest


@pytest.mark.parametrize("text", ["[partition]\ngamma = true", "[additions]\nflats = false"])
def test_a_truth_value_is_no_number(text: str) -> None:
    with pytest.raises(sp.errors.ConfigError, match=r"got '(true|false)'"):
        from_toml(f'base = "OBJECTS"\n{text}\n')
