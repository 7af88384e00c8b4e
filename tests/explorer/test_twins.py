# SPDX-License-Identifier: Apache-2.0
"""The page's JavaScript functions, which are translated from GLSL, match the NumPy functions."""

import numpy as np
import pytest

from mxeon.models.core.quadrature import albedo_dir_quadrature
from mxeon.models.diffuse import eon_rho_from_albedo_avg, eon_rho_from_albedo_normal
from mxeon.models.sampling import uniform_sample
from mxeon.models.table import DIFFUSE_MODELS, KNOWN_DEFECTS
from tests.support.hemispheres import uniforms
from tests.support.tolerances import FIT_ANGLE, FIT_LOSS

ROWS = DIFFUSE_MODELS + KNOWN_DEFECTS
# Relative error of values, because the GLSL uses fits. A BRDF value has two factors with the fitted
# loss. In full Oren-Nayar, the error of the fitted angle counts 4 times in two squared angles, and
# 3 + 2 times in other terms.
VALUE = max(2 * FIT_LOSS, (4 + 3 + 2) * FIT_ANGLE)
RHO = (0.0, 0.3, 0.8, 1.0)
PARAMETERS = (0.0, 0.2, 0.7, 1.0)
COSINES = (0.0, 1e-3, 0.05, 0.3, 0.77, 1.0)


@pytest.fixture(scope="module")
def pairs():
    """Pairs of directions, including grazing and equal directions."""
    wo, wi = (uniform_sample(uniforms(150, seed))[0] for seed in (7, 8))
    grazing = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]])
    return np.vstack([wo, grazing, wi[:9]]), np.vstack([wi, grazing[::-1], wi[:9]])


def parameter(row, value):
    return (value,) if row.parameter else ()


@pytest.mark.parametrize("row", ROWS)
def test_values_are_numpys(undrawn, pairs, row):
    wo, wi = pairs
    values = undrawn.evaluate(
        """([name, wo, wi, rhos, parameters]) => parameters.map(parameter =>
             rhos.map(rho => wo.map((each, k) =>
               mxeon.models.model(name).brdf(each, wi[k], rho, parameter))))""",
        [row.name, wo.tolist(), wi.tolist(), RHO, PARAMETERS],
    )
    for rows, value in zip(values, PARAMETERS, strict=True):
        expected = row.brdf(wo, wi, RHO, *parameter(row, value)).T
        scale = np.maximum(np.abs(expected), 1.0 / np.pi)
        assert (np.abs(np.array(rows) - expected) / scale).max() < VALUE


@pytest.mark.parametrize("row", ROWS)
def test_albedos_are_numpys(undrawn, row):
    dirs, avgs = undrawn.evaluate(
        """([name, mus, rhos, parameters]) => {
          const of = mxeon.models.model(name);
          return [
            parameters.map(parameter => mus.map(mu => rhos.map(rho =>
              of.albedoDir ? of.albedoDir(mu, rho, parameter)
                            : mxeon.models.albedoDir(of, mu, rho, parameter, 16)))),
            of.albedoAvg && parameters.map(p => rhos.map(rho => of.albedoAvg(rho, p)))];
        }""",
        [row.name, COSINES, RHO, PARAMETERS],
    )
    assert (avgs is None) == (row.albedo_avg is None)
    for k, value in enumerate(PARAMETERS):
        arguments = parameter(row, value)
        if row.albedo_dir:
            expected = row.albedo_dir(np.array(COSINES), RHO, *arguments)
        else:
            expected = albedo_dir_quadrature(row.brdf, COSINES, RHO, *arguments, nodes=16)
        assert np.abs(np.array(dirs[k]) - expected).max() < VALUE
        if row.albedo_avg:  # the albedo has a closed form without fits
            assert np.abs(np.array(avgs[k]) - row.albedo_avg(RHO, *arguments)).max() < 1e-12


@pytest.mark.parametrize(
    ("average", "invert"), [(False, eon_rho_from_albedo_normal), (True, eon_rho_from_albedo_avg)]
)
def test_colors_to_enter_are_numpys(undrawn, average, invert):
    colors = np.linspace(0.0, 1.0, 21)
    for roughness in PARAMETERS:
        values = undrawn.evaluate(
            """([colors, r, average]) => colors.map(color =>
                 mxeon.models.rhoFromAlbedo(mxeon.models.model("eon"), color, r, average))""",
            [colors.tolist(), roughness, average],
        )
        assert np.abs(np.array(values) - invert(colors, roughness)).max() < FIT_LOSS
