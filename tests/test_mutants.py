# SPDX-License-Identifier: Apache-2.0
"""The table of mutants fits the sources, and intended checks detect a sample of the mutants."""

from contextlib import closing
from functools import cache

import pytest

from mxeon.conformance.results import SOURCE
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import make_plan
from mxeon.shaders.document.policy import DEFAULT
from tools.benchmarks.mutants import operators, schemata, trial
from tools.benchmarks.mutants.mutant import FOLDERS, read_table

pytestmark = pytest.mark.whole

TABLE = read_table()
NAMED = {mutant.name: mutant for mutant in TABLE}
# Names of mutants, and the check that must detect each mutant.
SLICE = {
    "throughput is 0.01": "throughput",
    "environment behind": "surroundings",
    "0 at mu_o = 0": "value",
    "density: not normalized": "densities",
    "osl: s negated": "languages",
    "average: c2 1e-3 off": "output",
}
SHARE = 0.1  # tested fraction of the generated mutants
# Tasks that run several checks, by check.
TASKS = {"languages": SOURCE, "densities": "twins"}


@pytest.fixture(scope="module")
def judge():
    with closing(Judge(DEFAULT)) as opened:
        yield opened


def test_every_mutant_has_a_name_of_its_own_and_changes_the_sources():
    assert len(NAMED) == len(TABLE)
    read = cache(lambda file: (trial.ROOT / file).read_text())
    texts = [(each.name, *text) for each in TABLE for text in each.texts().items()]
    assert [name for name, file, text in texts if text == read(file)] == []
    tests = {trial.ROOT / trial.MODEL_TESTS / name for each in TABLE for name in each.tests}
    assert [path for path in tests if not path.is_file()] == []


def test_every_listed_survivor_is_a_mutant_of_the_operators():
    changes = set(map(operators.change, operators.every()))
    assert operators.known_survivors().keys() - changes == set()


def test_every_source_and_every_document_of_implementations_has_mutants():
    files = [path for folder in FOLDERS for path in (trial.ROOT / folder).rglob("*.*")]
    sources = {file.relative_to(trial.ROOT).as_posix() for file in files}
    assert sources - {mutant.file for mutant in TABLE} - set(operators.files()) == set()


def test_a_tenth_of_the_operators_mutants_is_noticed_but_for_those_that_are_listed(gl):
    """If a check always failed, the test would report the known survivors."""
    tenth = {each.name: each for each in operators.made(1, SHARE) if not each.survives}
    tenth |= {each.name: each for each in operators.made(1, SHARE / 4.0) if each.survives}
    found = schemata.trials(list(tenth.values()))
    survivors = {name for name, words in found.items() if words == trial.SURVIVED}
    listed = {name for name in found if tenth[name].survives}
    assert survivors <= listed and 2 * len(survivors) > len(listed) > 0
    unwritten = [name for name, words in found.items() if words == schemata.UNWRITTEN]
    assert len(found) > 0.75 * len(tenth) and len(unwritten) < 0.05 * len(found)


def test_mutants_of_rough_diffuse_nodes_are_not_judged_by_combinations_alone():
    assert trial.changed_nodes(NAMED["throughput above 1"]) == set()


@pytest.mark.parametrize(("name", "check"), SLICE.items())
def test_mutant_is_killed_by_the_check_meant(gl, judge, name, check):
    with trial.wrong_library(NAMED[name]) as path:
        tasks = make_plan((), ["gl"], [path]).tasks
        chosen = [task for task in tasks if task.check == TASKS.get(check, check)]
        failures = trial.failures_of(chosen, judge)
    assert check in [each.check for each in failures]


@pytest.mark.parametrize(
    ("name", "check"),
    [
        ("blackbody: N1 of X", "output"),
        ("translucent: environment of the visible side", "surroundings"),
        ("cone in OSL: soft always", "radiance"),
    ],
)
def test_wrong_node_is_killed_by_the_check_meant(gl, hosts, judge, name, check):
    if "OSL" in name:
        hosts("osl")
    found = trial.trial(NAMED[name], judge)
    assert found["checks"] == [check]
