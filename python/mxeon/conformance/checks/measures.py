# SPDX-License-Identifier: Apache-2.0
"""Measurements of the checks: the worst error of a probe, and its point."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.probes.cases import (
    BRANCHES,
    WHITE,
    edge_case,
    throughput_cases,
)
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.samples.batch import Array, Batch
from mxeon.conformance.samples.measurement import (
    Case,
    Measurement,
    absolute,
    count_named,
    count_not_finite,
)
from mxeon.hosts import front_lit_only
from mxeon.models import table as reference
from mxeon.models.core.quadrature import hemisphere_nodes
from mxeon.shaders.nodes import FLAG

COLORS = ((0.2, 0.2, 0.2), (0.5, 0.5, 0.5), (0.8, 0.8, 0.8), (0.8, 0.4, 0.1))
QUADRATURE_NODES = 16  # reaches 1e-9 on the models judged, far below float32


def quadrature(probe: Probe) -> Iterable[Case]:
    """Directional albedo, integrated from the host's values, against its closed form."""
    rows = list(product((0.1, 0.3, 0.6, 0.95), COLORS, (0.25, 1.0)))
    mu, color, roughness = (np.array(column) for column in zip(*rows, strict=True))
    wo = np.stack([np.sqrt(1.0 - mu * mu), 0.0 * mu, mu], axis=1)
    batch = Batch(wo, wo, {"color": color, "roughness": roughness})
    return [Case(batch, *integrated(probe, mu, color, roughness))]


def integrated(
    probe: Probe, mu: Array, color: ArrayLike, roughness: ArrayLike
) -> tuple[Array, Array]:
    """Directional albedo at some cosines: from the host's values, and in closed form.

    The host is asked once for all of them: to some a question takes as long as a thousand values.

    Parameters
    ----------
    probe : PairProbe
    mu : ndarray, shape (N,)
        Cosines.
    color : array_like, shape (3,) or (N, 3)
    roughness : array_like, number or shape (N,)

    Returns
    -------
    measured, expected : ndarray, shape (N, 3)
    """
    # Lay the nodes of all cosines out one after the other.
    rules = [hemisphere_nodes(float(each), QUADRATURE_NODES) for each in mu]
    wi = np.concatenate([directions for _, directions, _ in rules])
    count = len(wi) // len(mu)
    wo = np.repeat([view for view, _, _ in rules], count, axis=0)
    color = np.broadcast_to(color, (len(mu), 3))
    roughness = np.broadcast_to(roughness, len(mu))
    inputs = {"color": np.repeat(color, count, 0), "roughness": np.repeat(roughness, count)}
    # Sum the host's values over those of each.
    values = probe.direct(Batch(wo, wi, inputs)) / (np.pi * wi[:, 2:])
    parts = values.reshape(len(mu), count, 3)
    measured = [weights @ part for (_, _, weights), part in zip(rules, parts, strict=True)]
    row = reference.model(probe.subject.model)
    return np.array(measured), row.closed_albedo_dir(mu, color, roughness)


def black(probe: Probe) -> Iterable[Case]:
    """Values of a black surface against 0."""
    batches = [batch.altered(**probe.black) for batch in probe.few]
    return (Case(batch, probe.direct(batch), np.zeros((1, 3))) for batch in batches)


def throughput(probe: Probe) -> Iterable[Case]:
    """Throughput against 0 of an opaque node, in every branch and for every weight."""
    return (case for branch in BRANCHES for case in throughput_cases(probe, branch))


def furnace(probe: Probe) -> Iterable[Case]:
    """Albedo of a white surface against 1."""
    batches = [batch.altered(color=WHITE, weight=1.0) for batch in probe.cosines]
    return (Case(batch, probe.albedo(batch), np.ones((1, 3))) for batch in batches)


def reciprocity(probe: Probe) -> Iterable[Case]:
    """f(wo, wi) against f(wi, wo), both times both cosines."""
    cases: list[Case] = []
    for batch in probe.few:
        side = -1.0 if np.all(batch.wi[:, 2] <= 0.0) else 1.0  # light through the surface
        swapped = replace(batch, wo=side * batch.wi, wi=side * batch.wo)
        with np.errstate(invalid="ignore"):  # inf x 0 is NaN, which `absolute` notices
            forward = probe.direct(batch) * batch.wo[:, 2:]
            backward = probe.direct(swapped) * np.abs(batch.wi[:, 2:])
        cases.append(Case(batch, forward, backward))
    return cases


def lambert(probe: Probe) -> Iterable[Case]:
    """Values at roughness 0 against Lambert's."""
    batches = [batch.altered(roughness=0.0) for batch in probe.few]
    return (Case(batch, probe.direct(batch), batch.expected("lambert")) for batch in batches)


def flag(probe: Probe) -> Measurement:
    """The part that the subject's own mode has in a wrong change by the flag, relative to the models'."""
    error = largest = 0.0
    modes = ("eon", "qon") if probe.subject.model == "eon" else ("qon", "eon")
    for batch in probe.few:
        batch = batch.altered(roughness=np.minimum(batch.inputs["roughness"], 1.0))
        # Leave out the pairs for which the host has no closure of the flagged model.
        rows = slice(None)
        if front_lit_only(probe.host.name, "qon"):
            rows = (batch.wo[:, :2] * batch.wi[:, :2]).sum(axis=1) >= 0.0
        # A wrong change is charged to the mode whose values are wrong.
        own, other = (probe.direct(batch.altered(**{FLAG: mode == "eon"})) for mode in modes)
        expected, beside = map(batch.expected, modes)
        change = absolute(own - other, expected - beside)
        wrong = np.minimum(change, absolute(own, expected))
        error = np.maximum(error, wrong[rows].max(initial=0.0))
        largest = max(largest, np.abs(expected - beside)[rows].max(initial=0.0))
    return Measurement(float(error / largest), {"expected": [float(largest)]})


def counted(names: Callable[[Probe], list[str]]) -> Callable[[Probe], Measurement]:
    """The number of inputs that are wrong, by a function that names them."""
    return lambda probe: count_named(names(probe))


def finite(case_of: Callable[[Probe], Case] = edge_case) -> Callable[[Probe], Measurement]:
    """The number of values of a case that are not finite, by default at the edges of the domain."""

    def measure(probe: Probe) -> Measurement:
        batch, values, _ = case_of(probe)
        return count_not_finite(batch, values)

    return measure
