# SPDX-License-Identifier: Apache-2.0
"""The explorer's page in Chromium: of odd documents, and at odd addresses.

Each process has one browser. A page must run no script but its own, ask for nothing, and report no error.
"""

import atexit
import tempfile
from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path
from urllib.parse import quote

from mxeon import explorer
from mxeon.errors import MxeonError
from mxeon.explorer import document_sources
from mxeon.io.files import write_text
from tests.fuzz.words import SNIPPETS, TYPES, VALUES
from tests.support.documents import material

ACCEPTED, REFUSED, NOT_RUN = 0, 2, 3
HIT = "globalThis.hit = 1"
SCRIPTS = (
    f"</script><script>{HIT}</script><!--",
    f"<img src=x onerror='{HIT}'>",
    f"javascript:{HIT}",
    f"\u2028{HIT}//",
    f'"}});{HIT}//',
)
ODD = (*VALUES, *SCRIPTS)
LOBE = """<oren_nayar_diffuse_bsdf name="{name}" type="BSDF"{more}>
  <input name="color" type="color3" value="{color}" {port}/></oren_nayar_diffuse_bsdf>"""
PLACES = ("name", "color", "uiname", "uimin", "uimax", "uisoftmin", "doc", "uifolder")
KEYS = (
    "a", "b", "compare", "wipe", "scale", "shown", "shape", "light", "surroundings", "color",
    "roughness", "paths", "samples", "probe", "i", "n", "seed", "env", "x", "__proto__", "inputs",
    "constructor", "document/0/clay/eonlib",
)  # fmt: skip
STATE = """address => {
  const state = mxeon.from_address(address);
  mxeon.show(state);
  const again = mxeon.from_address(mxeon.to_address(state));
  const finite = JSON.stringify(state, (_, v) => typeof v === "number" && !isFinite(v) ? "!" : v);
  return {same: JSON.stringify(again) === JSON.stringify(state), odd: finite.includes('"!"')};
}"""


def document_rows():
    """Attributes of a document that a page shows, with every odd value; and whole snippets."""
    yield from product(PLACES, ODD)
    yield from product(("type",), TYPES)
    yield from product(("snippet",), SNIPPETS)


def fragment_rows():
    """Keys of an address with odd values, alone and in pairs, quoted or not."""
    for key, value, quoted in product(KEYS, ODD, (False, True)):
        yield f"{key}={quote(value[:300], safe='') if quoted else value[:300]}"
    for (first, second), value in product(product(KEYS[:10], KEYS), SCRIPTS):
        yield f"{first}={value}&{second}={value}"


def to_document(_, row):
    """The text of a document that a page is made of."""
    place, value = row
    if place == "snippet":
        return material(value + LOBE.format(name="lobe", more="", color="1, 1, 1", port=""))
    words = {"name": "lobe", "more": "", "color": "0.8, 0.4, 0.1", "port": ""}
    text = _escaped(value)
    words |= {place: text} if place in words else {"port": f'{place}="{text}"'}
    return material(LOBE.format(**words))


def shown(text):
    """Exit status of a document on the page, and what was wrong there."""
    with tempfile.TemporaryDirectory(prefix="mxeon-pages-") as folder:
        file = Path(folder, "odd.mtlx")
        file.write_text(text, encoding="utf-8", errors="replace")
        try:
            sources = document_sources(str(file))
        except (MxeonError, OSError):
            return REFUSED, ""
        own = (replace(each, id=f"document/0/{each.id}") for each in sources)
        data = replace(_without_documents(), sources=(*_without_documents().sources, *own))
        write_text(page := Path(folder, "page.html"), explorer.page(data))
        return _tried(page.as_uri(), None)


def addressed(fragment):
    """Exit status of an address of the page without documents, and what was wrong there."""
    return _tried(_plain(), fragment)


def _tried(address, fragment):
    """What is wrong with a page, or with the page that is open at another fragment."""
    try:
        page, said = _opened(address if fragment is not None else None)
    except MxeonError:
        return NOT_RUN, ""
    if fragment is None:
        page.goto(address)
    faults = []
    for _ in range(200):
        if said or page.evaluate("globalThis.mxeon !== undefined"):
            break
        page.wait_for_timeout(25)
    else:
        faults.append("shows nothing")
    if fragment is not None:
        answer = page.evaluate(STATE, fragment)
        faults += [
            key for key, bad in (("odd", answer["odd"]), ("lost", not answer["same"])) if bad
        ]
    if page.evaluate("globalThis.hit !== undefined"):
        faults.append("ran a script")
    faults += said
    said.clear()
    return ACCEPTED, "; ".join(faults)


@cache
def _without_documents():
    """The data of a page of the models alone, which take seconds."""
    return explorer.page_data()


@cache
def _plain():
    """Address of the page without documents."""
    folder = tempfile.TemporaryDirectory(prefix="mxeon-pages-")
    atexit.register(folder.cleanup)
    write_text(page := Path(folder.name, "page.html"), explorer.page(_without_documents()))
    return page.as_uri()


@cache
def _browser():
    """The browser of this process."""
    from playwright.sync_api import sync_playwright

    from mxeon.hosts.webgl import FLAGS, program

    browser = (
        sync_playwright()
        .start()
        .chromium.launch(executable_path=program(), args=FLAGS, chromium_sandbox=False)
    )
    atexit.register(browser.close)
    return browser


@cache
def _opened(address):
    """A page of this process's browser, without WebGL, and what it says and asks for."""
    page, said = _browser().new_page(), []
    page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    page.on("console", lambda message: said.append(f"said {message.text[:200]}"))
    page.on("pageerror", lambda error: said.append(f"error {str(error)[:200]}"))
    page.on("request", lambda request: _asked(request.url, said))
    if address:
        page.goto(address)
    return page, said


def _asked(url, said):
    if not url.startswith(("file:", "data:", "blob:")):
        said.append(f"asked for {url[:200]}")


def _escaped(text):
    """A text as the value of an attribute."""
    whole = "".join(each for each in text if each == "\t" or ord(each) >= 32)
    return whole.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
