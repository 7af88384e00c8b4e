# SPDX-License-Identifier: Apache-2.0
"""MkDocs hooks that add pages from outside `docs/`, adapt links, and complete ledger pages."""

import re
from pathlib import Path

from mkdocs.structure.files import File
from PIL import Image

from mxeon.report.formats import unbroken
from tools.site import explorer, field
from tools.site.ledger.pages import filled

ROOT = Path(__file__).resolve().parents[2]
# Pages made from files outside `docs/`. Links in these files are relative to the repository.
OUTSIDE = {
    "index.md": "README.md",
    "changelog.md": "CHANGELOG.md",
    "contributing.md": "CONTRIBUTING.md",
}


def on_files(files, config):
    """Add the pages in OUTSIDE, the explorer, and the comparison of renderers."""
    pages = {page: ROOT / name for page, name in OUTSIDE.items()}
    for page, path in pages.items():
        files.append(File.generated(config, page, abs_src_path=str(path)))
    for page, made in (("explore.html", explorer), ("field.html", field)):
        files.append(File.generated(config, page, content=made.text()))
    return files


def on_page_markdown(markdown, page, **_):
    """Complete ledger pages, adapt links, and hide the navigation on top-level pages."""
    if page.parent is None:
        page.meta["hide"] = ["navigation"]
    if page.file.src_uri.startswith("upstream/"):
        markdown = filled(Path(page.file.src_uri).stem, markdown)
    is_outside = page.file.src_uri in OUTSIDE
    root = "" if is_outside else "../"
    for page_name, name in OUTSIDE.items():
        markdown = markdown.replace(f"](../../{name}", f"](../{page_name}")  # links in docs/api
        markdown = markdown.replace(f"]({root}{name}", f"]({page_name}")
    return markdown.replace("](docs/", "](") if is_outside else markdown


def on_page_content(html, page, **_):
    """Prevent line breaks before units, split side-by-side pictures, and adapt links of wall.md."""
    html = unbroken(html)
    if page.file.src_uri == "wall.md":
        return html.replace('href="upstream/README.md"', 'href="upstream/index.html"')
    if page.file.src_uri not in ("index.md", "gallery.md"):
        return html
    return re.sub(r'<p><img alt="([^"]*)" src="(images/[^"]*)" ?/?></p>', _halves, html)


def _halves(found):
    """HTML that splits a side-by-side picture into halves, or unchanged HTML of another picture."""
    width, height = Image.open(ROOT / "docs" / found[2]).size
    if width != 2 * height:
        return found[0]
    half = '<span><img alt="{}, {}" src="{}" loading="lazy"></span>'
    halves = (half.format(found[1], each, found[2]) for each in ("stock", "eonlib"))
    return f'<p class="halves">{"".join(halves)}</p>'
