# SPDX-License-Identifier: Apache-2.0
"""The mutation bench: its table fits the sources, and a slice of it is noticed by the checks meant."""

from contextlib import closing

import pytest

from benchmarks.mutants import __main__ as command
from benchmarks.mutants import trial
from benchmarks.mutants.mutant import read_table
from mxeon.conformance.run.judge import Judge
from mxeon.shaders.document.policy import DEFAULT

TABLE = read_table()
NAMED = {mutant.name: mutant for mutant in TABLE}
SLICE = {
    "flag swapped, direct": "value",
    "weight dropped, direct": "inputs",
    "channels rotated, direct": "value",
    "QON: negative s counts": "value",
    "c1 1e-5 off": "value",
    "osl, stock node: keyword dropped": "source",
}


@pytest.fixture(scope="module")
def judge():
    with closing(Judge(DEFAULT)) as opened:
        yield opened


@pytest.mark.parametrize("mutant", TABLE, ids=lambda mutant: mutant.name)
def test_every_mutant_changes_the_sources(mutant):
    assert mutant.text() != (trial.ROOT / mutant.file).read_text()


def test_names_are_unique():
    assert len(NAMED) == len(TABLE)


def test_at_least_250_mutants_are_not_equivalent():
    assert sum(not mutant.equivalent for mutant in TABLE) >= 250


def test_every_mutant_has_a_reason():
    assert [mutant.name for mutant in TABLE if not mutant.reason] == []


def test_every_equivalent_mutant_has_a_proof():
    proofs = {mutant.name: mutant.reason for mutant in TABLE if mutant.equivalent}
    assert proofs and [name for name, proof in proofs.items() if not proof.endswith(".")] == []


@pytest.mark.parametrize(("name", "check"), SLICE.items())
def test_mutant_is_killed_by_the_check_meant(gl, judge, name, check):
    found = command.summary(trial.trial(NAMED[name], judge, quick=True))
    assert check in found["checks"]
