"""Interface to the Numba compiler. The decorator `kernel` compiles a function on its first call and caches the compiled
code.

Each kernel module has its own cache folder, because Numba does not notice changes of called functions. The folder name
contains a hash of the module's source and of all kernel modules that the module imports.
"""

from __future__ import annotations

import ast
import contextlib
import functools
import hashlib
import importlib.util
import logging
import os
import pkgutil
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, cast

import numba
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.caching import FunctionCache, _CacheLocator
from numba.extending import intrinsic

PACKAGE = __name__.rpartition(".")[0]
VERSION = str(sys.modules[__name__.partition(".")[0]].__version__)
ADVICE = "set SPIGOLO_CACHE_DIR to a writable folder"


def _cache_folder() -> Path | None:
    """Return the folder of the compiled kernels, or None if the folder cannot be created."""
    own = os.environ.get("SPIGOLO_CACHE_DIR") or os.environ.get("NUMBA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME")
    home = os.path.expanduser("~")
    if own is None and home == "~":  # the user has no home folder, so that "~" was not replaced
        return None
    folder = Path(own or os.path.join(home, ".cache")) / "spigolo" / "kernels"
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
    return folder if folder.is_dir() else None


def _can_write(folder: Path | None) -> bool:
    try:
        with tempfile.TemporaryFile(dir=folder):
            return folder is not None
    except OSError:
        return False


CACHE_FOLDER = _cache_folder()
CAN_WRITE = _can_write(CACHE_FOLDER)


@functools.cache
def module_key(name: str) -> str:
    """Return a hash of a kernel module, of the kernel modules that it imports, and of the versions of Numba and
    spigolo.
    """
    digest = hashlib.sha256(f"{numba.__version__} {VERSION}".encode())
    content, imported = _content(name)
    digest.update(content)
    for other in sorted(imported):
        digest.update(module_key(other).encode())
    return digest.hexdigest()[:16]


def _content(name: str) -> tuple[bytes, Iterable[str]]:
    """Return the source code of a kernel module, and the names of the kernel modules that it imports.

    In an application without source files, the bytecode of all kernel modules is returned instead of the source code.
    """
    spec = importlib.util.find_spec(f"{PACKAGE}.{name}")
    try:
        content = Path(spec.origin).read_bytes() if spec is not None and spec.origin is not None else b""
    except OSError:  # the module is inside an archive, so that only the versions enter the hash
        return b"", ()
    if spec is not None and str(spec.origin).endswith(".py"):
        nodes = (node for node in ast.walk(ast.parse(content)) if isinstance(node, ast.ImportFrom))
        modules = (str(node.module) for node in nodes)
        return content, {m.removeprefix(f"{PACKAGE}.") for m in modules if m.startswith(f"{PACKAGE}.")}
    folder = os.path.dirname(str(spec.origin)) if spec is not None else ""
    others = sorted(m.name for m in pkgutil.iter_modules([folder]))
    pieces = (importlib.util.find_spec(f"{PACKAGE}.{m}") for m in others)
    return b"".join(Path(str(piece.origin)).read_bytes() for piece in pieces if piece is not None), ()


class _Locator(_CacheLocator):
    """Locator that gives Numba the cache folder of a kernel module. The folder name contains `module_key`."""

    def __init__(self, py_func: Callable[..., Any], py_file: str) -> None:
        self._line = py_func.__code__.co_firstlineno
        module = py_func.__module__.rpartition(".")[2]
        self._key = module_key(module)
        self._path = str(CACHE_FOLDER) if CACHE_FOLDER is None else str(CACHE_FOLDER / f"{module}-{self._key}")

    def get_cache_path(self) -> str:
        return self._path

    def get_source_stamp(self) -> str:
        return self._key

    def get_disambiguator(self) -> str:
        return str(self._line)

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> _Locator:
        return cls(py_func, py_file)


class _CacheImpl(FunctionCache._impl_class):
    _locator_classes = (_Locator,)


class _Cache(FunctionCache):
    _impl_class = _CacheImpl

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        found = super().load_overload(sig, target_context)
        if found is None and CAN_WRITE:
            _announce()
        return found

    def save_overload(self, sig: Any, data: Any) -> None:
        if CAN_WRITE:
            super().save_overload(sig, data)
        else:
            _warn()


@functools.cache
def _announce() -> None:
    """Log a message, once per process, that kernels are being compiled."""
    logging.getLogger("spigolo").warning("compiling kernels for this machine: this takes up to a minute")


@functools.cache
def _warn() -> None:
    """Warn, once per process, that compiled kernels cannot be cached."""
    where = f" in {CACHE_FOLDER}" if CACHE_FOLDER is not None else ""
    warnings.warn(
        f"compiled kernels cannot be stored{where}, so each process compiles them again: {ADVICE}", stacklevel=2
    )


if CACHE_FOLDER is None:
    _warn()


def kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile the decorated function on its first call. The compiled code releases Python's global interpreter lock."""
    compiled = numba.njit(nogil=True, error_model="numpy")(function)
    if CACHE_FOLDER is not None and not numba.config.DISABLE_JIT:
        compiled._cache = _Cache(function)
    return cast(Callable[..., Any], compiled)


def inlined(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile the decorated function inline into each kernel that calls the function."""
    return cast(Callable[..., Any], numba.njit(nogil=True, error_model="numpy", inline="always")(function))


@intrinsic
def prefetch(typing_context, array, index):
    """Load array[index] into the processor's cache, before the element is read."""

    def generate(context, builder, signature, arguments):
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        byte, word = ir.IntType(8).as_pointer(), ir.IntType(32)
        kind = ir.FunctionType(ir.VoidType(), [byte, word, word, word])
        function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")
        address = builder.bitcast(builder.gep(data, [arguments[1]]), byte)
        to_read, keep_close, data_cache = word(0), word(3), word(1)
        builder.call(function, [address, to_read, keep_close, data_cache])
        return context.get_dummy_value()

    return types.void(array, index), generate
