# SPDX-License-Identifier: Apache-2.0
"""Checks of the shader functions, the models in GLSL: each function against the NumPy one.

A host evaluates a function by name; no library takes part.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mxeon.conformance.checks.batch import (
    GRAZING,
    SEED,
    Array,
    directions,
    random_inputs,
)
from mxeon.conformance.checks.controls import Call, scale_last
from mxeon.conformance.checks.evaluate import judge_measurements, not_measured
from mxeon.conformance.checks.measures import Measurement, absolute, relative
from mxeon.conformance.checks.tolerances import LOSS, VALUE, Tolerance
from mxeon.conformance.diagnosis import Diagnosis
from mxeon.conformance.results import Result
from mxeon.errors import NotRun, ShaderError
from mxeon.models import albedo
from mxeon.models import table as reference
from mxeon.shaders.functions import names

SUBJECT = "shader twins"  # the name in reports
PAIRS = 1 << 16
KINDS = ("pairs", "pictures", "planes")  # of probes whose hosts evaluate functions


@dataclass(frozen=True)
class FunctionCheck:
    """A row of the table: what is asked of the shader functions.

    Attributes
    ----------
    key, claim : str
        One word, and a sentence.
    measure : callable (call) -> Measurement
        `call(function, *arguments)` evaluates a shader function.
    variant : str
        The error that the control makes.
    control : callable (call) -> call
    tolerance : Tolerance
    """

    key: str
    claim: str
    measure: Callable[[Call], Measurement]
    variant: str
    control: Callable[[Call], Call]
    tolerance: Tolerance


def measure_functions(call: Call) -> Measurement:
    """The function that is furthest from its NumPy version, in pi f cos or in albedo."""
    errors = dict(_errors(call))
    name = max(errors, key=lambda function: errors[function])
    return Measurement(errors[name], {name: [errors[name]]})


def measure_loss(call: Call) -> Measurement:
    """1 - E of FON, relative, down to grazing: as H(mu), which the shader functions compute."""
    mu = np.geomspace(GRAZING, 1.0, PAIRS).astype(np.float32).astype(np.float64)
    error = relative(call("fon_loss", mu), np.reshape(albedo.fon_loss(mu), (-1, 1)))
    return Measurement(float(error.max()), {"mu": [float(mu[error.argmax()])]})


def _errors(call: Call) -> Iterator[tuple[str, float]]:
    """Names of the shader functions that are models or albedos, and their largest errors."""
    rng = np.random.default_rng(SEED)
    wo, wi = directions(rng, PAIRS), directions(rng, PAIRS)
    for row in reference.MODELS:
        inputs = random_inputs(rng, PAIRS, row)
        arguments = [wo, wi, inputs["color"], *([inputs["roughness"]] if row.parameter else [])]
        name = row.brdf.__name__
        if name in names("glsl"):
            difference = (call(name, *arguments) - row.brdf(*arguments)) * wi[:, 2:]
            yield name, float(np.pi * absolute(difference, 0.0).max())
    inputs = random_inputs(rng, PAIRS, reference.model("eon"))
    for name, arguments in _albedos(wo[:, 2], inputs["color"], inputs["roughness"]).items():
        expected = getattr(albedo, name)(*arguments).reshape(PAIRS, -1)
        yield name, float(absolute(call(name, *arguments), expected).max())


def _albedos(mu: Array, rho: Array, roughness: Array) -> dict[str, list[Array]]:
    """Arguments of the albedo functions, by their names."""
    sigma = 0.5 * np.pi * roughness
    return {
        "qon_albedo_dir": [mu, sigma],
        "qon_albedo_avg": [sigma],
        "fon_albedo_dir": [mu, roughness],
        "fon_albedo_avg": [roughness],
        "eon_albedo_dir": [mu, rho, roughness],
        "eon_albedo_avg": [rho, roughness],
    }


FUNCTION_CHECKS = (
    FunctionCheck(
        "twins",
        "The functions of the shader twins are the NumPy models.",
        measure_functions,
        "the last argument is 5 % off",
        scale_last,
        VALUE,
    ),
    FunctionCheck(
        "loss",
        "1 - E keeps its relative accuracy down to a cosine of 1e-6.",
        measure_loss,
        "the last argument is 5 % off",
        scale_last,
        LOSS,
    ),
)


def judge_functions(
    host: Any, checks: Sequence[FunctionCheck] = FUNCTION_CHECKS
) -> tuple[Result, ...]:
    """Results of the checks of the shader functions on a host; they are eonlib's."""
    return tuple(_judge_check(check, host) for check in checks)


def _judge_check(check: FunctionCheck, host: Any) -> Result:
    fields = {
        "check": check.key,
        "claim": check.claim,
        "subject": SUBJECT,
        "host": host.name,
        "library": "eonlib",
    }
    try:
        right = check.measure(host.call)
        wrong = check.measure(check.control(host.call))
    except (NotRun, ShaderError) as error:
        return not_measured(fields, error)
    return judge_measurements(fields, check.tolerance, right, check.variant, wrong, Diagnosis())
