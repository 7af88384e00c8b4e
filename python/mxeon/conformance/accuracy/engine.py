# SPDX-License-Identifier: Apache-2.0
"""Errors of an engine's own functions, measured on the host, and the tolerances that take them in."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from mxeon.conformance.accuracy.diffuse import power_of
from mxeon.conformance.accuracy.thin_films import FILM_PHASE, FILM_WAVES
from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.subject import Subject
from mxeon.conformance.samples.batch import SEED
from mxeon.conformance.samples.edge_cases import LEAST_SHEEN
from mxeon.conformance.samples.tolerance import ROUNDING, Tolerance, rounded_up
from mxeon.hosts.base import Host

COUNT = 1 << 14
POWER = """float mxeon_power(float x, float y)
{
    return pow(x, y);
}
"""
WAVE = """float mxeon_wave(float x)
{
    return max(cos(x), sin(x));
}
"""


def widen_for_engine(tolerance: Tolerance, subject: Subject, kind: str, host: Host) -> Tolerance:
    """Tolerance of values on a host: wider for a sheen of powers, by the engine's own."""
    if kind != kinds.FITTED:
        return tolerance
    measured = power_of(power_error(host), 1.0 / LEAST_SHEEN)
    return max(tolerance, measured, key=lambda each: each.value)


@lru_cache(maxsize=16)
def power_error(host: Host) -> float:
    """Error of the Conty-Kulla sheen by the engine's own power, relative where the sheen exceeds 1.

    The sheen, as pi f cos, is at most (2 + n) / 8 times a sine to the power of n, 1 / roughness.
    """
    rng = np.random.default_rng(SEED)
    exponent = LEAST_SHEEN ** -rng.random(COUNT)
    sine = rng.random(COUNT) ** (1.0 / exponent)  # uniform powers
    sine, exponent = (each.astype(np.float32).astype(np.float64) for each in (sine, exponent))
    power = sine**exponent
    error = np.abs(host.execute(POWER, "mxeon_power", sine, exponent)[:, 0] - power)
    factor = (2.0 + exponent) / 8.0
    return float((factor * error / np.maximum(1.0, factor * power)).max())


def widen_for_waves(tolerance: Tolerance, subject: Subject, kind: str, host: Host) -> Tolerance:
    """Tolerance of a film's curve on a host, with the error of the engine's own cosine and sine."""
    error = max(wave_error(host) - 2.0 * ROUNDING, 0.0)
    return replace(tolerance, value=rounded_up(tolerance.value + FILM_WAVES * error))


@lru_cache(maxsize=16)
def wave_error(host: Host) -> float:
    """Error of the engine's own cosine and sine of the phases of a film."""
    phase = np.linspace(0.0, FILM_PHASE, COUNT).astype(np.float32).astype(np.float64)
    exact = np.maximum(np.cos(phase), np.sin(phase))
    return float(np.abs(host.execute(WAVE, "mxeon_wave", phase)[:, 0] - exact).max())
