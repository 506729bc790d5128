#!/usr/bin/env python3
"""Every link leads somewhere.

usage: manual.py sources ROOT          links and anchors of the pages in Markdown, as GitHub reads them
       manual.py site FOLDER           every link, anchor, picture, script and style of a built manual; none from a network
                                       77 where none was built
       manual.py build ROOT            builds the manual, without what the program makes, and checks it; 77 without Sphinx
"""
import html.parser
import os
import re
import subprocess
import sys
import tempfile
import urllib.parse

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "../../docs/site"))
sys.dont_write_bytecode = True
import links  # noqa: E402

# What a browser fetches by itself, as against what a reader follows.
FETCHED = {("script", "src"), ("img", "src"), ("source", "src"), ("iframe", "src"), ("link", "href")}


def text_of(path):
    with open(path, encoding="utf-8") as f:
        return f.read()


def sources(root):
    """Faults of the repository's own pages."""
    pages = []
    for folder, inside, names in os.walk(root):
        inside[:] = [name for name in inside if name not in ("build", "node_modules", "results") and name[0] != "."]
        pages += [os.path.join(folder, name) for name in names if name.endswith(".md")]
    assert len(pages) > 20, pages
    checked = 0
    for page in sorted(pages):
        text = text_of(page)
        for target in links.links(text):
            if re.match(r"[a-z]+:", target):
                continue
            checked += 1
            place, _, anchor = target.partition("#")
            there = os.path.normpath(os.path.join(os.path.dirname(page), place)) if place else page
            if not os.path.exists(there):
                yield f"{os.path.relpath(page, root)}: {target}: no such file"
            elif anchor and there.endswith(".md") and anchor not in set().union(*links.anchors(text_of(there))):
                yield f"{os.path.relpath(page, root)}: {target}: no such heading"
    print(f"{len(pages)} pages, {checked} links within the repository")


class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.ids, self.to, self.fetched = set(), [], []
        self.feed(text_of(path))

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id" or (tag == "a" and name == "name"):
                self.ids.add(value)
            elif (tag, name) in FETCHED and value:
                self.fetched.append(value)
            elif tag == "a" and name == "href" and value is not None:
                self.to.append(value)


def site(folder):
    """Faults of a built site."""
    if not os.path.exists(os.path.join(folder, "index.html")):
        print("skipped: not built (target manual)")
        sys.exit(77)
    paths = [os.path.join(at, name) for at, _, names in os.walk(folder) for name in names if name.endswith(".html")]
    pages = {os.path.realpath(path): Page(path) for path in paths}
    assert len(pages) > 20, f"{folder} has {len(pages)} pages"
    checked = 0
    for path, page in sorted(pages.items()):
        name = os.path.relpath(path, os.path.realpath(folder))
        for target in page.to + page.fetched:
            parts = urllib.parse.urlsplit(target)
            if parts.scheme in ("data", "mailto", "javascript"):
                continue
            if parts.scheme or parts.netloc:
                if target in page.fetched:
                    yield f"{name}: {target}: asked of a network"
                continue
            checked += 1
            there = path if not parts.path else os.path.realpath(
                os.path.join(os.path.dirname(path), urllib.parse.unquote(parts.path)))
            if not os.path.isfile(there):
                yield f"{name}: {target}: no such file"
            elif parts.fragment and there in pages and "_static/gallery" not in there and \
                    urllib.parse.unquote(parts.fragment) not in pages[there].ids:
                yield f"{name}: {target}: no such place"
    for at, _, names in os.walk(folder):
        for name in names:
            text = text_of(os.path.join(at, name)) if name.endswith((".css", ".js")) else ""
            if name.endswith(".css"):
                for target in re.findall(r"""(?:url\(|@import\s)\s*['"]?(?!data:|#|url)([^'")\s;]+)""", text):
                    if not os.path.isfile(os.path.join(at, target.split("?")[0].split("#")[0])):
                        yield f"{name}: {target}: not within the site"
            elif re.search(r"^(import|export) ", text, re.M):
                yield f"{name}: a module, which a page that is read from a disk may not load"
    styles = text_of(os.path.join(folder, "_static/styles/furo.css")) + text_of(os.path.join(folder, "_static/wheeltap.css"))
    if not re.search(r"prefers-color-scheme:\s*dark", styles):
        yield "no style for who prefers dark pages"
    assert os.path.getsize(os.path.join(folder, "searchindex.js")) > 10000, "nothing to search"
    print(f"{len(pages)} pages, {checked} links within the site")


def build(root):
    with tempfile.TemporaryDirectory() as made:
        ran = subprocess.run([sys.executable, os.path.join(root, "docs/site/make_site.py"), root, made], text=True,
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if ran.returncode == 77:
            print(ran.stdout)
            sys.exit(77)
        assert ran.returncode == 0, ran.stdout
        yield from site(os.path.join(made, "html"))


def main(what, where):
    faults = list({"sources": sources, "site": site, "build": build}[what](os.path.abspath(where)))
    assert not faults, "\n".join(faults)


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except AssertionError as error:
        sys.exit(str(error))
