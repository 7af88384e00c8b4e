# SPDX-License-Identifier: Apache-2.0
"""Measurements of light through microfacets: its share, its place, and what it leaves alone."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace

import numpy as np

from mxeon.conformance.nodes.transmission import TransmissionSubject
from mxeon.conformance.probes.cases import SCATTERING
from mxeon.conformance.probes.probe import Probe, subject_of
from mxeon.conformance.samples.batch import Array, Batch, rounded
from mxeon.conformance.samples.edge_cases import aimed
from mxeon.conformance.samples.measurement import Case
from mxeon.conformance.samples.uneven_environment import sky, sky_map, texel_middles
from mxeon.models.microfacet.ggx import smith_g1
from mxeon.models.transmission.refraction import refraction_direction

COUNT = 1 << 9  # views of smooth surfaces
FEW = 1 << 6  # views whose inputs are changed
LEAST_SEEN = 0.05  # cosine of them
CRITICAL = 0.05  # distance from the critical angle, in its cosine: F has an infinite slope there
LEAST_PASSED = 0.01  # light of which the place is asked
NORMAL = (0.0, 0.0, 1.0)
ONE = np.ones((1, 3))


def transmitted(probe: Probe) -> list[Case]:
    """Light of a uniform environment through the surface, against the nearest value inside the limits.

    One is what the BTDF passes, without compensation; the other all that is not reflected. The first is
    the larger for some colors of Schlick's curve, of which the text compensates too much.
    """
    cases, subject = [], subject_of(probe, TransmissionSubject)
    for batch in probe.cosines:
        measured = probe.transmitted(batch)
        cases.append(Case(batch, measured, np.clip(measured, *limits(subject, batch))))
    return cases


def limits(subject: TransmissionSubject, batch: Batch) -> tuple[Array, Array]:
    """Least and most light that passes, with tint and weight, (N, 3) each.

    The most exceeds 1 where the node's own curve is below 0.
    """
    functions = subject.functions
    rest = functions.tint(batch.inputs) * (1.0 - functions.reflected(batch.wo, batch.inputs))
    rest, passed = np.maximum(rest, 0.0), functions.passed(batch.wo, batch.inputs, True)
    return batch.strength * np.minimum(rest, passed), batch.strength * np.maximum(rest, passed)


def seen(subject: TransmissionSubject, batch: Batch, masked: bool = False) -> Array:
    """The mean of 1 - F over the normals seen, (N, 3); divided by G_1 of the view, if that is masked."""
    value: Array = batch.strength * subject.functions.passed(batch.wo, batch.inputs, False)
    return value / smith_g1(batch.wo, batch.inputs["roughness"])[:, np.newaxis] if masked else value


def clear(probe: Probe) -> Iterable[Case]:
    """Light of a uniform environment that a white lobe reflects and transmits, against all of it."""
    cases = []
    for batch in probe.cosines:
        white = batch.altered(tint=(1.0, 1.0, 1.0), weight=1.0)
        cases.append(Case(white, probe.albedo(white) + probe.transmitted(white), ONE))
    return cases


def kept(probe: Probe) -> Iterable[Case]:
    """Reflection beside transmission, against that of mode R, or none; and none through mode R."""
    cases = []
    only = probe.reflection if subject_of(probe, TransmissionSubject).reflects else None
    for batch in probe.cosines:
        none = 0.0 * ONE
        cases += [
            Case(batch, probe.direct(batch), only.direct(batch) if only else none),
            Case(batch, probe.albedo(batch), only.albedo(batch) if only else none),
        ]
        for branch in SCATTERING if only else SCATTERING[:2]:
            expected = only.throughput(batch, branch) if only else ONE
            cases.append(Case(batch, probe.throughput(batch, branch), expected))
        if only:
            cases.append(Case(batch, only.transmitted(batch), none))
    return cases


def critical(probe: Probe) -> Iterable[Case]:
    """Light through smooth surfaces against 1 - F, and against none beyond the critical angle."""
    batch = _smooth(probe)
    functions = subject_of(probe, TransmissionSubject).functions
    index, mu = functions.ior(batch.inputs), np.minimum(batch.wo[:, 2], 1.0)
    away = np.abs(mu - np.sqrt(np.maximum(1.0 - index * index, 0.0))) > CRITICAL
    batch, mu = batch.where(away), mu[away]
    passed = functions.tint(batch.inputs) * (1.0 - functions.fresnel(mu, batch.inputs))
    return [Case(batch, probe.transmitted(batch), batch.strength * passed)]


def refraction_case(probe: Probe) -> Case:
    """An uneven environment through smooth surfaces, over a uniform one, against its place."""
    batch, place = _looking(_smooth(probe), subject_of(probe, TransmissionSubject).functions.ior)
    level = probe.transmitted(batch)
    bright = level.min(axis=1) > LEAST_PASSED
    measured = probe.transmitted(batch, sky_map()) / np.where(bright[:, np.newaxis], level, 1.0)
    return Case(batch.where(bright), measured[bright], sky(place[bright]))


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
    direction: Array = n * inner + (n * cosine - out) * far
    return direction


def _smooth(probe: Probe) -> Batch:
    """Views of smooth surfaces of all indices, with the node's colors."""
    batch: Batch = probe.few[0].first(COUNT)
    batch = batch.where(batch.wo[:, 2] >= LEAST_SEEN)
    return batch.altered(roughness=(0.0, 0.0))


def finite_case(probe: Probe) -> Case:
    """Light at the edges of the domain, of every fifth pair: each costs a sum over directions."""
    batch: Batch = probe.edges
    batch = batch.where(np.arange(len(batch.wo)) % 5 == 0)
    values = probe.transmitted(batch)
    return Case(batch, values, np.zeros_like(values))


def wrong_inputs(probe: Probe) -> list[str]:
    """Inputs that change no light through the surface, and those that must not.

    The retroreflective mode is of the reflection alone.
    """
    batch, wrong = probe.few[0].first(FEW), []
    plain = probe.transmitted(batch, sky_map())
    for name, (without, change) in probe.changes.items():
        before = probe.transmitted(batch.altered(**without), sky_map()) if without else plain
        after = probe.transmitted(batch.altered(**change), sky_map())
        if np.array_equal(before, after, equal_nan=True) != (name == "retroreflective"):
            wrong.append(name)
    return wrong
