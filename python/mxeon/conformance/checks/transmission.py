# SPDX-License-Identifier: Apache-2.0
"""Checks of light that microfacets transmit, in the branch that looks up an environment."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from mxeon.conformance.case import SCATTERING, Case
from mxeon.conformance.check import (
    check,
    drop_changes,
    of_family,
    offset,
    scale,
    with_inputs,
    with_values,
)
from mxeon.conformance.checks.lobes import SURROUNDINGS
from mxeon.conformance.diagnosis import inputs as input_diagnosis
from mxeon.conformance.diagnosis.candidates import NEAR, Diagnosis, not_finite
from mxeon.conformance.samples import Array, Batch, aimed, rounded, sky, sky_map, texel_middles
from mxeon.conformance.specs.microfacets import TransmissionSpec
from mxeon.conformance.tolerance import (
    Compared,
    Measurement,
    count_named,
    count_not_finite,
    count_of,
)
from mxeon.models.microfacet.ggx import smith_g1
from mxeon.models.transmission import refraction_direction

SEEN = "the mean of 1 - F over the visible normals"
SUMMED = 1e-3  # rms by which a sum over the normals of an engine differs from it
COUNT = 1 << 9  # views of smooth surfaces
FEW = 1 << 6  # views whose inputs are changed
LEAST_SEEN = 0.05  # cosine of them
CRITICAL = 0.05  # distance from the critical angle, in its cosine: F has an infinite slope there
LEAST_PASSED = 0.01  # light of which the place is asked
NORMAL = (0.0, 0.0, 1.0)
ONE = np.ones((1, 3))

is_transmitting = of_family(TransmissionSpec)


def unknown(case: Case) -> Diagnosis:
    return Diagnosis(input_diagnosis.UNKNOWN)


def diagnose_transmitted(case: Case) -> Diagnosis:
    """Whether the light is what facets pass, or that over G_1, as MaterialX has it; and where it is NaN."""
    compared, spec = list(transmitted(case)), case.of(TransmissionSpec)

    def distance(found: Callable[[Compared], Array]) -> float:
        return float(np.sqrt(np.mean(np.concatenate([_squares(c, found(c)) for c in compared]))))

    distances = {
        f"{SEEN}, divided by G_1 of the view": distance(lambda c: _seen(spec, c.batch, True)),
        SEEN: distance(lambda c: _seen(spec, c.batch)),
    }
    words = min(distances, key=lambda name: distances[name])
    known = distances[words] < max(NEAR * distance(lambda c: c.expected), SUMMED)
    return Diagnosis("; ".join(filter(None, (words if known else "", not_finite(compared)))))


def _squares(compared: Compared, expected: Array) -> Array:
    """Squared errors of the values that are finite."""
    known = np.isfinite(compared.measured)
    return np.asarray((compared.measured - expected)[known] ** 2)


def _seen(spec: TransmissionSpec, batch: Batch, masked: bool = False) -> Array:
    """The mean of 1 - F over the normals seen, (N, 3); divided by G_1 of the view, if that is masked."""
    value: Array = batch.strength * spec.functions.passed(batch.wo, batch.inputs, False)
    return value / smith_g1(batch.wo, batch.inputs["roughness"])[:, np.newaxis] if masked else value


@check(
    "transmitted",
    "In a uniform environment, the light that passes lies between the BTDF's share and all that is not reflected.",
    is_transmitting,
    scale("values are twice as large", 2.0),
    "value",
    diagnose=diagnose_transmitted,
)
def transmitted(case: Case) -> Iterator[Compared]:
    """Light of a uniform environment through the surface, against the nearest value inside the limits.

    One is what the BTDF passes, without compensation; the other all that is not reflected, with tint and
    weight. The first is the larger for some colors of Schlick's curve, of which the text compensates too
    much; and the most exceeds 1 where the node's own curve is below 0.
    """
    functions = case.of(TransmissionSpec).functions
    for batch in case.views:
        measured = case.transmitted(batch)
        rest = functions.tint(batch.inputs) * (1.0 - functions.reflected(batch.wo, batch.inputs))
        ends = np.maximum(rest, 0.0), functions.passed(batch.wo, batch.inputs, True)
        least, most = (batch.strength * each for each in (np.minimum(*ends), np.maximum(*ends)))
        yield Compared(batch, measured, np.clip(measured, least, most))


@check(
    "clear",
    "A white lobe that reflects and transmits returns all light of a uniform environment.",
    lambda spec: isinstance(spec, TransmissionSpec) and spec.reflects,
    scale("values are 5 % too large", 1.05),
    "light",
    diagnose=diagnose_transmitted,
)
def clear(case: Case) -> Iterator[Compared]:
    for batch in case.views:
        white = batch.altered(tint=(1.0, 1.0, 1.0), weight=1.0)
        yield Compared(white, case.albedo(white) + case.transmitted(white), ONE)


@check(
    "kept",
    "Modes R and RT reflect, and pass to their base, the same light; mode T reflects nothing; mode R transmits nothing.",
    is_transmitting,
    offset,
    diagnose=unknown,
)
def kept(case: Case) -> Iterator[Compared]:
    """Reflection beside transmission, against that of mode R, or none; and none through mode R."""
    spec = case.of(TransmissionSpec)
    only = case.another(spec.reflection) if spec.reflects else None
    none = 0.0 * ONE
    for batch in case.views:
        yield Compared(batch, case.direct(batch), only.direct(batch) if only else none)
        yield Compared(batch, case.albedo(batch), only.albedo(batch) if only else none)
        for branch in SCATTERING if only else SCATTERING[:2]:
            expected = only.throughput(batch, branch) if only else ONE
            yield Compared(batch, case.throughput(batch, branch), expected)
        if only:
            yield Compared(batch, only.transmitted(batch), none)


DENSER = with_inputs("the index is different", ior=2.5, color0=(0.5, 0.5, 0.5))


@check(
    "critical",
    "A smooth surface transmits 1 - F, and nothing beyond the critical angle.",
    is_transmitting,
    DENSER,
    diagnose=diagnose_transmitted,
)
def critical(case: Case) -> Compared:
    batch = _smooth(case)
    functions = case.of(TransmissionSpec).functions
    index, mu = functions.ior(batch.inputs), np.minimum(batch.wo[:, 2], 1.0)
    away = np.abs(mu - np.sqrt(np.maximum(1.0 - index * index, 0.0))) > CRITICAL
    batch, mu = batch.where(away), mu[away]
    passed = functions.tint(batch.inputs) * (1.0 - functions.fresnel(mu, batch.inputs))
    return Compared(batch, case.transmitted(batch), batch.strength * passed)


@check(
    "refraction",
    "An uneven environment is looked up along the ray that a solid sphere refracts.",
    is_transmitting,
    DENSER,
    tolerance=SURROUNDINGS,
    lit=True,
    diagnose=unknown,
)
def refraction(case: Case) -> Compared:
    batch, place = _looking(_smooth(case), case.of(TransmissionSpec).functions.ior)
    level = case.transmitted(batch)
    bright = level.min(axis=1) > LEAST_PASSED
    measured = case.transmitted(batch, sky_map()) / np.where(bright[:, np.newaxis], level, 1.0)
    return Compared(batch.where(bright), measured[bright], sky(place[bright]))


def _looking(batch: Batch, ior: Callable[[Mapping[str, Array]], Array]) -> tuple[Batch, Array]:
    """Views in frames from which a sphere refracts them to middles of texels of the sky, and these."""
    out = through_sphere(batch.wo, ior(batch.inputs))
    place = texel_middles(out)
    frames = aimed(np.broadcast_to(np.eye(3), (len(out), 3, 3)), out, place)
    axes = {"tangent": rounded(frames[:, :, 0].T), "normal": rounded(frames[:, :, 2].T)}
    return replace(batch.altered(**axes), frame=frames), place


def through_sphere(wo: Array, index: Array) -> Array:
    """Direction of a view that a solid sphere has refracted twice, (N, 3).

    At the far side the ray meets the surface at the same angle: it turns twice by the same amount.
    """
    inner = refraction_direction(wo, NORMAL, index)
    far = inner * (2.0 * inner[:, 2:]) - np.array(NORMAL)  # towards the inside
    cosine = -np.sum(inner * far, axis=1, keepdims=True)
    n = index[:, np.newaxis]
    out = np.sqrt(np.maximum(1.0 - n * n * (1.0 - cosine * cosine), 0.0))
    return np.asarray(n * inner + (n * cosine - out) * far)


def _smooth(case: Case) -> Batch:
    """Views of smooth surfaces of all indices, with the node's colors."""
    batch = case.few[0].first(COUNT)
    batch = batch.where(batch.wo[:, 2] >= LEAST_SEEN)
    return batch.altered(roughness=(0.0, 0.0))


