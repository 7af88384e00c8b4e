# SPDX-License-Identifier: Apache-2.0
"""Measurements of pbrlib's BSDF nodes: energy, layering, and their frames."""

from collections.abc import Iterable
from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.accuracy import bsdf as tolerances
from mxeon.conformance.nodes.bsdf import BsdfSubject
from mxeon.conformance.probes.cases import WHITE, layering_cases
from mxeon.conformance.probes.probe import Probe, subject_of
from mxeon.conformance.samples.batch import Array, Batch, Values, rounded
from mxeon.conformance.samples.edge_cases import LEAST_COLOR82
from mxeon.conformance.samples.measurement import Case
from mxeon.models.nodes.combinations import FACTOR

FEW = 1 << 12
ROUNDED = 1e-9  # difference of two albedos that are the same
LEAST_DIVIDED = 1.2  # of a dielectric whose values are divided
LEAST_VALUE = 1e-3  # pi f cos of values whose ratio is asked


def passing(probe: Probe) -> Iterable[Case]:
    """Throughput of a combination against 1 - E, where it is negative as `layer` takes it: 0."""
    cases = (
        case._replace(measured=np.maximum(case.measured, 0.0)) for case in layering_cases(probe)
    )
    return cases


def factors(probe: Probe) -> Iterable[Case]:
    """Values and throughputs with factors beyond [0, 1], against those of the nearest end."""
    cases = []
    for batch, (factor, end) in product(probe.few, ((2.0, 1.0), (-1.0, 0.0))):
        beyond, nearest = (
            batch.altered(**{FACTOR: np.full_like(batch.inputs[FACTOR], number)})
            for number in (factor, end)
        )
        cases += [
            Case(beyond, probe.direct(beyond), probe.direct(nearest)),
            Case(beyond, probe.throughput(beyond, "direct"), probe.throughput(nearest, "direct")),
        ]
    return cases


def layer(probe: Probe) -> Iterable[Case]:
    """Light that a lobe reflects and light that it passes to a white base, against all of it."""
    views, albedo = _integral(probe)
    total = albedo + probe.throughput(views, "direct")
    # Where the equations gain energy by themselves, no throughput makes up for it.
    own = subject_of(probe, BsdfSubject).albedo(views)
    sound = np.asarray((probe.integrals <= own + ROUNDED).all(axis=1))
    return [Case(views.where(sound), total[sound], np.ones((1, 3)))]


def dip(probe: Probe) -> Iterable[Case]:
    """Throughput of lobes that are white but for a dip at 82 degrees."""
    dipped = (LEAST_COLOR82,) * 3
    white: Values = {"color0": WHITE, "color90": WHITE, "color82": dipped, "exponent": 5.0}
    return [_passed(probe, batch.altered(**white)) for batch in probe.cosines]


def denser(probe: Probe) -> Iterable[Case]:
    """Throughput of lobes of the inverse indices."""
    return [
        _passed(probe, batch.altered(ior=1.0 / np.asarray(batch.inputs["ior"]), tint=WHITE))
        for batch in probe.cosines
    ]


def _passed(probe: Probe, batch: Batch) -> Case:
    """Throughput at full weight against 1 - E."""
    full = batch.altered(weight=1.0)
    passed = np.maximum(1.0 - probe.expected_albedo(full), 0.0)
    return Case(full, probe.throughput(full, "direct"), passed)


def energy(probe: Probe) -> Iterable[Case]:
    """Albedos above 1, and above what the node's own equations have."""
    views, albedo = _integral(probe)
    allowed = np.maximum(1.0, probe.integrals)
    return [Case(views, np.maximum(albedo, allowed), allowed)]


def lossless(probe: Probe) -> Iterable[Case]:
    """Albedo of a lobe that reflects all light, integrated from the host's values, against 1."""
    batch, weights = probe.integrated
    mirror = batch.altered(**subject_of(probe, BsdfSubject).row.mirror)
    views, albedo = summed(probe, mirror, weights)
    return [Case(views, albedo, np.ones_like(albedo))]


