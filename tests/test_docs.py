"""The examples run, and the pages say what is so."""

from __future__ import annotations

import doctest
import json
import os
import pkgutil
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import cv2
import numpy as np
import pytest

import spigolo as sp

ROOT = Path(__file__).resolve().parents[1]
SCENE = Path(sp.__file__).parent / "demo_scene"
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
SCRIPTS = sorted((ROOT / "scripts").glob("*.py"))
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").glob("*.md")])
ELSEWHERE = {"tuning.jpg", "tutorial-1.jpg", "tutorial-2.jpg"}
"""Pictures that tests of pages take (SPIGOLO_SCREENSHOTS names the folder), and those of scripts/write_tutorial.py."""
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")

compiled = pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="whole frames need compiled kernels")


def run(*words: object, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *map(str, words)], cwd=folder, capture_output=True, text=True, check=False, timeout=600
    )


def name(path: Path) -> str:
    return path.name


def test_the_examples_are_numbered_from_one() -> None:
    assert [path.name[:3] for path in EXAMPLES] == [f"{k:02d}_" for k in range(1, len(EXAMPLES) + 1)]
    assert len(EXAMPLES) >= 5


@pytest.mark.parametrize("path", EXAMPLES, ids=name)
def test_an_example_is_short_and_says_what_it_is(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert 30 <= len(text.splitlines()) <= 60
    title, _, prose = text.removeprefix('"""').partition("\n\n")
    assert re.fullmatch(r"[A-Z][^\n]{3,40}\.", title)
    assert prose.partition("\n\n")[0].count(".") >= 2
    assert f"python examples/{path.name}" in text


@compiled
@pytest.mark.parametrize("path", EXAMPLES, ids=name)
def test_an_example_runs_and_writes_into_its_output_folder(path: Path, tmp_path: Path) -> None:
    done = run(path, "--out", tmp_path / "out", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert 3 <= len(done.stdout.splitlines()) <= 30
    assert "nan" not in done.stdout
    assert [p.name for p in tmp_path.iterdir()] == ["out"]
    assert any(p.suffix == ".png" and p.stat().st_size > 10_000 for p in (tmp_path / "out").iterdir())


@compiled
@pytest.mark.parametrize("path", [p for p in EXAMPLES if "[rgb.png" in p.read_text(encoding="utf-8")], ids=name)
def test_an_example_takes_files(path: Path, tmp_path: Path) -> None:
    files = [SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json"]
    assert run(path, *files, "--out", tmp_path, folder=tmp_path).returncode == 0
    assert run(path, *files[:2], "--out", tmp_path, folder=tmp_path).returncode == 2


@compiled
def test_the_example_of_corrections_merges_what_was_apart(tmp_path: Path) -> None:
    done = run(ROOT / "examples" / "04_correct_by_hand.py", "--out", tmp_path, folder=tmp_path)
    merged = re.findall(r": (\d+) px and (\d+) px are (\d+) px", done.stdout)
    assert len(merged) == 2
    for one, other, both in merged:
        assert int(one) + int(other) == int(both)


@pytest.mark.parametrize("path", SCRIPTS, ids=name)
def test_a_script_says_what_it_takes(path: Path, tmp_path: Path) -> None:
    done = run(path, "--help", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"usage: {path.name}")
    assert run(path, "--no-such-flag", folder=tmp_path).returncode == 2


@compiled
def test_the_page_of_bad_input_has_the_present_messages() -> None:
    done = run(ROOT / "scripts" / "bad_inputs.py", folder=ROOT)
    assert done.returncode == 0, done.stderr
    written = (ROOT / "docs" / "bad-input.md").read_text(encoding="utf-8")
    assert done.stdout == written, "python scripts/bad_inputs.py --write"


RUN = {
    page: re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    for page in PAGES
    if page.name
    in (
        "README.md",
        "index.md",
        "python.md",
        "cameras.md",
        "presets.md",
        "outputs.md",
        "wrong-results.md",
        "extending.md",
    )
}
"""The Python of pages whose blocks continue each other."""
FIRST = {"python.md": 1, "cameras.md": 1}
"""How many blocks of a page run, where the others use things that a test does not have."""


def scene_in(folder: Path) -> Path:
    for file in ("rgb.png", "depth.png", "camera.json"):
        shutil.copy(SCENE / file, folder)
    return folder


@compiled
@pytest.mark.parametrize("page", RUN, ids=name)
def test_the_python_of_a_page_runs(page: Path, tmp_path: Path) -> None:
    blocks = RUN[page][: FIRST.get(page.name)]
    assert blocks
    done = run("-W", "error", "-c", "\n".join(blocks), folder=scene_in(tmp_path))
    assert done.returncode == 0, done.stderr
    assert done.stdout


@compiled
def test_the_reader_on_extending_reads_frames(tmp_path: Path) -> None:
    text = (ROOT / "docs" / "extending.md").read_text(encoding="utf-8")
    (block,) = (b for b in re.findall(r"```py\n(.*?)```", text, flags=re.DOTALL) if "class Mine(" in b)
    names: dict[str, Any] = {}
    exec(block, names)
    (day := tmp_path / "monday").mkdir()
    shutil.copy(SCENE / "rgb.png", day / "7_rgb.png")
    shutil.copy(SCENE / "depth.png", day / "7_depth.png")
    assert names["Mine"].matches(day)
    (entry,) = names["Mine"](day)
    assert (entry.name, entry.data_set) == ("7_rgb", "monday")
    frame = entry.read()
    assert frame.camera == sp.Camera.named("realsense-d435")
    assert 0.2 < float(np.median(frame.depth[frame.depth > 0])) < 3


@compiled
def test_the_first_command_on_tuning_opens_a_page(tmp_path: Path) -> None:
    line = (ROOT / "docs" / "tuning.md").read_text(encoding="utf-8").partition("```sh\n")[2].partition("\n")[0]
    words = [sys.executable, "-m", *line.split(), "--no-browser"]
    with subprocess.Popen(words, cwd=scene_in(tmp_path), stdout=subprocess.PIPE, text=True) as page:
        assert page.stdout is not None
        said = page.stdout.readline()
        page.terminate()
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+ shows 1 frame\. Ctrl-C ends it\.\n", said)


@compiled
def test_the_file_for_a_grasp_planner_has_every_object_in_the_frame_of_the_robot(tmp_path: Path) -> None:
    (block,) = [text for text in RUN[ROOT / "docs" / "outputs.md"] if "savez_compressed" in text]
    done = run("-W", "error", "-c", block, folder=scene_in(tmp_path))
    assert done.returncode == 0, done.stderr
    result = sp.segment(sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json"))
    with np.load(tmp_path / "grasps.npz") as file:
        assert len(file["masks"]) == len(file["scores"]) == len(result) > 5
        T = file["T_base_camera"]
        for o, mask, size_m, pose in zip(result, file["masks"], file["sizes_m"], file["T_base_box"], strict=True):
            assert np.array_equal(mask, o.mask)
            inside = (o.points_m() @ T[:3, :3].T + T[:3, 3] - pose[:3, 3]) @ pose[:3, :3]  # along the axes of the box
            assert (np.abs(inside) <= size_m / 2 + 1e-6).all(axis=1).mean() > 0.85, o.label


@compiled
@pytest.mark.parametrize("page", [p for p in PAGES if "```sh" in p.read_text(encoding="utf-8")], ids=name)
def test_the_shell_commands_of_a_page_run(page: Path, tmp_path: Path) -> None:
    scene_in(tmp_path)
    for block in re.findall(r"```sh\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL):
        for line in block.splitlines():
            if line.startswith("spigolo tune "):
                continue  # a page that waits: it has a test of its own
            done = run("-m", *line.split(), folder=tmp_path)
            assert done.returncode == 0, line + done.stderr
            assert done.stdout


@compiled
def test_the_examples_of_the_api_reference_give_what_they_show(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(scene_in(tmp_path))
    text = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    examples = "\n".join(re.findall(r"```pycon\n(.*?)```", text, flags=re.DOTALL))
    asked = doctest.DocTestParser().get_doctest(examples, {}, "api.md", None, 0)
    told: list[str] = []
    failed, tried = doctest.DocTestRunner().run(asked, out=told.append)
    assert tried > 20
    assert not failed, "".join(told)


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_links_between_pages_and_to_pictures_lead_somewhere(page: Path) -> None:
    for link in LINK.findall(without_code(page)):
        if link.startswith(("https://", "http://")):
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.is_file(), link
        if anchor:
            assert anchor in anchors(target), link


def test_every_picture_is_shown_and_small() -> None:
    shown = {Path(link).name for page in PAGES for link in LINK.findall(page.read_text(encoding="utf-8"))}
    for picture in (ROOT / "docs" / "images").iterdir():
        assert picture.name in shown
        assert picture.stat().st_size < 200_000, picture.name


@compiled
def test_every_picture_can_be_drawn_again(tmp_path: Path) -> None:
    done = run("-W", "error", ROOT / "scripts" / "draw_docs.py", "--out", tmp_path, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    held = sorted(p for p in (ROOT / "docs" / "images").iterdir() if p.name not in ELSEWHERE)
    assert sorted(map(name, tmp_path.iterdir())) == [path.name for path in held]
    for path in held:
        drawn = cv2.imread(str(tmp_path / path.name))
        assert drawn.shape == cv2.imread(str(path)).shape, f"python scripts/draw_docs.py {path.stem}"
        assert drawn.std() > 20, path.name


def test_every_page_is_in_the_navigation() -> None:
    navigation = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").partition("nav:")[2].partition("plugins:")[0]
    pages = [str(page.relative_to(ROOT / "docs")) for page in (ROOT / "docs").rglob("*.md")]
    assert sorted(re.findall(r": (\S+\.md)$", navigation, flags=re.MULTILINE)) == sorted(pages)


def test_the_first_page_leads_to_every_other() -> None:
    first = ROOT / "docs" / "index.md"
    led = set(LINK.findall(first.read_text(encoding="utf-8").partition("## Where to read on")[2]))
    assert {p.name for p in PAGES if p.parent == first.parent} - {first.name} == {p for p in led if p.endswith(".md")}


def test_every_public_name_is_on_the_page_of_python() -> None:
    page = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    told = re.findall(r"^::: (spigolo(?:\.\w+)+)$", page, flags=re.MULTILINE)
    things = {path: pkgutil.resolve_name(path) for path in told}  # each of them is there
    names = {path.rpartition(".")[2] for path in told}
    rooms = {f"spigolo.{name}" for name in sp.__all__ if isinstance(getattr(sp, name), ModuleType)}
    assert rooms <= set(told)
    assert set(sp.__all__) - {"__version__"} <= names
    assert set(sp.settings.__all__) - {"Parameters", "Settings"} <= names
    kinds = {
        thing for thing in vars(sp.errors).values() if isinstance(thing, type) and thing.__module__ == "spigolo.errors"
    }
    assert all(kind in things.values() for kind in kinds)
    for name in set(sp.__all__) & names:
        assert any(thing is getattr(sp, name) for thing in things.values()), name


def test_the_homes_of_the_equations_exist() -> None:
    page = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
    homes = re.findall(r"`([a-z_]+(?:\.\w+)+)`", page.partition("## Equations")[2].partition("## Symbols")[0])
    assert len(homes) > 15
    for home in homes:
        assert pkgutil.resolve_name(f"spigolo.{home}") is not None


def without_code(page: Path) -> str:
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    return re.sub(r"`[^`\n]*`", "", text)


def anchors(page: Path) -> set[str]:
    """As both the site and GitHub make them of the plain headings used here."""
    headings = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def test_dead_links_and_missing_words_of_a_site_are_reported(tmp_path: Path) -> None:
    page = '<a href="other.html#there">a</a><a href="#nowhere">b</a><a href="gone.html">c</a><a href="https://x.org">'
    (tmp_path / "index.html").write_text(page, encoding="utf-8")
    (tmp_path / "other.html").write_text('<h2 id="there">d</h2>', encoding="utf-8")
    item = {"location": "outputs.html#a", "title": "Segmap", "text": "hand-eye calibration"}
    (tmp_path / "search.json").write_text(json.dumps({"items": [item]}), encoding="utf-8")
    done = run(ROOT / "scripts" / "check_site.py", tmp_path, folder=tmp_path)
    assert done.returncode == 1
    assert done.stdout.splitlines() == [
        "index.html: dead link #nowhere",
        "index.html: dead link gone.html",
        "cameras.html: no section has the words 'depth scale'",
        "cameras.html: no section has the words 'realsense'",
        "wrong-results.html: no section has the words 'table returned as object'",
        "install.html: no section has the words 'docker'",
        "command-line.html: no section has the words 'resume'",
        "wrong-results.html: no section has the words 'upside down'",
    ]
