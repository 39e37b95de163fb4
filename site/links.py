"""Whether all links within a built site are good, and all that its pages load is in it."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag

_LOADING = {
    ("script", "src"), ("img", "src"), ("iframe", "src"), ("source", "src"), ("video", "src"),
    ("audio", "src"), ("embed", "src"), ("object", "data"), ("link", "href"), ("img", "srcset"),
}  # fmt: skip
"""What a browser fetches as soon as it shows a page."""
_NOT_FETCHED = {"canonical", "next", "prev", "search", "index", "author", "license", "top", "up"}
_OUTSIDE = re.compile(r"^(?:[a-z][a-z+.-]*:)?//|^(?:https?|ftp):", re.IGNORECASE)
_IN_STYLE = re.compile(r"url\(\s*['\"]?((?:https?:)?//[^)'\"]+)|@import\s+['\"](https?:[^'\"]+)")


class _Page(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.loaded: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        self.anchors |= {given[name] for name in ("id", "name") if name in given}
        for name, value in given.items():
            if (tag, name) in _LOADING:
                if tag == "link" and set(given.get("rel", "").split()) & _NOT_FETCHED:
                    continue
                self.loaded.append(value)
            elif tag == "a" and name == "href":
                self.links.append(value)


def problems(folder: Path) -> list[str]:
    """Return what is wrong: links that lead nowhere, and what is loaded from outside.

    Anchors within the pages of the crates are left to rustdoc, which checks and partly makes them
    while the page is shown.
    """
    # What the theme brings there are templates of its own.
    pages = (path for path in sorted(folder.rglob("*.html")) if "_static" not in path.parts)
    parsed = {path: _parsed(path) for path in pages}
    found = []
    for path, page in parsed.items():
        inside = path.relative_to(folder)
        for address in page.loaded:
            if _OUTSIDE.match(address):
                found.append(f"{inside}: loads {address}")
        of_rust = inside.parts[0] == "rust"
        if of_rust:
            continue
        for address in [*page.links, *page.loaded]:
            if _OUTSIDE.match(address) or address.startswith(("mailto:", "data:", "javascript:")):
                continue
            place, anchor = urldefrag(unquote(address))
            target = (path.parent / place).resolve() if place else path
            target = target / "index.html" if target.is_dir() else target
            if not target.exists() and place.split("?")[0] != place:
                target = (path.parent / place.split("?")[0]).resolve()
            if not target.exists():
                found.append(f"{inside}: {address} leads nowhere")
            elif anchor and target in parsed and (folder / "rust") not in target.parents:
                if anchor in parsed[target].anchors:
                    continue
                found.append(f"{inside}: {address} has no such place")
    for path in sorted(folder.rglob("*.css")):
        for match in _IN_STYLE.finditer(path.read_text(encoding="utf-8", errors="replace")):
            found.append(f"{path.relative_to(folder)}: loads {match[1] or match[2]}")
    return found


def _parsed(path: Path) -> _Page:
    page = _Page()
    page.feed(path.read_text(encoding="utf-8"))
    return page
