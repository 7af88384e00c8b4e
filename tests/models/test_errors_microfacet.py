# SPDX-License-Identifier: Apache-2.0
"""Bad arguments of the microfacet models: name, rule, value, place."""

import re

import numpy as np
import pytest

from mxeon import albedo, models, sampling

UP = [0.0, 0.0, 1.0]
A = [0.5, 0.5]

MESSAGES = (
    (lambda: models.fresnel_dielectric(1.5, 1.5), "mu must lie in [0, 1]; got 1.5"),
    (lambda: models.fresnel_dielectric(0.5, -1.5), "ior must lie in [0, 1e50]; got -1.5"),
    (lambda: models.fresnel_dielectric_avg(np.inf), "ior must lie in [0, 1e50]; got inf"),
    (
        lambda: models.fresnel_conductor(0.5, 1.0, [0.0, -1.0]),
        "extinction must lie in [0, 1e50]; got -1.0 at index (1,)",
    ),
    (
        lambda: models.fresnel_conductor_avg([1.0, 2.0], [1.0, 2.0, 3.0]),
        "ior, extinction must have equal numbers of channels; got 2, 3",
    ),
    (lambda: models.fresnel_schlick(0.5, 1.2, 1.0, 1.0, 5.0), "color0 must lie in [0, 1]; got 1.2"),
    (
        lambda: models.fresnel_schlick(0.5, 1.0, 1.2, 1.0, 5.0),
        "color82 must lie in [0, 1]; got 1.2",
    ),
    (lambda: models.fresnel_schlick_avg(1.0, 1.0, 1.2, 5.0), "color90 must lie in [0, 1]; got 1.2"),
    (
        lambda: models.fresnel_schlick_avg(1.0, 1.0, 1.0, -1.0),
        "exponent must lie in [0, 1e50]; got -1.0",
    ),
    (
        lambda: models.ggx_ndf([0.0, 0.0, -1.0], A),
        "wh must not point below the horizon (z >= 0); got z = -1.0",
    ),
    (
        lambda: models.conductor_brdf(UP, UP, [[0.5, 0.4, 0.3]], 1.5, 3.0),
        "write roughness[..., np.newaxis] for a number for each direction",
    ),
    (
        lambda: models.smith_g1(UP, [0.5, 1.5]),
        "roughness must lie in [0, 1]; got 1.5 at index (1,)",
    ),
    (lambda: models.smith_g2(0.5, 1.5, 0.5), "mu_i must lie in [0, 1]; got 1.5"),
    (lambda: models.smith_g2(1.5, 0.5, 0.5), "mu_o must lie in [0, 1]; got 1.5"),
    (
        lambda: models.smith_g2_anisotropic(UP, [UP] * 2, [A] * 3),
        "wo, wi, roughness must broadcast (last axis of wo, wi, roughness apart); got shapes (3,), (2, 3), (3, 2)",
    ),
    (lambda: models.dielectric_brdf(UP, UP, 2.0, A, 1.5), "tint must lie in [0, 1]; got 2.0"),
    (
        lambda: models.dielectric_brdf(UP, [0.0, 0.0, 2.0], 1.0, A, 1.5),
        "wi must be unit vectors to 1e-06; got squared length 4.0",
    ),
    (
        lambda: models.conductor_brdf(UP, UP, [A] * 2, np.ones((3, 1)), 1.0),
        "wo, wi, roughness, ior, extinction must broadcast",
    ),
    (
        lambda: models.generalized_schlick_brdf(UP, UP, 1.0, 1.0, 1.0, [0.5, 0.5, 0.5], 5.0),
        "roughness must be a number or have shape (..., 2); got shape (3,)",
    ),
    (lambda: albedo.ggx_albedo_dir(0.5, 1.5), "alpha must lie in [0, 1]; got 1.5"),
    (
        lambda: albedo.ggx_albedo_dir([0.5] * 2, [0.5] * 3),
        "mu, alpha must broadcast; got shapes (2,), (3,)",
    ),
    (
        lambda: albedo.ggx_albedo_dir_anisotropic([0.6, 0.0, -0.8], A),
        "wo must not point below the horizon (z >= 0); got z = -0.8",
    ),
    (
        lambda: albedo.dielectric_albedo_dir(UP, 1.0, A, np.nan),
        "ior must lie in [0, 1e50]; got nan",
    ),
    (lambda: albedo.conductor_albedo_dir(UP, A, -1.0, 1.0), "ior must lie in [0, 1e50]; got -1.0"),
    (
        lambda: albedo.generalized_schlick_albedo_dir(UP, 1.0, -1.0, 1.0, A, 5.0),
        "color82 must lie in [0, 1]; got -1.0",
    ),
    (lambda: sampling.ggx_sample(UP, [0.5, 1.0], A), "u must lie in [0, 1); got 1.0 at index (1,)"),
    (lambda: sampling.ggx_sample([UP] * 2, [[0.5, 0.5]] * 3, A), "wo, u, roughness must broadcast"),
    (lambda: sampling.ggx_pdf([0.0, 0.0, -1.0], UP, A), "wo must not point below the horizon"),
)


@pytest.mark.parametrize("call, message", MESSAGES, ids=[message for _, message in MESSAGES])
def test_message_names_rule_value_and_place(call, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        call()
