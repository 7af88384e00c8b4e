# SPDX-License-Identifier: Apache-2.0
"""Explorer pages in headless Chromium. A page's network requests and messages fail the test."""

from contextlib import contextmanager

from mxeon.hosts.webgl import FLAGS, is_root, program
from tests.support.availability import package

# Chromium flags that block all network access except to this machine.
LOCAL = tuple(each.replace("~NOTFOUND", "~NOTFOUND, EXCLUDE 127.0.0.1") for each in FLAGS)

# The window is small, because software drivers render slowly.
SMALL = {"viewport": {"width": 880, "height": 180}, "device_scale_factor": 0.5}
HAS = """fields => Object.entries(fields).every(([name, value]) =>
    JSON.stringify(mxeon.state()[name]) === JSON.stringify(value))"""
DRAWN = "mxeon?.stage?.isSettled(mxeon.state())"


sync_playwright = package("playwright.sync_api").sync_playwright


@contextmanager
def launched(flags=LOCAL):
    with sync_playwright() as playwright, started(playwright.chromium, flags) as browser:
        yield browser


@contextmanager
def started(kind, flags):
    """Context manager that starts a playwright browser of the given type with the given flags."""
    browser = kind.launch(executable_path=program(), args=flags, chromium_sandbox=not is_root())
    yield browser
    browser.close()


@contextmanager
def opened(browser, address, allowed=(), drawn=True, **options):
    """Context manager that opens an explorer page in a new browser context.

    If `drawn` is false, WebGL is disabled, because WebGL is slow with a software driver.
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
    """Open an address. The test fails at any network request or message that is not allowed."""
    asked, said = [], []
    page.set_default_timeout(600_000.0)  # milliseconds, enough for a busy machine
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
    """Wait until a JavaScript expression is true, and return its value.

    The security policy of the page blocks playwright's own function.
    """
    for _ in range(20 * seconds):
        if value := page.evaluate(expression, argument):
            return value
        page.wait_for_timeout(50)
    raise AssertionError(f"never true: {expression}")


def state(page):
    return page.evaluate("mxeon.state()")


def shows(page, **fields):
    """Wait until the view has the given fields, and fail after a time limit."""
    try:
        until(page, HAS, fields)
    except AssertionError:
        view = state(page)
        raise AssertionError(f"{ {name: view[name] for name in fields} }, not {fields}") from None


def show(page, **patch):
    page.evaluate("patch => mxeon.show({...mxeon.state(), ...patch})", patch)


def judged(page, side, badge):
    """Wait until a side's verdict, which the page computes from pixels, has the given badge."""
    text = "side => document.querySelector(`.side.${side} .verdict strong`).textContent"
    until(page, f"([side, badge]) => ({text})(side) === badge", [side, badge])
