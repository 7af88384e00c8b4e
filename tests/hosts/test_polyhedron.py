# SPDX-License-Identifier: Apache-2.0
"""Mitsuba, LuxCoreRender and EEVEE: their own nodes, and what may go wrong."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.conformance.results import PASSED
from mxeon.conformance.results.known_issues import RENDERER_NODES
from mxeon.conformance.run import check
from mxeon.shaders.library import examples_folder
from mxeon.shaders.scene import BACK, FRONT, SIDE, VIEW, local_directions
from mxeon.survey.facets import facet_points
from mxeon.survey.polyhedron import luxcore, mitsuba
from tests.support.availability import available
from tests.support.plans import keep_host
from tests.support.sharing import shared

EXAMPLE = examples_folder() / "plaster.mtlx"
MODULES = {"mitsuba": mitsuba, "luxcore": luxcore}
# Errors of pictures of facets, times the light's cosine; of EEVEE's, in half floats; and of values of pairs.
FACETS, COARSE_FACETS, FACET_PAIRS = 7e-5, 0.02, 6e-6


def judged_all(name, factory):
    """Results of a host, by check and subject."""
    with available(name), MODULES[name].Host() as host:
        host.identity()
    with pytest.MonkeyPatch.context() as patch:
        keep_host(patch, name)
        results = shared(factory, name, lambda: check([EXAMPLE], [name], nodes=["common"])).results
    return {(each.check, each.subject): each for each in results if each.library == RENDERER_NODES}


def facet_pairs(scene):
    """Directions to the camera and the light at each facet, and which facets both see."""
    normal = facet_points(scene.size).normal[facet_points(scene.size).mask]
    wo, wi = (local_directions(normal, each) for each in (VIEW, scene.light))
    return wo, wi, (np.minimum(wo, wi)[:, 2] >= 0.05)


@pytest.fixture(scope="module", params=MODULES)
def host(request):
    with available(request.param), MODULES[request.param].Host() as host:
        host.identity()
        yield host


@pytest.fixture(scope="module")
def of_mitsuba(tmp_path_factory):
    return judged_all("mitsuba", tmp_path_factory)


def test_mitsuba_has_the_models_that_it_documents(of_mitsuba):
    assert {subject for _, subject in of_mitsuba} == {each.title for each in mitsuba.NODES}
    assert {each.verdict for each in of_mitsuba.values()} == {PASSED}
    assert all(each.control.caught for each in of_mitsuba.values())


@pytest.mark.parametrize("scene", [FRONT, SIDE, BACK], ids=lambda each: each.name)
def test_pictures_are_linear_and_have_float_precision(host, scene):
    """A dark color beside a bright one: 8 bits or a tone curve would be off by far more."""
    scene = replace(scene, size=64)
    material = MODULES[host.name].NODES[0].made((1.0, 0.02, 1e-4), 0.0)
    picture = host.node(material, scene)[facet_points(64).mask]
    _, wi, mask = facet_pairs(scene)
    expected = wi[mask][:, 2:] * np.array([1.0, 0.02, 1e-4])
    relative = np.abs(picture[mask] / expected - 1.0) * wi[mask][:, 2:]
    assert relative.max() <= FACETS
