# SPDX-License-Identifier: Apache-2.0
"""Microfacet BRDFs: limits, invariants, and agreement with the printed equations in 50 digits."""

import mpmath as mp
import numpy as np
import pytest

from mxeon.models import (
    conductor_brdf,
    dielectric_brdf,
    fresnel_conductor_avg,
    fresnel_dielectric_avg,
    fresnel_schlick_avg,
    generalized_schlick_brdf,
    smith_g1,
    smith_g2,
    smith_g2_anisotropic,
)
from mxeon.models.microfacet import ggx_albedo_dir_anisotropic, node_brdf
from mxeon.models.microfacet.defects import MICROFACET_DEFECTS
from mxeon.models.microfacet.ggx import ggx_albedo_dir, ndf
from mxeon.models.nodes.microfacets import MICROFACET_NODES
from tests.support import tolerances
from tests.support.cases import direction, directions
from tests.support.hemispheres import hemisphere

GOLD = [0.183, 0.421, 1.373], [3.424, 2.346, 1.77]
COLORS = [0.9, 0.2, 0.0], [0.5, 1.0, 0.1], [1.0, 0.8, 1.0]
BRDFS = {
    "dielectric_bsdf": lambda wo, wi, alpha, *a: dielectric_brdf(
        wo, wi, [0.2, 1.0, 0.5], alpha, 1.5, *a
    ),
    "conductor_bsdf": lambda wo, wi, alpha, *a: conductor_brdf(wo, wi, alpha, *GOLD, *a),
    "generalized_schlick_bsdf": lambda wo, wi, alpha, *a: generalized_schlick_brdf(
        wo, wi, *COLORS, alpha, 5.0, *a
    ),
}
INPUTS = {
    "dielectric_bsdf": {"tint": [0.2, 1.0, 0.5], "ior": 1.5},
    "conductor_bsdf": {"ior": GOLD[0], "extinction": GOLD[1]},
    "generalized_schlick_bsdf": dict(zip(("color0", "color82", "color90"), COLORS, strict=True))
    | {"exponent": 5.0},
}
every_node = pytest.mark.parametrize("name", BRDFS)


def pairs(count, seed=1):
    """Random pairs of directions, and roughness with alpha >= 0.05."""
    rng = np.random.default_rng(seed)
    return *directions((2, count), rng), 0.05 + 0.95 * rng.random((count, 2))


def fresnel_exact(name, c, channel):
    """Fresnel reflectance by the printed equations of the specification."""
    if name == "generalized_schlick_bsdf":
        r0, t, r90 = (mp.mpf(color[channel]) for color in COLORS)
        m = mp.mpf(1) / 7
        a = (r0 + (r90 - r0) * (1 - m) ** 5) * (1 - t) / (m * (1 - m) ** 6)
        return max(r0 + (r90 - r0) * (1 - c) ** 5 - a * c * (1 - c) ** 6, 0)  # curve of OpenPBR
    if name == "dielectric_bsdf":
        g = mp.sqrt(mp.mpf(1.5) ** 2 + c * c - 1)
        ratio = (c * (g + c) - 1) / (c * (g - c) + 1)
        return (g - c) ** 2 / (g + c) ** 2 * (1 + ratio**2) / 2
    n, k = (mp.mpf(part[channel]) for part in GOLD)
    s = 1 - c * c
    ab = mp.sqrt((n * n - k * k - s) ** 2 + 4 * n * n * k * k)
    a = mp.sqrt((ab + n * n - k * k - s) / 2)
    rs = (ab - 2 * a * c + c * c) / (ab + 2 * a * c + c * c)
    rp = rs * (c * c * ab - 2 * a * c * s + s * s) / (c * c * ab + 2 * a * c * s + s * s)
    return (rs + rp) / 2


