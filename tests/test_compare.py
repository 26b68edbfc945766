"""Methods side by side on one frame."""

from __future__ import annotations

from pathlib import Path

import cv2

from test_cli import SCENE, spigolo


def test_methods_stand_side_by_side(tmp_path: Path) -> None:
    out = tmp_path / "compare.png"
    done = spigolo("compare", SCENE, "--methods", "rao2010", "--out", out)
    assert done.returncode == 0, done.stderr
    assert [line.split(":")[0] for line in done.stdout.splitlines()] == ["rao2010", "toscana2016 OBJECTS", "picture"]
    assert cv2.imread(str(out)).shape[1] > 3 * 600


def test_presets_stand_side_by_side(tmp_path: Path) -> None:
    mine = tmp_path / "mine.toml"
    mine.write_text('base = "TABLE"\n[partition]\ngamma = 0.02\n')
    flags = ("--methods", "rao2010", "--presets", "TABLE", mine, "--out", tmp_path / "x.png")
    done = spigolo("compare", SCENE, *flags)
    assert done.returncode == 0, done.stderr
    names = [line.split(":")[0] for line in done.stdout.splitlines()]
    assert names == ["rao2010", "toscana2016 TABLE", "toscana2016 mine", "picture"]
    done = spigolo("compare", SCENE, "--presets", "TABEL", "--out", tmp_path / "y.png")
    assert done.returncode == 2 and "unknown preset 'TABEL'" in done.stderr


def test_an_unknown_method_is_named(tmp_path: Path) -> None:
    done = spigolo("compare", SCENE, "--methods", "rao2011", "--out", tmp_path / "x.png")
    assert done.returncode == 2
    assert "unknown method 'rao2011': expected one or more of toscana2016" in done.stderr
    assert not (tmp_path / "x.png").exists()


def test_one_frame_is_compared_and_a_folder_is_no_picture(tmp_path: Path) -> None:
    done = spigolo("compare", SCENE, SCENE, "--methods", "rao2010", "--out", tmp_path / "x.png")
    assert done.returncode == 2 and "expected one frame, got 2" in done.stderr
    done = spigolo("compare", SCENE, "--methods", "rao2010", "--out", tmp_path / "new")
    assert done.returncode == 0 and (tmp_path / "new" / "compare.png").is_file(), done.stderr
