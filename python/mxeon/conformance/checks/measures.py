# SPDX-License-Identifier: Apache-2.0
"""Measurements of the checks: the worst error of a probe, and its point."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.checks.batch import Array, Batch
from mxeon.conformance.checks.sky import sky, sky_map
from mxeon.models import table as reference
from mxeon.models.quadrature import albedo_dir_quadrature
from mxeon.shaders.hosts import front_lit_only
from mxeon.shaders.nodes import FLAG

CHANGES = {
    "weight": 0.5,
    "color": (0.9, 0.1, 0.6),
    "roughness": 0.3,
    "normal": (0.0, 0.6, 0.8),
}
COLORS = ((0.2, 0.2, 0.2), (0.5, 0.5, 0.5), (0.8, 0.8, 0.8), (0.8, 0.4, 0.1))
BRANCHES = ("direct", "environment", "transmission", "emission")
WHITE, BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
QUADRATURE_NODES = 16  # reaches 1e-9 on the models judged, far below float32

Metric = Callable[[Array, Any], Array]  # of measured and expected values: error of each row


class Case(NamedTuple):
    """A batch with measured and expected values."""

    batch: Batch
    measured: Array
    expected: Array


@dataclass(frozen=True)
class Measurement:
    """The worst error of a check, and its point.

    Attributes
    ----------
    error : float
    worst : dict of str to list of float
        Inputs and values at the worst point, by name.
    """

    error: float
    worst: dict[str, list[float]]


def absolute(measured: ArrayLike, expected: ArrayLike) -> Array:
    """Largest difference of each row; infinity for what is not a number."""
    error = np.abs(np.subtract(measured, expected)).max(axis=-1)
    return np.where(np.isfinite(error), error, np.inf)


def relative(measured: Array, expected: Array) -> Array:
    """Largest difference of each row, relative to the expected value."""
    return absolute(measured / expected, 1.0)


def of_mean(measured: Array, expected: Array) -> Array:
    """Difference of the means over all rows, for every row: noise averages out."""
    return np.broadcast_to(absolute(np.mean(measured - expected, axis=0), 0.0), len(measured))


def value(probe: Any, metric: Metric) -> Measurement:
    """Values against the model's, over all pairs of the probe."""
    return _worst(metric, value_cases(probe))


def value_cases(probe: Any) -> Iterator[Case]:
    """The cases of `value`."""
    for batch in probe.batches:
        yield Case(batch, probe.direct(batch), batch.expected(probe.subject.model))


def environment(probe: Any, metric: Metric) -> Measurement:
    """The environment branch against the closed form of the directional albedo."""
    return _worst(metric, albedo_cases(probe))


def albedo_cases(probe: Any) -> Iterator[Case]:
    """The cases of `environment`."""
    for batch in probe.cosines:
        yield Case(batch, probe.albedo(batch), batch.albedo(probe.subject.model))


def frame(probe: Any, metric: Metric) -> Measurement:
    """Values in turned frames, of which half have a normal that faces away, against those in none."""
    return _worst(metric, frame_cases(probe))


def frame_cases(probe: Any) -> Iterator[Case]:
    """The cases of `frame`."""
    batch = probe.turned
    local = replace(batch.altered(normal=(0.0, 0.0, 1.0)), frame=None)
    for output in (probe.direct, probe.albedo):
        yield Case(batch, output(batch), output(local))


def surroundings(probe: Any, metric: Metric) -> Measurement:
    """The environment branch under an uneven sky, over that in a uniform one, against the sky."""
    return _worst(metric, [surroundings_case(probe)])


def surroundings_case(probe: Any) -> Case:
    """The case of `surroundings`."""
    batch = probe.turned.altered(color=WHITE)
    with np.errstate(divide="ignore", invalid="ignore"):
        measured = probe.albedo(batch, sky_map()) / probe.albedo(batch)
    return Case(batch, measured, sky(batch.normal))


def quadrature(probe: Any, metric: Metric) -> Measurement:
    """Directional albedo, integrated from the host's values, against its closed form."""
    cases: list[Case] = []
    for mu, color, roughness in product((0.1, 0.3, 0.6, 0.95), COLORS, (0.25, 1.0)):
        wo = np.array([[np.sqrt(1.0 - mu * mu), 0.0, mu]])
        batch = Batch(wo, wo, {"color": color, "roughness": roughness})
        cases.append(Case(batch, *integrated(probe, mu, color, roughness)))
    return _worst(metric, cases)


