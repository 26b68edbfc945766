"""The first frame: short kernels, a cache where the user may write, and none where nothing can be written."""

from __future__ import annotations

import ast
import importlib
import os
import pkgutil
import shutil
import stat
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path

import pytest

import spigolo
import spigolo.kernels._jit

SOURCES = Path(spigolo.__file__).parents[1]
KERNELS = sorted((SOURCES / "spigolo" / "kernels").glob("[a-z]*.py"))
NOBODY = 65534
SEGMENT = """
import os, numpy as np, spigolo as sp
rng = np.random.default_rng(0)
depth = np.full((60, 80), 1.0, np.float32)
depth[20:40, 30:50] = 0.8
color = np.full((60, 80, 3), 90, np.uint8)
color[20:40, 30:50] = 200, 30, 30
result = sp.segment(sp.Frame(color, depth, sp.Camera(80, 80, 39.5, 29.5, 80, 60)), sp.TABLE)
print(os.getuid(), *result.labels.shape)
"""
UNPACK = """
import numpy as np
from spigolo.kernels.lzf import unpack_lzf
unpack_lzf(np.array([0, 7], np.uint8), np.zeros(1, np.uint8))
"""
"""Calls a kernel that no segmentation needs."""


@pytest.mark.parametrize("path", KERNELS, ids=lambda p: p.stem)
def test_no_kernel_is_longer_than_sixty_lines(path: Path) -> None:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef):
            assert node.end_lineno is not None
            assert node.end_lineno - node.lineno < 60, node.name


@pytest.fixture
def public() -> Iterator[Path]:
    """A folder that every user can read, unlike pytest's own."""
    folder = Path(tempfile.mkdtemp())
    folder.chmod(0o755)
    yield folder
    shutil.rmtree(folder)


def closed_to_others(folder: Path) -> Path | None:
    """The outermost folder on the way to this one that other users cannot enter."""
    return next((part for part in reversed((folder, *folder.parents)) if not part.stat().st_mode & stat.S_IXOTH), None)


def interpreter_for_all(folder: Path) -> Path:
    """This interpreter where every user can run it: its home may be closed to others."""
    libraries = Path(sysconfig.get_path("stdlib"))
    left_out = shutil.ignore_patterns("site-packages", "test", "__pycache__", "idlelib", "tkinter")
    shutil.copytree(libraries, folder / "lib" / libraries.name, ignore=left_out)
    for shared in Path(sys.base_prefix, "lib").glob("libpython*"):
        shutil.copy(shared, folder / "lib")
    (folder / "bin").mkdir()
    return Path(shutil.copy(Path(sys.executable).resolve(), folder / "bin" / "python"))


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root can become another user")
def test_another_user_without_a_home_who_can_write_nowhere_still_gets_an_answer(public: Path) -> None:
    packages = sysconfig.get_path("purelib")
    for folder in (public, SOURCES, Path(packages)):
        if (closed := closed_to_others(folder.resolve())) is not None:
            pytest.skip(f"{closed} is closed to other users")
    environment = {
        "PYTHONHOME": str(public),
        "PYTHONPATH": f"{SOURCES}:{packages}",
        "LD_LIBRARY_PATH": str(public / "lib"),
        "HOME": "/nonexistent",
    }
    done = subprocess.run(
        [interpreter_for_all(public), "-c", SEGMENT],
        user=NOBODY, group=NOBODY, extra_groups=[], env=environment, cwd="/", capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [str(NOBODY), "60", "80"]
    assert "each process compiles them again: set SPIGOLO_CACHE_DIR" in done.stderr


def test_the_cache_lies_where_it_is_asked_for_and_a_run_that_compiles_says_so_once(tmp_path: Path) -> None:
    environment = {**os.environ, "SPIGOLO_CACHE_DIR": str(tmp_path)}
    first, second, more, again = (
        subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
        for code in (SEGMENT, SEGMENT, UNPACK, UNPACK)
    )
    assert first.stderr == more.stderr == "compiling kernels for this machine: this takes up to a minute\n"
    assert second.stderr == again.stderr == ""
    kept = [path.relative_to(tmp_path).parts for path in tmp_path.rglob("*.nbi")]
    assert len(kept) > 20
    kernels = sorted(path.stem for path in KERNELS)
    keyed = {("spigolo", "kernels", f"{name}-{spigolo.kernels._jit.module_key(name)}") for name in kernels}
    assert {part[:3] for part in kept} <= keyed


def test_an_edit_gives_a_new_key_to_its_module_and_to_those_that_import_it(monkeypatch: pytest.MonkeyPatch) -> None:
    jit = spigolo.kernels._jit
    names = [path.stem for path in KERNELS]
    content = jit._content

    def edited(name: str) -> tuple[bytes, Iterable[str]]:
        source, imported = content(name)
        return source + b"# edited" * (name == "merging"), imported

    jit.module_key.cache_clear()
    before = {name: jit.module_key(name) for name in names}
    monkeypatch.setattr(jit, "_content", edited)
    jit.module_key.cache_clear()
    after = {name: jit.module_key(name) for name in names}
    jit.module_key.cache_clear()
    assert {name for name in names if before[name] != after[name]} == {"merging", "choosing", "sorting"}


@pytest.mark.parametrize("path", KERNELS, ids=lambda p: p.stem)
def test_a_kernel_module_imports_others_as_its_key_reads_them(path: Path) -> None:
    """`from spigolo.kernels.x import y`: any other form would not count as imported."""
    package = "spigolo.kernels"
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            assert not any(alias.name.startswith(package) for alias in node.names)
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0 and node.module != package


@pytest.mark.parametrize(
    "name",
    sorted(m.name for m in pkgutil.walk_packages(spigolo.__path__, "spigolo.") if not m.name.endswith(".__main__")),
)
def test_every_module_can_be_imported(name: str) -> None:
    importlib.import_module(name)
