# SPDX-License-Identifier: Apache-2.0
"""Measured and expected values, their errors, and tolerances as sums of terms."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import NamedTuple
from zlib import crc32

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.conformance.results import Errors, Quantity, Region
from mxeon.conformance.samples import Array, Batch, Mask, Values

Metric = Callable[[Array, Array], Array]  # measured, expected values -> error of each row

ROUNDING = 2.0**-24  # unit roundoff of float32


class Compared(NamedTuple):
    batch: Batch
    measured: Array
    expected: Array

    def where(self, rows: Mask | NDArray[np.integer]) -> "Compared":
        expected = np.broadcast_to(self.expected, self.measured.shape)
        return Compared(self.batch.where(rows), self.measured[rows], expected[rows])

    def over(self, scale: Array) -> "Compared":
        return Compared(self.batch, self.measured / scale, self.expected / scale)


@dataclass(frozen=True)
class Measurement:
    """The worst error of a check, with the worst sample and the errors of all samples."""

    error: float
    worst: dict[str, list[float]]  # inputs and values of the worst sample, by name
    errors: tuple[Errors, ...] = ()
    samples: str = ""  # checksum of the samples


def _largest(values: Array) -> Array:
    """The maximum over the last axis. A loop is five times as fast as `numpy.max`."""
    return reduce(np.maximum, np.moveaxis(values, -1, 0))


def absolute(measured: ArrayLike, expected: ArrayLike) -> Array:
    """Largest difference of each row, or infinity for a row whose difference is not finite."""
    error = _largest(np.abs(np.subtract(measured, expected)))
    return np.where(np.isfinite(error), error, np.inf)


def _scale(expected: Array) -> Array:
    return np.asarray(np.maximum(1.0, _largest(np.abs(expected)))[..., np.newaxis])


def scaled(measured: Array, expected: Array) -> Array:
    """Largest difference of each row, divided by the larger of 1 and the largest expected value."""
    scale = _scale(expected)
    return absolute(measured / scale, expected / scale)


def relative(measured: Array, expected: Array) -> Array:
    """Largest relative difference of each row. Differences are divided by expected values."""
    return absolute(measured / expected, 1.0)


def mean_error(measured: Array, expected: Array) -> Array:
    """Largest difference between the means of measured and expected values, repeated for every row.

    The mean removes the noise of random paths.
    """
    return np.broadcast_to(absolute(np.mean(measured - expected, axis=0), 0.0), len(measured))


def mean_scaled(measured: Array, expected: Array) -> Array:
    """The `mean_error` after dividing each row by the larger of 1 and the expected values."""
    scale = _scale(expected)
    return mean_error(measured / scale, expected / scale)


def root_mean_square(measured: Array, expected: Array) -> Array:
    """Root mean square of the largest differences of all rows, repeated for every row.

    A tolerance for the largest error misses small errors in many rows, which this metric detects.
    """
    errors = absolute(measured, expected)
    return np.broadcast_to(np.sqrt(np.mean(errors * errors)), len(errors))


def worst_of(metric: Metric, compared: Iterable[Compared]) -> Measurement:
    worst = Measurement(-1.0, {})
    for batch, measured, expected in compared:
        errors = metric(measured, expected)
        row = int(np.argmax(errors))
        if errors[row] > worst.error:
            expected = np.broadcast_to(expected, measured.shape)
            values = {"measured": measured[row].tolist(), "expected": expected[row].tolist()}
            worst = Measurement(float(errors[row]), {**point_of(batch, row), **values})
    return worst


def errors_of(rows: NDArray[np.floating], tolerance: float, region: Region | None = None) -> Errors:
    """Statistics of the errors of rows. A row is wrong if the error is NaN or too large."""
    finite = rows[np.isfinite(rows)]
    rms = float(np.sqrt(np.mean(finite**2))) if len(finite) else 0.0
    wrong = int(np.count_nonzero(~(rows <= tolerance)))
    largest = float(finite.max(initial=0.0))
    return Errors(len(rows), wrong, len(rows) - len(finite), largest, rms, region)


def checksum(batches: Iterable[Batch]) -> str:
    """Hexadecimal CRC-32 of directions and inputs, which are first rounded to float32."""
    crc = 0
    for batch in batches:
        for column in (batch.wo, batch.wi, *batch.inputs.values()):
            crc = crc32(np.asarray(column, np.float32).tobytes(), crc)
    return f"{crc:08x}"


def count_not_finite(compared: Compared) -> Measurement:
    """The number of rows with a measured value that is not finite, and the first such row."""
    wrong = ~np.isfinite(compared.measured).all(axis=1)
    if not wrong.any():
        return Measurement(0, {})
    errors = errors_of(np.where(wrong, np.inf, 0.0), 0.0)
    first = point_of(compared.batch, int(wrong.argmax()))
    return Measurement(errors.wrong, first, (errors,), checksum([compared.batch]))


def count_named(names: Sequence[str]) -> Measurement:
    return Measurement(len(names), {name: [0.0] for name in names})


def point_of(batch: Batch, row: int) -> dict[str, list[float]]:
    """The directions and inputs of a row, by name."""
    point = batch.where(np.array([row]))
    columns: Values = {"wo": point.wo, "wi": point.wi, **point.inputs}
    return {name: np.ravel(values).astype(float).tolist() for name, values in columns.items()}


class Term(NamedTuple):
    """A summand of a tolerance, with the cause of the error in words."""

    value: float
    words: str


def roundings(count: float, words: str = "") -> Term:
    """The error of `count` float32 roundings of numbers near 1. Each rounding is at most 2^-24."""
    plural = "" if count == 1 else "s"
    return Term(count * ROUNDING, f"{count:.3g} float32 rounding{plural}{words and ' '}{words}")


@dataclass(frozen=True)
class Tolerance:
    """The largest error that passes, which is a sum of terms, rounded up unless `exact` is set."""

    terms: tuple[Term, ...]
    quantity: Quantity = Quantity.VALUE
    metric: Metric = scaled
    exact: bool = False  # whether the sum is used without rounding up

    @property
    def value(self) -> float:
        total = float(sum(term.value for term in self.terms))  # results store plain floats
        return total if self.exact or not total else rounded_up(total)

    @property
    def derivation(self) -> str:
        parts = (f"{words} ({value:.2g})" if value else words for value, words in self.terms)
        text = " + ".join(parts)
        return text if self.exact or not self.value else f"{text}, rounded up"

    def wrong(self, compared: Compared) -> Mask:
        return np.asarray(self.metric(compared.measured, compared.expected) > self.value)

    def plus(self, *terms: Term) -> "Tolerance":
        return replace(self, terms=(*self.terms, *terms))

    def term(self, words: str, factor: float = 1.0) -> Term:
        """A term with this tolerance's value times `factor`, to be added to another tolerance."""
        return Term(factor * self.value, words)

    def scale(self, expected: Array) -> Array:
        """Divisors of the rows' errors, (N, 1), which are 1 unless the metric is `scaled`."""
        return _scale(expected) if self.metric is scaled else np.ones((len(expected), 1))


def sum_of(
    *terms: Term, quantity: Quantity = Quantity.VALUE, metric: Metric = scaled, exact: bool = False
) -> Tolerance:
    return Tolerance(terms, quantity, metric, exact)


def sum_in(quantity: Quantity, *terms: Term, exact: bool = False) -> Tolerance:
    """A tolerance for absolute errors of a quantity."""
    return Tolerance(terms, quantity, absolute, exact)


def single(value: float, quantity: Quantity, words: str, metric: Metric = absolute) -> Tolerance:
    """A tolerance with a single term, which is not rounded up."""
    return Tolerance((Term(value, words),), quantity, metric, exact=True)


def count_of(quantity: Quantity) -> Tolerance:
    return single(0.0, quantity, "a count")


def rounded_up(value: float) -> float:
    """The value rounded up to one significant digit.

    >>> rounded_up(1.94e-6)
    2e-06
    """
    exponent = math.floor(math.log10(value))
    return float(f"{math.ceil(value / 10.0**exponent)}e{exponent}")
