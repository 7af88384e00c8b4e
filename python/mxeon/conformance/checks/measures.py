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
from mxeon.models.core.quadrature import albedo_dir_quadrature
from mxeon.shaders.nodes import FLAG

COLORS = ((0.2, 0.2, 0.2), (0.5, 0.5, 0.5), (0.8, 0.8, 0.8), (0.8, 0.4, 0.1))
QUADRATURE_NODES = 16  # reaches 1e-9 on the models judged, far below float32


def quadrature(probe: Probe) -> Iterable[Case]:
    """Directional albedo, integrated from the host's values, against its closed form."""
    cases: list[Case] = []
    for mu, color, roughness in product((0.1, 0.3, 0.6, 0.95), COLORS, (0.25, 1.0)):
        wo = np.array([[np.sqrt(1.0 - mu * mu), 0.0, mu]])
        batch = Batch(wo, wo, {"color": color, "roughness": roughness})
        cases.append(Case(batch, *integrated(probe, mu, color, roughness)))
    return cases


def integrated(
    probe: Probe, mu: ArrayLike, color: ArrayLike, roughness: float
) -> tuple[Array, Array]:
    """Directional albedo at one or more cosines: from the host's values, and in closed form.

    Returns
    -------
    measured, expected : ndarray, shape (N, 3)
    """

    def brdf(wo: Array, wi: Array, rho: Array, roughness: float) -> Array:
        wo = np.broadcast_to(wo, wi.shape)
        values: Array = probe.direct(Batch(wo, wi, {"color": rho, "roughness": roughness}))
        return values / (np.pi * wi[:, 2:])

    mu, color = np.atleast_1d(mu), np.array(color)
    row = reference.model(probe.subject.model)
    measured = albedo_dir_quadrature(brdf, mu, color, roughness, nodes=QUADRATURE_NODES)
    return measured, row.closed_albedo_dir(mu, color, roughness)


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
    """The change that the flag makes, against the models' difference, relative to the largest."""
    error = largest = 0.0
    for batch in probe.few:
        batch = batch.altered(roughness=np.minimum(batch.inputs["roughness"], 1.0))
        # Leave out the pairs for which the host has no closure of the flagged model.
        rows = slice(None)
        if front_lit_only(probe.host.name, "qon"):
            rows = (batch.wo[:, :2] * batch.wi[:, :2]).sum(axis=1) >= 0.0
        # Compare the change of the host with that of the models.
        on, off = (probe.direct(batch.altered(**{FLAG: state})) for state in (True, False))
        models = batch.expected("eon") - batch.expected("qon")
        error = np.maximum(error, absolute(on - off, models)[rows].max(initial=0.0))
        largest = max(largest, np.abs(models[rows]).max(initial=0.0))
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
