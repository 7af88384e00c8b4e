# SPDX-License-Identifier: Apache-2.0
"""Layering operators return the specified albedos, even if the albedo of a sum exceeds 1."""

import numpy as np

from mxeon.models.core.layering import Bsdf, add, layer, mix, multiply, throughput

# Lobes with albedo E, whose value is E and whose throughput is 1 - E. All numbers are multiples of
# 1/64, so the sums and products below are exact.
A, B = (Bsdf(np.array(e), throughput(e)) for e in ([0.25, 0.5, 0.0], [0.5, 0.125, 1.0]))
TREE = 1e-13  # error of trees with 6 levels, at most twice 400 roundings
NOTHING, BLACK = Bsdf(np.zeros(3), np.ones(3)), Bsdf(np.zeros(3), np.zeros(3))


def same(one, other):
    pairs = (one.value, other.value), (one.throughput, other.throughput)
    return all(np.array_equal(*each) for each in pairs)


def test_identities():
    assert same(layer(NOTHING, A), A) and same(layer(A, NOTHING), A)
    assert same(mix(A, B, 0.0), B) and same(mix(A, B, 1.0), A)
    assert same(add(A, NOTHING), A) and same(multiply(A, 1.0), A)
    assert same(multiply(A, 0.0), NOTHING) and same(layer(layer(A, B), A), layer(A, layer(B, A)))
    assert same(layer(BLACK, A), BLACK)


def test_a_sum_that_reflects_more_than_all_light_hides_what_lies_below():
    sum_of_both = layer(add(B, B), Bsdf(np.ones(3), np.zeros(3)))
    assert np.array_equal(sum_of_both.value, [1.0, 1.0, 2.0])
    assert np.array_equal(sum_of_both.throughput, [0.0, 0.0, -1.0])
    assert np.array_equal(throughput([1.5, -1.0]), [-0.5, 2.0])


def tree(rng, depth):
    """Random combination of lobes, and the albedo that the specified equations predict."""
    kind = rng.choice(("layer", "mix", "add", "multiply")) if depth else "lobe"
    if kind == "lobe":
        albedo = rng.random(3)
        return Bsdf(albedo, throughput(albedo)), albedo
    (one, E), (other, E_other) = tree(rng, depth - 1), tree(rng, rng.integers(depth))
    if kind == "layer":  # a layer with an albedo above 1 hides its base
        return layer(one, other), E + np.where(E < 1.0, 1.0 - E, 0.0) * E_other
    if kind == "mix":
        w = rng.random()
        return mix(one, other, w), (1.0 - w) * E_other + w * E
    if kind == "add":
        return add(one, other), E + E_other
    s = 1.5 * rng.random(rng.choice((1, 3)))
    return multiply(one, s), s * E


def test_every_tree_of_combinations_keeps_the_albedo_of_the_text():
    rng = np.random.default_rng(25)
    above = 0
    for _ in range(1000):
        lobe, albedo = tree(rng, int(rng.integers(1, 7)))
        scale = np.maximum(albedo, 1.0)
        assert np.all(np.abs(lobe.value - albedo) <= TREE * scale)
        assert np.all(np.abs(1.0 - lobe.throughput - albedo) <= TREE * scale)
        white = layer(lobe, Bsdf(np.ones(3), np.zeros(3))).value
        assert np.all(np.abs(white - np.maximum(albedo, 1.0)) <= TREE * scale)
        above += np.count_nonzero(albedo > 1.0)
    assert 500 < above < 2500  # many of the 3000 albedos lie on either side of 1
