# SPDX-License-Identifier: Apache-2.0
"""Hair lobes are normalized, lose no light, and match 50-digit arithmetic and Mitsuba."""

import itertools

import mpmath as mp
import numpy as np
import pytest

from mxeon.models.hair import (
    TEXT,
    azimuthal,
    bessel_scaled,
    chiang_hair_attenuation,
    chiang_hair_bcsdf,
    longitudinal,
    section,
    tilted_share,
)
from mxeon.models.nodes.lobes import FORMS, READINGS, TILTED, materialx_longitudinal
from tests.support.availability import package
from tests.support.hemispheres import sphere

ROUND = 1e-14  # relative error of about 45 float64 roundings
PICK = {"roughness_R": (0.5, 0.6), "roughness_TT": (0.3, 0.4), "roughness_TRT": (0.8, 0.9)}
VIEWS = np.array([[0.0, 0.0, 1.0], [0.6, 0.3, 0.0], [-0.95, -0.2, 0.0]])
VIEWS[:, 2] = np.sqrt(1.0 - (VIEWS[:, :2] ** 2).sum(axis=1))


def inclined(theta):
    return np.sin(theta), np.cos(theta)


def furnace(wo, **inputs):
    """Integral of the scattering function over the sphere, one value per color channel."""
    wi, weights = sphere(96)
    return (weights[:, np.newaxis] * chiang_hair_bcsdf(wo, wi, **PICK | inputs)).sum(axis=0)


def test_the_scaled_bessel_function_has_the_value_of_50_digits():
    x = np.array([0.0, 1e-9, 0.5, 3.0, 12.0, 19.99, 20.0, 20.01, 100.0, 3000.0])
    exact = [float(mp.besseli(0, mp.mpf(each)) * mp.exp(-mp.mpf(each))) for each in map(float, x)]
    np.testing.assert_allclose(bessel_scaled(x), exact, rtol=ROUND)
    assert bessel_scaled(np.array(1e300)) == pytest.approx(1.0 / np.sqrt(2e300 * np.pi), rel=ROUND)


@pytest.mark.parametrize("v", [1e-3, 0.01, 0.05, 0.3, 1.0, 2.0, 30.0, 100.0])
def test_the_longitudinal_function_has_the_value_of_50_digits(v):
    for theta_i, theta_o in [(0.3, -0.2), (-1.2, 1.3), (0.0, 0.0), (1.5, 1.5)]:
        a, b, u = mp.mpf(theta_i), mp.mpf(theta_o), mp.mpf(v)
        value = mp.exp(-mp.sin(a) * mp.sin(b) / u) * mp.besseli(0, mp.cos(a) * mp.cos(b) / u)
        value /= 2 * u * mp.sinh(1 / u)
        found = longitudinal(*inclined(theta_i), *inclined(theta_o), np.float64(v))
        assert found == pytest.approx(float(value), rel=ROUND / min(v, 1.0))


@pytest.mark.parametrize("s", [0.01, 0.3, 2.0, 100.0])
def test_the_azimuthal_function_is_normalized(s):
    x, w = np.polynomial.legendre.leggauss(400)
    phi = np.pi * x * x * x  # nodes are dense inside narrow lobes
    norm = (3.0 * np.pi * x * x * w * azimuthal(phi, s)).sum()
    assert norm == pytest.approx(1.0, abs=1e-6)
    turned, near = azimuthal(0.4 + np.pi * np.array([4.0, 0.0]), s)
    assert turned == pytest.approx(near)


