# SPDX-License-Identifier: Apache-2.0
"""Tables: a host is one module and one row, and says what it lacks; a model is one function and one row."""

import re

import numpy as np
import pytest

import mxeon
from mxeon import check, hosts
from mxeon.hosts import base
from mxeon.models import table
from mxeon.models.diffuse import eon_brdf, lambert_brdf
from mxeon.shaders.library import examples_folder
from mxeon.shaders.nodes import EON
from tests.support.plans import keep_checks
from tests.support.verdicts import NOT_RUN, SHADER_FUNCTIONS, has


class Toy(base.Host):
    """A toy host: EON itself, whatever the shader."""

    name, target = "toy", "glsl"

    def identity(self):
        return base.Identity(self.name, "1", "paper")

    def evaluate(self, shader, wo, wi, inputs, branch, **options):
        rho = np.broadcast_to(inputs["color"], wo.shape)
        above = wi * np.where(wi[:, 2:] < 0.0, [1.0, 1.0, -1.0], 1.0)
        brdf = table.diffuse_model("eon").brdf(wo, above, rho, np.minimum(inputs["roughness"], 1.0))
        factor = np.maximum(inputs.get("weight", 1.0), 0.0) * inputs.get("occlusion", 1.0)
        return brdf * np.clip(wi[:, 2:], 0.0, 1.0) * np.reshape(factor, (-1, 1))


@pytest.fixture
def toy(monkeypatch):
    """The toy host in a row of its own."""
    row = hosts.Row("toy", "glsl", "pairs", start=lambda name: Toy())
    monkeypatch.setattr(hosts, "HOSTS", (*hosts.HOSTS, row))


def test_a_new_host_is_one_module_and_one_row(toy, monkeypatch):
    keep_checks(monkeypatch, "value", "twins")
    run = check([examples_folder() / "clay.mtlx"], ["toy"], workers=0, nodes=["common"])
    assert [each.device for each in run.hosts] == ["paper"]
    results = {(each.check, each.subject): each for each in run.results if each.host == "toy"}
    assert results["value", EON].verdict == "passed"
    reason = results["twins", SHADER_FUNCTIONS].reason
    assert reason == "toy: this host has no calls of a shader function; use gl"


def test_a_document_is_not_run_on_a_renderer(monkeypatch):
    keep_checks(monkeypatch, "document")
    run = check([examples_folder() / "clay.mtlx"], ["mitsuba"])
    [result] = [each for each in run.results if each.check == "document"]
    assert result.verdict == NOT_RUN
    assert re.fullmatch("mitsuba: this renderer .*; it reads no documents", result.reason)


def toy_brdf(wo, wi, rho, roughness):
    """Lambert, and EON as far as the surface is rough."""
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
