# SPDX-License-Identifier: Apache-2.0
"""Pages of the explorer in a headless Chromium, which fail a test by what they ask for or say."""

from contextlib import contextmanager

from mxeon.hosts.webgl import FLAGS, is_root, program
from tests.support.availability import package

# Nothing but this machine can be reached.
LOCAL = tuple(each.replace("~NOTFOUND", "~NOTFOUND, EXCLUDE 127.0.0.1") for each in FLAGS)

# Few pixels, for a software driver.
SMALL = {"viewport": {"width": 880, "height": 180}, "device_scale_factor": 0.5}
HAS = """fields => Object.entries(fields).every(([name, value]) =>
    JSON.stringify(mxeon.state()[name]) === JSON.stringify(value))"""
DRAWN = "mxeon?.stage?.isSettled(mxeon.state())"


sync_playwright = package("playwright.sync_api").sync_playwright


@contextmanager
def launched(flags=LOCAL):
    """A browser of its own."""
    with sync_playwright() as playwright, started(playwright.chromium, flags) as browser:
        yield browser


@contextmanager
def started(kind, flags):
    """A browser of a kind that playwright knows, with these flags."""
    browser = kind.launch(executable_path=program(), args=flags, chromium_sandbox=not is_root())
    yield browser
    browser.close()


@contextmanager
def opened(browser, address, allowed=(), drawn=True, **options):
    """The page of the explorer at an address, as `watched` has it.

    Unless it is to be drawn it has no WebGL, which costs a software driver most of its time.
    """
    context = browser.new_context(**(SMALL | options))
    page = context.new_page()
    if not drawn:
        page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    with watched(page, address, allowed):
        until(page, DRAWN if drawn else "globalThis.mxeon !== undefined")
        yield page
        context.close()


@contextmanager
def watched(page, address, allowed=()):
    """Open an address in a page; messages that are not allowed, and requests, fail the test."""
    asked, said = [], []
    page.set_default_timeout(600_000.0)  # of a busy machine
    page.on("request", lambda request: asked.append(request.url))
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.goto(address)
    yield
    start = address.partition("#")[0]
    others = [url for url in asked if not url.startswith((start, "data:", "blob:"))]
    assert not others, f"requests: {others}"
    complaints = [text for text in said if not text.startswith(tuple(allowed))]
    assert not complaints, f"messages: {complaints}"


def until(page, expression, argument=None, seconds=600):
    """Wait until an expression is true, and give its value.

    Playwright's own way needs what the page's policy forbids.
    """
    for _ in range(20 * seconds):
        if value := page.evaluate(expression, argument):
            return value
        page.wait_for_timeout(50)
    raise AssertionError(f"never true: {expression}")


def state(page):
    """The view that the page shows."""
    return page.evaluate("mxeon.state()")


def shows(page, **fields):
    """Require that the page shows a view with these fields, soon."""
    try:
        until(page, HAS, fields)
    except AssertionError:
        view = state(page)
        raise AssertionError(f"{ {name: view[name] for name in fields} }, not {fields}") from None


def show(page, **patch):
    """Show a view with other fields."""
    page.evaluate("patch => mxeon.show({...mxeon.state(), ...patch})", patch)


def judged(page, side, badge):
    """Require that the verdict on a side has a badge, soon: values are read back before."""
    text = "side => document.querySelector(`.side.${side} .verdict strong`).textContent"
    until(page, f"([side, badge]) => ({text})(side) === badge", [side, badge])
