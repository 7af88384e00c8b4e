# SPDX-License-Identifier: Apache-2.0
"""`check_brdf` judges a Python function by the checks that judge hosts."""

import numpy as np
import pytest

import mxeon
from mxeon.errors import CheckError
from mxeon.models import table as reference
from mxeon.models.diffuse import eon_brdf
from tests.support.verdicts import has

PARAMETRIC = [row for row in reference.DIFFUSE_MODELS if row.parameter and row.name != "eon_approx"]


def failed(run):
    return {result.check for result in run.results if result.verdict != "passed"}


@pytest.mark.parametrize("row", PARAMETRIC)
def test_each_model_passes_as_itself(row):
    run = mxeon.check_brdf(row.brdf, row.name)
    run.raise_for_failure()
    assert failed(run) == set()


@pytest.mark.parametrize("name", ["eon_clamped", "eon_rho_cubed"])
def test_a_known_defect_is_named(name):
    row = reference.diffuse_model(name)
    run = mxeon.check_brdf(row.brdf, "eon", "theirs")
    assert failed(run) == {"value", "integral"}
    assert any(has(each, "model", row.title) for each in run.results if each.check == "value")
    assert {result.host for result in run.results} == {"theirs"}


def unfinished(wo, wi, rho, roughness):
    """EON with two faults: NaN for light at the horizon, and infinity for a red in (0.999, 1)."""
    value = eon_brdf(wo, wi, rho, roughness) * wi[:, 2:] / wi[:, 2:]
    return value + np.where((rho[:, :1] > 0.999) & (rho[:, :1] < 1.0), np.inf, 0.0)


def test_values_that_are_not_finite_are_counted_placed_and_the_rest_is_judged():
    with pytest.warns(RuntimeWarning, match="invalid value encountered in divide") as records:
        run = mxeon.check_brdf(unfinished)
    # NumPy's warnings name the file of the function that is checked.
    assert {record.filename for record in records} == {__file__}
    assert failed(run) == {"finite"}
    (finite,) = [result for result in run.results if result.verdict == "failed"]
    cause = finite.diagnosis.first
    assert has(finite, "not finite") and cause.wrong == finite.error
    first = {"wo": [1.0, 0.0, 0.0], "wi": [1.0, 0.0, 0.0], "color": [0.0] * 3, "roughness": [0.0]}
    assert cause.point == first


def test_a_function_without_a_finite_value_fails_every_check_of_them():
    run = mxeon.check_brdf(lambda wo, wi, rho, roughness: np.full(wi.shape, np.nan))
    every = {"value", "integral", "black", "reciprocity", "lambert", "inputs", "finite"}
    assert failed(run) == every


def test_values_that_a_check_cannot_tell_from_wrong_ones_are_said_to_be():
    run = mxeon.check_brdf(lambda wo, wi, rho, roughness: rho / np.pi, "eon")
    (result,) = [each for each in run.results if each.check == "lambert"]
    assert result.verdict == "failed" and result.error <= result.tolerance
    assert has(result, "control") and result.control.variant == "roughness is 0.1"
    assert all(each.diagnosis.causes for each in run.results if each.verdict == "failed")


@pytest.mark.parametrize(
    "brdf, words",
    [
        (lambda wo, wi, rho, roughness: rho / np.pi + 0.0 * wo[:, :1], "the negative control is not caught: "),
        (reference.diffuse_model("eon_rho_cubed").brdf, "0.0409 > 2e-06 pi f cos; best match: EON"),
    ],
)  # fmt: skip
def test_a_failing_test_says_why(brdf, words):
    with pytest.raises(CheckError, match=words):
        mxeon.check_brdf(brdf).raise_for_failure()


@pytest.mark.parametrize(
    "brdf, model, words",
    [
        (eon_brdf, "eom", "no model 'eom': did you mean eon[?] see mxeon.models.table.DIFFUSE_MODELS$"),
        (eon_brdf, "lambert", "model must be one of .*; got"),
        (lambda *each: eon_brdf(*each) + 0j, "eon", "must be real; got complex128"),
        (lambda *each: eon_brdf(*each)[:, 0], "eon", r"must have shape \(65536, 3\); got"),
    ],
)  # fmt: skip
def test_what_cannot_be_judged_is_refused(brdf, model, words):
    with pytest.raises(ValueError, match=words):
        mxeon.check_brdf(brdf, model)
