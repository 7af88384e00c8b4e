# SPDX-License-Identifier: Apache-2.0
"""Mitsuba as a renderer: its own BSDFs, judged by pictures of faceted solids."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon import check
from mxeon.shaders.library import examples_folder
from mxeon.shaders.scene import BACK, FRONT, SIDE, VIEW, local_directions
from mxeon.survey.facets import facet_points
from mxeon.survey.polyhedron import mitsuba
from tests.support.availability import available
from tests.support.plans import keep
from tests.support.verdicts import PASSED, RENDERER_NODES

EXAMPLE = examples_folder() / "plaster.mtlx"
FACETS = 7e-5  # relative error of a picture, times the light's cosine


@pytest.fixture(scope="module")
def host():
    with available("mitsuba"), mitsuba.MitsubaHost() as host:
        host.identity()
        yield host


@pytest.mark.usefixtures("host")  # skips the test if Mitsuba is missing
def test_mitsuba_has_the_models_that_it_documents(monkeypatch):
    keep(monkeypatch, lambda task: task.host == "mitsuba")
    report = check([EXAMPLE], ["mitsuba"], nodes=["common"])
    results = [each for each in report.results if each.library == RENDERER_NODES]
    assert {each.subject for each in results} == {each.title for each in mitsuba.NODES}
    assert {each.verdict for each in results} == {PASSED}
    assert all(each.control.caught for each in results)


@pytest.mark.parametrize("scene", [FRONT, SIDE, BACK])
def test_pictures_are_linear_and_have_float_precision(host, scene):
    """One channel is very dark: 8-bit pixels or a tone curve would change it by far more."""
    scene = replace(scene, size=64)
    material = mitsuba.NODES[0].made((1.0, 0.02, 1e-4), 0.0)
    picture = host.node(material, scene)[facet_points(64).mask]
    normal = facet_points(scene.size).normal[facet_points(scene.size).mask]
    wo, wi = (local_directions(normal, each) for each in (VIEW, scene.light))
    mask = np.minimum(wo, wi)[:, 2] >= 0.05
    expected = wi[mask][:, 2:] * np.array([1.0, 0.02, 1e-4])
    relative = np.abs(picture[mask] / expected - 1.0) * wi[mask][:, 2:]
    assert relative.max() <= FACETS