def _edges(case: Case) -> tuple[Batch, Array]:
    """Light at the edges of the domain, of every fifth pair: each costs a sum over directions."""
    batch = case.samples.edges
    batch = batch.where(np.arange(len(batch.wo)) % 5 == 0)
    return batch, case.transmitted(batch)


@check(
    "transmitted_finite",
    "All light through the surface is finite at the edges of the domain.",
    is_transmitting,
    with_values("every value is infinite", lambda batch, values: np.full_like(values, np.inf)),
    tolerance=count_of("values"),
    diagnose=lambda case: Diagnosis(
        not_finite([Compared(batch, found, found) for batch, found in [_edges(case)]])
    ),
)
def transmitted_finite(case: Case) -> Measurement:
    return count_not_finite(*_edges(case))


@check(
    "transmitted_inputs",
    "Every input except retroreflective changes the light through the surface.",
    is_transmitting,
    drop_changes,
    tolerance=count_of("inputs"),
    lit=True,
    diagnose=lambda case: Diagnosis(f"no effect, or a wrong one: {', '.join(wrong_inputs(case))}"),
)
def transmitted_inputs(case: Case) -> Measurement:
    return count_named(wrong_inputs(case))


def wrong_inputs(case: Case) -> list[str]:
    """Inputs that change no light through the surface, and those that must not.

    The retroreflective mode is of the reflection alone.
    """
    batch, wrong = case.few[0].first(FEW), []
    plain = case.transmitted(batch, sky_map())
    for name, (without, change) in case.changes.items():
        before = case.transmitted(batch.altered(**without), sky_map()) if without else plain
        after = case.transmitted(batch.altered(**change), sky_map())
        if np.array_equal(before, after, equal_nan=True) != (name == "retroreflective"):
            wrong.append(name)
    return wrong
