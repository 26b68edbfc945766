"""Run spigolo on each kind of bad input and print the messages as Markdown tables: `python scripts/bad_inputs.py`.

With `--write`, the script writes the tables to docs/bad-input.md.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import cv2
import numpy as np

import spigolo as sp
from spigolo.lab.evaluation import Row, row_to_json, score_row

SCENE = Path(sp.__file__).parent / "demo_scene"
PAGE = Path(__file__).resolve().parents[1] / "docs" / "bad-input.md"
INTRODUCTION = """# Bad input

spigolo refuses input that it cannot use, and gives a one-line message. The message says what was expected, what was
given and, if possible, how to correct the input. The command line prints the message after `spigolo:` and ends with
exit code 2. In Python, a `FileError`, `FrameError`, `CameraError` or `ConfigError` is raised with the message. These
four exceptions are subclasses of `SpigoloError`. Warnings do not stop a run. `spigolo doctor` finds faults in a frame
that can be read.

`python scripts/bad_inputs.py --write` runs spigolo on all inputs in the tables and writes this page.
"""

Words = list[str]
Call = Callable[[], Any]


def main() -> None:
    parser = argparse.ArgumentParser(description="Print the messages of spigolo for bad input.")
    parser.add_argument("--write", action="store_true", help="write docs/bad-input.md instead of printing")
    arguments = parser.parse_args()
    page = make_page()
    if arguments.write:
        PAGE.write_text(page, encoding="utf-8")
    else:
        print(page, end="")


def make_page() -> str:
    """Create the bad inputs in a temporary folder, collect all messages, and return the page as Markdown."""
    with tempfile.TemporaryDirectory(prefix="bad-") as name, ThreadPoolExecutor(2) as pool:
        folder = Path(name)
        make_files(folder)
        commands, calls = command_line(), library(folder)
        answers = list(pool.map(lambda case: clean(run_command(case[1], folder), folder), commands))
        tables = [
            table("Command line", [what for what, _ in commands], answers),
            table("Python", [what for what, _ in calls], [clean(run_call(call), folder) for _, call in calls]),
        ]
    return "\n".join([INTRODUCTION, *tables])


def table(title: str, inputs: list[str], sentences: list[str]) -> str:
    """Return a section of the page: a heading, and a table of inputs and messages."""
    rows = [f"| {what} | {escape(sentence)} |" for what, sentence in zip(inputs, sentences, strict=True)]
    return "\n".join([f"## {title}", "", "| input | message |", "|---|---|", *rows, ""])


def make_files(folder: Path) -> None:
    """Write the bundled scene and all bad input files into a folder."""
    copy_scene(folder)
    make_images(folder)
    make_cameras(folder)
    (folder / "unknown-key.toml").write_text('base = "TABLE"\n[partition]\ngama = 0.004\n', encoding="utf-8")
    (folder / "range.toml").write_text('base = "TABLE"\n[edges]\ncanny_low = 1.5\n', encoding="utf-8")
    (folder / "broken.toml").write_text("gamma 0.004\n", encoding="utf-8")
    (folder / "file").write_text("", encoding="utf-8")
    make_sets(folder)
    make_rows(folder)


def copy_scene(folder: Path) -> None:
    """Copy the images and the camera file of the bundled scene, which have no fault, into a folder."""
    for name in ("rgb.png", "depth.png", "camera.json"):
        shutil.copy(SCENE / name, folder / name)


def make_images(folder: Path) -> None:
    """Write images of the wrong size, type or content, and files that are not images."""
    depth = cv2.imread(str(SCENE / "depth.png"), cv2.IMREAD_UNCHANGED)
    grey = np.clip(depth / 10, 0, 255).astype(np.uint8)
    pictures = {
        "half.png": depth[::2, ::2],
        "depth8.png": grey,
        "colours.png": cv2.applyColorMap(grey, cv2.COLORMAP_TURBO),
        "depth.jpg": grey,
        "nothing.png": np.zeros_like(depth),
        "huge.png": np.zeros((4001, 4000, 3), np.uint8),
        "huge-depth.png": np.zeros((4001, 4000), np.uint16),
    }
    for name, picture in pictures.items():
        cv2.imwrite(str(folder / name), picture)
    (folder / "truncated.png").write_bytes((SCENE / "depth.png").read_bytes()[:1000])
    (folder / "empty.png").write_bytes(b"")
    (folder / "empty.npy").write_bytes(b"")
    np.save(folder / "unit.npy", depth.astype(np.float32))


def make_cameras(folder: Path) -> None:
    """Write camera files with missing or invalid values."""
    camera = json.loads((SCENE / "camera.json").read_text(encoding="utf-8"))
    cameras = {
        "no-scale": {k: v for k, v in camera.items() if k != "depth_scale"},
        "other-size": {**camera, "width": 1280, "height": 720},
        "zero": {**camera, "fx": 0},
        "negative": {**camera, "fy": -525.0},
        "no-number": {k: v for k, v in camera.items() if k != "fx"},
        "text": {**camera, "fx": "525 px"},
        "scale": {**camera, "depth_scale": 1},
        "fisheye": {**camera, "distortion": [0.1, 0, 0, 0], "distortion_model": "equidistant"},
    }
    for name, values in cameras.items():
        (folder / f"{name}.json").write_text(json.dumps(values), encoding="utf-8")
    (folder / "broken.json").write_text('{"fx": 525.0', encoding="utf-8")


def make_sets(folder: Path) -> None:
    """Create folders without frames, with an incomplete data set, and without labels."""
    (folder / "no-frames").mkdir()
    scene = folder / "half-a-set" / "test" / "000001"
    scene.mkdir(parents=True)
    intrinsics = {"cam_K": [525.0, 0.0, 319.5, 0.0, 525.0, 239.5, 0.0, 0.0, 1.0], "depth_scale": 1.0}
    (scene / "scene_camera.json").write_text(json.dumps({"0": intrinsics}), encoding="utf-8")
    (folder / "unlabelled").mkdir()
    copy_scene(folder / "unlabelled")


def make_rows(folder: Path) -> None:
    """Write the scores of an evaluation on a data set that is not in the paper."""
    labels = cv2.imread(str(SCENE / "label.png"), cv2.IMREAD_UNCHANGED)
    row = Row(
        data_set="mine", frame="rgb", group="mine/rgb", labelling="full", method="toscana2016", preset="TABLE",
        digest=sp.TABLE.digest, parameters={}, version=sp.__version__, machine="", cpu_s=None, wall_s=None,
        n_predicted=int(labels.max()), rejected={}, score=score_row(labels, labels),
    )  # fmt: skip
    (folder / "rows.jsonl").write_text(row_to_json(row) + "\n", encoding="utf-8")


def segment(color: str = "rgb.png", depth: str = "depth.png", camera: str = "camera.json", *more: str) -> Words:
    """Return the command-line arguments that segment a frame."""
    return ["segment", color, depth, "--camera", camera, "--no-check", *more]


def flags(*more: str) -> Words:
    """Return the command-line arguments that segment the frame without faults, with additional flags."""
    return segment("rgb.png", "depth.png", "camera.json", *more)


def command_line() -> list[tuple[str, Words]]:
    """Return all command-line cases, as pairs of a description and the arguments after `spigolo`."""
    return [*wrong_files(), *wrong_flags(), *other_verbs(), *warned_of()]


def wrong_files() -> list[tuple[str, Words]]:
    """Return the command-line cases with bad images and cameras."""
    return [
        ("a depth map and a colour image of different sizes", segment(depth="half.png")),
        ("depth with 8 bits", segment(depth="depth8.png")),
        ("depth as a colour-coded image", segment(depth="colours.png")),
        ("depth as JPEG", segment(depth="depth.jpg")),
        ("an image file that does not exist", segment("none.png")),
        ("a colour image without a depth image", ["segment", "rgb.png", "--camera", "camera.json"]),
        ("a truncated image file", segment(depth="truncated.png")),
        ("an empty image file", segment("empty.png")),
        ("an empty depth file", segment(depth="empty.npy")),
        ("an image of more than 16 million pixels", segment("huge.png", "huge-depth.png", "camera.json")),
        ("integer depth without a depth scale", segment(camera="no-scale.json")),
        ("a depth scale in millimetres per unit", segment(camera="scale.json")),
        ("a depth scale of 0", flags("--depth-scale", "0")),
        ("intrinsics for another image size", segment(camera="other-size.json")),
        ("a focal length of 0", segment(camera="zero.json")),
        ("a negative focal length", segment(camera="negative.json")),
        ("a camera file without fx", segment(camera="no-number.json")),
        ("text instead of a number in a camera file", segment(camera="text.json")),
        ("a camera file with invalid JSON", segment(camera="broken.json")),
        ("a camera file that does not exist", segment(camera="none.json")),
        ("an unknown camera name", segment("rgb.png", "depth.png", "kinect-v9", "--depth-scale", "0.001")),
        ("fisheye distortion", segment(camera="fisheye.json")),
    ]


def wrong_flags() -> list[tuple[str, Words]]:
    """Return the command-line cases with bad presets, values and output folders."""
    return [
        ("an unknown preset", flags("--preset", "tabel")),
        ("an unknown key in a TOML file", flags("--preset", "unknown-key.toml")),
        ("a value out of range in a TOML file", flags("--preset", "range.toml")),
        ("a preset file with invalid TOML", flags("--preset", "broken.toml")),
        ("a preset file that does not exist", flags("--preset", "none.toml")),
        ("an unknown flag", flags("--verbose", "1")),
        ("a misspelt flag", flags("--partition.gama", "0.004")),
        ("a flag without its value", flags("--partition.gamma")),
        ("a parameter value out of range", flags("--partition.gamma", "-1")),
        ("text instead of a parameter value", flags("--partition.gamma", "much")),
        ("a region of interest outside of the image", flags("--roi", "0", "0", "481", "640")),
        ("two regions of interest", flags("--roi", "0", "0", "9", "9", "--roi-mask", "rgb.png")),
        ("a region of interest with another image size", flags("--roi-mask", "half.png")),
        ("an output folder that is a file", flags("--out", "file")),
    ]


def other_verbs() -> list[tuple[str, Words]]:
    """Return the command-line cases of commands other than `segment`."""
    return [
        ("a folder without frames", ["segment", "no-frames"]),
        ("a folder that does not exist", ["segment", "nowhere"]),
        ("no input", ["segment"]),
        ("a folder in an unknown layout", ["evaluate", "no-frames"]),
        ("an incomplete data set", ["evaluate", "half-a-set"]),
        ("an unknown data set", ["fetch", "imagenet"]),
        ("`fetch` of a data set whose hash is not known", ["fetch", "tejani"]),
        ("a file of scores that does not exist", ["report", "none.jsonl"]),
        ("`--paper` with scores of a data set that is not in the paper", ["report", "rows.jsonl", "--paper"]),
        ("`--paper` together with `--against`", ["report", "rows.jsonl", "--against", "TABLE", "--paper"]),
        ("`fit` to a folder without frames", ["fit", "no-frames"]),
        ("`fit` to frames without labels", ["fit", "unlabelled"]),
        ("an unknown family of scenes", ["render", "attic"]),
        ("an unknown layout for rendered frames", ["render", "table", "--layout", "coco"]),
    ]


def warned_of() -> list[tuple[str, Words]]:
    """Return the command-line cases that give a warning instead of an error."""
    return [
        ("a frame without any depth: a warning, no objects", segment(depth="nothing.png")),
        (
            "depth in millimetres, read as metres: a warning",
            ["segment", "rgb.png", "unit.npy", "--camera", "camera.json"],
        ),
    ]


def library(folder: Path) -> list[tuple[str, Call]]:
    """Return all cases of the Python library, as pairs of a description and a function to call."""
    frame = sp.read_frame(folder / "rgb.png", folder / "depth.png", folder / "camera.json")
    color, depth, camera = frame.color, frame.depth, frame.camera
    assert camera is not None
    bare, box = sp.Frame(color, depth, None), sp.MetricBox((0, 0, 0), (1, 1, 1))
    in_millimetres, no_rotation = np.eye(4) + 25 * np.eye(4, k=3), np.diag([2, 1, 1, 1])
    return [
        ("a colour image with one channel", lambda: sp.Frame(color[..., 0], depth, camera)),
        ("a colour image of floats", lambda: sp.Frame(color / 255, depth, camera)),
        ("more pixels than `max_pixels`", lambda: sp.Frame(color, depth, camera, max_pixels=100_000)),
        ("integer depth without `depth_scale`", lambda: sp.Frame(color, depth.astype(np.uint16), camera)),
        ("negative depth: a warning", lambda: sp.Frame(color, depth - 1, camera)),
        ("an infinite focal length", lambda: sp.Camera(np.inf, 525, 319.5, 239.5, 640, 480)),
        ("intrinsics of three numbers", lambda: sp.Frame(color, depth, (525, 319.5, 239.5))),
        ("a transposed camera matrix", lambda: sp.Frame(color, depth, camera.matrix.T)),
        ("an unknown parameter of a preset", lambda: sp.TABLE.replace(**{"partition.gama": 0.004})),
        ("a parameter value out of range", lambda: sp.settings.Partition(connectivity=6)),
        (
            "a low Canny threshold above the high threshold",
            lambda: sp.settings.EdgesConfig(canny_low=0.2, canny_high=0.1),
        ),
        ("a pixel outside of the image", lambda: sp.segment(frame, sp.TABLE).at((480, 0))),
        ("a metric box with low Z above high Z", lambda: sp.MetricBox((0, 0, 1), (1, 1, 0))),
        ("a metric box for a frame without intrinsics", lambda: sp.segment(bare, roi=box)),
        ("points in metres for a frame without intrinsics", lambda: sp.segment_at(bare, (140, 160)).points_m()),
        (
            "registration with a translation in millimetres",
            lambda: sp.register_depth(depth, camera, camera, in_millimetres),
        ),
        (
            "registration with a matrix that is not a rotation",
            lambda: sp.register_depth(depth, camera, camera, no_rotation),
        ),
    ]


def run_command(words: Words, folder: Path) -> str:
    """Run spigolo with command-line arguments and return its messages. The exit code must be 2, or 0 after a
    warning.
    """
    out = [] if "--out" in words or words[-1].startswith("--") or words[0] == "fetch" else ["--out", "out"]
    done = subprocess.run(
        [sys.executable, "-c", "from spigolo.cli import main; main()", *words, *out],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )
    lines = [line for line in done.stderr.splitlines() if line.startswith("spigolo: ")]
    expected = 0 if any("warning: " in line for line in lines) else 2
    if done.returncode != expected or not lines:
        raise AssertionError(f"{words}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return " ".join(line.removeprefix("spigolo: ") for line in lines)


def run_call(call: Call) -> str:
    """Call a function and return its error message or its warnings."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            call()
        except (sp.SpigoloError, IndexError) as error:
            return f"{type(error).__name__}: {error}"
    return " ".join(f"{type(w.message).__name__}: {w.message}" for w in caught)


def clean(text: str, folder: Path) -> str:
    """Remove the path of the temporary folder from a message."""
    return text.replace(f"{folder}/", "").replace(f"{folder}", "")


def escape(text: str) -> str:
    """Escape a text for a cell of a Markdown table."""
    for character in "\\|<*_[":
        text = text.replace(character, f"\\{character}")
    return text


if __name__ == "__main__":
    main()
