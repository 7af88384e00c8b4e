# SPDX-License-Identifier: Apache-2.0
"""The explorer on the site. `python -m tools.site.explorer` takes a screenshot for the docs."""

from pathlib import Path
from tempfile import TemporaryDirectory

from mxeon.explorer import page, page_data
from mxeon.hosts.webgl import FLAGS, is_root, program
from mxeon.io.files import write_text
from tools.site import DOCS

PICTURE = DOCS / "images" / "explorer.png"
PAGES = "upstream/{}.html"  # path of a ledger page, relative to the built explorer
SIZE = {"width": 1280, "height": 900}


def text() -> str:
    """HTML of the explorer, with links to the site's ledger pages."""
    return page(page_data(pages=PAGES))


def main() -> None:
    from playwright.sync_api import sync_playwright

    with TemporaryDirectory() as folder, sync_playwright() as playwright:
        file = Path(folder, "explore.html")
        write_text(file, text())
        browser = playwright.chromium.launch(
            executable_path=program(), args=FLAGS, chromium_sandbox=not is_root()
        )
        tab = browser.new_page(viewport=SIZE)
        tab.goto(file.as_uri())
        tab.get_by_text("shader, float32").first.wait_for()
        tab.wait_for_timeout(5000)  # the explorer needs time to smooth edges
        tab.screenshot(path=PICTURE)
        browser.close()


if __name__ == "__main__":
    main()
