"""Fetching from a server that cuts connections, lies about files, or knows no ranges: nothing half-written is left."""

from __future__ import annotations

import hashlib
import io
import subprocess
import sys
import threading
import zipfile
from collections.abc import Iterator
from dataclasses import replace
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import numpy as np
import pytest

from spigolo.errors import ConfigError, FileError
from spigolo.lab.datasets.catalogue import KNOWN_SETS, Archive, KnownSet, known_set
from spigolo.lab.datasets.fetching import ATTEMPTS, fetch


def zipped(files: dict[str, bytes]) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as file:
        for name, data in files.items():
            file.writestr(name, data)
    return out.getvalue()


NOISE = np.random.default_rng(0).bytes(300_000)
FILES = {
    "toy_base.zip": zipped({"toy/camera.json": b"{}"}),
    "toy_test.zip": zipped({"test/000001/rgb/000000.png": NOISE}),
    "text.zip": b"no archive",
}


class Server(ThreadingHTTPServer):
    """Serves FILES. cut_after: bytes after which each of the next `cuts` connections ends."""

    daemon_threads = True
    cuts, cut_after, ranges = 0, 100_000, True

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Handler)
        self.asked: list[tuple[str, str | None]] = []

    def archive(self, name: str, into: str) -> Archive:
        url = f"http://127.0.0.1:{self.server_port}/{name}"
        return Archive(url, hashlib.sha256(FILES[name]).hexdigest(), into)

    @property
    def toy(self) -> KnownSet:
        archives = self.archive("toy_base.zip", ""), self.archive("toy_test.zip", "toy")
        return KnownSet("toy", "a toy", "none", "one frame", "nowhere", archives)


class Handler(BaseHTTPRequestHandler):
    server: Server

    def do_GET(self) -> None:
        name, asked = self.path.strip("/"), self.headers.get("Range")
        self.server.asked.append((name, asked))
        if name not in FILES:
            self.send_error(404)
            return
        start = int(asked.removeprefix("bytes=").rstrip("-")) if asked and self.server.ranges else 0
        data = FILES[name][start:]
        if not data:
            self.send_error(416)
            return
        self.send_response(206 if start else 200)
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        if self.server.cuts and len(data) > self.server.cut_after:
            self.server.cuts -= 1
            data = data[: self.server.cut_after]
        self.wfile.write(data)

    def log_message(self, *_: object) -> None:
        """Silent."""


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> Iterator[Server]:
    for name in ("NO_PROXY", "no_proxy"):
        monkeypatch.setenv(name, "127.0.0.1")
    with Server() as running:
        thread = threading.Thread(target=running.serve_forever, args=(0.01,))
        thread.start()
        yield running
        running.shutdown()
        thread.join()


