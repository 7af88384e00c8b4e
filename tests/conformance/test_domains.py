# SPDX-License-Identifier: Apache-2.0
"""Every input is asked at and beyond both ends of its range, and at the limits of its definition."""

import numpy as np
import pytest

from mxeon.conformance.specs import ALL, PBRLIB
from mxeon.conformance.specs.combinations import CombinedSpec
from mxeon.conformance.specs.diffuse import SURFACE_LOBES
from mxeon.conformance.specs.emission import ConeSpec, EmissionSpec, MediumSpec
from mxeon.conformance.specs.hair import HairSpec
from mxeon.conformance.specs.surface_shaders import FREE_PATHS, SurfaceShaderSpec
from mxeon.conformance.specs.utilities import UtilitySpec
from mxeon.shaders.library import load_library

SHADERS = [spec for spec in PBRLIB if isinstance(spec, SurfaceShaderSpec)]
NODES = [spec for spec in ALL if spec.inputs and spec not in (*SHADERS, *SURFACE_LOBES)]
# Why inputs have no values outside their ranges: of a family, a category, or a type.
REASONS = {
    CombinedSpec: "its lobes are judged alone",
    MediumSpec: "its media are judged alone, and a share is clamped",
    UtilitySpec: "`output_finite` has values beyond both ends",
    HairSpec: "the edges of its inputs are those of their domain",
    ConeSpec: "its angles are those of a full turn",
    EmissionSpec: "the range of the exponent is what a power is exact for",
    "vector3": "directions of a frame have no ends",
    "boolean": "it has two values",
    "color3": "above 1 a reflectance makes light",
    "burley_diffuse_bsdf": "the equation has a roughness up to 1",
    "subsurface_bsdf": "a plane has no mean free path",
}
HARD, SOFT = ("uimin", "uimax"), ("uisoftmin", "uisoftmax")  # of MaterialX's definitions


def ends(spec, each, names):
    """What a definition says of the ends of an input."""
    definitions = load_library("eonlib").getMatchingNodeDefs(spec.node)
    ports = [definition.getActiveInput(each.name.split("/")[-1]) for definition in definitions]
    texts = {port.getAttribute(name) for port in filter(None, ports) for name in names}
    return [float(text) for text in texts if text and "," not in text]


@pytest.mark.parametrize("spec", NODES, ids=lambda spec: spec.title)
def test_every_input_is_asked_below_and_above_its_range_up_to_where_it_ends(spec):
    reasons = [kind for kind in REASONS if isinstance(kind, type) and isinstance(spec, kind)]
    for each in getattr(spec, "drawn", spec.inputs):
        low, high = (float(np.max(end)) for end in (each.low, each.high))
        if not each.beyond:
            limits = ends(spec, each, HARD)
            known = reasons or {each.type, spec.node} & REASONS.keys()
            assert known or len(limits) == 2, each.name  # or no host passes more
        else:
            assert max(each.beyond) > high, each.name
            assert min(each.beyond) < low or low == 0.0, each.name


@pytest.mark.parametrize("spec", NODES, ids=lambda spec: spec.title)
def test_every_input_reaches_the_limits_of_its_definition(spec):
    for each in getattr(spec, "drawn", spec.inputs):
        asked = [*np.ravel(each.low), *np.ravel(each.high), *each.edges, *each.beyond]
        for limit in ends(spec, each, (*HARD, *SOFT)):
            assert min(asked) <= limit <= max(asked), each.name


@pytest.mark.parametrize("spec", SHADERS, ids=lambda spec: spec.title)
def test_every_input_of_a_surface_shader_is_changed_or_has_a_reason(spec):
    definitions = load_library("stock").getMatchingNodeDefs(spec.node)
    newest = max(definitions, key=lambda each: each.getVersionString())
    names = {each.getName() for each in newest.getActiveInputs()}
    assert names == {*spec.names, *spec.unseen} | (names & {*FREE_PATHS})
