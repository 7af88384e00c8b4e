# SPDX-License-Identifier: Apache-2.0
"""Engines that err: what a run says of them, and which of their own errors its tolerances take in."""

from contextlib import closing

import numpy as np
import pytest

from mxeon.conformance.results import FAILED, NOT_RUN, SHADER_FUNCTIONS
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import Task
from mxeon.errors import NotRun, ShaderError
from mxeon.hosts.gl import Host
from mxeon.shaders.document.policy import DEFAULT

EON, SHADER = "oren_nayar_diffuse_bsdf, energy_compensation true", "standard_surface, every lobe"
EVALUATE, EXECUTE = Host.evaluate, Host.execute


def judged(check, title):
    """The result of a check on a gl host of its own."""
    with closing(Judge(DEFAULT)) as judge:
        [result] = judge.work(Task(check, title, "gl", "eonlib")).results
    return result


def turned(host, shader, wo, wi, inputs, *rest, **options):
    return EVALUATE(host, shader, wo, wi[:, [1, 0, 2]] * [-1, 1, 1], inputs, *rest, **options)


def swapped(host, shader, wo, wi, *rest, **options):
    return EVALUATE(host, shader, wi, wo, *rest, **options)


def uncoated(host, shader, wo, wi, inputs, *rest, **options):
    return EVALUATE(
        host, shader, wo, wi, {**inputs, "coat": 0.0 * inputs["coat"]}, *rest, **options
    )


def without_numbers(host, shader, wo, *rest, **options):
    return np.full(wo.shape, np.nan)


@pytest.mark.parametrize(
    "evaluate, check, title, words",
    [
        (turned, "reciprocity", EON, ""),
        (swapped, "value", EON, ""),
        (uncoated, "lobes", SHADER, "the layer equation holds without the coat"),
        (without_numbers, "value", EON, "NaN or infinity"),
    ],
)
def test_a_host_that_mistakes_its_arguments_fails(monkeypatch, evaluate, check, title, words):
    monkeypatch.setattr(Host, "evaluate", evaluate)
    result = judged(check, title)
    assert result.verdict == FAILED and words in result.diagnosis
    assert (result.error == np.inf) == (evaluate is without_numbers)


@pytest.mark.parametrize("error, verdict", [(NotRun, NOT_RUN), (ShaderError, FAILED)])
@pytest.mark.parametrize(
    "check, title",
    [("value", EON), ("output", "eon_rho_from_albedo_avg"), ("twins", SHADER_FUNCTIONS)],
)
def test_what_does_not_run_is_never_passed(monkeypatch, error, verdict, check, title):
    def fails(*arguments, **options):
        raise error("0:1(1): error: here")

    for verb in ("evaluate", "execute", "picture"):
        monkeypatch.setattr(Host, verb, fails)
    with closing(Judge(DEFAULT)) as judge:
        results = judge.work(Task(check, title, "gl", "eonlib")).results
    assert {result.verdict for result in results} == {verdict}
    assert all("0:1(1): error: here" in each.reason + each.diagnosis for each in results)


@pytest.mark.parametrize(
    "check, title, function, widened",
    [
        ("value", "sheen_bsdf, mode conty_kulla", "power", 2e-4),
        ("radiance", "generalized_schlick_edf", "power", 2e-4),
        ("transmittance", "anisotropic_vdf", "exponential", 3e-4),
        ("value", "burley_diffuse_bsdf", "power", None),
    ],
)
def test_a_tolerance_takes_in_the_error_of_an_engines_own_function(
    monkeypatch, check, title, function, widened
):
    def execute(host, source, name, *arguments):
        values = EXECUTE(host, source, name, *arguments)
        return values * (1.0 + 1e-4) if function in name else values

    exact = judged(check, title).tolerance
    monkeypatch.setattr(Host, "execute", execute)
    assert judged(check, title).tolerance == (widened or exact) >= exact
