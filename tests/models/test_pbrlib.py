# SPDX-License-Identifier: Apache-2.0
"""Functions and variants of pbrlib's nodes have the properties that the table of nodes states."""

from itertools import chain

import numpy as np
import pytest

from mxeon.models.core.quadrature import hemisphere_nodes
from mxeon.models.diffuse import burley_albedo_dir
from mxeon.models.hair import DEFAULTS
from mxeon.models.media import blackbody_xyz, kang_xyz
from mxeon.models.microfacet import defects as materialx_fits
from mxeon.models.microfacet import dielectric_albedo_dir
from mxeon.models.microfacet.ggx import ggx_albedo_dir
from mxeon.models.nodes import PBR_NODES, node
from mxeon.models.nodes.combinations import COMBINATIONS, NESTED, ROUGHNESS
from mxeon.models.nodes.lobes import HAIR_NODE, circle_blur
from mxeon.models.nodes.microfacets import CONDUCTOR_LOBE, FILM_NODES, LOBES, MICROFACET_NODES
from mxeon.models.nodes.renderers import BSDL_VARIANTS, CYCLES_VARIANTS
from mxeon.models.sheen import conty_kulla_albedo_dir
from tests.support.cases import direction, directions

COUNT = 6
WO = directions(COUNT, seed=2, least=0.2)
ROWS = PBR_NODES + COMBINATIONS
RENDERERS = BSDL_VARIANTS, CYCLES_VARIANTS
VECTORS = ("color", "tint", "color0", "color82", "color90", "extinction")
INTEGRAL = 2e-3  # quadrature error of 48 x 48 nodes, for alpha >= 0.4 and roughness 0.5
PRINTED = 5e-6  # half a unit of the sixth significant digit


def inputs(row, count=COUNT):
    """Random inputs of a node, away from the ends of their ranges."""
    rng = np.random.default_rng(1)
    values = {}
    for name in row.inputs:
        colored = name in VECTORS or (row.category == "conductor_bsdf" and name == "ior")
        colored |= name.endswith("/color") or (name.endswith("in2") and "color3" in row.name)
        shape = (count, 3) if colored else (count,)
        values[name] = 0.3 + 0.6 * rng.random(shape)
        if name == "exponent":
            values[name] = 5.0 * values[name]
        if name in ("ior", "thinfilm_ior"):
            values[name] = 1.0 + values[name]
        if name == "thinfilm_thickness":
            values[name] = 500.0 * values[name]
        if name in ROUGHNESS and row.name in NESTED:
            # The lobes are rough, so the albedo of the sum exceeds 1.
            values[name] = 0.9 + 0.1 * rng.random(count)
        if name == "roughness" and row in MICROFACET_NODES + FILM_NODES:
            values[name] = np.repeat(0.4 + 0.5 * rng.random((count, 1)), 2, axis=1)
    return values


def test_an_unknown_node_lists_the_known_ones():
    assert node("burley") is PBR_NODES[0]
    with pytest.raises(ValueError, match="^node must be one of burley, .*, schlick; got 'hair'$"):
        node("hair")


@pytest.mark.parametrize("row", ROWS)
def test_values_integrate_to_the_albedo(row):
    wo, values = WO, inputs(row)
    expected = (row.integral or row.albedo)(wo, values)
    for number in range(COUNT):
        view = direction(wo[number : number + 1, 2])
        _, wi, weights = hemisphere_nodes(float(wo[number, 2]), 48)
        wi = wi * [1.0, 1.0, -1.0 if row.transmits else 1.0]
        rows = np.full(len(wi), number)
        one = {name: each[rows] for name, each in values.items()}
        f = row.value(np.repeat(view, len(wi), axis=0), wi, one)
        albedo = (weights[:, np.newaxis] * f).sum(axis=0)  # the weights include the cosine
        np.testing.assert_allclose(albedo, expected[number], rtol=0.0, atol=INTEGRAL)


@pytest.mark.parametrize("row", [row for row in ROWS if not row.transmits])
def test_a_node_is_reciprocal_if_its_row_says_so(row):
    wo, wi, values = WO, WO[::-1], inputs(row)
    forth, back = row.value(wo, wi, values), row.value(wi, wo, values)
    assert np.allclose(forth, back, rtol=1e-13) == row.reciprocal


@pytest.mark.parametrize("row", ROWS + FILM_NODES)
def test_each_variant_has_another_value_or_another_albedo(row):
    """The test covers all variants of a node, including variants of OSL's BSDL and of Cycles."""
    wo, wi, values = WO, WO[::-1], inputs(row)
    others = (each.get(row.name, ()) for each in RENDERERS)
    for variant in chain(row.variants, *others):
        if variant.value:
            value = variant.value(wo, wi, values)
            same = np.allclose(value, row.value(wo, wi, values), rtol=1e-6)
            assert np.isfinite(value).all()
            assert not same or variant.title == "Smith at the geometric mean"
        if variant.albedo:
            albedo = variant.albedo(wo, values)
            assert albedo.shape == (COUNT, 3) and np.isfinite(albedo).all()
            assert not np.allclose(albedo, row.albedo(wo, values), rtol=1e-6)


@pytest.mark.parametrize("variants", RENDERERS, ids=["BSDL", "Cycles"])
def test_color82_counts_as_1_in_renderers_of_osl(variants):
    wo, wi, values = WO, WO[::-1], inputs(node("schlick"))
    both = values, values | {"color82": np.full((COUNT, 3), 0.9)}
    for each in variants["schlick"]:
        assert not each.value or np.array_equal(*(each.value(wo, wi, given) for given in both))
        assert not each.albedo or np.array_equal(*(each.albedo(wo, given) for given in both))


