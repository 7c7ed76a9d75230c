"""Check a built site: every link leads to a file and an anchor, and no page loads anything from the network.

    python docs/check_links.py site

External links are not opened. The exit code is 1 if something is missing.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADED = {"img": "src", "script": "src", "link": "href", "source": "src", "video": "src", "iframe": "src"}
"""Attribute with the address of what a page loads, keyed by the element."""


@dataclass
class Page(HTMLParser):
    """Addresses and anchors of one page.

    Attributes:
        path: File of the page.
        links: Addresses of links.
        loaded: Addresses of pictures, scripts and styles.
        anchors: Identifiers of elements.
    """

    path: Path
    links: list[str] = field(default_factory=list[str])
    loaded: list[str] = field(default_factory=list[str])
    anchors: set[str] = field(default_factory=set[str])

    def __post_init__(self) -> None:
        """Read the file."""
        super().__init__()
        self.feed(self.path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Record the addresses and the identifier of an element."""
        values = dict(attrs)
        if identifier := values.get("id"):
            self.anchors.add(identifier)
        if tag == "a" and (address := values.get("href")):
            self.links.append(address)
        if tag in LOADED and (address := values.get(LOADED[tag])):
            self.loaded.append(address)


def find_errors(folder: Path) -> Iterator[str]:
    """Yield a sentence about each broken link, and about each file that is loaded from the network."""
    pages = {path: Page(path) for path in sorted(folder.resolve().rglob("*.html"))}
    for path, page in pages.items():
        name = path.relative_to(folder.resolve()).as_posix()
        for address in page.loaded:
            if urlsplit(address).netloc:
                yield f"{name} loads {address} from the network"
        for address in {*page.links, *page.loaded}:
            parts = urlsplit(address)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.is_file():
                yield f"{name} links to {address}; there is no such file"
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
                yield f"{name} links to {address}; the page has no such anchor"


def main() -> int:
    """Check the site in the folder that is the first argument."""
    folder = Path(sys.argv[1])
    n_pages = len(list(folder.rglob("*.html")))
    errors = list(find_errors(folder))
    print(*errors, f"{n_pages} pages, {len(errors)} errors", sep="\n")
    return 1 if errors or not n_pages else 0


if __name__ == "__main__":
    sys.exit(main())