def exact(name, wo, wi, roughness, channel):
    """The printed BRDF in 50 digits, without compensation and tint."""
    wo, wi = ([mp.mpf(float(x)) for x in w] for w in (wo, wi))
    ax, ay = (mp.mpf(float(alpha)) for alpha in roughness)
    h = [a + b for a, b in zip(wo, wi, strict=True)]
    length = mp.sqrt(sum(x * x for x in h))
    h = [x / length for x in h]
    D = 1 / (mp.pi * ax * ay * ((h[0] / ax) ** 2 + (h[1] / ay) ** 2 + h[2] ** 2) ** 2)
    lo, li = (mp.sqrt((ax * w[0]) ** 2 + (ay * w[1]) ** 2 + w[2] ** 2) for w in (wo, wi))
    G2 = 2 * wo[2] * wi[2] / (lo * wi[2] + li * wo[2])
    return D * fresnel_exact(name, length / 2, channel) * G2 / (4 * wo[2] * wi[2])


@every_node
def test_values_agree_with_the_printed_equations_in_50_digits(name):
    wo, wi, alpha = pairs(12)
    values = BRDFS[name](wo, wi, alpha, False, False)
    tint = [0.2, 1.0, 0.5] if name == "dielectric_bsdf" else [1.0, 1.0, 1.0]
    with mp.workdps(50):
        for n, channel in np.ndindex(values.shape):
            expected = tint[channel] * exact(name, wo[n], wi[n], alpha[n], channel)
            error = abs(values[n, channel] - expected)
            assert error <= tolerances.MICROFACET * max(abs(expected), 1e-3)


@every_node
def test_without_compensation_the_value_is_reciprocal(name):
    wo, wi, alpha = pairs(200)
    forth, back = BRDFS[name](wo, wi, alpha, False, False), BRDFS[name](wi, wo, alpha, False, False)
    assert np.allclose(forth, back, rtol=tolerances.MICROFACET, atol=0.0)


@every_node
@pytest.mark.parametrize("equal", [True, False])
def test_compensation_is_that_of_the_albedo(name, equal):
    wo, wi, alpha = pairs(50)
    alpha = alpha[:, [0, 0]] if equal else alpha
    F_ss = {
        "dielectric_bsdf": fresnel_dielectric_avg(1.5),
        "conductor_bsdf": fresnel_conductor_avg(*GOLD),
        "generalized_schlick_bsdf": np.maximum(fresnel_schlick_avg(*COLORS, 5.0), 0.0),
    }[name]
    E = ggx_albedo_dir(wo[:, 2], alpha[:, 0]) if equal else ggx_albedo_dir_anisotropic(wo, alpha)
    E = E[:, None]
    expected = BRDFS[name](wo, wi, alpha, False, False) * (1.0 + F_ss * (1.0 - E) / E)
    value = BRDFS[name](wo, wi, alpha)
    assert np.allclose(value, expected, rtol=tolerances.E_SS, atol=0.0)


@every_node
def test_retroreflection_mirrors_the_view_about_the_normal(name):
    wo, wi, alpha = pairs(50)
    mirrored = BRDFS[name](wo * [-1.0, -1.0, 1.0], wi, alpha)
    assert np.array_equal(BRDFS[name](wo, wi, alpha, True), mirrored)


@every_node
def test_anisotropy_turns_with_the_tangent(name):
    wo, wi, alpha = pairs(50)
    turned = [np.stack([-w[:, 1], w[:, 0], w[:, 2]], axis=-1) for w in (wo, wi)]
    value = BRDFS[name](*turned, alpha[:, ::-1])
    assert np.allclose(value, BRDFS[name](wo, wi, alpha), rtol=tolerances.MICROFACET, atol=0.0)


@every_node
def test_values_are_finite_on_the_closed_domain(name):
    mu = np.array([0.0, 5e-324, 1e-160, 1e-8, 0.5, 1.0 - 1e-16, 1.0])
    ends = np.array([0.0, 5e-324, 1e-160, 1e-4, 0.5, 1.0])
    wo = direction(mu, 0.0)[:, None, None, None, None]
    wi = direction(mu[:, None], np.array([0.0, 2.0, np.pi]))[:, :, None, None]
    alpha = np.stack(np.meshgrid(ends, ends), axis=-1)
    values = BRDFS[name](wo, wi, alpha)
    assert np.isfinite(values).all()
    assert name == "generalized_schlick_bsdf" or (values >= 0.0).all()
    assert (values[..., 0, :, :] == 0.0).all()  # values of a perfect mirror are 0


