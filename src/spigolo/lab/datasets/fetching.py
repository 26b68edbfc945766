"""Download of data sets. An interrupted download continues, and each archive is verified by its hash and unpacked.

The folder of the data set is created when the data set is complete.
"""

from __future__ import annotations

import functools
import http.client
import importlib
import shutil
import urllib.error
import urllib.request
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from spigolo.errors import FileError
from spigolo.lab.datasets.catalogue import Archive, KnownSet

Tell = Callable[[str, int, int | None], None]
"""Function called with the archive's name, the bytes received, and the total bytes if the server reports them."""

ATTEMPTS = 3
"""Maximum number of attempts to continue a download after its connection is cut. The received part is kept."""
BLOCK = 1 << 18
TIMEOUT_S = 60


def fetch(known: KnownSet, to: Path, tell: Tell | None = None) -> Path:
    """Fetch a data set into the folder `to`, and return its folder.

    Raises FileError if it cannot be fetched. The received part of an archive is kept for the next attempt, except an
    archive with a wrong hash.
    """
    target = to / known.name
    if target.exists():
        raise FileError(f"expected no {target} yet, but it is there: remove it to fetch {known.name} again")
    if not known.archives:
        raise FileError(
            f"expected a set whose files have a known hash, got {known.name}: fetch it yourself from where it is"
            f" published ({known.home}), then give its folder to `spigolo evaluate`"
        )
    _pooch()
    try:
        to.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"expected a folder to fetch into, got {to}: {error.strerror or error}") from None
    archives = [(archive, _download(archive, to, tell)) for archive in known.archives]
    _unpack(archives, to, known.name)
    for _, path in archives:
        path.unlink()
    return target


def _download(archive: Archive, to: Path, tell: Tell | None) -> Path:
    """Return the complete and verified archive. Pooch handles its hash and its name."""
    pooch, partial = _pooch(), to / f"{archive.file_name}.part"

    def download(url: str, out: str, _: Any) -> None:
        _resume(url, partial, functools.partial(tell, archive.file_name) if tell else None)
        shutil.move(partial, out)

    try:
        pooch.get_logger().setLevel("ERROR")
        known = f"sha256:{archive.sha256}"
        return Path(pooch.retrieve(archive.url, known, archive.file_name, to, downloader=download))
    except ValueError:  # pooch raises this for a wrong hash
        raise FileError(
            f"expected a file with SHA-256 {archive.sha256} from {archive.url}, got another one: nothing of it is kept;"
            " it may have been changed there"
        ) from None


def _resume(url: str, partial: Path, tell: Callable[[int, int | None], None] | None) -> None:
    """Continue the download of `partial` from its end. Raises FileError."""
    for attempt in range(1, ATTEMPTS + 1):
        try:
            if _append(url, partial, tell):
                return
            reason: object = "the connection was cut"
        except urllib.error.HTTPError as error:
            if error.code == http.HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE and partial.exists():
                return  # complete
            raise FileError(f"expected {url}, but the server answers {error.code} {error.reason}") from None
        except (OSError, http.client.HTTPException) as error:
            reason = getattr(error, "reason", None) or error
        if attempt == ATTEMPTS:
            size = partial.stat().st_size if partial.exists() else 0
            raise FileError(
                f"expected {url}, but after {size} bytes: {reason}. Run the same again: it goes on from there"
            )


def _append(url: str, partial: Path, tell: Callable[[int, int | None], None] | None) -> bool:
    """Request the remaining bytes. Return True if all arrived."""
    start = partial.stat().st_size if partial.exists() else 0
    request = urllib.request.Request(url, headers={"Range": f"bytes={start}-"} if start else {})
    with urllib.request.urlopen(request, timeout=TIMEOUT_S) as answer:
        if answer.status != http.HTTPStatus.PARTIAL_CONTENT:
            start = 0  # servers without range requests start again
        length = answer.headers.get("Content-Length")
        total = None if length is None else start + int(length)
        done = start
        with partial.open("ab" if start else "wb") as file:
            while block := answer.read(BLOCK):
                file.write(block)
                done += len(block)
                if tell is not None:
                    tell(done, total)
    return total is None or done == total


def _unpack(archives: list[tuple[Archive, Path]], to: Path, name: str) -> None:
    """Unpack next to the final folder, and rename at the end."""
    beside = to / f".{name}-unpacking"
    shutil.rmtree(beside, ignore_errors=True)
    try:
        for archive, path in archives:
            with zipfile.ZipFile(path) as file:
                file.extractall(beside / archive.into)
        if not (beside / name).is_dir():
            raise FileError(f"expected a folder {name} in {archives[0][1].name}, got none")
        (beside / name).rename(to / name)
    except (OSError, zipfile.BadZipFile) as error:
        if isinstance(error, FileError):
            raise
        raise FileError(f"could not unpack {name} in {to}: {error}") from None
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def _pooch() -> Any:
    try:
        return importlib.import_module("pooch")
    except ImportError:
        raise FileError('expected pooch to fetch data, but it is missing: pip install "spigolo[datasets]"') from None
