# SPDX-License-Identifier: Apache-2.0
"""The BSDF nodes of pbrlib on every host: what engines add, and what pictures and texts show."""

from functools import partial

import numpy as np
import pytest

from mxeon.conformance.accuracy import engine
from mxeon.conformance.accuracy.accuracy import ACCURACY
from mxeon.conformance.accuracy.rendered import TRACED_FLAT, TRACED_SHARP
from mxeon.conformance.checks.application import judge_check
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.nodes.bsdf import BSDFS
from mxeon.conformance.probes.families import HOST_PROBES, probe_type_of
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.conformance.probes.pictures import PictureProbe
from mxeon.conformance.results import FAILED, NOT_RUN, PASSED
from mxeon.conformance.text import checks as text_checks
from mxeon.models.nodes.cycles import CYCLES_VARIANTS

ROWS = {check.key: check for check in CHECKS}
SUBJECTS = {subject.model: subject for subject in BSDFS}


def judged(host, model, key):
    """Result of a check of a stock node on a host."""
    probe = probe_type_of(
        SUBJECTS[model], HOST_PROBES[{"cycles": "pictures"}.get(host.name, "pairs")]
    )
    return judge_check(ROWS[key], probe(host, SUBJECTS[model], "stock"))


class Engine:
    """A host whose power is off by a share."""

    name = "engine"

    def __init__(self, share):
        self.share = share

    def execute(self, source, function, x, y):
        return np.repeat((x**y * (1.0 + self.share))[:, np.newaxis], 3, axis=1)


def test_the_error_of_an_engines_power_is_that_of_a_value_of_the_sheen():
    assert engine.sheen_error(Engine(0.0)) == 0.0
    assert engine.sheen_error(Engine(1e-4)) == pytest.approx(1e-4, rel=1e-2)


def test_only_a_sheen_of_powers_takes_the_engine_into_its_tolerance():
    own = ACCURACY["fitted pairs"].value
    sheen, burley = (
        partial(engine.widen_for_engine, own, SUBJECTS[name], SUBJECTS[name].kind)
        for name in ("conty_kulla", "burley")
    )
    assert burley(Engine(1e-4)) is own
    wider = sheen(Engine(1e-4))
    assert own.value < wider.value == 2e-4 and "1.0e-04" in wider.derivation
    assert sheen(Engine(0.0)) is own


@pytest.mark.parametrize("name", ["webgl", "wgsl"])
def test_a_node_is_judged_on_every_host_that_evaluates(hosts, name):
    result = judged(hosts(name), "zeltner", "layering")
    assert result.verdict == FAILED and "without the color" in result.diagnosis


@pytest.mark.parametrize("name", ["slang"])
@pytest.mark.parametrize("model", ["zeltner", "dielectric"])
def test_the_repaired_nodes_are_the_specifications_in_other_languages(hosts, name, model):
    host, subject = hosts(name), SUBJECTS[model]
    probe = probe_type_of(subject, PairProbe)(host, subject, "eonlib")
    batch = probe.batches[1]
    tolerance = ACCURACY[probe.kind].value
    errors = tolerance.metric(probe.direct(batch), subject.expected(batch))
    assert errors.max() <= tolerance.value


def traced(host, model, library="stock"):
    """The probe of a node on Cycles."""
    return probe_type_of(SUBJECTS[model], PictureProbe)(host, SUBJECTS[model], library)


def test_cycles_evaluates_any_pair(hosts):
    probe = traced(hosts("cycles"), "burley")
    batch = probe.batches[0]
    values = probe.direct(batch)
    assert len(batch.wo) > 2000
    assert 0.0 < TRACED_FLAT.metric(values, probe.expected(batch)).max() <= TRACED_FLAT.value / 4.0
    assert np.array_equal(values, probe.direct(batch))  # without noise


@pytest.mark.parametrize("model", ["dielectric", "conductor", "schlick"])
def test_cycles_microfacets_scatter_once(hosts, model):
    probe = traced(hosts("cycles"), model)
    [single] = [each for each in CYCLES_VARIANTS[model] if each.value and "single" in each.title]
    batch = probe.batches[0].first(512)
    expected = probe.subject.values(single.value, batch)
    values = probe.direct(batch)
    assert TRACED_SHARP.metric(values, expected).max() <= TRACED_SHARP.value
    # It is none of the others, nor the same in another frame.
    assert TRACED_SHARP.metric(values, probe.expected(batch)).max() > 0.1
    turned = batch.altered(roughness=np.asarray(batch.inputs["roughness"])[:, ::-1])
    other = probe.subject.values(single.value, turned)
    assert TRACED_SHARP.metric(values, other).max() > 0.1


@pytest.mark.parametrize(
    ("model", "bound"), [("dielectric", 1e-3), ("schlick", 1e-2), ("zeltner", 1e-2)]
)
def test_cycles_layers_let_through_what_its_tables_say(hosts, model, bound):
    probe = traced(hosts("cycles"), model)
    [albedo] = [each.albedo for each in CYCLES_VARIANTS[model] if not each.value]
    [batch] = probe.cosines
    expected = 1.0 - batch.strength * albedo(batch.wo, batch.inputs)
    assert np.abs(probe.throughput(batch, "direct") - expected).max() <= bound


def test_a_closure_that_cycles_lacks_is_not_run_and_is_named(hosts):
    host = hosts("cycles")
    result = judged(host, "translucent", "black")
    assert result.verdict == NOT_RUN and "'translucent_bsdf' is not supported" in result.reason
    answers = host.closures()
    assert [name for name, reason in answers.items() if reason] == [
        "translucent_bsdf",
        "chiang_hair_bsdf",
    ]


def test_every_input_reaches_the_call_in_text_that_nothing_runs():
    results = text_checks.check_calls(BSDFS, "stock")
    assert {result.subject.rsplit(", ", 1)[1] for result in results} == {"msl", "mdl"}
    assert all(result.verdict == PASSED and result.control.caught for result in results)


@pytest.mark.parametrize(
    "old, new", [("mxp_tint:lobe_tint", "mxp_tint:color(1.0)"), ("mxp_tint:lobe_tint, ", "")]
)
def test_an_input_that_a_call_drops_is_named(monkeypatch, old, new):
    text = text_checks.source(SUBJECTS["dielectric"], "mdl", "stock")
    monkeypatch.setattr(text_checks, "source", lambda *_: text.replace(old, new))
    monkeypatch.setattr(text_checks, "TEXT_ONLY", ("mdl",))
    (result,) = text_checks.check_calls([SUBJECTS["dielectric"]], "stock")
    assert result.verdict == FAILED and "tint is never passed" in result.diagnosis