def left(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_set_is_there_when_all_of_it_is(server: Server, tmp_path: Path) -> None:
    told: list[tuple[str, int, int | None]] = []
    folder = fetch(server.toy, tmp_path / "data", lambda *words: told.append(words))
    assert folder == tmp_path / "data" / "toy"
    assert (folder / "test" / "000001" / "rgb" / "000000.png").read_bytes() == NOISE
    assert left(tmp_path / "data") == ["toy"] and left(folder) == ["camera.json", "test"]
    for name, data in list(FILES.items())[:2]:
        steps = [(done, total) for file, done, total in told if file == name]
        assert steps == sorted(steps) and steps[-1] == (len(data), len(data))
    with pytest.raises(FileError, match=r"expected no .*toy, but the folder exists"):
        fetch(server.toy, tmp_path / "data")


def test_a_connection_that_is_cut_is_taken_up_where_it_ended(server: Server, tmp_path: Path) -> None:
    server.cuts = ATTEMPTS - 1
    folder = fetch(server.toy, tmp_path)
    assert (folder / "test" / "000001" / "rgb" / "000000.png").read_bytes() == NOISE
    ranges = [asked for name, asked in server.asked if name == "toy_test.zip"]
    assert ranges == [None, "bytes=100000-", "bytes=200000-"]


def test_what_has_come_is_kept_and_the_next_run_goes_on(server: Server, tmp_path: Path) -> None:
    server.cuts, server.cut_after = ATTEMPTS, 50_000
    with pytest.raises(FileError, match=r"after 150000 bytes: .*Run the same command again"):
        fetch(server.toy, tmp_path)
    assert left(tmp_path) == ["toy_base.zip", "toy_test.zip.part"]
    server.asked.clear()
    assert left(fetch(server.toy, tmp_path)) == ["camera.json", "test"]
    assert server.asked == [("toy_test.zip", "bytes=150000-")]
    assert left(tmp_path) == ["toy"]


def test_a_server_without_ranges_begins_anew(server: Server, tmp_path: Path) -> None:
    server.cuts, server.ranges = 1, False
    folder = fetch(server.toy, tmp_path)
    assert (folder / "test" / "000001" / "rgb" / "000000.png").read_bytes() == NOISE


def test_a_download_that_was_whole_but_not_yet_named_is_taken(server: Server, tmp_path: Path) -> None:
    (tmp_path / "toy_test.zip.part").write_bytes(FILES["toy_test.zip"])
    assert left(fetch(server.toy, tmp_path)) == ["camera.json", "test"]


def test_nothing_of_a_file_with_a_wrong_hash_is_kept(server: Server, tmp_path: Path) -> None:
    base, test = server.toy.archives
    wrong = replace(server.toy, archives=(base, replace(test, sha256="0" * 64)))
    with pytest.raises(
        FileError, match=r"expected a file with SHA-256 0{64} from http.*toy_test.zip, got a different file"
    ):
        fetch(wrong, tmp_path)
    assert left(tmp_path) == ["toy_base.zip"]


def test_a_missing_file_on_the_server_or_a_wrong_archive_is_reported(server: Server, tmp_path: Path) -> None:
    base, test = server.toy.archives
    lost = replace(server.toy, archives=(base, replace(test, url=test.url.replace("toy_test", "other"))))
    with pytest.raises(FileError, match=r"expected http.*other.zip, but the server answered 404"):
        fetch(lost, tmp_path / "a")
    with pytest.raises(FileError, match=r"expected a folder toy in toy_test.zip, got none"):
        fetch(replace(server.toy, archives=(replace(test, into=""),)), tmp_path / "b")
    with pytest.raises(FileError, match="could not unpack toy in"):
        fetch(replace(server.toy, archives=(base, server.archive("text.zip", "toy"))), tmp_path / "c")
    assert not any((tmp_path / folder / "toy").exists() for folder in "abc")
    assert not any(path.name.startswith(".") for folder in "abc" for path in (tmp_path / folder).iterdir())


def test_a_server_that_is_gone_is_reported(server: Server, tmp_path: Path) -> None:
    toy = server.toy
    nowhere = replace(toy, archives=(replace(toy.archives[0], url="http://127.0.0.1:1/toy_base.zip"),))
    with pytest.raises(FileError, match=r"the download of http://127.0.0.1:1/toy_base.zip stopped after 0 bytes: "):
        fetch(nowhere, tmp_path)
    assert left(tmp_path) == []
    (tmp_path / "file").write_text("")
    with pytest.raises(FileError, match=r"expected a folder to fetch into, got .*file"):
        fetch(toy, tmp_path / "file")


def test_the_catalogue_knows_hashes_or_says_where_a_set_is(tmp_path: Path) -> None:
    assert len({known.name for known in KNOWN_SETS}) == len(KNOWN_SETS)
    assert [known.name for known in KNOWN_SETS if known.archives] == ["ruapc"]
    assert all(len(archive.sha256) == 64 for known in KNOWN_SETS for archive in known.archives)
    with pytest.raises(FileError, match=r"download the data set yourself \(rgbd-dataset"):
        fetch(known_set("UW_scenes_v1"), tmp_path)
    assert left(tmp_path) == []
    with pytest.raises(ConfigError, match=r"expected one of rutgers-apc, .*, got 'uw'"):
        known_set("uw")


def test_the_command_line_lists_and_refuses(tmp_path: Path) -> None:
    def spigolo(*words: object) -> subprocess.CompletedProcess[str]:
        code = "from spigolo.cli import main; main()"
        command = [sys.executable, "-c", code, *map(str, words)]
        return subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)

    listed = spigolo("datasets")
    assert listed.returncode == 0, listed.stderr
    assert all(known.name in listed.stdout and known.home in listed.stdout for known in KNOWN_SETS)
    refused = spigolo("fetch", "tejani", "--to", tmp_path)
    assert refused.returncode == 2
    assert refused.stderr.startswith("spigolo: expected a data set with a known hash, got tejani")
    assert refused.stderr.count("\n") == 1
