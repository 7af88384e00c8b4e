# SPDX-License-Identifier: Apache-2.0
"""What is done once: counts of what takes time, not times."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import groupby
from types import SimpleNamespace

import MaterialX as mx
import numpy as np
import pytest

from mxeon.conformance import run
from mxeon.conformance.nodes.diffuse import SUBJECTS
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.conformance.probes.probe import LobeProbe
from mxeon.conformance.reference import closures
from mxeon.conformance.run.plan import make_plan
from mxeon.conformance.run.tasks import Findings
from mxeon.conformance.samples.batch import Array, Batch, Counts
from mxeon.conformance.samples.uneven_environment import sky_map
from mxeon.hosts import fragment
from mxeon.hosts.gl import Host
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


def test_a_lobe_without_a_film_computes_none(monkeypatch):
    monkeypatch.setattr(curve, "_airy", None)
    bare = conductor_brdf(*PAIR, METAL["roughness"], METAL["ior"], METAL["extinction"])
    np.testing.assert_array_equal(film_brdf("conductor_bsdf", *PAIR, METAL | NO_FILM), bare)
    assert film_albedo_dir("conductor_bsdf", PAIR[0], METAL | NO_FILM).shape == (3,)
