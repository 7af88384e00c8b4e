# SPDX-License-Identifier: Apache-2.0
"""Verdicts are the same whatever the seed of the samples, and the seed changes them and their numbers."""

import json
from functools import lru_cache

import pytest

import mxeon
from mxeon.conformance.samples import SEED, Counts
from mxeon.errors import InputError
from tests.support import command

SEEDS = (2, 3, 4)
LIBRARIES = ("eonlib", "stock")
NODES = ("burley_diffuse_bsdf", "conical_edf", "roughness_anisotropy")


@lru_cache
def verdicts(seed, libraries, *nodes):
    run = mxeon.check((), ["gl"], libraries, nodes=nodes, seed=seed)
    places = {(each.library, each.subject, each.check): each for each in run.results}
    found = {place: each.verdict for place, each in places.items()}
    caught = {place: each.control is None or each.control.caught for place, each in places.items()}
    return found, caught


@pytest.mark.parametrize("seed", SEEDS)
def test_another_seed_gives_the_same_verdicts_and_catches_every_control(seed):
    assert verdicts(seed, LIBRARIES, *NODES) == verdicts(1, LIBRARIES, *NODES)


@pytest.mark.whole
@pytest.mark.parametrize("seed", SEEDS)
def test_every_check_of_every_node_passes_with_another_seed(seed):
    found, caught = verdicts(seed, LIBRARIES[:1], "all")
    assert all(caught.values())
    assert {each for each in found if found[each] != "passed"} == set()


@pytest.mark.whole
@pytest.mark.parametrize("seed", SEEDS)
def test_materialx_has_the_same_verdicts_with_another_seed(seed):
    assert verdicts(seed, LIBRARIES[1:], "common") == verdicts(1, LIBRARIES[1:], "common")


def test_numbers_of_samples_change_with_the_seed():
    sizes = set()
    for seed in SEEDS:
        token = SEED.set(seed)
        sizes.add(Counts().varied().pairs)
        SEED.reset(token)
    assert len(sizes) == len(SEEDS)
    assert all(0.875 * Counts().pairs <= each <= Counts().pairs for each in sizes)


def test_the_command_takes_a_seed_and_refuses_one_below_0():
    def worst(seed):
        words = ("check", "--node", "burley_diffuse_bsdf", "--seed", seed, "--json")
        results = json.loads(command.run(*words).stdout)["results"]
        return {each["check"]: each["worst"] for each in results if each["check"] == "value"}

    assert worst("7") != worst("8")
    with pytest.raises(InputError, match="seed must be at least 0; got -1"):
        mxeon.check(seed=-1)
