# SPDX-License-Identifier: Apache-2.0
"""Tables: a renderer states what it lacks; a model is one function and one row."""

import re

import numpy as np
import pytest

import mxeon
from mxeon import check
from mxeon.models import table
from mxeon.models.diffuse import eon_brdf, lambert_brdf
from mxeon.shaders.library import examples_folder
from tests.support.plans import keep_checks
from tests.support.verdicts import NOT_RUN, has


def test_a_document_is_not_run_on_a_renderer(monkeypatch):
    keep_checks(monkeypatch, "document")
    run = check([examples_folder() / "clay.mtlx"], ["mitsuba"])
    [result] = [each for each in run.results if each.check == "document"]
    assert result.verdict == NOT_RUN
    assert re.fullmatch("mitsuba: this renderer .*; it reads no documents", result.reason)


def toy_brdf(wo, wi, rho, roughness):
    """A mix of Lambert and EON by roughness."""
    share = np.asarray(roughness)[..., np.newaxis]
    return (1.0 - share) * lambert_brdf(wo, wi, rho) + share * eon_brdf(wo, wi, rho, roughness)


@pytest.fixture
def toy_model(monkeypatch):
    """The table of models with one more row."""
    row = table.row("toy", "a toy model", toy_brdf, "roughness")
    monkeypatch.setattr(table, "DIFFUSE_MODELS", (*table.DIFFUSE_MODELS, row))


def test_a_new_model_is_one_row_by_which_functions_are_judged(toy_model):
    assert {result.verdict for result in mxeon.check_brdf(toy_brdf, "toy").results} == {"passed"}


def test_a_diagnosis_names_a_new_model(toy_model):
    (value,) = [
        result for result in mxeon.check_brdf(toy_brdf, "eon").results if result.check == "value"
    ]
    assert has(value, "model", "a toy model")
