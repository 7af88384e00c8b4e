# SPDX-License-Identifier: Apache-2.0
"""The mutation bench: its table fits the sources, and a slice of it is noticed by the checks meant."""

import json
from contextlib import closing

import pytest

from benchmarks.mutants import trial
from benchmarks.mutants.mutant import read_table
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import SOURCE
from mxeon.shaders.document.policy import DEFAULT

TABLE = read_table()
NAMED = {mutant.name: mutant for mutant in TABLE}
# By name, the check that is meant to notice it.
SLICE = {
    "throughput is 1": "throughput",
    "weight dropped, direct": "value",
    "environment behind": "surroundings",
    "normal not turned": "frame",
    "0 at mu_o = 0": "value",
    "c1 1e-5 off": "value",
    "EON: multiple scattering dropped": "value",
    "density: cosine dropped": "densities",
    "osl, stock node: keyword misspelled": "closure",
    "osl: s negated": "languages",
    "mdl, eon node: tint not squared": "closure",
    "average: c2 1e-3 off": "inversion",
    "stock node: flag on by default": "definition",
}
# The tasks that answer several checks.
TASKS = dict.fromkeys(("closure", "languages"), SOURCE) | {"densities": "twins"}


@pytest.fixture(scope="module")
def judge():
    with closing(Judge(DEFAULT)) as opened:
        yield opened


@pytest.mark.parametrize("mutant", TABLE, ids=lambda mutant: mutant.name)
def test_every_mutant_changes_the_sources(mutant):
    texts = mutant.texts().items()
    assert all(text != (trial.ROOT / file).read_text() for file, text in texts)


def test_names_are_unique():
    assert len(NAMED) == len(TABLE)


def test_at_least_250_mutants_are_not_equivalent():
    assert sum(not mutant.equivalent for mutant in TABLE) >= 250


def test_every_mutant_has_a_reason():
    assert [mutant.name for mutant in TABLE if not mutant.reason] == []


def test_every_equivalent_mutant_has_a_proof():
    proofs = {mutant.name: mutant.reason for mutant in TABLE if mutant.equivalent}
    assert proofs and [name for name, proof in proofs.items() if not proof.endswith(".")] == []


def test_the_page_is_of_this_table_and_has_no_survivor():
    trials = json.loads((trial.ROOT / "docs" / "mutants.json").read_text())
    verdicts = {name: found["verdict"] == trial.KILLED for name, found in trials.items()}
    assert verdicts == {mutant.name: not mutant.equivalent for mutant in TABLE}


@pytest.mark.parametrize(("name", "check"), SLICE.items())
def test_mutant_is_killed_by_the_check_meant(gl, judge, name, check):
    with trial.wrong_library(NAMED[name]) as path:
        tasks = trial.tasks_on_gl(path)
        chosen = [task for task in tasks if task.check == TASKS.get(check, check)]
        failures = trial.failures_of(chosen, judge, every=False)
    assert check in [each.check for each in failures]
