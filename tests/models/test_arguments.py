# SPDX-License-Identifier: Apache-2.0
"""Every public function of the models, found by introspection, refuses bad arguments."""

import functools
import re
import warnings
from collections import defaultdict
from inspect import ismodule
from pathlib import Path
from pkgutil import resolve_name

import numpy as np
import pytest

from mxeon import models
from mxeon.models import hair, sampling, thin_film
from mxeon.models.core.arguments import RANGES
from mxeon.models.core.layering import Bsdf, multiply
from mxeon.models.diffuse import translucent_btdf
from mxeon.models.nodes.utilities import node
from mxeon.models.sheen import conty_kulla_albedo_dir
from mxeon.models.table import diffuse_model
from mxeon.models.transmission import refraction_direction, schlick_ior
from tests.fuzz import arguments

PAGES = Path(__file__).resolve().parents[2] / "docs" / "api"
# Functions on the API pages that accept no arrays.
NO_ARRAYS = {"layer", "add", "model", "model_names"}


@pytest.fixture(scope="module")
def rows():
    """Rows of bad arguments, grouped by function, so that each function has its own test."""
    found = defaultdict(list)
    for row in arguments.rows():
        found[row[0]].append(row)
    return found


@pytest.mark.parametrize("name", arguments.functions())
def test_bad_arguments_are_refused_by_name_or_computed(name, rows):
    judged = [(row[1], arguments.BAD[row[2]], arguments.judged(row)[1]) for row in rows[name]]
    assert [fault for fault in judged if fault[-1]] == []


def test_the_least_number_above_zero_counts_as_zero():
    for function in arguments.functions().values():
        for name in arguments.tried(function, arrays=True):
            least, zero = (result(function, name, value) for value in (arguments.SMALLEST, 0.0))
            # The specified film model jumps at thickness 0.
            if least and zero and name != "thickness":
                for a, b in zip(least, zero, strict=True):
                    np.testing.assert_allclose(a, b, 1e-9, 1e-12, err_msg=f"{function} {name}")


def result(function, name, value):
    """Arrays that a function returns, or an empty list if the function refuses the value."""
    returned = []

    @functools.wraps(function)
    def kept(*values, **named):
        returned.append(function(*values, **named))
        return 0.0

    arguments.answer(kept, arguments.base(function) | {name: value})
    values = [getattr(each, "value", each) for each in returned]
    return [part for each in values for part in (each if isinstance(each, tuple) else (each,))]


def test_every_function_on_the_pages_is_tried():
    text = "".join(page.read_text(encoding="utf-8") for page in PAGES.glob("*.md"))
    names = r"^::: (mxeon\.(?:models|albedo|inversion|sampling)[\w.]*\.[a-z]\w+)$"
    paths = re.findall(names, text, re.MULTILINE)
    # Functions of surface shaders take a light and a set of inputs.
    paths = [each for each in paths if ".surfaces." not in each]
    names = {path.rpartition(".")[2] for path in paths if not ismodule(resolve_name(path))}
    tried = {name.rpartition(".")[2] for name in arguments.functions()}
    assert len(names) > 90
    assert names - NO_ARRAYS <= tried


def computed(function, values):
    """Arrays that a function returns, or "refused" if the function raises a ValueError."""
    try:
        with warnings.catch_warnings(action="ignore"), np.errstate(all="ignore"):
            result = arguments.call(function, values)
    except ValueError:
        return "refused"
    if isinstance(result, arguments.Bsdf | arguments.SimpleNamespace):
        result = tuple(vars(result).values())
    parts = map(np.asarray, result if isinstance(result, tuple) else (result,))
    return [(each.dtype, each.tolist()) for each in parts]


@pytest.mark.parametrize("kind", (np.float16, np.float32, np.longdouble))
def test_every_function_computes_in_float64_whatever_the_type_of_its_arguments(kind):
    tried = 0
    for function in arguments.functions().values():
        base = arguments.base(function)
        for name in arguments.tried(function, arrays=True):
            if isinstance(base[name], int | float | tuple | np.ndarray):
                # A type with more digits than float64 gets a value that needs these digits.
                exact = np.asarray(base[name], np.longdouble) * (1.0 - np.longdouble(2.0) ** -57)
                value = exact.astype(kind)
                found = computed(function, base | {name: value})
                assert found == computed(function, base | {name: value.astype(np.float64)}), name
                tried += 1
    assert tried > 310


@pytest.mark.parametrize("roughness", (5e-324, 1e-320, 1e-300))
def test_conty_kulla_has_no_albedo_away_from_grazing_at_the_least_roughness(roughness):
    assert conty_kulla_albedo_dir(0.5, roughness) == 0.0


@pytest.mark.parametrize("ior", (5e-324, 1e-160, 1e-51))
def test_an_index_of_nothing_reflects_all(ior):
    assert not refraction_direction([0.0, 0.0, 1.0], [0.0, 0.0, 1.0], ior).any()


def test_a_quantity_without_a_range_is_refused():
    rule = "'sparkle' must have a range in mxeon.models.core.arguments"
    with pytest.raises(LookupError, match=rule):
        RANGES["sparkle"]


# --- wording of messages -----------------------------------------------------------------------

