"""Files that are made to fill the memory or to run code."""

from __future__ import annotations

import ast
import pickle
import struct
import subprocess
import sys
import tracemalloc
import zipfile
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest

import spigolo as sp
from spigolo.errors import FileError, FrameError, SpigoloError
from spigolo.frames import arrays
from spigolo.frames.camera_files import read_camera
from spigolo.frames.images import read_color, read_depth, read_labels, read_mask
from spigolo.frames.yaml_text import parse_yaml
from spigolo.lab.datasets.rutgers import read_pose

SOURCES = sorted(Path(sp.__file__).parent.rglob("*.py"))

LAUGHS = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{name}: &{name} [{', '.join([f'*{inner}'] * 9)}]\n" for inner, name in zip("abcdefghi", "bcdefghij", strict=True)
)
MERGES = "a: &a {k: 1}\n" + "".join(
    f"a{k}: &a{k}\n  <<: [{', '.join(['*a' + (str(k - 1) if k else '')] * 9)}]\n" for k in range(9)
)
BOMBS = {"laughs": LAUGHS, "merges": MERGES, "circle": "&a [*a]", "circle in a mapping": "fx: &a {k: *a}"}


@pytest.mark.parametrize("name", BOMBS)
def test_aliases_that_grow_are_refused_by_every_reader(tmp_path: Path, name: str) -> None:
    path = tmp_path / "camera.yaml"
    path.write_text(BOMBS[name], encoding="utf-8")
    tracemalloc.start()
    with pytest.raises(ValueError, match="aliases repeat"):
        parse_yaml(BOMBS[name])
    with pytest.raises(FileError, match="aliases repeat more than 10000 values"):
        read_camera(path)
    with pytest.raises(FileError):
        read_pose(path)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 5_000_000


def test_harmless_aliases_are_read() -> None:
    assert parse_yaml("a: &x [1, 2]\nb: *x\nc: {<<: &m {k: 1}, l: 2}\nd: *m\n") == {
        "a": [1, 2],
        "b": [1, 2],
        "c": {"k": 1, "l": 2},
        "d": {"k": 1},
    }


@pytest.mark.parametrize("text", ["!!python/object/apply:os.system ['true']", "!!python/name:os.system", "[" * 9000])
def test_tags_of_python_and_deep_nests_end_in_a_message(tmp_path: Path, text: str) -> None:
    path = tmp_path / "camera.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(FileError, match="the file cannot be read"):
        read_camera(path)