def test_the_distribution_covers_the_surface_once():
    wh, weights = hemisphere(1.0)
    for alpha in ([0.3, 0.3], [0.4, 0.9], [1.0, 1.0]):
        assert abs(np.sum(ndf(wh.T, alpha) * wh[:, 2] * weights) - 1.0) < 1e-10


def test_masking_is_a_fraction_and_both_forms_agree_for_isotropic_roughness():
    wo, wi, alpha = pairs(200)
    isotropic = alpha[:, [0, 0]]
    G2, exact_G2 = (
        smith_g2(wo[:, 2], wi[:, 2], alpha[:, 0]),
        smith_g2_anisotropic(wo, wi, isotropic),
    )
    assert np.allclose(G2, exact_G2, rtol=tolerances.MICROFACET, atol=0.0)
    assert (G2 > 0.0).all() and (smith_g1(wo, isotropic) * (1.0 + 1e-15) >= G2).all()
    assert smith_g1([1.0, 0.0, 0.0], [0.5, 0.5]) == smith_g2(0.0, 0.0, 0.5) == 0.0
    assert smith_g1([1.0, 0.0, 0.0], [0.0, 0.0]) == smith_g2(0.5, 0.7, 0.0) == 1.0


DEFECTS = {defect.name: defect for defect in MICROFACET_DEFECTS}


COMPENSATIONS = (
    "compensation_half",
    "compensation_f0",
    "compensation_view",
    "compensation_average",
)


@pytest.mark.parametrize("exponent, equal", [(5.0, True), (2.0, False)])
def test_the_average_by_its_ends_is_that_of_schlicks_curve_of_exponent_5(exponent, equal):
    wo, wi, alpha = pairs(20)
    colors = {"color0": COLORS[0], "color82": [1.0, 1.0, 1.0], "color90": COLORS[2]}
    inputs = colors | {"exponent": exponent, "roughness": alpha}
    value = generalized_schlick_brdf(wo, wi, *colors.values(), alpha, exponent)
    same = node_brdf(
        "generalized_schlick_bsdf", wo, wi, inputs, DEFECTS["compensation_average"].lobe
    )
    assert np.allclose(same, value, rtol=tolerances.MICROFACET, atol=0.0) == equal


AVERAGE_FITTED = DEFECTS["compensation_average_fitted"].title


@pytest.mark.parametrize("row", MICROFACET_NODES, ids=lambda row: row.name)
def test_the_text_permits_the_average_by_its_ends(row):
    wo, wi, alpha = pairs(20)
    inputs = {
        name: np.broadcast_to(v, (20, *np.shape(v))) for name, v in INPUTS[row.category].items()
    }
    inputs |= {"roughness": alpha[:, [0, 0]]}
    value, albedo = (
        each for each in row.variants if each.title == AVERAGE_FITTED and each.permitted
    )
    assert value.value(wo, wi, inputs).shape == albedo.albedo(wo, inputs).shape == (20, 3)


def test_defects_agree_with_the_specification_where_they_should():
    wo, wi, alpha = pairs(20)
    white = {"color0": 1.0, "color82": 1.0, "color90": 1.0, "exponent": 5.0, "roughness": alpha}
    value = generalized_schlick_brdf(wo, wi, 1.0, 1.0, 1.0, alpha, 5.0, True)
    for name in COMPENSATIONS:
        same = node_brdf("generalized_schlick_bsdf", wo, wi, white, DEFECTS[name].lobe, True)
        assert np.allclose(same, value, rtol=tolerances.MICROFACET, atol=0.0)
    isotropic = white | {"roughness": alpha[:, [0, 0]]}
    value = generalized_schlick_brdf(wo, wi, 1.0, 1.0, 1.0, alpha[:, [0, 0]], 5.0)
    same = node_brdf("generalized_schlick_bsdf", wo, wi, isotropic, DEFECTS["smith_mean"].lobe)
    assert np.allclose(same, value, rtol=tolerances.MICROFACET, atol=0.0)
