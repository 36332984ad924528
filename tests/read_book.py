#!/usr/bin/env python3
"""Reads the pages that mdBook made: every link and picture is there, nothing is asked from a network, no formula is left as TeX.

    mdbook build book --dest-dir DIR && python3 tests/read_book.py DIR
"""
import html.parser
import pathlib
import sys
import urllib.parse

# links that a reader follows may go anywhere; what a page loads may not
LOADED = {"img": "src", "script": "src", "link": "href", "source": "src", "iframe": "src"}


class Page(html.parser.HTMLParser):
    """Links, names and words of one page."""

    def __init__(self, file):
        super().__init__()
        self.file, self.links, self.loaded, self.names, self.formulas, self.words = file, [], [], set(), 0, []
        self.code = 0
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.names.update(v for k, v in attributes if k in ("id", "name") and v)
        self.code += tag in ("code", "script", "style")
        self.formulas += tag == "math"
        if tag == "a" and found.get("href"):
            self.links.append(found["href"])
        if found.get(LOADED.get(tag, "")):
            self.loaded.append(found[LOADED[tag]])

    def handle_endtag(self, tag):
        self.code -= tag in ("code", "script", "style")

    def handle_data(self, data):
        if not self.code:
            self.words.append(data)


def mistakes(page, pages, root):
    for link in page.links + page.loaded:
        parts = urllib.parse.urlsplit(link)
        if parts.scheme or parts.netloc:
            if link in page.loaded and parts.scheme != "data":
                yield f"loads {link} from elsewhere"
            continue
        path = urllib.parse.unquote(parts.path)
        target = (root / path.lstrip("/") if path.startswith("/") else page.file.parent / path).resolve() if path else page.file
        if not target.exists():
            yield f"links to {link}, which is not there"
        elif parts.fragment and target in pages and urllib.parse.unquote(parts.fragment) not in pages[target].names:
            yield f"links to a place that is not there: {link}"
    text = " ".join(page.words)
    for left in ("{{#", "\\mathbf", "\\frac", "\\sum", "$$", "[ERROR"):
        if left in text:
            yield f"shows `{left}`"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    files = sorted(f for f in root.rglob("*.html") if f.name not in ("print.html", "toc.html", "404.html"))
    pages = {f: Page(f) for f in files}
    wrong = [f"{f.relative_to(root)}: {m}" for f, page in pages.items() for m in mistakes(page, pages, root)]
    formulas = sum(p.formulas for p in pages.values())
    print("\n".join(wrong + [f"{len(pages)} pages, {formulas} formulas: {len(wrong)} mistakes"]))
    sys.exit(1 if wrong or formulas < 100 else 0)


if __name__ == "__main__":
    main()
