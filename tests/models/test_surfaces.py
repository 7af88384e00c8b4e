# SPDX-License-Identifier: Apache-2.0
"""Specified surface shaders: limits, invariants and energy."""

import numpy as np
import pytest

from mxeon.conformance.samples import Counts
from mxeon.conformance.specs.surface_texts import SENTENCES
from mxeon.models import dielectric_brdf, eon_brdf
from mxeon.models.surfaces import Light, gltf, open_pbr, standard_surface, usd_preview

COSINES = np.array([0.05, 0.3, 0.7, 1.0])
VIEWS = np.stack([np.sqrt(1.0 - COSINES**2), 0.0 * COSINES, COSINES], axis=1)
LIGHTS = VIEWS[::-1] * [-1.0, 1.0, 1.0]
WHITE = (1.0, 1.0, 1.0)


def test_openpbr_without_reflection_is_eon():
    p = open_pbr.parameters(specular_weight=0.0, base_color=WHITE, base_diffuse_roughness=0.7)
    expected = eon_brdf(VIEWS, LIGHTS, WHITE, 0.7) * LIGHTS[:, 2:]
    np.testing.assert_allclose(open_pbr.surface(Light(VIEWS, LIGHTS), p), expected, rtol=1e-12)


def test_a_black_base_leaves_the_dielectric():
    p = open_pbr.parameters(base_weight=0.0, specular_roughness=0.6)
    expected = dielectric_brdf(VIEWS, LIGHTS, tint=WHITE, ior=1.5, roughness=0.36) * LIGHTS[:, 2:]
    np.testing.assert_allclose(open_pbr.surface(Light(VIEWS, LIGHTS), p), expected, rtol=1e-10)


def test_squared_alphas_keep_their_mean():
    rough, stretch = np.array([[0.3], [0.5]]), np.array([[0.2], [0.9]])
    alphas = open_pbr.alphas(rough, stretch)
    np.testing.assert_allclose(np.mean(alphas**2, axis=1), rough[:, 0] ** 4)
    np.testing.assert_allclose(alphas[:, 1] / alphas[:, 0], 1.0 - stretch[:, 0])


FURNACES = [
    (open_pbr, {"base_color": WHITE}),
    (open_pbr, {"base_color": WHITE, "coat_weight": 1.0, "coat_roughness": 0.3}),
    (open_pbr, {"base_color": WHITE, "fuzz_weight": 0.5}),
    (standard_surface, {"base": 1.0, "metalness": 0.0, "sheen": 0.0}),
    (standard_surface, {"base": 1.0, "metalness": 0.0, "sheen": 0.7, "coat": 0.5}),
    (gltf, {"metallic": 0.0, "roughness": 0.4}),
    (gltf, {"metallic": 0.0, "sheen_color": WHITE, "sheen_roughness": 0.6, "clearcoat": 1.0}),
    (usd_preview, {"diffuseColor": WHITE}),
]


@pytest.mark.parametrize(("model", "inputs"), FURNACES)
def test_white_surfaces_vanish_in_a_white_environment(model, inputs):
    p = model.parameters(**inputs)
    np.testing.assert_allclose(model.surface(Light(VIEWS), p), 1.0, atol=1e-6)


@pytest.mark.parametrize("weight", ["transmission_weight", "base_metalness", "subsurface_weight"])
def test_clear_glass_and_mixtures_lose_no_light(weight):
    """White glass, white metal and white subsurface scattering lose no light."""
    p = open_pbr.parameters(**{weight: 1.0}, base_color=WHITE, subsurface_color=WHITE)
    total = open_pbr.surface(Light(VIEWS), p) + open_pbr.surface(Light(VIEWS, behind=True), p)
    np.testing.assert_allclose(total, 1.0, atol=1e-6)


def test_an_undarkened_coat_keeps_the_albedo_along_the_normal():
    """For a smooth coat over a matte base, the albedo is E_c = lerp(F_0, 1, E_b)."""
    color, coat = (0.2, 0.5, 0.9), {"coat_weight": 1.0, "coat_darkening": 0.0}
    p = open_pbr.parameters(base_color=color, specular_weight=0.0, **coat)
    f0 = (0.6 / 2.6) ** 2
    expected = f0 + (1.0 - f0) * np.array([color])
    found = open_pbr.surface(Light(VIEWS[-1:]), p)
    np.testing.assert_allclose(found, expected, atol=1e-6)


@pytest.mark.parametrize("model", [open_pbr, standard_surface])
def test_emission_below_a_full_coat_has_its_color(model):
    color = {"coat_color": (0.5, 0.25, 1.0)}
    lit = {"emission_luminance": 2.0} if model is open_pbr else {"emission": 2.0}
    weight = {"coat_weight": 1.0} if model is open_pbr else {"coat": 1.0}
    found = model.emission(Light(VIEWS), model.parameters(**color, **lit, **weight))
    np.testing.assert_allclose(found[:, 0] / found[:, 2], 0.5)
    np.testing.assert_allclose(found[:, 1] / found[:, 2], 0.25)


@pytest.mark.whole
@pytest.mark.parametrize("spec", SENTENCES)
def test_named_forms_are_others_than_the_text(spec):
    [batch] = spec.batches(Counts())
    text, *forms, _ = (each.values(batch) for each in spec.value_candidates)
    assert np.isfinite(text).all()
    assert all(np.abs(form - text).max() > 1e-4 for form in forms)


def test_an_unknown_parameter_is_refused_by_name():
    with pytest.raises(TypeError, match="^parameters are base_weight, .*; got base_colour$"):
        open_pbr.parameters(base_colour=WHITE)