@pytest.mark.parametrize("row", MICROFACET_NODES)
def test_a_mirror_reflects_all_light_and_prefiltered_what_the_fit_says(row):
    wo, values = WO, inputs(row)
    for name, value in row.mirror.items():
        values[name] = np.broadcast_to(value, values[name].shape)
    np.testing.assert_allclose(row.albedo(wo, values), 1.0, atol=1e-5)
    mu, alpha = wo[:, 2], values["roughness"][:, 0]
    share = materialx_fits.fitted_albedo(mu, alpha, 1.0, 1.0) / ggx_albedo_dir(mu, alpha)
    found = LOBES[row.category].prefiltered(wo, values)
    np.testing.assert_allclose(found, np.stack([share] * 3, -1), atol=1e-5)


def test_the_fits_of_materialx_have_the_values_of_its_shaders():
    grazing = np.array([[1.0, 0.0, 1e-7]])
    rough = {"roughness": np.ones(1), "color": np.ones((1, 3))}
    # 0.230783895 is a sheen albedo times the tint 0.42389375, as returned by the gl host. 1.55754
    # is a constant in MaterialX's fit of the Burley albedo.
    sheen = materialx_fits.conty_kulla_albedo(grazing, rough)
    np.testing.assert_allclose(sheen, 0.230783895 / 0.42389375, rtol=PRINTED)
    np.testing.assert_allclose(materialx_fits.burley_albedo(grazing, rough), 1.55754, rtol=PRINTED)
    # If F = F0 = F90 = 1, the compensation adds exactly the energy loss that the fit predicts.
    lobe = {"roughness": np.full((COUNT, 2), 0.4)}
    white = materialx_fits.layer_albedo(WO, lobe, np.ones((COUNT, 1)), 1.0, np.ones((COUNT, 1)))
    np.testing.assert_allclose(white, 1.0, rtol=1e-12)


def burley_error(mu, roughness):
    inputs = {"roughness": roughness, "color": np.ones((len(mu), 1))}
    exact = burley_albedo_dir(mu, 1.0, roughness)
    return materialx_fits.burley_albedo(mu[..., np.newaxis] * [0.0, 0.0, 1.0], inputs) - exact


def conty_kulla_error(mu, roughness):
    exact = np.minimum(conty_kulla_albedo_dir(mu, roughness), 1.0)
    wo = mu[..., np.newaxis] * [0.0, 0.0, 1.0]
    return materialx_fits.conty_kulla_albedo(wo, {"roughness": roughness})[:, 0] - exact


def kang_error(share, _):
    kelvin = 1667.0 * (25000.0 / 1667.0) ** share
    colors = kang_xyz(kelvin), blackbody_xyz(kelvin)
    x, exact = (each[:, :2] / each.sum(axis=1)[:, np.newaxis] for each in colors)
    return x - exact


@pytest.mark.parametrize(
    ("error", "low", "stated"),
    [
        (lambda x, y: materialx_fits.fitted_albedo(x, y, 1.0, 1.0) - ggx_albedo_dir(x, y), 1e-3, 0.14),
        (burley_error, 0.0, 0.0174),
        (conty_kulla_error, 0.01, 0.0705),
        (kang_error, 0.0, 6e-4),
    ],
)  # fmt: skip
def test_a_fit_of_others_has_the_error_that_stands_beside_it(error, low, stated):
    grid = np.unique(np.concatenate([low + (1.0 - low) * np.linspace(0.0, 1.0, 31), [2.0 * low]]))
    largest = np.abs(error(*(each.ravel() for each in np.meshgrid(grid, grid)))).max()
    assert 0.9 * stated < largest <= stated


def test_the_environment_of_materialx_hair_is_a_dielectric():
    [ggx] = [each for each in HAIR_NODE.variants if each.title.startswith("a GGX lobe")]
    rough = dict.fromkeys(("roughness_R", "roughness_TT", "roughness_TRT"), (0.3, 0.3))
    values = {name: np.tile(value, (COUNT, 1)) for name, value in {**DEFAULTS, **rough}.items()}
    expected = dielectric_albedo_dir(WO, 1.0, (0.3, 0.3), 1.55)
    found = ggx.albedo(WO, values | {"ior": np.full(COUNT, 1.55)})
    assert found == pytest.approx(np.repeat(expected, 3, axis=-1), rel=1e-12)


def test_a_film_of_no_thickness_leaves_the_albedo_of_a_metal():
    [row] = [each for each in FILM_NODES if each.category == "conductor_bsdf"]
    shapes = {"ior": (0.5, 3), "extinction": (3.0, 3), "roughness": (0.4, 2)}
    metal = {name: np.full((2, size), value) for name, (value, size) in shapes.items()}
    film = {"thinfilm_thickness": np.array([0.0, 400.0]), "thinfilm_ior": np.array([1.3, 1.3])}
    wo, curve = WO[:2], 1e-4  # error of the polynomial for a film's curve, see `film_albedo_dir`
    bare = CONDUCTOR_LOBE.albedo(wo, metal)
    for albedo in (row.albedo, row.integral, CONDUCTOR_LOBE.albedo):
        found = albedo(wo, metal | film)
        assert found[0] == pytest.approx(bare[0], abs=curve)
        assert np.abs(found[1] - bare[1]).max() > 10.0 * curve


def test_the_circle_of_materialx_is_nearly_lambert_and_leaks_over_the_horizon():
    mu = np.array([-0.5, -0.05, 0.3, 1.0])
    narrow, wide = (circle_blur(mu, np.full((4, 1), radius))[:, 0] for radius in (0.1, 10.0))
    assert narrow == pytest.approx(np.maximum(mu, 0.0), abs=0.05)
    assert 0.01 < narrow[1] < wide[1]
