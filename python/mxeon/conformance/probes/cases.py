# SPDX-License-Identifier: Apache-2.0
"""Values of a probe beside those that are expected of it, which checks measure and diagnoses explain."""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.measurement import Case
from mxeon.conformance.samples.uneven_environment import sky_map

SCATTERING = ("direct", "environment", "transmission")  # branches of light that is scattered
BRANCHES = (*SCATTERING, "emission")
WHITE, BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
LEAST_LIGHT = 0.01  # of a uniform environment, where the place of an uneven one is asked


def value_cases(probe: Probe) -> Iterator[Case]:
    """Values against the expected ones, over all pairs of the probe."""
    for batch in probe.batches:
        yield Case(batch, probe.direct(batch), probe.expected(batch))


def conditioned(cases: Callable[[Probe], Iterator[Case]]) -> Callable[[Probe], Iterator[Case]]:
    """The same cases, each over its condition."""
    return lambda probe: (over_condition(probe, case) for case in cases(probe))


def over_condition(probe: Probe, case: Case) -> Case:
    """Values that count relative to what they are sensitive to."""
    batch, measured, expected = case
    condition = probe.condition(batch)
    return Case(batch, measured / condition, expected / condition)


def albedo_cases(probe: Probe) -> Iterator[Case]:
    """The environment branch against the directional albedo."""
    for batch, expected in zip(probe.cosines, probe.albedos, strict=True):
        yield Case(batch, probe.albedo(batch), expected)


def frame_cases(probe: Probe) -> Iterator[Case]:
    """Values in turned frames, of which half have a normal that faces away, against those in none."""
    batch = probe.turned
    local = replace(batch.altered(normal=(0.0, 0.0, 1.0), tangent=(1.0, 0.0, 0.0)), frame=None)
    for output in (probe.direct, probe.albedo):
        yield Case(batch, output(batch), output(local))


def surroundings_case(probe: Probe) -> Case:
    batch = probe.turned
    if "color" in batch.inputs:
        batch = batch.altered(color=WHITE)
    level = probe.albedo(batch)
    bright = level.min(axis=1) > LEAST_LIGHT
    if bright.any():  # or what is dark is wrong
        batch, level = batch.where(bright), level[bright]
    with np.errstate(divide="ignore", invalid="ignore"):
        measured = probe.albedo(batch, sky_map()) / level
    return Case(batch, measured, probe.expected_sky(batch))


def throughput_cases(probe: Probe, branch: str) -> Iterator[Case]:
    for batch in probe.few:
        yield Case(batch, probe.throughput(batch, branch), np.zeros((len(batch.wo), 3)))


def dead_inputs(probe: Probe) -> list[str]:
    """Names of the inputs whose change does not show in the values."""
    batch = probe.few[0]
    plain = probe.direct(batch)  # most changes are of the batch as it is
    dead = []
    for name, (before, after) in probe.changes.items():
        one = probe.direct(batch.altered(**before)) if before else plain
        other = probe.direct(batch.altered(**after))
        if np.array_equal(one, other, equal_nan=True):
            dead.append(name)
    return dead


def edge_case(probe: Probe) -> Case:
    """Values and albedos at the edges of the domain, beside 0."""
    batch = probe.edges
    values = np.concatenate([probe.direct(batch), probe.albedo(batch)], axis=1)
    return Case(batch, values, np.zeros_like(values))


LIGHT = ("direct", "environment")  # branches that light a base from above


def layering_cases(probe: Probe) -> Iterator[Case]:
    """Throughput of a layer against 1 - E, in the branches that light a base from above."""
    for branch in LIGHT:
        yield from _throughput_cases(probe, branch)


def transmission_cases(probe: Probe) -> Iterator[Case]:
    """Throughput of a layer against 1 - E, in the branch of light through the base."""
    return _throughput_cases(probe, "transmission")


def _throughput_cases(probe: Probe, branch: str) -> Iterator[Case]:
    for batch, albedo in zip(probe.cosines, probe.albedos, strict=True):
        yield Case(batch, probe.throughput(batch, branch), np.maximum(1.0 - albedo, 0.0))


def stretched_case(probe: Probe) -> Case:
    batch, expected = probe.stretched
    return Case(batch, probe.albedo(batch), expected)


def back_cases(probe: Probe) -> Iterator[Case]:
    """Radiance towards views from the back."""
    batch = probe.backs
    yield Case(batch, probe.direct(batch), probe.expected(batch))


def transmittance_cases(probe: Probe) -> Iterator[Case]:
    """Light through a medium and the throughput of a surface over it, against its transmittance."""
    (batch,) = probe.batches
    expected = probe.expected(batch)
    yield Case(batch, probe.direct(batch), expected)
    yield Case(batch, probe.through, expected)
