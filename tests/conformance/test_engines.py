# SPDX-License-Identifier: Apache-2.0
"""Faults of engines are reported. Tolerances allow for errors of built-in functions."""

import numpy as np
import pytest

from mxeon.errors import NotRun, ShaderError
from mxeon.hosts.gl import GlHost
from tests.support.verdicts import FAILED, NOT_RUN, SHADER_FUNCTIONS, Verdicts, has, said

EON, SHADER = "oren_nayar_diffuse_bsdf, energy_compensation true", "standard_surface, every lobe"


@pytest.fixture
def judged_by(gl):
    """Function that judges checks with the given subclass of the OpenGL host."""
    opened = []

    def judge(kind):
        opened.append(kind())
        return Verdicts(lambda name: opened[-1])

    yield judge
    for host in opened:
        host.close()


def turned(wo, wi, inputs):
    return wo, wi[:, [1, 0, 2]] * [-1, 1, 1], inputs


def exchanged(wo, wi, inputs):
    return wi, wo, inputs


def uncoated(wo, wi, inputs):
    return wo, wi, {**inputs, "coat": 0.0 * inputs["coat"]}


@pytest.mark.parametrize(
    "change, check, title, cause",
    [
        (turned, "reciprocity", EON, ()),
        (exchanged, "value", EON, ()),
        (uncoated, "lobes", SHADER, ("right_without", "coat")),
        (None, "value", EON, ("not finite",)),
    ],
)
def test_a_host_that_mistakes_its_arguments_fails(judged_by, change, check, title, cause):
    class Mistaken(GlHost):
        def evaluate(self, shader, wo, wi, inputs, *rest, **options):
            if change is None:
                return np.full(wo.shape, np.nan)
            return super().evaluate(shader, *change(wo, wi, inputs), *rest, **options)

    result = judged_by(Mistaken)(check, title)
    assert result.verdict == FAILED and has(result, *cause)
    assert (result.error == np.inf) == (change is None)


class Failing(GlHost):
    error = NotRun

    def evaluate(self, *arguments, **options):
        raise self.error("0:1(1): error: here")

    execute = picture = evaluate


class Refusing(Failing):
    error = ShaderError


@pytest.mark.parametrize("kind, verdict", [(Failing, NOT_RUN), (Refusing, FAILED)])
@pytest.mark.parametrize(
    "check, title",
    [("value", EON), ("output", "eon_rho_from_albedo_avg"), ("twins", SHADER_FUNCTIONS)],
)
def test_what_does_not_run_is_never_passed(judged_by, kind, verdict, check, title):
    results = judged_by(kind).all(check, title)
    assert {result.verdict for result in results} == {verdict}
    assert all("0:1(1): error: here" in each.reason + said(each) for each in results)


class Rounding(GlHost):
    """OpenGL host whose power and exponential functions have a relative error of 1e-4."""

    def execute(self, source, name, *arguments):
        values = super().execute(source, name, *arguments)
        return values * (1.0 + 1e-4) if "power" in name or "exponential" in name else values


@pytest.mark.parametrize(
    "check, title, widened",
    [
        ("value", "sheen_bsdf, mode conty_kulla", 2e-4),
        ("radiance", "generalized_schlick_edf", 2e-4),
        ("transmittance", "anisotropic_vdf", 3e-4),
        ("value", "burley_diffuse_bsdf", None),
    ],
)
def test_a_tolerance_takes_in_the_error_of_an_engines_own_function(
    judged, judged_by, check, title, widened
):
    exact = judged(check, title).tolerance
    assert judged_by(Rounding)(check, title).tolerance == (widened or exact) >= exact
