# SPDX-License-Identifier: Apache-2.0
"""Bad arguments of the models and albedos: name, rule, value, place."""

import re

import numpy as np
import pytest

from mxeon import albedo
from mxeon.models.diffuse import eon_brdf, lambert_brdf, qon_brdf
from mxeon.models.table import KNOWN_DEFECTS, MODELS, OTHERS, PARAMETRIZATIONS, model

ALL = (*MODELS, *KNOWN_DEFECTS, *OTHERS, *PARAMETRIZATIONS)

UP = [0.0, 0.0, 1.0]

MESSAGES = (
    (lambda: eon_brdf(UP, UP, 1.0, 1.2), "roughness must lie in [0, 1]; got 1.2"),
    (
        lambda: eon_brdf(UP, UP, 1.0, [0.0, 1.0, -0.5]),
        "roughness must lie in [0, 1]; got -0.5 at index (2,)",
    ),
    (
        lambda: eon_brdf(UP, UP, [[0.5, 2.0, 3.0]], 1.0),
        "rho must lie in [0, 1]; got 2.0 at index (0, 1)",
    ),
    (lambda: eon_brdf(UP, UP, np.nan, 1.0), "rho must lie in [0, 1]; got nan"),
    (lambda: qon_brdf(UP, UP, 1.0, 1.6), "sigma must lie in [0, pi/2]; got 1.6"),
    (lambda: lambert_brdf(UP, UP, "red"), "rho must be real numbers; got 'red'"),
    (lambda: lambert_brdf(UP, UP, 1j), "rho must be real numbers; got 1j"),
    (lambda: lambert_brdf(UP, UP, [[1.0], [1.0, 0.5]]), "rho must be real numbers; got [[1.0], "),
    (lambda: lambert_brdf([1.0, 0.0], UP, 1.0), "wo must have shape (..., 3); got shape (2,)"),
    (lambda: lambert_brdf(UP, 1.0, 1.0), "wi must have shape (..., 3); got shape ()"),
    (
        lambda: lambert_brdf(UP, [UP, [0.0, 0.0, 2.0]], 1.0),
        "wi must be unit vectors to 1e-06; got squared length 4.0 at index (1,)",
    ),
    (
        lambda: lambert_brdf([np.nan, 0.0, 1.0], UP, 1.0),
        "wo must be unit vectors to 1e-06; got squared length nan",
    ),
    (
        lambda: lambert_brdf(UP, [1e200, 0.0, 0.0], 1.0),
        "wi must be unit vectors to 1e-06; got squared length inf",
    ),
    (
        lambda: lambert_brdf(UP, [UP, [0.6, 0.0, -0.8]], 1.0),
        "wi must not point below the horizon (z >= 0); got z = -0.8 at index (1,)",
    ),
    (
        lambda: eon_brdf([UP] * 2, [UP] * 3, 1.0, 1.0),
        "wo, wi, rho, roughness must broadcast (last axis of wo, wi, rho apart); "
        "got shapes (2, 3), (3, 3), (1,), ()",
    ),
    (
        lambda: albedo.fon_albedo_dir([0.5] * 4, [0.5] * 5),
        "mu, roughness must broadcast; got shapes (4,), (5,)",
    ),
    (
        lambda: albedo.eon_albedo_dir(0.5, np.full((4, 3), 0.5), [0.5] * 5),
        "rho, roughness, mu must broadcast (last axis of rho apart); got shapes (4, 3), (5,), ()",
    ),
    (
        lambda: albedo.eon_albedo_avg(np.full((4, 3), 0.5), [0.5] * 5),
        "rho, roughness must broadcast (last axis of rho apart); got shapes (4, 3), (5,)",
    ),
    (
        lambda: albedo.albedo_dir_quadrature(eon_brdf, [0.5] * 4, 0.5, [0.5] * 5),
        "rho, mu, parameter 0 must broadcast (last axis of rho apart); got shapes (1,), (4,), (5,)",
    ),
    (
        lambda: lambert_brdf(UP, UP, np.ma.masked_less([0.1, 0.5], 0.2)),
        "rho must not be a masked array, whose mask would be lost; fill it",
    ),
    (
        lambda: lambert_brdf(np.ma.array(UP), UP, 1.0),
        "wo must not be a masked array, whose mask would be lost; fill it",
    ),
    (lambda: albedo.fon_loss(np.ma.array([0.5])), "mu must not be a masked array, "),
    (lambda: albedo.fon_loss(-0.1), "mu must lie in [0, 1]; got -0.1"),
    (lambda: albedo.qon_albedo_dir(1.1, 0.5), "mu must lie in [0, 1]; got 1.1"),
    (lambda: albedo.qon_albedo_dir(0.5, -1.0), "sigma must lie in [0, pi/2]; got -1.0"),
    (lambda: albedo.qon_albedo_avg(2.0), "sigma must lie in [0, pi/2]; got 2.0"),
    (
        lambda: albedo.fon_albedo_dir([0.5, 2.0], 1.0),
        "mu must lie in [0, 1]; got 2.0 at index (1,)",
    ),
    (lambda: albedo.fon_albedo_dir_approx(0.5, 2.0), "roughness must lie in [0, 1]; got 2.0"),
    (lambda: albedo.fon_albedo_avg(np.inf), "roughness must lie in [0, 1]; got inf"),
    (lambda: albedo.eon_albedo_dir(0.5, -1.0, 1.0), "rho must lie in [0, 1]; got -1.0"),
    (lambda: albedo.eon_albedo_dir_approx(-1.0, 1.0, 1.0), "mu must lie in [0, 1]; got -1.0"),
    (lambda: albedo.eon_albedo_avg(1.0, 7), "roughness must lie in [0, 1]; got 7"),
    (
        lambda: albedo.albedo_dir_quadrature(eon_brdf, 2.0, 1.0, 1.0),
        "mu must lie in [0, 1]; got 2.0",
    ),
    (
        lambda: model("phong"),
        f"model must be one of {', '.join(row.name for row in ALL)}; got 'phong'",
    ),
)


@pytest.mark.parametrize("call, message", MESSAGES, ids=[message for _, message in MESSAGES])
def test_message_names_rule_value_and_place(call, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        call()


def test_first_bad_element_of_a_large_array_is_found():
    wi = np.tile(UP, (100_000, 1))
    wi[77_777, 2] = wi[99_999, 2] = -1.0
    with pytest.raises(ValueError, match=re.escape("z = -1.0 at index (77777,)")):
        lambert_brdf(UP, wi, 1.0)
