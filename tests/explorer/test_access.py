# SPDX-License-Identifier: Apache-2.0
"""The explorer page is accessible: axe-core finds no problem, and the page works without WebGL2."""

import pytest

from tests.explorer.browser import opened, show, started, state
from tests.explorer.stage import written
from tests.explorer.test_build import MODULES, needs_modules

# Flags that disable WebGL by removing all graphics drivers.
NO_GRAPHICS = ("--disable-gpu", "--disable-software-rasterizer", "--no-proxy-server")
VIEWS = {
    "light": {},
    "paths": {"comparison": "flicker", "paths": True, "samples": 1, "probe": [0.5, 0.3]},
    "dark": {
        "comparison": "difference",
        "left": {"source": "model/qon", "flag": True, "sampler": "exact"},
        "right": {"source": "variant/cycles_rho_cubed/4", "flag": True, "sampler": "exact"},
        "wanted": [0.9, 0.9, 0.9],
    },
}


@pytest.fixture(scope="module")
def documents(tmp_path_factory):
    """URL of an explorer page with two documents."""
    file = tmp_path_factory.mktemp("documents") / "explorer.html"
    return written(file, "clay", "standard_surface_rough_base")


@pytest.fixture(scope="module")
def checked(browser, documents):
    """Explorer page with axe-core. The page's security policy is off, so that axe-core may run."""
    needs_modules()
    with opened(browser, documents, bypass_csp=True) as page:
        page.add_script_tag(path=MODULES / "axe-core" / "axe.min.js")
        yield page


@pytest.mark.parametrize("name", VIEWS)
def test_axe_finds_nothing(checked, name):
    checked.emulate_media(color_scheme="dark" if name == "dark" else "light")
    checked.evaluate("mxeon.show(mxeon.fromAddress(''))")
    show(checked, **VIEWS[name])
    violations = checked.evaluate("axe.run()")["violations"]
    assert [(each["id"], each["help"], each["nodes"][0]["html"]) for each in violations] == []


def test_without_webgl2_there_are_all_numbers(browser, documents):
    with (
        started(browser.browser_type, NO_GRAPHICS) as other,
        opened(other, documents, drawn=False) as page,
    ):
        assert "no WebGL2" in page.get_by_role("alert").inner_text()
        assert page.locator("canvas").count() == 0
        assert "not EON" in page.locator(".side.right .verdict").inner_text()
        assert "EON, clamped, float64" in page.locator(".values").inner_text()
        page.get_by_label("Roughness, number").fill("0.5")
        page.get_by_label("Roughness, number").blur()
        assert state(page)["roughness"] == 0.5
