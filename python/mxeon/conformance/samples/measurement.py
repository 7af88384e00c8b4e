# SPDX-License-Identifier: Apache-2.0
"""Measured values beside expected ones, the error of each row, and the worst of them."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.samples.batch import Array, Batch, Values

Metric = Callable[[Array, Array], Array]  # of measured and expected values: error of each row


class Case(NamedTuple):
    """A batch with measured and expected values."""

    batch: Batch
    measured: Array
    expected: Array


@dataclass(frozen=True)
class Measurement:
    """The worst error of a check, and its point."""

    error: float
    worst: dict[str, list[float]]  # inputs and values at the worst point, by name


def _largest(values: Array) -> Array:
    """Largest of the last axis, channel by channel: NumPy's maximum takes five times as long."""
    return reduce(np.maximum, np.moveaxis(values, -1, 0))


def absolute(measured: ArrayLike, expected: ArrayLike) -> Array:
    """Largest difference of each row; infinity for what is not a number."""
    error = _largest(np.abs(np.subtract(measured, expected)))
    return np.where(np.isfinite(error), error, np.inf)


def scaled(measured: Array, expected: Array) -> Array:
    """Largest difference of each row, relative to its largest expected value where that exceeds 1."""
    scale = np.maximum(1.0, _largest(np.abs(expected)))[..., np.newaxis]
    return absolute(measured / scale, expected / scale)


def relative(measured: Array, expected: Array) -> Array:
    """Largest difference of each row, relative to the expected value."""
    return absolute(measured / expected, 1.0)


def mean_error(measured: Array, expected: Array) -> Array:
    """Difference of the means over all rows, for every row: noise averages out."""
    return np.broadcast_to(absolute(np.mean(measured - expected, axis=0), 0.0), len(measured))


def mean_scaled(measured: Array, expected: Array) -> Array:
    """Mean of the differences of all rows, each relative to its largest expected value above 1."""
    scale = np.maximum(1.0, _largest(np.abs(expected)))[..., np.newaxis]
    return mean_error(measured / scale, expected / scale)


def root_mean_square(measured: Array, expected: Array) -> Array:
    """Root mean square of the largest differences of all rows, for every row.

    It notices a small error of many rows, where a bound on the largest has room for that of a few.
    """
    errors = absolute(measured, expected)
    return np.broadcast_to(np.sqrt(np.mean(errors * errors)), len(errors))


def worst_of(metric: Metric, cases: Iterable[Case]) -> Measurement:
    """The worst row of (batch, measured, expected) cases."""
    worst = Measurement(-1.0, {})
    for batch, measured, expected in cases:
        errors = metric(measured, expected)
        row = int(np.argmax(errors))
        if errors[row] > worst.error:
            expected = np.broadcast_to(expected, measured.shape)
            values = {"measured": measured[row].tolist(), "expected": expected[row].tolist()}
            worst = Measurement(float(errors[row]), {**point_of(batch, row), **values})
    return worst


def count_not_finite(batch: Batch, values: Array) -> Measurement:
    """Number of rows that are not finite, and the first of them."""
    bad = ~np.isfinite(values).all(axis=1)
    return Measurement(int(bad.sum()), point_of(batch, int(bad.argmax())) if bad.any() else {})


def count_named(names: Sequence[str]) -> Measurement:
    """Number of inputs that are wrong, and their names."""
    return Measurement(len(names), {name: [0.0] for name in names})


def point_of(batch: Batch, row: int) -> dict[str, list[float]]:
    columns: Values = {"wo": batch.wo, "wi": batch.wi, **batch.inputs}
    return {
        name: np.ravel(
            np.asarray(values)[row] if np.shape(values)[:1] == (len(batch.wo),) else values
        )
        .astype(float)
        .tolist()
        for name, values in columns.items()
    }