@pytest.mark.parametrize("tree", SOURCES, ids=lambda path: path.stem)
def test_no_module_loads_pickles_or_unsafe_yaml(tree: Path) -> None:
    for node in ast.walk(ast.parse(tree.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = {alias.name for alias in node.names} | {getattr(node, "module", None)}
            assert not names & {"pickle", "cPickle", "dill", "joblib", "shelve", "marshal"}
        if isinstance(node, ast.keyword) and node.arg == "allow_pickle":
            assert isinstance(node.value, ast.Constant)
            assert node.value.value is False
        if isinstance(node, ast.Attribute) and tree.stem != "yaml_text":
            assert node.attr not in ("unsafe_load", "full_load", "FullLoader", "UnsafeLoader", "SafeLoader")


@pytest.mark.parametrize("suffix", [".npy", ".npz"])
def test_pickled_arrays_are_never_loaded(tmp_path: Path, suffix: str) -> None:
    mark, path = tmp_path / "ran", tmp_path / f"depth{suffix}"

    class Evil:
        def __reduce__(self) -> tuple[object, tuple[str]]:
            return Path.touch, (mark,)

    evil = np.array([Evil()], object)
    (np.save if suffix == ".npy" else np.savez)(path, evil, allow_pickle=True)
    raw = tmp_path / f"raw{suffix}"
    raw.write_bytes(pickle.dumps(Evil()))
    for file in (path, raw):
        with pytest.raises(SpigoloError):
            read_depth(file)
    assert not mark.exists()


def png_of(width: int, height: int, bits: int = 16, kind: int = 0) -> bytes:
    """A PNG of zeros: a thousandth of its pixels' size."""

    def chunk(name: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))

    header = struct.pack(">IIBBBBB", width, height, bits, kind, 0, 0, 0)
    rows = zlib.compress(bytes((1 + width * bits // 8) * min(height, 2000)), 9)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")


@pytest.mark.parametrize("read", [read_color, read_depth, read_labels, read_mask])
def test_a_png_of_too_many_pixels_is_not_decoded(tmp_path: Path, read: object, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "bomb.png"
    path.write_bytes(png_of(30_000, 30_000))
    assert path.stat().st_size < 200_000
    monkeypatch.setattr(cv2, "imdecode", lambda *_: pytest.fail("it was decoded"))
    with pytest.raises(FrameError, match="expected at most 16000000 pixels, got 30000x30000"):
        read(path)  # type: ignore[operator]


MEASURED = """
import resource, sys
from spigolo.frames.images import read_color
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
assert read_color(sys.argv[1]).shape == (8, 8, 3)
print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) // (1 if sys.platform == "linux" else 1024))
"""
HEADS = {b"zTXt": b"k\0\0", b"iTXt": b"k\0\1\0\0\0", b"iCCP": b"k\0\0"}


@pytest.mark.skipif(sys.platform == "win32", reason="needs the resource module")
@pytest.mark.parametrize("kind", HEADS)
def test_a_png_text_or_profile_that_unpacks_to_much_is_not_unpacked(tmp_path: Path, kind: bytes) -> None:
    packer = zlib.compressobj(9)
    body = HEADS[kind] + b"".join(packer.compress(bytes(2**20)) for _ in range(256)) + packer.flush()
    _, encoded = cv2.imencode(".png", np.zeros((8, 8, 3), np.uint8))
    plain, after_header = encoded.tobytes(), 33
    bomb = struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    path = tmp_path / "bomb.png"
    path.write_bytes(plain[:after_header] + bomb + plain[after_header:])
    done = subprocess.run([sys.executable, "-c", MEASURED, str(path)], capture_output=True, text=True, check=True)
    assert int(done.stdout) < 64 * 1024  # KiB; unpacked it has 256 MiB


def test_a_larger_limit_is_passed_on(tmp_path: Path) -> None:
    path = tmp_path / "wide.png"
    path.write_bytes(png_of(9000, 2000))
    with pytest.raises(FrameError, match="got 9000x2000"):
        read_depth(path)
    assert read_depth(path, 18_000_000).shape == (2000, 9000)


def test_an_array_file_that_unpacks_to_gigabytes_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "depth.npz"
    np.savez_compressed(path, depth=np.zeros((2000, 2000), np.float32))
    with zipfile.ZipFile(path) as file:
        assert file.infolist()[0].file_size > 100 * path.stat().st_size
    assert read_depth(path).shape == (2000, 2000)
    monkeypatch.setattr(arrays, "MAX_UNPACKED", 1_000_000)
    with pytest.raises(FileError, match="maximum 1000000"):
        read_depth(path)


@pytest.mark.parametrize("file", ["../x.png", "rgb/../../x.png", "/etc/x.png", "C:/x.png", "..\\x.png"])
def test_a_list_of_images_cannot_lead_out_of_its_folder(tmp_path: Path, file: str) -> None:
    from spigolo.lab.datasets.tum import Tum

    (tmp_path / "rgb.txt").write_text(f"# time file\n1.0 {file}\n")
    (tmp_path / "depth.txt").write_text("1.0 depth/1.png\n")
    with pytest.raises(FileError, match="line 2"):
        list(Tum(tmp_path))


def test_a_list_of_images_may_go_up_and_down_inside_its_folder(tmp_path: Path) -> None:
    from spigolo.lab.datasets.tum import Tum

    for folder in ("rgb", "other", "depth"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "1.png").touch()
    (tmp_path / "rgb.txt").write_text("1.0 rgb/../other/1.png\n")
    (tmp_path / "depth.txt").write_text("1.0 depth/1.png\n")
    assert len(Tum(tmp_path)) == 1
