# SPDX-License-Identifier: Apache-2.0
"""What is done once: counts of what takes time, not times."""

import gc
import weakref
from collections.abc import Callable
from dataclasses import dataclass
from itertools import groupby
from types import SimpleNamespace

import MaterialX as mx
import numpy as np
import pytest

from mxeon.conformance import run
from mxeon.conformance.diagnosis import comparisons
from mxeon.conformance.diagnosis.candidates import Diagnosis
from mxeon.conformance.nodes.bsdf import BSDFS
from mxeon.conformance.nodes.diffuse import SUBJECTS
from mxeon.conformance.probes.memory import KEPT, LARGEST, Remembered
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.conformance.probes.probe import LobeProbe
from mxeon.conformance.reference import closures
from mxeon.conformance.reference.lobes import KEPT as LOBES_KEPT
from mxeon.conformance.reference.lobes import kept
from mxeon.conformance.run import journal
from mxeon.conformance.run.plan import make_plan
from mxeon.conformance.run.tasks import Findings
from mxeon.conformance.samples.batch import Array, Batch, Counts
from mxeon.conformance.samples.uneven_environment import sky_map
from mxeon.hosts import fragment
from mxeon.hosts.gl import Host
from mxeon.models.core.layering import Bsdf
from mxeon.models.microfacet import conductor_brdf
from mxeon.models.nodes import node
from mxeon.models.thin_film import curve
from mxeon.models.thin_film.lobe import film_albedo_dir, film_brdf
from mxeon.shaders.document.policy import DEFAULT
from mxeon.shaders.document.reading import read_document
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import OREN_NAYAR, material_text

METAL = {
    "ior": np.array([0.2, 0.9, 1.1]),
    "extinction": np.array([3.9, 2.5, 2.2]),
    "roughness": [0.3, 0.3],
}
NO_FILM = {"thinfilm_thickness": 0.0, "thinfilm_ior": 1.4}
PAIR = [0.6, 0.0, 0.8], [-0.28, 0.0, 0.96]


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


def test_a_document_is_walked_once_and_its_library_for_no_count(monkeypatch):
    walked, asked = [], []
    walk, inputs = mx.Element.traverseTree, mx.InterfaceElement.getInputs
    monkeypatch.setattr(
        mx.Element, "traverseTree", lambda self: (walked.append(self), walk(self))[1]
    )
    monkeypatch.setattr(
        mx.InterfaceElement,
        "getInputs",
        lambda self: (asked.append(self.isA(mx.Document)), inputs(self))[1],
    )
    document = read_document(material_text(OREN_NAYAR, {"roughness": 0.5}))
    assert walked == [document.content] and asked and not any(asked)


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


def test_large_batches_and_old_ones_are_not_kept():
    calls = []
    function, large, small = (
        Remembered(counted(calls)),
        batch(LARGEST + 1),
        [batch(count) for count in range(1, KEPT + 2)],
    )
    for each in (large, large, *small, small[-1], small[0]):
        function(each)
    assert len(calls) == 2 + len(small) + 1


@dataclass(frozen=True)
class CountedSubject:
    """A subject that counts what it is asked."""

    expected: Callable[[Batch], Array]
    albedo: Callable[[Batch], Array]


def test_a_check_its_control_and_both_libraries_share_the_reference():
    calls = []
    values = counted(calls)
    subject = CountedSubject(values, values)
    for library in ("eonlib", "eonlib", "stock"):
        probe = LobeProbe(None, subject, library)
        probe.expected(batch())
        probe.expected_albedo(batch())
    assert len(calls) == 2


def test_tasks_of_a_subject_are_done_one_after_the_other_with_both_libraries(monkeypatch):
    done = []
    judge = SimpleNamespace(work=lambda task: done.append(task) or Findings(), close=lambda: None)
    monkeypatch.setattr(run, "Judge", lambda policy: judge)
    libraries = ("eonlib", "stock")
    plan = make_plan((), ("gl", "osl"), libraries, nodes=("sheen_bsdf", "translucent_bsdf"))
    positions = [position for position, _ in run._run_inline(DEFAULT, plan.tasks)]
    assert sorted(positions) == list(range(len(plan.tasks)))
    assert [plan.tasks[position] for position in positions] == done
    runs = [key for key, _ in groupby((task.host, task.subject) for task in done)]
    evaluated = [key for key in runs if key[0] == "gl"]
    assert len(evaluated) == len(set(evaluated)) > 1
    # A host that reads libraries by itself has one after the other.
    assert [key for key, _ in groupby(task.library for task in done if task.host == "osl")] == [
        *libraries
    ]


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


