# SPDX-License-Identifier: Apache-2.0
"""Every input of a lobe has values outside the range that is drawn, or a reason why it has none."""

import numpy as np
import pytest

from mxeon.conformance.specs import PBRLIB
from mxeon.conformance.specs.lobes import PbrSpec
from mxeon.conformance.specs.surface_shaders import FREE_PATHS, SurfaceShaderSpec
from mxeon.shaders.library import load_library

SHADERS = [spec for spec in PBRLIB if isinstance(spec, SurfaceShaderSpec)]
LOBES = [spec for spec in PBRLIB if isinstance(spec, PbrSpec)]
# Why an input has no values outside its range: of a category, or of a type.
REASONS = {
    "color3": "above 1 a reflectance makes light",
    "burley_diffuse_bsdf": "the equation has a roughness up to 1",
    "subsurface_bsdf": "a plane has no mean free path",
    "chiang_hair_bsdf": "the edges of its inputs are those of their domain",
}
LIMITS = ("uimin", "uimax")  # of MaterialX's definitions


@pytest.mark.parametrize("spec", LOBES, ids=lambda spec: spec.title)
def test_every_input_is_asked_below_and_above_its_range_up_to_where_it_ends(spec):
    [definition] = load_library("stock").getMatchingNodeDefs(spec.node)[:1]
    for each in spec.drawn:
        port = definition.getActiveInput(each.name)
        low, high = (float(np.max(end)) for end in (each.low, each.high))
        if {each.type, spec.node} & REASONS.keys() and not each.beyond:
            continue
        if port and all(port.hasAttribute(limit) for limit in LIMITS):
            continue  # no host passes more
        if spec.node in ("layer", "mix", "add", "multiply"):
            continue  # of lobes that are judged alone
        assert max(each.beyond) > high, each.name
        assert min(each.beyond) < low or low == 0.0, each.name


@pytest.mark.parametrize("spec", SHADERS, ids=lambda spec: spec.title)
def test_every_input_of_a_surface_shader_is_changed_or_has_a_reason(spec):
    definitions = load_library("stock").getMatchingNodeDefs(spec.node)
    newest = max(definitions, key=lambda each: each.getVersionString())
    names = {each.getName() for each in newest.getActiveInputs()}
    assert names == {*spec.names, *spec.table.unseen} | (names & {*FREE_PATHS})
