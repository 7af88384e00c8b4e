# SPDX-License-Identifier: Apache-2.0
"""Arrays of Dr.Jit: values of every function that takes them, and what is refused."""

from functools import partial

import numpy as np
import pytest

from mxeon import mitsuba, models
from mxeon.albedo import fon_albedo_dir
from mxeon.models import eon_brdf, unchecked
from mxeon.models.core import drjit_arrays
from mxeon.models.core.edges import power
from mxeon.models.diffuse import formulas
from mxeon.models.microfacet.missing import missing_light
from tests.fuzz import arguments
from tests.support.availability import available
from tests.support.tolerances import DRJIT_MISSING, DRJIT_SLOPE, DRJIT_VALUE
from tools.site.arrays import takes_drjit

SEED, PAIRS = 3, 500
COLOR = (0.25, 0.5, 1.0)  # exact in float32
MATERIAL = {"sigma": 0.5, "ior": 1.5, "extinction": (3.0, 2.0, 1.0), "exponent": 5.0}
FUNCTIONS = {n: f for n, f in arguments.functions().items() if takes_drjit(f)}


@pytest.fixture
def llvm():
    """Dr.Jit's types for LLVM, if it can run."""
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("llvm_ad_rgb")
    with available("mitsuba"):
        mitsuba.register()
    return pytest.importorskip("drjit.llvm.ad")


def directions(rng):
    """Unit vectors in float32."""
    w = rng.normal(size=(PAIRS, 3))
    w[:, 2] = np.abs(w[:, 2]) + 0.05
    return (w / np.linalg.norm(w, axis=1, keepdims=True)).astype(np.float32)


def material(name, function):
    """A material of a function, in plain numbers."""
    names = list(arguments.base(function))
    row = {key: MATERIAL.get(key, COLOR) for key in names if key not in ("wo", "wi")}
    row |= {"roughness": 0.5} if "roughness" in row else {}
    row |= {"ior": (0.25, 0.5, 1.5)} if "conductor" in name else {}
    switches = {"retroreflective": True, "compensate": "conductor" not in name}
    return row | {key: value for key, value in switches.items() if key in names}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_values_are_those_of_numpy(llvm, name):
    rng, function = np.random.default_rng(SEED), FUNCTIONS[name]
    wo, wi = directions(rng), directions(rng)
    row = material(name, function)
    expected = function(wo, wi, **row)
    with unchecked():
        value = np.array(function(*(llvm.Array3f(w.T.copy()) for w in (wo, wi)), **row)).T
    error = np.abs(value - expected) / np.maximum(1.0, expected)  # one value may stand for all
    assert error.shape == expected.shape and error.max() <= DRJIT_VALUE


def test_a_whole_exponent_is_a_product(llvm):
    x = np.array([0.0, 0.3, 2.0], np.float32)
    for exponent in (3.0, llvm.Float(3.0)):
        assert np.allclose(power(llvm.Float(x), exponent), x * x * x, 3e-7, 0.0)


@pytest.mark.parametrize("exponent", (0.5, 4.5))
def test_a_broken_exponent_gives_the_values_of_numpy(llvm, exponent):
    rng, row = np.random.default_rng(SEED), (COLOR, 0.9, 1.0, 0.5, exponent)
    wo, wi = directions(rng), directions(rng)
    expected = models.generalized_schlick_brdf(wo, wi, *row)
    with unchecked():
        views = (llvm.Array3f(w.T.copy()) for w in (wo, wi))
        value = np.array(models.generalized_schlick_brdf(*views, *row)).T
    assert (np.abs(value - expected) / np.maximum(1.0, expected)).max() <= DRJIT_VALUE


