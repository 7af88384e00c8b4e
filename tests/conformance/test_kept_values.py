# SPDX-License-Identifier: Apache-2.0
"""Kept values are those of the same question, and parts of a long evaluation those of the whole."""

from types import SimpleNamespace

import numpy as np
import pytest

from mxeon.conformance.nodes.bsdf import BSDFS
from mxeon.conformance.nodes.diffuse import SUBJECTS
from mxeon.conformance.probes.memory import Remembered
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.conformance.reference.lobes import KEPT as LOBES_KEPT
from mxeon.conformance.reference.lobes import kept
from mxeon.conformance.samples.batch import Batch, Counts
from mxeon.conformance.samples.uneven_environment import sky_map
from mxeon.hosts import fragment
from mxeon.models.core.layering import Bsdf
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import material_text


def batch(count=8):
    """Pairs with a roughness."""
    up = np.tile([0.0, 0.0, 1.0], (count, 1))
    return Batch(up, up.copy(), {"roughness": np.linspace(0.0, 1.0, max(count, 32))})


def counted(calls):
    """A function of batches that counts its calls."""

    def values(each):
        calls.append(each)
        return np.zeros((len(each.wo), 3))

    return values


def test_values_of_a_batch_are_computed_once():
    calls, one = [], batch()
    function = Remembered(counted(calls))
    first = function(one)
    assert function(one.altered()) is function(batch()) is first and len(calls) == 1
    assert function(one.altered(roughness=0.5)) is function(one.altered(roughness=0.5))
    assert len(calls) == 2
    with pytest.raises(ValueError, match="read-only"):
        first += 1.0


@pytest.mark.parametrize(
    "change",
    [
        {"wo": -batch().wo},
        {"wi": -batch().wi},
        {"inputs": {"roughness": np.linspace(0.0, 0.5, 32)}},
        {"inputs": {"roughness": np.linspace(0.0, 1.0, 64)}},
        {"inputs": {}},
        {"frame": np.zeros((8, 3, 3))},
    ],
    ids=lambda change: next(iter(change)),
)
def test_values_of_another_batch_are_computed(change):
    calls, one = [], batch()
    function = Remembered(counted(calls))
    function(one)
    function(Batch(**(vars(one) | change)))
    assert len(calls) == 2


def test_a_lobe_keeps_its_values_of_the_last_inputs():
    calls = []
    lobe = kept(lambda node, inputs, layered: calls.append(layered) or Bsdf(None, None))
    inputs = {"color": np.array([[0.2, 0.5, 0.8]]), "roughness": np.array([0.5])}
    first = lobe(BSDFS[0].row, inputs, False)
    assert lobe(BSDFS[0].row, {name: each.copy() for name, each in inputs.items()}, False) is first
    others = [{"roughness": np.array([number])} for number in np.linspace(0.0, 1.0, LOBES_KEPT)]
    for row, values, layered in (
        (BSDFS[1].row, inputs, False),
        (BSDFS[0].row, inputs, True),
        (BSDFS[0].row, {"color": inputs["color"][0], "roughness": inputs["roughness"]}, False),
    ):
        lobe(row, values, layered)
    assert len(calls) == 4
    for each in others:
        lobe(BSDFS[0].row, each, False)
    assert lobe(BSDFS[0].row, inputs, False) is not first


def test_a_host_evaluates_once_what_checks_ask_for_again():
    asked = []

    def evaluate(shader, wo, wi, inputs, branch, **options):
        asked.append((len(wo), branch, *options.values()))
        return np.zeros((len(wo), 3), np.float32)

    host = SimpleNamespace(compile=lambda *_, **__: [None], evaluate=evaluate)
    probe = PairProbe(host, SUBJECTS[0], "eonlib", Counts(pairs=64, few=8))
    few = probe.few[0]
    first = probe.albedo(few)
    assert probe.albedo(few.where(slice(None))) is first and len(asked) == 1
    others = [few.altered(weight=0.5), few.altered(weight=0.25), few.first(4), probe.turned]
    for each in [*others, *others]:
        probe.albedo(each)
    for _ in range(2):
        probe.throughput(few, "environment")
        probe.direct(few)
        probe.albedo(few, sky_map())
    assert len(asked) == 1 + len(others) + 3
    with pytest.raises(ValueError, match="read-only"):
        first += 1.0


def test_a_long_evaluation_is_that_of_its_parts(gl):
    [shader] = generate(material_text("conductor_bsdf", {}), "glsl")
    count = fragment.PART + 7
    wo, wi = (np.tile(each, (count, 1)) for each in ([0.6, 0.0, 0.8], [-0.28, 0.0, 0.96]))
    rough = np.linspace(0.1, 0.9, 2 * count).reshape(count, 2)
    values = gl.evaluate(shader, wo, wi, {"roughness": rough}, "direct")
    last = gl.evaluate(shader, wo[-7:], wi[-7:], {"roughness": rough[-7:]}, "direct")
    assert len(values) == count
    np.testing.assert_array_equal(values[-7:], last)
