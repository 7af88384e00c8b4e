# SPDX-License-Identifier: Apache-2.0
"""The shader twins: OSL written from GLSL, and the values of the GLSL against float64."""

import inspect
import re

import numpy as np
import pytest

from mxeon.models.diffuse import albedo, formulas, qon_albedo
from mxeon.models.diffuse import brdf as models
from mxeon.models.microfacet.ggx_albedo import ggx_albedo_dir
from mxeon.models.sheen import conty_kulla_albedo_dir
from mxeon.shaders.functions import source_file
from tests.support.cases import directions_32
from tests.support.tolerances import FIT_GGX, TWIN_ALBEDO, TWIN_LOSS, TWIN_VALUE

ALBEDOS_OF_NODES = ("ggx_albedo", "conty_kulla_albedo")
FITTED_ROUNDING = 32 * 2.0**-24  # of a rational function in float32
VALUES = (
    models.lambert_brdf,
    models.oren_nayar_brdf,
    models.qon_brdf,
    models.qon_footnote_brdf,
    models.qon_fujii_brdf,
    models.fon_brdf,
    models.eon_brdf,
    models.eon_brdf_approx,
)
ALBEDOS = (
    qon_albedo.qon_albedo_dir,
    qon_albedo.qon_albedo_avg,
    albedo.fon_albedo_dir,
    albedo.fon_albedo_dir_approx,
    albedo.fon_albedo_avg,
    albedo.eon_albedo_dir,
    albedo.eon_albedo_dir_approx,
    albedo.eon_albedo_avg,
)


def text(language, stem):
    return source_file(language, stem).read_text(encoding="utf-8")


def materials(rng, count):
    """Reflectances and roughnesses in float32; the first two are corners of their ranges."""
    corners = np.float32([[0.0] * 3, [1.0] * 3])
    roughness = np.append([1.0, 0.0], rng.random(count - 2)).astype("f4")
    rho = np.append(corners, rng.random((count - 2, 3), "f4"), axis=0)
    return {"rho": rho, "roughness": roughness, "sigma": np.float32(1.57) * roughness}


def twin_error(gl, function, columns):
    """Values of the twin of a Python function less those of the function, (N, C)."""
    arguments = [columns[name] for name in inspect.signature(function).parameters]
    exact = function(*arguments)
    return gl.call(function.__name__, *arguments) - exact.reshape(len(exact), -1)


def name_of(function):
    return function.__name__


@pytest.mark.parametrize("function", VALUES, ids=name_of)
def test_twin_values_agree_with_float64_down_to_grazing(gl, function):
    rng = np.random.default_rng(1)
    wo, wi = directions_32(rng, 100_000), directions_32(rng, 100_000)
    error = twin_error(gl, function, {"wo": wo, "wi": wi} | materials(rng, 100_000))
    assert np.max(np.abs(np.pi * error * wi[:, 2:])) <= TWIN_VALUE


@pytest.mark.parametrize("function", VALUES, ids=name_of)
def test_twin_values_agree_with_float64_on_the_edges_of_the_domain(gl, function):
    axes = np.float32([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, 0, 1], [0.6, 0, 0.8]])
    o, i, rho, parameter = map(np.ravel, np.meshgrid(range(5), range(5), [0.0, 1.0], [0.0, 1.0]))
    columns = {"wo": axes[np.intp(o)], "wi": axes[np.intp(i)], "rho": np.repeat(rho[:, None], 3, 1)}
    error = twin_error(gl, function, columns | {"sigma": parameter, "roughness": parameter})
    assert np.max(np.abs(np.pi * error)) <= TWIN_VALUE


@pytest.mark.parametrize("function", ALBEDOS, ids=name_of)
def test_twin_albedos_agree_with_float64_on_the_closed_domain(gl, function):
    rng = np.random.default_rng(2)
    mu = np.append([0.0, 1.0], 10.0 ** rng.uniform(-8, 0, 9_998)).astype("f4")
    error = twin_error(gl, function, {"mu": mu} | materials(rng, 10_000))
    assert np.max(np.abs(error)) <= TWIN_ALBEDO


def test_twin_loss_keeps_its_relative_accuracy_down_to_grazing(gl):
    mu = np.logspace(-8, 0, 100_000).astype("f4")
    error = gl.call("fon_loss", mu)[:, 0] / formulas.fon_loss(np.float64(mu)) - 1.0
    assert np.max(np.abs(error)) <= TWIN_LOSS


NODE_ALBEDOS = (
    ("ggx_albedo", ggx_albedo_dir, FIT_GGX),
    ("conty_kulla_albedo", conty_kulla_albedo_dir, 1.5e-3),
)


@pytest.mark.parametrize("stem, function, fit", NODE_ALBEDOS, ids=ALBEDOS_OF_NODES)
def test_the_osl_of_an_albedo_is_the_model_up_to_its_fit(hosts, stem, function, fit):
    mu, roughness = 10.0 ** np.random.default_rng(1).uniform(-2.0, 0.0, (2, 4096))
    columns = [each.astype(np.float32).astype(np.float64) for each in (mu, roughness)]
    exact = np.minimum(function(*columns), 1.0)

    def error(text):
        values = hosts("osl").execute(text, function.__name__, *columns)[:, 0]
        return np.abs(values - exact).max()

    right = text("osl", stem)
    wrong = re.sub(r"(define \w+_N10) (\S+)", r"\1 (1.1 * \2)", right)
    assert error(right) <= fit + FITTED_ROUNDING < error(wrong)