def test_an_albedo_that_takes_long_is_computed_once_for_points_that_are_the_same():
    counts = []

    def albedo(wo, inputs):
        counts.append(len(wo))
        return wo[:, 2:] * np.reshape(inputs["roughness"], (-1, 1)) * inputs["tint"]

    wo = np.array(PAIR)[[0, 1, 0, 0, 1]]
    inputs = {"roughness": np.array([0.1, 0.2, 0.1, 0.3, 0.2]), "tint": np.array([[0.2, 0.5, 0.8]])}
    expected = albedo(wo, inputs)
    for name, count in (("schlick", 3), ("burley", 5)):
        found = closures._albedo(node(name), albedo, wo, inputs)
        np.testing.assert_array_equal(found, expected)
        assert counts[-1] == count


@pytest.fixture
def drawn(monkeypatch):
    """Textures of the frames that gl draws, one mapping each."""
    frames, draw = [], Host._draw
    monkeypatch.setattr(
        Host, "_draw", lambda self, *rest: (frames.append(rest[1]), draw(self, *rest))[1]
    )
    return frames


def evaluated(host, branch="direct", count=8, **options):
    """Values of a conductor of another roughness in each row."""
    [shader] = generate(material_text("conductor_bsdf", {}), "glsl")
    wo, wi = (np.tile(each, (count, 1)) for each in PAIR)
    rough = np.linspace(0.1, 0.9, 2 * count).reshape(count, 2)
    return host.evaluate(shader, wo, wi, {"roughness": rough}, branch, **options)


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


def test_the_driver_compiles_a_program_for_textures_of_one_kind(gl, drawn):
    for count in (1024, 1300, 8):
        evaluated(gl, count=count)
        for irradiance in (None, sky_map()):
            evaluated(gl, "environment", count, irradiance=irradiance)
    sides = {
        (name, side) for textures in drawn for name, each in textures.items() for side in each.size
    }
    assert {name for name, side in sides if not side & (side - 1)} == {"u_envRadiance"}
    assert all(each["u_envRadiance"].width > 1 for each in drawn if "u_envRadiance" in each)


def test_a_long_evaluation_is_that_of_its_parts(gl, drawn):
    count = fragment.PART + 7
    values = evaluated(gl, count=count)
    assert len(drawn) == 2 and len(values) == count
    [shader] = generate(material_text("conductor_bsdf", {}), "glsl")
    rough = np.linspace(0.1, 0.9, 2 * count).reshape(count, 2)[-7:]
    wo, wi = (np.tile(each, (7, 1)) for each in PAIR)
    last = gl.evaluate(shader, wo, wi, {"roughness": rough}, "direct")
    np.testing.assert_array_equal(values[-7:], last)


def test_failures_of_one_reason_are_explained_once_and_keep_no_probe(monkeypatch):
    calls = []
    monkeypatch.setattr(
        comparisons, "explain", lambda probe, *_: (calls.append(1), Diagnosis("because"))[1]
    )
    row = comparisons.Comparison("value", lambda probe: [], lambda probe: [])
    monkeypatch.setattr(comparisons.Comparison, "tolerance", lambda self, probe: None)
    probe = LobeProbe(None, None, "eonlib")
    assert row.diagnose(probe) is row.diagnose(probe) and len(calls) == 1
    gone = weakref.ref(probe)
    del probe
    gc.collect()
    assert gone() is None


def test_a_lobe_without_a_film_computes_none(monkeypatch):
    monkeypatch.setattr(curve, "_airy", None)
    bare = conductor_brdf(*PAIR, METAL["roughness"], METAL["ior"], METAL["extinction"])
    np.testing.assert_array_equal(film_brdf("conductor_bsdf", *PAIR, METAL | NO_FILM), bare)
    assert film_albedo_dir("conductor_bsdf", PAIR[0], METAL | NO_FILM).shape == (3,)


def test_a_journal_makes_its_converter_once(tmp_path, monkeypatch):
    made, make = [], journal.make_converter
    monkeypatch.setattr(
        journal, "make_converter", lambda *folder: (made.append(folder), make(*folder))[1]
    )
    plan = make_plan((), ("gl",), ("eonlib",), nodes=("sheen_bsdf",), resumable=True)
    with journal.Journal(tmp_path, plan) as kept:
        for number in range(3):
            kept.add(number, Findings(errors=("none",)))
    assert len(made) == 1
