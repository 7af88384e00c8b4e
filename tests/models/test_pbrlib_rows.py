# SPDX-License-Identifier: Apache-2.0
"""The rows of pbrlib's nodes other than reflection: hair, films, transmission, subsurface."""

import numpy as np
import pytest

from mxeon.models.hair import DEFAULTS
from mxeon.models.microfacet import dielectric_albedo_dir
from mxeon.models.nodes.lobes import HAIR_NODE, circle_blur
from mxeon.models.nodes.microfacets import (
    CONDUCTOR_LOBE,
    DIELECTRIC_LOBE,
    FILM_NODES,
    TRANSMISSIONS,
)
from tests.support.hemispheres import sphere

WO = np.array([[0.3, -0.4, np.sqrt(0.75)], [0.0, 0.6, 0.8]])
WIDE = {name: (0.6, 0.8) for name in ("roughness_R", "roughness_TT", "roughness_TRT")}
# Error of 160 by 320 directions for lobes as wide as these.
SPHERE = 1e-6
FILM = {"thinfilm_thickness": np.array([0.0, 400.0]), "thinfilm_ior": np.array([1.3, 1.3])}
METAL = {
    "ior": np.full((2, 3), 0.5),
    "extinction": np.full((2, 3), 3.0),
    "roughness": np.full((2, 2), 0.4),
}
# The polynomial for a film's curve in the docstring of `film_albedo_dir`.
CURVE = 1e-4


def hair_inputs(count, **changes):
    """The node's defaults with some changes, one row per direction."""
    inputs = {**DEFAULTS, **WIDE, "absorption_coefficient": (0.1, 0.4, 1.5), **changes}
    return {name: np.repeat([np.asarray(each, float)], count, 0) for name, each in inputs.items()}


@pytest.mark.parametrize("wo", WO)
def test_values_of_hair_integrate_to_its_albedo(wo):
    wi, weights = sphere(160)
    views = np.broadcast_to(wo, wi.shape)
    values = HAIR_NODE.value(views, wi, hair_inputs(len(wi)))
    expected = HAIR_NODE.albedo(wo[np.newaxis], hair_inputs(1))[0]
    assert weights @ values == pytest.approx(expected, abs=SPHERE)


def test_hair_without_its_factor_keeps_pi_times_the_light():
    titled = [each for each in HAIR_NODE.variants if each.title.startswith("no factor 1/pi")]
    [whole] = [each for each in titled if each.albedo]
    inputs = hair_inputs(2)
    assert whole.albedo(WO, inputs) == pytest.approx(np.pi * HAIR_NODE.albedo(WO, inputs))


def test_the_environment_of_materialx_hair_is_a_dielectric():
    [ggx] = [each for each in HAIR_NODE.variants if each.title.startswith("a GGX lobe")]
    tints = dict.fromkeys(("tint_R", "tint_TT", "tint_TRT"), (1.0, 1.0, 1.0))
    inputs = hair_inputs(2, **{name: (0.3, 0.3) for name in WIDE}, **tints)
    expected = dielectric_albedo_dir(WO, 1.0, (0.3, 0.3), 1.55)
    assert ggx.albedo(WO, inputs) == pytest.approx(np.repeat(expected, 3, axis=-1), rel=1e-12)


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


def test_what_a_dielectric_reflects_beside_its_transmission_has_no_tint():
    inputs = {
        "tint": np.full((2, 3), 0.5),
        "ior": np.array([1.5, 1.3]),
        "roughness": np.full((2, 2), 0.4),
    }
    white = DIELECTRIC_LOBE.albedo(WO, inputs | {"tint": np.ones((2, 3))})
    found = TRANSMISSIONS["dielectric_bsdf"].reflected(WO, inputs)
    assert found == pytest.approx(white, rel=1e-12)


def test_the_circle_of_materialx_is_nearly_lambert_and_leaks_over_the_horizon():
    mu = np.array([-0.5, -0.05, 0.3, 1.0])
    narrow, wide = (circle_blur(mu, np.full((4, 1), radius))[:, 0] for radius in (0.1, 10.0))
    assert narrow == pytest.approx(np.maximum(mu, 0.0), abs=0.05)
    assert 0.01 < narrow[1] < wide[1]
