# SPDX-License-Identifier: Apache-2.0
"""A model that is a NumPy function and a row of the table, with no shader: the checks take it."""

import numpy as np
import pytest

import mxeon
from mxeon.models import table
from mxeon.models.diffuse import eon_brdf, lambert_brdf
from mxeon.models.table import Model


def toy_brdf(wo, wi, rho, roughness):
    """Lambert, and EON as far as the surface is rough."""
    share = np.asarray(roughness)[..., np.newaxis]
    return (1.0 - share) * lambert_brdf(wo, wi, rho) + share * eon_brdf(wo, wi, rho, roughness)


@pytest.fixture(autouse=True)
def toy(monkeypatch):
    """The table of models with one more row."""
    row = Model("toy", "a toy model", toy_brdf, "roughness")
    monkeypatch.setattr(table, "MODELS", (*table.MODELS, row))


def test_a_function_is_checked_against_it():
    assert {result.verdict for result in mxeon.check_brdf(toy_brdf, "toy").results} == {"passed"}


def test_a_diagnosis_names_it():
    (value,) = [
        result for result in mxeon.check_brdf(toy_brdf, "eon").results if result.check == "value"
    ]
    assert value.diagnosis.startswith("best match: a toy model (rms ")
