# SPDX-License-Identifier: Apache-2.0
"""Make `docs/explore.html`, and its picture on the page about it: `python -m tools.site.explorer`."""

from mxeon.explorer import page, page_data
from mxeon.hosts.webgl import FLAGS, is_root, program
from mxeon.io.files import write_text
from tools.site import DOCS

PAGE = DOCS / "explore.html"
PICTURE = DOCS / "images" / "explorer.png"
PAGES = "upstream/{}.html"  # relative to the page in the built site
SIZE = {"width": 1280, "height": 900}


def main() -> None:
    from playwright.sync_api import sync_playwright

    write_text(PAGE, page(page_data(pages=PAGES)))
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=program(), args=FLAGS, chromium_sandbox=not is_root()
        )
        sheet = browser.new_page(viewport=SIZE)
        sheet.goto(PAGE.as_uri())
        sheet.get_by_text("shader, float32").first.wait_for()
        sheet.wait_for_timeout(5000)  # until the edges of the picture are smooth
        sheet.screenshot(path=PICTURE)
        browser.close()


if __name__ == "__main__":
    main()
