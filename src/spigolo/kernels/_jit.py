"""The one place that knows the compiler: `kernel` compiles on first call and keeps the result on disk.

The cache folder carries a hash of all kernels' source, since numba does not notice that a called function changed.
Where nothing can be written the kernels are compiled in each process.
"""

from __future__ import annotations

import functools
import hashlib
import logging
import os
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numba
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.caching import FunctionCache, _CacheLocator
from numba.extending import intrinsic


def _source_hash() -> str:
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _cache_folder() -> Path | None:
    """A folder that the user can write, or None."""
    own = os.environ.get("SPIGOLO_CACHE_DIR") or os.environ.get("NUMBA_CACHE_DIR")
    base = own or os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    folder = Path(base) / "spigolo" / f"kernels-{SOURCE_HASH}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError:
        pass
    warnings.warn(
        f"spigolo cannot keep its compiled kernels in {folder} and compiles them in each process;"
        " set SPIGOLO_CACHE_DIR to one that can be written",
        stacklevel=2,
    )
    return None


SOURCE_HASH = _source_hash()
CACHE_FOLDER = _cache_folder()


class _Locator(_CacheLocator):
    """Tells numba where the files go and that the hash stands for all of the source."""

    def __init__(self, py_func: Callable[..., Any], py_file: str) -> None:
        self._line = py_func.__code__.co_firstlineno

    def get_cache_path(self) -> str:
        return str(CACHE_FOLDER)

    def get_source_stamp(self) -> str:
        return SOURCE_HASH

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
        if found is None:
            _announce()
        return found


@functools.cache
def _announce() -> None:
    """Says once in a process that this is the first run on a machine."""
    if CACHE_FOLDER is not None and not any(CACHE_FOLDER.iterdir()):
        logging.getLogger("spigolo").warning("compiling the kernels, once on this machine: about 20 s")


def kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compiles `function` on first call, without the GIL and without threads of its own."""
    compiled = numba.njit(nogil=True, error_model="numpy")(function)
    if CACHE_FOLDER is not None and not numba.config.DISABLE_JIT:
        compiled._cache = _Cache(function)
    return cast(Callable[..., Any], compiled)


def inlined(function: Callable[..., Any]) -> Callable[..., Any]:
    """A formula that is compiled into its callers; the equations of the paper stand in these."""
    return cast(Callable[..., Any], numba.njit(nogil=True, error_model="numpy", inline="always")(function))


@intrinsic
def prefetch(typing_context, array, index):
    """Asks for the memory of array[index] ahead of its use; changes nothing else."""

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