def shape(probe: Probe) -> Iterable[Case]:
    """Ratio of two values of one view against that of the equations: compensation cancels."""
    batch, other = (_clear(each.first(FEW)) for each in probe.mirrored)
    first, second = probe.expected(batch), probe.expected(other)
    lit = (np.minimum(first, second) > LEAST_VALUE).any(axis=1)
    least = np.minimum(batch.wo[:, 2], np.minimum(batch.wi[:, 2], other.wi[:, 2]))
    lit &= least >= tolerances.LEAST_COSINE
    scale = (first * second).max(axis=1, keepdims=True)
    with np.errstate(invalid="ignore"):
        measured = probe.direct(batch) * second / scale
        expected = probe.direct(other) * first / scale
    return [Case(batch.where(lit), measured[lit], expected[lit])]


def _clear(batch: Batch) -> Batch:
    """A batch without curves of which float32 cannot hold F: its terms cancel.

    These are dielectrics whose index is near 1, and deep dips at 82 degrees, which turn F negative.
    """
    changes: dict[str, ArrayLike] = {}
    if np.ndim(batch.inputs.get("ior", 0.0)) == 1:
        changes["ior"] = np.maximum(batch.inputs["ior"], LEAST_DIVIDED)
    if "color82" in batch.inputs:
        changes["color82"] = np.maximum(batch.inputs["color82"], LEAST_COLOR82)
    return batch.altered(**changes)


def retroreflection(probe: Probe) -> Iterable[Case]:
    """Values in retroreflective mode against those of the mirrored view."""
    cases = []
    for batch in probe.few:
        mirrored = replace(batch, wo=batch.wo * [-1.0, -1.0, 1.0])
        measured = probe.direct(batch.altered(retroreflective=True))
        cases.append(Case(batch, measured, probe.direct(mirrored.altered(retroreflective=False))))
    return cases


def anisotropy(probe: Probe) -> Iterable[Case]:
    """Values with a turned tangent against those of directions turned the other way."""
    batch = probe.mirrored[0].first(FEW)
    batch = batch.where(np.minimum(batch.wo[:, 2], batch.wi[:, 2]) >= tolerances.LEAST_COSINE)
    batch = batch.altered(roughness=np.maximum(batch.inputs["roughness"], tolerances.LEAST_ALPHA))
    angle = np.linspace(0.0, 2.0 * np.pi, len(batch.wo))
    cosine, sine, zero = np.cos(angle), np.sin(angle), np.zeros(len(angle))
    tangent = rounded([cosine, sine, zero])
    turned = replace(
        batch.altered(tangent=(1.0, 0.0, 0.0)),
        wo=_turned_back(batch.wo, tangent),
        wi=_turned_back(batch.wi, tangent),
    )
    measured = probe.direct(batch.altered(tangent=tangent))
    return [Case(batch, measured, probe.direct(turned))]


def _turned_back(w: Array, tangent: Array) -> Array:
    """Directions in the frame of a tangent in the surface."""
    along = w[:, 0] * tangent[:, 0] + w[:, 1] * tangent[:, 1]
    across = w[:, 1] * tangent[:, 0] - w[:, 0] * tangent[:, 1]
    return rounded([along, across, w[:, 2]])


def integral(probe: Probe) -> Iterable[Case]:
    """Directional albedo, integrated from the host's values, against that of the equations."""
    views, albedo = _integral(probe)
    return [Case(views, albedo, probe.integrals)]


def _integral(probe: Probe) -> tuple[Batch, Array]:
    """Views of the integrated materials, and their albedos from the host's values, (N, 3)."""
    return summed(probe, *probe.integrated)


def summed(probe: Probe, batch: Batch, weights: Array) -> tuple[Batch, Array]:
    """Views of materials in many directions of light, and their albedos, (N, 3)."""
    count, nodes = weights.shape
    values = probe.direct(batch).reshape(count, nodes, 3)
    albedo = (weights[..., np.newaxis] * values).sum(axis=1)
    return batch.where(np.arange(count) * nodes), albedo