@pytest.mark.parametrize("ior", [0.5, 1.0, 1.55, 3.0])
def test_attenuations_sum_to_1_without_absorption_and_to_less_with_it(ior):
    wo, _ = sphere(12)
    wo = np.concatenate([wo[wo[:, 2] >= 0.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])
    clear, dark = (chiang_hair_attenuation(wo, ior, each) for each in (0.0, (0.1, 5.0)))
    np.testing.assert_allclose(clear.sum(axis=-1), 1.0, rtol=ROUND)
    assert (dark >= 0.0).all() and (dark.sum(axis=-1) <= 1.0 + ROUND).all()


@pytest.mark.parametrize("wo", VIEWS)
def test_a_white_furnace_returns_all_light_over_pi(wo):
    np.testing.assert_allclose(furnace(wo), 1.0 / np.pi, atol=1e-9)
    later = READINGS["no factor 1/pi, as in later versions of the text"]
    np.testing.assert_allclose(furnace(wo, form=later), 1.0, atol=1e-9)


def test_a_furnace_with_absorption_returns_the_attenuations():
    wo, absorption = VIEWS[1], np.array([0.1, 0.5, 3.0])
    factors = chiang_hair_attenuation(wo, 1.55, absorption)
    value = furnace(wo, absorption_coefficient=absorption)
    np.testing.assert_allclose(value, factors.sum(axis=-1) / np.pi, atol=1e-9)


def test_only_a_tilt_of_the_viewer_keeps_the_furnace():
    # If a cuticle's tilt of two degrees is applied as specified, rough hair loses 2 % of the light
    # in a slanted view.
    cuticle = 0.5 + 2.0 / 180.0
    tilted = np.pi * furnace(VIEWS[2], cuticle_angle=cuticle)
    np.testing.assert_allclose(tilted, 0.9775, atol=1e-3)
    viewer = np.pi * furnace(VIEWS[2], cuticle_angle=cuticle, form=FORMS[TILTED])
    np.testing.assert_allclose(viewer, 1.0, atol=1e-9)


def test_the_sign_of_a_tilted_cosine_has_no_effect():
    a = [np.array(each) for each in (0.6, 0.8, 0.28, 0.96, 0.01)]
    assert longitudinal(*a) == longitudinal(a[0], -a[1], *a[2:])


def test_the_ten_terms_of_materialx_are_off_by_2_percent():
    # For x < 12, MaterialX's series of I_0(x) lacks the tenth and higher powers of x^2.
    sine, cosine, v = np.array(0.0), np.array(1.0), np.array(1.0 / 11.9)
    exact = longitudinal(sine, cosine, sine, cosine, v)
    assert materialx_longitudinal(sine, cosine, sine, cosine, v) / exact < 0.982
    v = np.array(1.0 / 12.1)  # MaterialX's expansion for x > 12 has half of the term 1 / (8 x)
    short = materialx_longitudinal(sine, cosine, sine, cosine, v)
    assert short / longitudinal(sine, cosine, sine, cosine, v) == pytest.approx(0.9944, abs=1e-3)


@pytest.mark.parametrize("form", [*FORMS.values(), *READINGS.values()])
def test_each_form_has_other_values(form):
    wi, _ = sphere(6)
    inputs = {**PICK, "roughness_R": (0.05, 3.0), "cuticle_angle": 0.6}
    values = [chiang_hair_bcsdf(VIEWS[1], wi, **inputs, form=each) for each in (TEXT, form)]
    assert not np.allclose(*values, rtol=1e-5)


@pytest.mark.parametrize("tilt", [0.0, 3.0])
def test_mitsuba_has_the_values_of_the_model(tilt):
    """Mitsuba follows [Chiang2016], without a factor 1 / pi. The tilt applies to the viewer."""
    mi = package("mitsuba")
    mi.set_variant("scalar_rgb")
    absorption, beta = (0.1, 0.2, 0.3), 0.6
    v, s = (0.726 * beta + 0.812 * beta**2 + 3.7 * beta**20) ** 2, 0.265 * beta + 1.194 * beta**2
    s += 5.372 * beta**22
    fiber = {"type": "hair", "longitudinal_roughness": beta, "azimuthal_roughness": beta}
    fiber |= {"scale_tilt": tilt, "int_ior": 1.55, "ext_ior": 1.0}
    bsdf = mi.load_dict(fiber | {"sigma_a": {"type": "rgb", "value": list(absorption)}})
    point = mi.SurfaceInteraction3f()
    for wo, wi in zip(VIEWS[1:], [[0.2, -0.5, 0.4], [0.1, 0.3, -0.9]], strict=True):
        wi = np.array(wi) / np.linalg.norm(wi)
        point.wi = mi.Vector3f(*wo[[1, 0, 2]])  # Mitsuba's hair fibers point along +y
        value = np.array(bsdf.eval(mi.BSDFContext(), point, mi.Vector3f(*wi[[1, 0, 2]])))
        rough = {"roughness_R": (v, s), "roughness_TT": (v / 4.0, s), "roughness_TRT": (4.0 * v, s)}
        cuticle = {"cuticle_angle": 0.5 - tilt / 180.0, "form": FORMS[TILTED]}
        inputs = rough | cuticle | {"absorption_coefficient": absorption}
        expected = np.pi * chiang_hair_bcsdf(wo, wi, **inputs)
        np.testing.assert_allclose(value, expected, rtol=2e-6)


@pytest.mark.parametrize("theta", [0.0, 0.7, -1.3])
def test_a_tilted_lobe_has_the_light_of_its_limits(theta):
    """M_p is a delta function at variance 0, and is 1/2 at infinite variance."""
    view, _ = section(np.array([np.sin(theta), 0.0, np.cos(theta)]), np.array(1.55))

    def share(v, tilt):
        return float(tilted_share(view, np.array(v), np.array(tilt)))

    for tilt in (-2.0, -0.3, 0.1, 1.9):
        peak = max(np.cos(theta + tilt), 0.0) + max(-np.cos(theta - tilt), 0.0)
        assert share(1e-12, tilt) == pytest.approx(peak / np.cos(theta), abs=1e-5)
        assert share(1e9, tilt) == pytest.approx(1.0, abs=1e-8)
    for v, tilt in itertools.product([1e-6, 0.1, 3.0], [0.0, np.pi, -2.0 * np.pi]):
        assert share(v, tilt) == pytest.approx(1.0, abs=1e-12)
