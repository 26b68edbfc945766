"""Check the links and the search index of the built documentation: `python scripts/check_site.py [SITE]`.

`make docs` runs this script after each build. The script prints all faults and returns exit code 1 if there are any.
"""

from __future__ import annotations

import argparse
import json
import re
from html.parser import HTMLParser
from pathlib import Path

SITE = Path(__file__).resolve().parents[1] / "site"
SEARCHED = {
    "depth scale": "cameras.html",
    "realsense": "cameras.html",
    "segmap": "outputs.html",
    "table returned as object": "wrong-results.html",
    "hand eye calibration": "outputs.html",
    "docker": "install.html",
    "resume": "command-line.html",
    "upside down": "wrong-results.html",
}
"""Search words, and the page that must have a section with all of these words."""
ELSEWHERE = re.compile(r"[a-z]+:|//|#__")


class Page(HTMLParser):
    """Links and anchors of one page."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collect the link targets and the anchors of an HTML tag."""
        for key, value in attrs:
            if value and key in ("id", "name"):
                self.anchors.add(value)
            elif value and key in ("href", "src"):
                self.links.append(value)


def main() -> None:
    parser = argparse.ArgumentParser(description="Check the built site for dead links, and its search index.")
    parser.add_argument("site", nargs="?", type=Path, default=SITE, help="default: site/")
    site = parser.parse_args().site.resolve()
    if not (site / "index.html").is_file():
        raise SystemExit(f"{site}: expected a built site, found no index.html: run make docs")
    faults = find_dead_links(site) + find_missed_words(site)
    print("\n".join(faults) or "no dead links, and the search index has all test words")
    raise SystemExit(bool(faults))


def find_dead_links(site: Path) -> list[str]:
    """Return one line of text for each link to a file or an anchor that does not exist."""
    pages = {path: Page(path) for path in site.rglob("*.html") if path.name != "404.html"}
    faults = []
    for path, page in pages.items():
        for link in page.links:
            file, _, anchor = link.partition("#")
            target = (path.parent / file).resolve() if file else path
            if ELSEWHERE.match(link):
                continue
            if not target.exists() or (anchor and target in pages and anchor not in pages[target].anchors):
                faults.append(f"{path.relative_to(site)}: dead link {link}")
    return faults


def find_missed_words(site: Path) -> list[str]:
    """Return one line of text for each entry of `SEARCHED` without a section that contains all search words."""
    sections = json.loads((site / "search.json").read_text(encoding="utf-8"))["items"]
    faults = []
    for words, page in SEARCHED.items():
        texts = [f"{s['title']} {s['text']}".lower() for s in sections if s["location"].startswith(page)]
        if not any(all(word in text for word in words.split()) for text in texts):
            faults.append(f"{page}: no section has the words {words!r}")
    return faults


if __name__ == "__main__":
    main()
