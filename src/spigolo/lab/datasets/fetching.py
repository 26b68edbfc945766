"""Download of published data sets.

If a download is interrupted, the next call of `fetch` continues it. Archives are verified by their SHA-256 hash.

The folder of a data set is created only after all archives have been downloaded and extracted.
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
"""Progress callback.

The arguments of the callback are the archive's name, the number of received bytes, and the total number of bytes. The
total number of bytes is None if the server does not report it.
"""

ATTEMPTS = 3
"""Maximum number of attempts to download a file. A new attempt starts if the connection breaks."""
BLOCK = 1 << 18
TIMEOUT_S = 60


def fetch(known: KnownSet, to: Path, tell: Tell | None = None) -> Path:
    """Download a data set into a new subfolder of `to`, and return the path of this subfolder.

    Raises FileError if the download fails. A partly downloaded archive is kept, and the next call continues the
    download. An archive with a wrong hash is deleted.
    """
    target = to / known.name
    if target.exists():
        raise FileError(f"expected no folder {target}, but the folder exists: remove it to fetch {known.name} again")
    if not known.archives:
        raise FileError(
            f"expected a data set with a known hash, got {known.name}: download the data set yourself"
            f" ({known.home}), then give its folder to `spigolo evaluate`"
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
    """Download an archive and verify its hash with pooch. Return the path of the file."""
    pooch, partial = _pooch(), to / f"{archive.file_name}.part"

    def download(url: str, out: str, _: Any) -> None:
        _resume(url, partial, functools.partial(tell, archive.file_name) if tell else None)
        shutil.move(partial, out)

    try:
        pooch.get_logger().setLevel("ERROR")
        known = f"sha256:{archive.sha256}"
        return Path(pooch.retrieve(archive.url, known, archive.file_name, to, downloader=download))
    except ValueError:  # raised by pooch for a wrong hash
        raise FileError(
            f"expected a file with SHA-256 {archive.sha256} from {archive.url}, got a different file, which was"
            " deleted: the file on the server may have changed"
        ) from None


def _resume(url: str, partial: Path, tell: Callable[[int, int | None], None] | None) -> None:
    """Download a file, or continue the partial download in `partial`. Raises FileError if the download fails."""
    for attempt in range(1, ATTEMPTS + 1):
        try:
            if _append(url, partial, tell):
                return
            reason: object = "the connection was cut"
        except urllib.error.HTTPError as error:
            if error.code == http.HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE and partial.exists():
                return  # complete
            raise FileError(f"expected {url}, but the server answered {error.code} {error.reason}") from None
        except (OSError, http.client.HTTPException) as error:
            reason = getattr(error, "reason", None) or error
        if attempt == ATTEMPTS:
            size = partial.stat().st_size if partial.exists() else 0
            raise FileError(
                f"the download of {url} stopped after {size} bytes: {reason}. Run the same command again to continue"
            )


def _append(url: str, partial: Path, tell: Callable[[int, int | None], None] | None) -> bool:
    """Request the missing bytes of a file, and append the received bytes. Return True if the file is complete."""
    start = partial.stat().st_size if partial.exists() else 0
    request = urllib.request.Request(url, headers={"Range": f"bytes={start}-"} if start else {})
    with urllib.request.urlopen(request, timeout=TIMEOUT_S) as answer:
        if answer.status != http.HTTPStatus.PARTIAL_CONTENT:
            start = 0  # the server does not support range requests
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
    """Extract all archives into a temporary folder, and move the extracted folder `name` to `to`/`name`."""
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
