"""The command line as a user meets it."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

import spigolo as sp

SCENE = Path(sp.__file__).parent / "demo_scene"


def spigolo(*words: object) -> subprocess.CompletedProcess[str]:
    code = "from spigolo.cli import main; main()"
    return subprocess.run(
        [sys.executable, "-c", code, *map(str, words)], capture_output=True, text=True, check=False, timeout=300
    )


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


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["segment", "none.png", SCENE / "depth.png", "--camera", SCENE / "camera.json"], "none.png"),
        (["segment", SCENE / "rgb.png", SCENE / "depth.png", "--camera", "none.json"], "none.json"),
        (["segment", SCENE / "rgb.png", SCENE / "rgb.png", "--camera", SCENE / "camera.json"], "no depth"),
        (
            ["segment", SCENE / "rgb.png", SCENE / "depth.png", "--camera", SCENE / "camera.json", "--preset", "tabel"],
            "unknown preset 'tabel'",
        ),
        (["segment", SCENE / "rgb.png"], "requires an argument"),
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
    assert "RGB" in done.stdout
