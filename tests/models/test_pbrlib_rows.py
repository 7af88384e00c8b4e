# SPDX-License-Identifier: Apache-2.0
"""Nodes for hair and films, and MaterialX's circle for subsurface scattering."""

import numpy as np
import pytest

from mxeon.models.hair import DEFAULTS
from mxeon.models.microfacet import dielectric_albedo_dir
from mxeon.models.nodes.lobes import HAIR_NODE, circle_blur
from mxeon.models.nodes.microfacets import CONDUCTOR_LOBE, FILM_NODES

WO = np.array([[0.3, -0.4, np.sqrt(0.75)], [0.0, 0.6, 0.8]])
FILM = {"thinfilm_thickness": np.array([0.0, 400.0]), "thinfilm_ior": np.array([1.3, 1.3])}
METAL = {
    "ior": np.full((2, 3), 0.5),
    "extinction": np.full((2, 3), 3.0),
    "roughness": np.full((2, 2), 0.4),
}
# Error of the polynomial for a film's curve, as in the docstring of `film_albedo_dir`.
CURVE = 1e-4


def test_the_environment_of_materialx_hair_is_a_dielectric():
    [ggx] = [each for each in HAIR_NODE.variants if each.title.startswith("a GGX lobe")]
    rough = dict.fromkeys(("roughness_R", "roughness_TT", "roughness_TRT"), (0.3, 0.3))
    inputs = {name: np.tile(value, (2, 1)) for name, value in {**DEFAULTS, **rough}.items()}
    expected = dielectric_albedo_dir(WO, 1.0, (0.3, 0.3), 1.55)
    found = ggx.albedo(WO, inputs | {"ior": np.full(2, 1.55)})
    assert found == pytest.approx(np.repeat(expected, 3, axis=-1), rel=1e-12)


def test_a_film_of_no_thickness_leaves_the_albedo_of_a_metal():
    [row] = [each for each in FILM_NODES if each.category == "conductor_bsdf"]
    bare = CONDUCTOR_LOBE.albedo(WO, METAL)
    for found in (
        row.albedo(WO, METAL | FILM),
        row.integral(WO, METAL | FILM),
        CONDUCTOR_LOBE.albedo(WO, METAL | FILM),
    ):
        assert found[0] == pytest.approx(bare[0], abs=CURVE)
        assert np.abs(found[1] - bare[1]).max() > 10.0 * CURVE


def test_the_circle_of_materialx_is_nearly_lambert_and_leaks_over_the_horizon():
    mu = np.array([-0.5, -0.05, 0.3, 1.0])
    narrow, wide = (circle_blur(mu, np.full((4, 1), radius))[:, 0] for radius in (0.1, 10.0))
    assert narrow == pytest.approx(np.maximum(mu, 0.0), abs=0.05)
    assert 0.01 < narrow[1] < wide[1]
