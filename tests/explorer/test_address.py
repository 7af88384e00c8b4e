# SPDX-License-Identifier: Apache-2.0
"""The page's address stores and restores the view, and an invalid address does no harm."""

import pytest

from tests.explorer.browser import opened, show, state, until

# All fields of a view, with values that differ from the initial view.
CHANGED = {
    "left": {"source": "model/qon", "flag": False, "sampler": "cosine"},
    "right": {"source": "variant/cycles_rho_cubed/4", "flag": False, "sampler": "cltc"},
    "comparison": "difference",
    "wipe": 0.125,
    "scale": 2e-7,
    "shown": "right",
    "shape": "cloth",
    "turn": 30.5,
    "tilt": -12,
    "zoom": 2.5,
    "azimuth": -31.5,
    "elevation": 12,
    "light": 2.5,
    "surroundings": "sky",
    "exposure": -1.7,
    "color": [0.1, 0.3333, 1],
    "roughness": 0.30001,
    "wanted": [0, 0.25, 0.5],
    "average": True,
    "keep": False,
    "paths": True,
    "samples": 33,
    "inputs": {"shader/eonlib": {"lobe_weight": 0.5, "shading_thin_walled": True}},
    "probe": [0.625, 0.1],
}


def test_a_view_of_other_values_everywhere_comes_back(undrawn):
    first = undrawn.evaluate("mxeon.fromAddress('')")
    assert set(CHANGED) == set(first)
    assert all(CHANGED[name] != first[name] for name in CHANGED.keys() - {"keep"})
    again = undrawn.evaluate("view => mxeon.fromAddress(mxeon.toAddress(view))", CHANGED)
    assert again == CHANGED


@pytest.mark.parametrize(
    "part",
    [
        "roughness=NaN&color=1,2&wipe=&probe=x,y&samples=many",
        "a=shader/nothing,1,exact&b=%3Cscript%3E,2,",
        "shape=<img src=x onerror=alert(1)>&compare=constructor&surroundings=__proto__",
        "input:shader/eonlib:lobe_color=1,2&input:shader/eonlib:nothing=3&input:__proto__:x=1",
        "%E0%A4%A&&==&=&#%00",
    ],
)
def test_what_cannot_be_read_keeps_its_first_value(undrawn, part):
    found = undrawn.evaluate("address => mxeon.fromAddress(address)", part)
    assert found == undrawn.evaluate("mxeon.fromAddress('')")


def test_numbers_out_of_range_come_to_its_ends(undrawn):
    view = undrawn.evaluate("mxeon.fromAddress('roughness=7&color=-1,0.5,2&elevation=-1e9')")
    assert (view["roughness"], view["color"], view["elevation"]) == (1, [0, 0.5, 1], -90)


def test_the_address_follows_the_view_and_the_view_the_address(browser, address):
    with opened(browser, f"{address}#roughness=0.25&shape=plane", drawn=False) as page:
        assert (state(page)["roughness"], state(page)["shape"]) == (0.25, "plane")
        show(page, exposure=1.5)
        until(page, "location.hash.includes('exposure=1.5')")
        page.evaluate("location.hash = 'roughness=0.75'")
        until(page, "mxeon.state().roughness === 0.75")
        assert state(page)["exposure"] == 0
