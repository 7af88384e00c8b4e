# SPDX-License-Identifier: Apache-2.0
"""The algebra of layers: its albedos, its identities and its domain."""

import numpy as np
import pytest

from mxeon.models.layering import Bsdf, add, layer, mix, multiply, throughput

# Values with the cosine, integrated: a lobe that reflects E has value E and throughput 1 - E. The
# numbers are multiples of 1/64, so that the sums and products below are exact.
A, B = (Bsdf(np.array(e), throughput(e)) for e in ([0.25, 0.5, 0.0], [0.5, 0.125, 1.0]))
NOTHING, BLACK = Bsdf(np.zeros(3), np.ones(3)), Bsdf(np.zeros(3), np.zeros(3))


def same(one, other):
    return np.array_equal(one.value, other.value) and np.array_equal(
        one.throughput, other.throughput
    )


@pytest.mark.parametrize(
    "combined",
    (layer(A, B), mix(A, B, 0.25), add(A, multiply(B, 0.5)), multiply(A, [0.5, 1.0, 2.0])),
)
def test_throughput_is_what_the_combination_does_not_reflect(combined):
    assert np.array_equal(combined.throughput, 1.0 - combined.value)


def test_a_layer_over_white_returns_all_light():
    assert np.array_equal(layer(A, Bsdf(np.ones(3), np.zeros(3))).value, np.ones(3))


def test_identities():
    assert same(layer(NOTHING, A), A) and same(layer(A, NOTHING), A)
    assert same(mix(A, B, 0.0), B) and same(mix(A, B, 1.0), A)
    assert same(add(A, NOTHING), A) and same(multiply(A, 1.0), A)
    assert same(multiply(A, 0.0), NOTHING) and same(layer(layer(A, B), A), layer(A, layer(B, A)))
    assert same(layer(BLACK, A), BLACK)


def test_a_sum_that_reflects_more_than_all_light_hides_what_lies_below():
    assert np.array_equal(add(B, B).throughput, [0.0, 0.75, 0.0])
    assert np.array_equal(throughput([1.5, -1.0]), [0.0, 2.0])


@pytest.mark.parametrize(
    "call, message",
    (
        (lambda: mix(A, B, 1.5), r"amount must lie in \[0, 1\]; got 1.5"),
        (lambda: multiply(A, -0.5), r"weight must lie in \[0, inf\); got -0.5"),
        (lambda: throughput([0.5, np.nan]), r"albedo must lie in .* got nan at index \(1,\)"),
    ),
)
def test_what_leaves_its_range_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
