"""Manifest of a run, with one line of JSON for each finished or failed frame."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from types import FrameType, TracebackType
from typing import Any, BinaryIO

from spigolo.errors import FileError, warn
from spigolo.frames.files import append_lines, write_bytes

FILE = "manifest.jsonl"
LOCK = ".lock"


@dataclass(frozen=True, slots=True)
class Entry:
    """Line of the manifest, which records the outcome of one frame."""

    frame: str
    """Name of the frame."""
    stamp: str
    """Short text from `Job.stamp` that describes the state of the input files. If the text is the same as in an earlier
    run, the hash of the input files is not computed again.
    """
    inputs: str
    """Hash of the content of the input files, from `Job.fingerprint`."""
    digest: str
    """Digest of the preset (`Config.digest`), a hash of all parameter values."""
    version: str
    """Version of spigolo that processed the frame."""
    objects: int
    """Number of objects in the frame."""
    files: Mapping[str, int]
    """Size in bytes of each output file of the frame, indexed by the name of the output folder, such as `labels`."""
    warnings: tuple[str, ...]
    """Warnings about the frame."""
    error: str | None
    """Reason of the failure, or None if the frame did not fail."""


NAMES = tuple(f.name for f in fields(Entry))


class Manifest:
    """File that records the outcome of each frame in an output folder. Only one run at a time can open the manifest. If
    the manifest has several lines for the same frame, only the last of these lines is valid.

    Raises FileError if another run uses the folder.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self.path = root / FILE
        self.entries: dict[str, Entry] = {}
        self._lock: BinaryIO | None = None
        self._file: BinaryIO | None = None

    def __enter__(self) -> Manifest:
        self._lock = _locked(self.root)
        try:
            append_lines(self.path).close()  # removes an incomplete last line
            self._file = self.path.open("ab", buffering=0)
            self._read()
        except BaseException:
            self.__exit__(None, None, None)
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for file in (self._file, self._lock):
            if file is not None:
                file.close()
        self._file = self._lock = None

    def append(self, entry: Entry) -> None:
        """Append a line with the outcome of a frame to the manifest file, without buffering. Raises FileError if the
        line cannot be written, for example because the disk is full.
        """
        assert self._file is not None
        line = _line(entry)
        try:
            written = self._file.write(line)
        except OSError as error:
            raise FileError(f"could not write {self.path}: {error.strerror or error}") from None
        if written != len(line):
            raise FileError(f"could not write {self.path}: no space left on the device")
        self.entries[entry.frame] = entry

    def sort(self, names: Iterable[str]) -> None:
        """Rewrite the manifest with one line per frame. The frames in `names` come first, in the order of `names`. All
        other frames follow, sorted by name.
        """
        first = dict.fromkeys(name for name in names if name in self.entries)
        order = [*first, *sorted(self.entries.keys() - first.keys())]
        if self._file is not None:
            self._file.close()
            self._file = None
        write_bytes(self.path, b"".join(_line(self.entries[name]) for name in order))

    def _read(self) -> None:
        damaged = 0
        with self.path.open("rb") as file:
            for line in file:
                entry = _entry(line)
                if entry is None:
                    damaged += 1
                else:
                    self.entries[entry.frame] = entry
        if damaged:
            warn(f"{self.path}: {damaged} damaged lines are skipped. Their frames are computed again")


def _line(entry: Entry) -> bytes:
    return (json.dumps(asdict(entry)) + "\n").encode()


def _entry(line: bytes) -> Entry | None:
    """Parse a line of the manifest. Return None if the line is damaged."""
    try:
        values: Any = json.loads(line)
        values["warnings"] = tuple(values["warnings"])
        texts = [values[name] for name in ("frame", "stamp", "inputs", "digest", "version")]
        whole = all(isinstance(text, str) for text in texts) and isinstance(values["files"], dict)
        return Entry(**{name: values[name] for name in NAMES}) if whole else None
    except (ValueError, TypeError, KeyError, RecursionError):
        return None


def _locked(root: Path) -> BinaryIO:
    """Lock a folder and return the open lock file. The operating system releases the lock when the process ends."""
    try:
        root.mkdir(parents=True, exist_ok=True)
        file = (root / LOCK).open("ab")
    except OSError as error:
        blocked = next((p for p in (root, *root.parents) if p.is_file()), None)
        reason = f"{blocked} is a file, not a folder" if blocked else error.strerror or error
        raise FileError(f"could not write {root}: {reason}") from None
    try:
        _lock(file.fileno())
    except OSError:
        file.close()
        if _in_worker():
            raise FileError(
                f"another run writes to {root}: in a script, call run_batch inside the block if __name__ =="
                ' "__main__":, because each worker imports the script'
            ) from None
        raise FileError(f"another run writes to {root}: wait until that run ends, or give another --out") from None
    return file


def _in_worker() -> bool:
    """Return True if this process is a worker that runs the user's script a second time. A script without `if __name__
    == "__main__"` is run a second time by each worker.
    """
    frame: FrameType | None = sys._getframe()
    while frame is not None and frame.f_globals.get("__name__") != "__mp_main__":
        frame = frame.f_back
    return frame is not None


def _lock(handle: int) -> None:
    if sys.platform == "win32":
        import msvcrt

        os.lseek(handle, 0, os.SEEK_SET)
        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