UP, CLAY, LOBE = [0.0, 0.0, 1.0], (0.5, 0.5, 0.5), Bsdf(np.array(0.5), np.array(0.5))
SOAP = {"tint": 1.0, "ior": 1.5, "roughness": [0.5, 0.5]}
SOAP |= {"thinfilm_thickness": -1.0, "thinfilm_ior": 1.3}
LAMBERT, SAMPLE, FILM = models.lambert_brdf, sampling.eon_sample, thin_film.film_brdf
COATED, HAIR = models.dielectric_over_eon_albedo_dir, hair.chiang_hair_absorption_from_color
NODE, HALF = "dielectric_bsdf", np.full((4, 3), 0.5)
# Functions, positional arguments, and the expected error message.
RULES = (
    # Ranges: the message names the first element that is out of range.
    (models.eon_brdf, (UP, UP, 1.0, 1.2), "roughness must lie in [0, 1]; got 1.2"),
    (models.eon_brdf, (UP, UP, 1.0, [0, 1, -0.5]), "roughness must lie in [0, 1]; got -0.5 at index (2,)"),
    (models.eon_brdf, (UP, UP, [[0.5, 2.0, 3.0]], 1.0), "rho must lie in [0, 1]; got 2.0 at index (0, 1)"),
    (models.eon_brdf, (UP, UP, np.nan, 1.0), "rho must lie in [0, 1]; got nan"),
    (SAMPLE, (UP, [[0.0, 0.0], [1.0, 0.0]], 0.5), "u must lie in [0, 1); got 1.0 at index (1, 0)"),
    (HAIR, ([0.0, 1.0, 1.0], 0.5), "hair_color must lie in (0, 1]; got 0.0 at index (0,)"),
    (FILM, (NODE, UP, UP, SOAP), "thinfilm_thickness must lie in [0, 1e9]; got -1.0"),
    (multiply, (LOBE, -0.5), "weight must lie in [0, inf); got -0.5"),
    (COATED, (*CLAY, 0.001, 1.5), "alpha must lie in [0.01, 1]; got 0.001"),
    # Directions of a wrong length, or on the wrong side of the surface.
    (LAMBERT, (UP, [UP, [0, 0, 2]], 1), "wi must be unit vectors within 1e-06; got squared length 4.0 at index (1,)"),
    (LAMBERT, ([np.nan, 0, 1], UP, 1), "wo must be unit vectors within 1e-06; got squared length nan"),
    (LAMBERT, (UP, [1e200, 0, 0], 1), "wi must be unit vectors within 1e-06; got squared length inf"),
    (sampling.cosine_pdf, ([UP, [0.6, 0, -0.8]],), "wi must not point below the horizon (z >= 0); got z = -0.8 at index (1,)"),
    (translucent_btdf, (UP, [0.6, 0, 0.8], 1.0), "wi must not point above the horizon (z <= 0); got z = 0.8"),
    # Types of arguments.
    (LAMBERT, (UP, UP, "red"), "rho must be real numbers; got 'red'"),
    (LAMBERT, (UP, UP, 1j), "rho must be real numbers; got 1j"),
    (LAMBERT, (UP, UP, [[1.0], [1.0, 0.5]]), "rho must be real numbers; got [[1.0], [1.0, 0.5]]"),
    (LAMBERT, (UP, UP, np.ma.masked_less([0.1, 0.5], 0.2)), "rho must not be a masked array, whose mask would be lost; fill it"),
    (FILM, (NODE, UP, UP, 3), "inputs must be a mapping of names to values; got 3"),
    (FILM, (NODE, UP, UP, {"tint": 1.0}), "inputs must have ior, roughness, thinfilm_ior, thinfilm_thickness"),
    (thin_film.film_reflectance, (NODE, 0.5, SOAP, "x"), "form must be a Form; got 'x'"),
    (schlick_ior, (0.5, "mean"), "reading must be one of text, unclamped"),
    (diffuse_model, ("phong",), "no model 'phong'; see mxeon.models.table.DIFFUSE_MODELS"),
    (node, ("nothing",), "category must be one of roughness_anisotropy, "),
    # Shapes of arguments.
    (LAMBERT, ([1.0, 0.0], UP, 1.0), "wo must have shape (..., 3); got shape (2,)"),
    (LAMBERT, (UP, 1.0, 1.0), "wi must have shape (..., 3); got shape ()"),
    (sampling.cosine_sample, ([0.1, 0.2, 0.3],), "u must have shape (..., 2); got shape (3,)"),
    (models.smith_g1, (UP, [0.5] * 3), "roughness must be a number or have shape (..., 2); got shape (3,): write roughness[..., np"),
    (HAIR, (0.5, 0.5), "hair_color must have shape (..., 3); got shape ()"),
    (models.fresnel_conductor_avg, ([1, 2], [1, 2, 3]), "ior, extinction must have equal numbers of channels; got 2, 3"),
    (COATED, (*CLAY, [0.1, 0.2], 1.5), "alpha must be one number, for all pairs; got shape (2,)"),
    (models.eon_brdf, ([UP] * 2, [UP] * 3, 1.0, 1.0), "wo has 2 rows, wi has 3 rows; give equal counts, or one"),
    (models.eon_albedo_dir, (0.5, HALF, [0.5] * 5), "rho has 4 rows, roughness has 5 values; give equal counts, or one"),
)  # fmt: skip


@pytest.mark.parametrize("function, values, message", RULES)
def test_a_message_names_rule_value_and_place(function, values, message):
    with pytest.raises(ValueError, match="^" + re.escape(message)):
        function(*values)


def test_inputs_of_another_name_are_refused():
    with pytest.raises(TypeError, match=r"^inputs must be among tint_R, .*; got weight$"):
        hair.chiang_hair_bcsdf(UP, UP, weight=1.0)


def test_the_first_bad_element_of_a_large_array_is_found():
    wi = np.tile(UP, (100_000, 1))
    wi[77_777, 2] = wi[99_999, 2] = -1.0
    with pytest.raises(ValueError, match=re.escape("z = -1.0 at index (77777,)")):
        models.lambert_brdf(UP, wi, 1.0)
