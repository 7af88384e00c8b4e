# SPDX-License-Identifier: Apache-2.0
"""Messages for invalid arguments, one row per rule.

`test_arguments` tries every bad value with every function; this module tests the wording.
"""

import re

import numpy as np
import pytest

from mxeon import models
from mxeon.models import hair, sampling, thin_film
from mxeon.models.core.layering import Bsdf, multiply
from mxeon.models.diffuse import translucent_btdf
from mxeon.models.nodes.utilities import node
from mxeon.models.table import diffuse_model
from mxeon.models.transmission import schlick_ior

UP, A = [0.0, 0.0, 1.0], [0.5, 0.5]
BELOW = [UP, [0.6, 0.0, -0.8]]
SOAP = {"tint": 1.0, "ior": 1.5, "roughness": A, "thinfilm_thickness": -1.0, "thinfilm_ior": 1.3}
CLAY = {"mu": 0.5, "rho": 0.5, "roughness": 0.5}
COAT = CLAY | {"alpha": 0.3, "ior": 1.5}
LOBE = Bsdf(np.array(0.5), np.array(0.5))


def coated(**changes):
    return models.dielectric_over_eon_albedo_dir(**COAT | changes)


RULES = {
    # Ranges: the message names the first element that is out of range.
    "roughness must lie in [0, 1]; got 1.2": lambda: models.eon_brdf(UP, UP, 1.0, 1.2),
    "roughness must lie in [0, 1]; got -0.5 at index (2,)": lambda: models.eon_brdf(
        UP, UP, 1.0, [0.0, 1.0, -0.5]
    ),
    "rho must lie in [0, 1]; got 2.0 at index (0, 1)": lambda: models.eon_brdf(
        UP, UP, [[0.5, 2.0, 3.0]], 1.0
    ),
    "rho must lie in [0, 1]; got nan": lambda: models.eon_brdf(UP, UP, np.nan, 1.0),
    "u must lie in [0, 1); got 1.0 at index (1, 0)": lambda: sampling.eon_sample(
        UP, [[0.0, 0.0], [1.0, 0.0]], 0.5
    ),
    "hair_color must lie in (0, 1]; got 0.0 at index (0,)": (
        lambda: hair.chiang_hair_absorption_from_color([0.0, 1.0, 1.0], 0.5)
    ),
    "thinfilm_thickness must lie in [0, 1e9]; got -1.0": lambda: thin_film.film_brdf(
        "dielectric_bsdf", UP, UP, SOAP
    ),
    "weight must lie in [0, inf); got -0.5": lambda: multiply(LOBE, -0.5),
    "alpha must lie in [0.01, 1]; got 0.001": lambda: coated(alpha=0.001),
    # Directions: unit length and sides of the surface.
    "wi must be unit vectors to 1e-06; got squared length 4.0 at index (1,)": (
        lambda: models.lambert_brdf(UP, [UP, [0.0, 0.0, 2.0]], 1.0)
    ),
    "wo must be unit vectors to 1e-06; got squared length nan": lambda: models.lambert_brdf(
        [np.nan, 0.0, 1.0], UP, 1.0
    ),
    "wi must be unit vectors to 1e-06; got squared length inf": lambda: models.lambert_brdf(
        UP, [1e200, 0.0, 0.0], 1.0
    ),
    "wi must not point below the horizon (z >= 0); got z = -0.8 at index (1,)": (
        lambda: sampling.cosine_pdf(BELOW)
    ),
    "wi must not point above the horizon (z <= 0); got z = 0.8": lambda: translucent_btdf(
        UP, [0.6, 0, 0.8], 1.0
    ),
    # Types of arguments.
    "rho must be real numbers; got 'red'": lambda: models.lambert_brdf(UP, UP, "red"),
    "rho must be real numbers; got 1j": lambda: models.lambert_brdf(UP, UP, 1j),
    "rho must be real numbers; got [[1.0], [1.0, 0.5]]": lambda: models.lambert_brdf(
        UP, UP, [[1.0], [1.0, 0.5]]
    ),
    "rho must not be a masked array, whose mask would be lost; fill it": (
        lambda: models.lambert_brdf(UP, UP, np.ma.masked_less([0.1, 0.5], 0.2))
    ),
    "inputs must be a mapping of names to values; got 3": lambda: thin_film.film_brdf(
        "dielectric_bsdf", UP, UP, 3
    ),
    "inputs must have ior, roughness, thinfilm_ior, thinfilm_thickness": lambda: (
        thin_film.film_brdf("dielectric_bsdf", UP, UP, {"tint": 1.0})
    ),
    "form must be a Form; got 'x'": lambda: thin_film.film_reflectance(
        "dielectric_bsdf", 0.5, SOAP, form="x"
    ),
    "reading must be one of text, unclamped": lambda: schlick_ior(0.5, "mean"),
    "no model 'phong'; see mxeon.models.table.DIFFUSE_MODELS": lambda: diffuse_model("phong"),
    "category must be one of roughness_anisotropy, ": lambda: node("nothing"),
    # Shapes of arguments.
    "wo must have shape (..., 3); got shape (2,)": lambda: models.lambert_brdf([1.0, 0.0], UP, 1.0),
    "wi must have shape (..., 3); got shape ()": lambda: models.lambert_brdf(UP, 1.0, 1.0),
    "u must have shape (..., 2); got shape (3,)": lambda: sampling.cosine_sample([0.1, 0.2, 0.3]),
    "roughness must be a number or have shape (..., 2); got shape (3,): write roughness[..., np": (
        lambda: models.smith_g1(UP, [0.5, 0.5, 0.5])
    ),
    "hair_color must have shape (..., 3); got shape ()": (
        lambda: hair.chiang_hair_absorption_from_color(0.5, 0.5)
    ),
    "ior, extinction must have equal numbers of channels; got 2, 3": (
        lambda: models.fresnel_conductor_avg([1.0, 2.0], [1.0, 2.0, 3.0])
    ),
    "alpha must be one number, for all pairs; got shape (2,)": lambda: coated(alpha=[0.1, 0.2]),
    "wo has 2 rows, wi has 3 rows; give equal counts, or one": lambda: models.eon_brdf(
        [UP] * 2, [UP] * 3, 1.0, 1.0
    ),
    "rho has 4 rows, roughness has 5 values; give equal counts, or one": (
        lambda: models.eon_albedo_dir(0.5, np.full((4, 3), 0.5), [0.5] * 5)
    ),
}


@pytest.mark.parametrize("message", RULES)
def test_a_message_names_rule_value_and_place(message):
    with pytest.raises(ValueError, match="^" + re.escape(message)):
        RULES[message]()


def test_inputs_of_another_name_are_refused():
    with pytest.raises(TypeError, match=r"^inputs must be among tint_R, .*; got weight$"):
        hair.chiang_hair_bcsdf(UP, UP, weight=1.0)


def test_the_first_bad_element_of_a_large_array_is_found():
    wi = np.tile(UP, (100_000, 1))
    wi[77_777, 2] = wi[99_999, 2] = -1.0
    with pytest.raises(ValueError, match=re.escape("z = -1.0 at index (77777,)")):
        models.lambert_brdf(UP, wi, 1.0)