@pytest.mark.parametrize("kind", ("Float", "Float64"))
@pytest.mark.parametrize("alpha", (0.0, 2.0**-60, 0.0078125, 0.5, 1.0))
def test_the_light_that_facets_miss_is_that_of_numpy(llvm, kind, alpha):
    import drjit as dr

    number = getattr(llvm, kind)
    mu = np.concatenate([[0.0, 1.0], np.geomspace(1e-37, 1.0, 5000), np.linspace(0.0, 1.0, 5000)])
    mu = mu.astype(np.float32)
    expected = missing_light(mu.astype(np.float64), np.array(alpha))
    cosine = number(mu)
    dr.enable_grad(cosine)
    found = missing_light(cosine, number(alpha))
    assert np.abs(np.array(found) - expected).max() <= DRJIT_MISSING
    # Compare the slopes over the logarithm, where no end is near.
    dr.backward(dr.sum(found), dr.ADFlag.Default | dr.ADFlag.AllowNoGrad)  # a mirror has none
    inside = (mu > 1e-3) & (mu < 0.998)
    exact = mu[inside].astype(np.float64)
    ends = [missing_light(exact * (1.0 + h), np.array(alpha)) for h in (1e-4, -1e-4)]
    slope = np.broadcast_to(dr.grad(cosine), mu.shape)[inside] * exact
    assert np.abs(slope - (ends[0] - ends[1]) / 2e-4).max() <= DRJIT_SLOPE


def test_the_light_that_facets_miss_takes_an_alpha_each(llvm):
    mu, alpha = (np.random.default_rng(SEED).random((2, PAIRS)).astype(np.float32)).astype(float)
    found = np.array(missing_light(llvm.Float(mu), llvm.Float(alpha)))
    assert np.abs(found - missing_light(mu, alpha)).max() <= DRJIT_VALUE


def test_gradients_by_the_parameters_are_those_of_differences(llvm):
    import drjit as dr

    rng = np.random.default_rng(SEED)
    wo, wi = directions(rng), directions(rng)
    color, roughness = llvm.Array3f(*COLOR), llvm.Float(0.5)
    dr.enable_grad(color, roughness)
    with unchecked():
        value = eon_brdf(llvm.Array3f(wo.T.copy()), wi[0], color, roughness)
    dr.backward(dr.mean(dr.sum(value, axis=0)))
    step = 1e-4
    total = partial(lambda r: eon_brdf(wo, wi[0], COLOR, r).sum() / PAIRS)
    slope = (total(0.5 + step) - total(0.5 - step)) / (2.0 * step)
    assert np.array(dr.grad(roughness)).item() == pytest.approx(slope, abs=1e-5)
    assert np.array(dr.grad(color)).min() > 0.0


def test_values_are_not_checked_and_that_is_said(llvm):
    up = llvm.Array3f(0.0, 0.0, 1.0)
    with pytest.raises(ValueError, match=r"^arrays of Dr.Jit have no values .* mxeon.models.unch"):
        eon_brdf(up, up, 0.5, 0.5)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda up: fon_albedo_dir(up[2], 0.5), "^arrays must not be Dr.Jit's: the page on arrays"),
        (lambda up: eon_brdf(up, np.eye(3), 0.5, 0.5), r"^beside arrays of Dr.Jit, .* \(3, 3\)"),
        (
            lambda up: models.conductor_brdf(up, up, 0.3, 1.0, 1.0),
            "^arrays of Dr.Jit need compensa",
        ),
    ],
)
def test_what_they_do_not_do_is_refused(llvm, call, message):
    with unchecked(), pytest.raises(ValueError, match=message):
        call(llvm.Array3f(0.0, 0.0, 1.0))


def test_formulas_take_scalar_arrays_and_functions_do_not():
    drjit = pytest.importorskip("drjit.scalar")
    mu_o, mu_i, s = np.array([0.3, 1.0, 0.0]), np.array([0.7, 0.4, 0.0]), np.array([0.2, 0.0, -0.5])
    expected = formulas.eon_brdf_mu(mu_o, mu_i, s, np.array(0.7), np.array(0.4))
    value = formulas.eon_brdf_mu(*map(drjit.ArrayXf, (mu_o, mu_i, s)), 0.7, 0.4)
    np.testing.assert_allclose(np.array(value), expected, 1e-6)
    up = drjit.Array3f(0.0, 0.0, 1.0)
    with unchecked(), pytest.raises(ValueError, match="^arrays of Dr.Jit must be compiled ones"):
        eon_brdf(up, up, 0.5, 0.5)


def test_the_logarithm_of_what_is_next_to_1_keeps_its_digits(llvm):
    x = np.geomspace(1e-7, 10.0, 64, dtype=np.float32)
    log1p = drjit_arrays.drjit_namespace.__wrapped__().log1p
    assert np.array(log1p(llvm.Float(x))) == pytest.approx(np.log1p(x), rel=DRJIT_VALUE)
