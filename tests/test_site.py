"""The search box of the built site, typed into in a real browser."""

from __future__ import annotations

import functools
import http.server
import os
import shutil
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from browser import chromium, in_browser

if TYPE_CHECKING:
    from playwright.sync_api import Browser

ROOT = Path(__file__).resolve().parents[1]
BUILDER = Path(sys.executable).with_name("zensical")
pytestmark = [
    in_browser,
    pytest.mark.alone,
    pytest.mark.skipif(not (BUILDER.exists() or os.environ.get("CI")), reason="needs the group docs of pyproject.toml"),
]
FOUND = {
    "depth scale": "cameras.html#depth-scale",
    "RealSense": "cameras.html#realsense",
    "segmap": "outputs.html#segmap-masks-clouds-boxes",
    "table returned as object": "wrong-results.html#the-table-is-returned-as-an-object",
}
"""Words that people type, and a section that must be among the first three links."""


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Print nothing."""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    folder = tmp_path_factory.mktemp("site")
    shutil.copy(ROOT / "mkdocs.yml", folder)
    for name in ("docs", "src"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    subprocess.run([BUILDER, "build", "--clean"], cwd=folder, capture_output=True, check=True, timeout=300)
    handler = functools.partial(Quiet, directory=str(folder / "site"))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_address[1]}/"
        server.shutdown()


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with chromium() as started:
        yield started


@pytest.mark.parametrize("words", FOUND)
def test_the_search_box_finds_the_section_among_the_first(site: str, browser: Browser, words: str) -> None:
    page = browser.new_page()
    page.goto(f"{site}index.html")
    page.wait_for_timeout(800)
    page.keyboard.press("/")  # opens the box
    page.wait_for_timeout(500)
    page.keyboard.type(words, delay=20)
    page.wait_for_function(LINKS + "().length > 0", timeout=20_000)
    page.wait_for_timeout(1000)
    first = [link.removeprefix(site) for link in page.evaluate(LINKS)[:3]]
    page.close()
    assert FOUND[words] in first


LINKS = """(() => {
    const found = []
    const walk = root => root.querySelectorAll("*").forEach(one => {
        if (root != document && one.matches("a[href]")) found.push(one.href)
        if (one.shadowRoot) walk(one.shadowRoot)
    })
    walk(document)
    return found
})"""
