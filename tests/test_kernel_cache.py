"""Where compiled kernels are kept: without a home, in a cache that can only be read, without sources."""

from __future__ import annotations

import compileall
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

SOURCES = Path(__file__).resolve().parents[1] / "src"
NO_HOME = """
import os, pwd
for name in ("HOME", "XDG_CACHE_HOME", "SPIGOLO_CACHE_DIR", "NUMBA_CACHE_DIR"):
    os.environ.pop(name, None)
def nobody(uid):
    raise KeyError(uid)
pwd.getpwuid = nobody
from spigolo.kernels import _jit
print(_jit.CACHE_FOLDER, os.listdir("."))
"""
UNPACK = """
import numpy as np, sys, tempfile, warnings
def refuse(*_, **__):
    raise OSError(30, "Read-only file system")
if sys.argv[1] == "read":
    tempfile.TemporaryFile = refuse
warnings.simplefilter("error")
from spigolo.kernels.lzf import unpack_lzf
unpack_lzf(np.array([0, 7], np.uint8), np.zeros(1, np.uint8))
print(sum(unpack_lzf.stats.cache_hits.values()), sum(unpack_lzf.stats.cache_misses.values()))
"""
KEY = "from spigolo.kernels import _jit; print(_jit.module_key('lzf'), _jit.module_key('costs'))"


def run(code: str, *words: str, sources: Path = SOURCES, cwd: Path | None = None, **more: str) -> str:
    environment = {**os.environ, "PYTHONPATH": str(sources), **more}
    done = subprocess.run(
        [sys.executable, "-c", code, *words], env=environment, cwd=cwd, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_without_a_home_no_folder_named_tilde_is_made(tmp_path: Path) -> None:
    assert run(NO_HOME, cwd=tmp_path) == "None []"


def test_a_cache_that_can_only_be_read_is_read_without_a_word(tmp_path: Path) -> None:
    assert run(UNPACK, "write", SPIGOLO_CACHE_DIR=str(tmp_path)) == "0 1"
    assert run(UNPACK, "read", SPIGOLO_CACHE_DIR=str(tmp_path)) == "1 0"


@pytest.mark.parametrize("changed", ["lzf.py", "powers.py"])
def test_an_application_without_sources_never_runs_old_kernels(tmp_path: Path, changed: str) -> None:
    keys = []
    for version in ("old", "new"):
        package = tmp_path / version / "spigolo"
        shutil.copytree(SOURCES / "spigolo" / "kernels", package / "kernels")
        for name in ("__init__.py", "errors.py"):
            shutil.copy(SOURCES / "spigolo" / name, package / name)
        if version == "new":
            with (package / "kernels" / changed).open("a") as file:
                file.write("\nUPGRADED = 1\n")
        compileall.compile_dir(package, quiet=2, legacy=True)
        for source in package.rglob("*.py"):
            source.unlink()
        keys.append(run(KEY, sources=tmp_path / version).split())
    assert all(old != new for old, new in zip(*keys, strict=True))