def integrated(
    probe: Any, mu: ArrayLike, color: ArrayLike, roughness: float
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


def black(probe: Any, metric: Metric) -> Measurement:
    """Values of a black surface against 0."""
    batches = [batch.altered(color=BLACK) for batch in probe.few]
    return _worst(metric, (Case(batch, probe.direct(batch), np.zeros((1, 3))) for batch in batches))


def throughput(probe: Any, metric: Metric) -> Measurement:
    """Throughput of an opaque node against 0, in every branch and for every weight."""
    return _worst(metric, (case for branch in BRANCHES for case in throughput_cases(probe, branch)))


def throughput_cases(probe: Any, branch: str) -> Iterator[Case]:
    """The cases of `throughput` in one of BRANCHES."""
    for batch in probe.few:
        yield Case(batch, probe.throughput(batch, branch), np.zeros((len(batch.wo), 3)))


def furnace(probe: Any, metric: Metric) -> Measurement:
    """Albedo of a white surface against 1."""
    batches = [batch.altered(color=WHITE, weight=1.0) for batch in probe.cosines]
    return _worst(metric, (Case(batch, probe.albedo(batch), np.ones((1, 3))) for batch in batches))


def reciprocity(probe: Any, metric: Metric) -> Measurement:
    """f(wo, wi) against f(wi, wo), both times both cosines."""
    cases: list[Case] = []
    for batch in probe.few:
        swapped = replace(batch, wo=batch.wi, wi=batch.wo)
        with np.errstate(invalid="ignore"):  # inf x 0 is no number, which `absolute` notices
            forward = probe.direct(batch) * batch.wo[:, 2:]
            backward = probe.direct(swapped) * batch.wi[:, 2:]
        cases.append(Case(batch, forward, backward))
    return _worst(metric, cases)


def lambert(probe: Any, metric: Metric) -> Measurement:
    """Values at roughness 0 against Lambert's."""
    batches = [batch.altered(roughness=0.0) for batch in probe.few]
    return _worst(
        metric, (Case(batch, probe.direct(batch), batch.expected("lambert")) for batch in batches)
    )


def flag(probe: Any, _: Metric) -> Measurement:
    """The change that the flag makes, against the models' difference, relative to the largest."""
    error = largest = 0.0
    for batch in probe.few:
        batch = batch.altered(roughness=np.minimum(batch.inputs["roughness"], 1.0))
        rows = slice(None)
        if front_lit_only(probe.host.name, "qon"):
            rows = (batch.wo[:, :2] * batch.wi[:, :2]).sum(axis=1) >= 0.0
        on, off = (probe.direct(batch.altered(**{FLAG: state})) for state in (True, False))
        models = batch.expected("eon") - batch.expected("qon")
        error = np.maximum(error, absolute(on - off, models)[rows].max(initial=0.0))
        largest = max(largest, np.abs(models[rows]).max(initial=0.0))
    return Measurement(float(error / largest), {"expected": [float(largest)]})


def inputs(probe: Any, _: Metric) -> Measurement:
    """Number of inputs of the node that change nothing."""
    dead = dead_inputs(probe)
    return Measurement(len(dead), {name: [0.0] for name in dead})


def dead_inputs(probe: Any) -> list[str]:
    """The inputs of `inputs`."""
    batch = probe.few[0]
    values = probe.direct(batch)
    changes = {**CHANGES, FLAG: not probe.subject.flag}
    return [
        name
        for name in probe.subject.inputs
        if np.array_equal(values, probe.direct(batch.altered(**{name: changes[name]})))
    ]


def finite(probe: Any, _: Metric) -> Measurement:
    """Number of values at the edges of the domain that are not finite."""
    batch, values, _expected = edge_case(probe)
    bad = ~np.isfinite(values).all(axis=1)
    return Measurement(int(bad.sum()), _point(batch, int(bad.argmax())) if bad.any() else {})


def edge_case(probe: Any) -> Case:
    """Values and albedos at the edges of the domain, beside 0."""
    cosine = [0.0, 1e-30, 1e-6, 0.5, 1.0]
    rows = product(cosine, cosine, [0.0, 1.0, 2.0, np.pi], [0.0, 1e-6, 1.0], [0.0, 0.5, 1.0])
    mu_o, mu_i, azimuth, roughness, color = np.array(list(rows)).T
    S_o, S_i = np.sqrt(1.0 - mu_o**2), np.sqrt(1.0 - mu_i**2)
    wo = np.stack([S_o, 0.0 * S_o, mu_o], axis=-1)
    wi = np.stack([S_i * np.cos(azimuth), S_i * np.sin(azimuth), mu_i], axis=-1)
    batch = Batch(wo, wi, {"color": np.stack([color] * 3, axis=-1), "roughness": roughness})
    values = np.concatenate([probe.direct(batch), probe.albedo(batch)], axis=1)
    return Case(batch, values, np.zeros_like(values))


def _worst(metric: Metric, cases: Iterable[Case]) -> Measurement:
    """The worst row of (batch, measured, expected) cases."""
    worst = Measurement(-1.0, {})
    for batch, measured, expected in cases:
        errors = metric(measured, expected)
        row = int(np.argmax(errors))
        if errors[row] > worst.error:
            expected = np.broadcast_to(expected, measured.shape)
            values = {"measured": measured[row].tolist(), "expected": expected[row].tolist()}
            worst = Measurement(float(errors[row]), {**_point(batch, row), **values})
    return worst


def _point(batch: Batch, row: int) -> dict[str, list[float]]:
    """Directions and inputs of one row of a batch."""
    columns: dict[str, Any] = {"wo": batch.wo, "wi": batch.wi, **batch.inputs}
    return {
        name: np.ravel(_row(values, row, len(batch.wo))).astype(float).tolist()
        for name, values in columns.items()
    }


def _row(values: Any, row: int, count: int) -> Any:
    """One row of values, or the values that hold for all rows."""
    return values[row] if np.shape(values) and len(values) == count else values
