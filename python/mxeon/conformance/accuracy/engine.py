# SPDX-License-Identifier: Apache-2.0
"""Errors of an engine's own functions, measured on the host, and the tolerances that take them in."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from mxeon.conformance.accuracy import utilities
from mxeon.conformance.accuracy.bsdf import power_of
from mxeon.conformance.accuracy.thin_films import FILM_PHASE, FILM_WAVES
from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.emission import EXPONENTS
from mxeon.conformance.nodes.media import MediumSubject
from mxeon.conformance.nodes.subject import Subject
from mxeon.conformance.samples.batch import SEED, Array, float32
from mxeon.conformance.samples.edge_cases import LEAST_SHEEN
from mxeon.conformance.samples.tolerance import ROUNDING, Tolerance, rounded_up
from mxeon.hosts.base import Host

COUNT = 1 << 14
FEWER = 1 << 12  # arguments of the functions of utility nodes
LEAST_LOGARITHM = 1e-4  # number whose logarithm is measured


@dataclass(frozen=True)
class EngineFunction:
    """A function that engines have themselves."""

    name: str  # in GLSL, of x or of x and y
    expression: str
    exact: Callable[..., Array]  # the same in NumPy

    def errors(self, host: Host, *arguments: Array) -> Array:
        """Errors of a host's values of arguments that are float32 numbers, (N,)."""
        function = f"mxeon_{self.name}"
        parameters = ", ".join(f"float {name}" for name in "xy"[: len(arguments)])
        text = f"float {function}({parameters})\n{{\n    return {self.expression};\n}}\n"
        values = host.execute(text, function, *arguments)[:, 0]
        return np.abs(values - self.exact(*arguments))


POWER = EngineFunction("power", "pow(x, y)", np.power)
EXPONENTIAL = EngineFunction("exponential", "exp(-x)", lambda x: np.exp(-x))
LOGARITHM = EngineFunction("logarithm", "log(x)", np.log)
WAVE = EngineFunction("wave", "max(cos(x), sin(x))", lambda x: np.maximum(np.cos(x), np.sin(x)))
TURN = EngineFunction(
    "turn",
    "max(abs(cos(6.28318530718 * x)), abs(sin(6.28318530718 * x)))",
    lambda x: np.maximum(np.abs(np.cos(2.0 * np.pi * x)), np.abs(np.sin(2.0 * np.pi * x))),
)


def widen_for_engine(tolerance: Tolerance, subject: Subject, kind: str, host: Host) -> Tolerance:
    """Tolerance of values on a host, with the errors of the engine's own functions that make them."""
    if kind in (kinds.UTILITY, kinds.UTILITY_OSL):
        return _utility_tolerance(subject, kind, host)
    if kind == kinds.FITTED:
        measured = power_of(sheen_error(host), 1.0 / LEAST_SHEEN)
        return max(tolerance, measured, key=lambda each: each.value)
    error = 0.0
    if kind == kinds.POWER_EMISSION:
        error = power_error(host)
    if kind == kinds.MEDIUM:
        error = 2.0 * exponential_error(host)
        if isinstance(subject, MediumSubject) and subject.combined:
            error += 2.0 * power_error(host)
    return replace(tolerance, value=rounded_up(tolerance.value + error)) if error else tolerance


def widen_for_waves(tolerance: Tolerance, subject: Subject, kind: str, host: Host) -> Tolerance:
    """Tolerance of a film's curve on a host, with the error of the engine's own cosine and sine."""
    error = max(wave_error(host) - 2.0 * ROUNDING, 0.0)
    return replace(tolerance, value=rounded_up(tolerance.value + FILM_WAVES * error))


def _utility_tolerance(subject: Subject, kind: str, host: Host) -> Tolerance:
    if subject.node == "blackbody":
        return utilities.BLACKBODY if kind == kinds.UTILITY else utilities.OSL_BLACKBODY
    if subject.node == "chiang_hair_roughness":
        return utilities.power_tolerance(high_power_error(host))
    if subject.node == "deon_hair_absorption_from_melanin":
        return utilities.melanin_tolerance(logarithm_error(host))
    if subject.node == "chiang_hair_absorption_from_color":
        return utilities.color_tolerance(logarithm_error(host))
    return utilities.TOLERANCES[subject.title]


@lru_cache(maxsize=16)
def sheen_error(host: Host) -> float:
    """Error of the Conty-Kulla sheen by the engine's own power, relative where the sheen exceeds 1.

    The sheen, as pi f cos, is at most (2 + n) / 8 times a sine to the power of n, 1 / roughness.
    """
    rng = np.random.default_rng(SEED)
    exponent = LEAST_SHEEN ** -rng.random(COUNT)
    sine = float32(rng.random(COUNT) ** (1.0 / exponent))  # uniform powers
    exponent = float32(exponent)
    factor = (2.0 + exponent) / 8.0
    scale = np.maximum(1.0, factor * sine**exponent)
    return float((factor * POWER.errors(host, sine, exponent) / scale).max())


@lru_cache(maxsize=16)
def power_error(host: Host) -> float:
    """Error of the engine's own power of numbers in [0, 1], beside its rounding."""
    rng = np.random.default_rng(SEED)
    base, exponent = float32(rng.random(COUNT)), float32(rng.uniform(*EXPONENTS, COUNT))
    return _beside(POWER.errors(host, base, exponent))


@lru_cache(maxsize=16)
def exponential_error(host: Host) -> float:
    """Error of the engine's own exp(-x) for x in [0, 8], beside its rounding."""
    return _beside(EXPONENTIAL.errors(host, float32(np.linspace(0.0, 8.0, COUNT))))


@lru_cache(maxsize=16)
def high_power_error(host: Host) -> float:
    """Error of the engine's own 20th and 22nd power in [0, 1]."""
    x = _shares()
    return float(POWER.errors(host, x, np.where(np.arange(len(x)) % 2, 20.0, 22.0)).max())


@lru_cache(maxsize=16)
def logarithm_error(host: Host) -> float:
    """Error of the engine's own logarithm of numbers below 1."""
    return float(LOGARITHM.errors(host, float32(LEAST_LOGARITHM ** (1.0 - _shares()))).max())


@lru_cache(maxsize=16)
def wave_error(host: Host) -> float:
    """Error of the engine's own cosine and sine of the phases of a film."""
    return float(WAVE.errors(host, float32(np.linspace(0.0, FILM_PHASE, COUNT))).max())


def _shares() -> Array:
    """Numbers in [0, 1], the last of which is 1."""
    return float32(np.append(np.random.default_rng(SEED).random(FEWER), 1.0))


def _beside(errors: Array) -> float:
    """Largest error beside one rounding of 1."""
    return max(float(errors.max()) - ROUNDING, 0.0)
