# SPDX-License-Identifier: Apache-2.0
"""The seed changes the random samples and the measured errors, but no verdict."""

import json

import pytest

import mxeon
from mxeon.errors import InputError
from mxeon.hosts.gl import GlHost
from tests.support import command
from tests.support.sharing import DRAWN, EXAMPLES
from tests.support.verdicts import Verdicts

SEEDS = (2, 3)  # all other tests use seed 1
LIBRARIES = ("eonlib", "stock")
NODES = ("burley_diffuse_bsdf", "conical_edf", "roughness_anisotropy")


def verdicts(run):
    """Verdict of each check, and whether the check caught a deliberate mistake."""
    found = {}
    for each in run.results:
        caught = each.control is None or each.control.caught
        found[each.library, each.subject, each.check] = each.verdict, caught
    return found


@pytest.mark.parametrize("seed", SEEDS)
def test_another_seed_gives_the_same_verdicts_and_catches_every_control(seed):
    again = mxeon.check(None, ["gl"], LIBRARIES, nodes=NODES, seed=seed)
    assert verdicts(again) == verdicts(mxeon.check(None, ["gl"], LIBRARIES, nodes=NODES))


@pytest.mark.whole
@pytest.mark.parametrize(("library", "seed"), [("eonlib", 3), ("stock", 2)])
def test_every_check_of_every_node_has_the_same_verdict_with_another_seed(
    run, stock, library, seed
):
    """The run checks a single document, because pictures use no random samples.

    Checks in DRAWN, which the fixtures `run` and `stock` leave out, must pass.
    """
    found = verdicts(mxeon.check(EXAMPLES[:1], ["gl"], [library], nodes=["all"], seed=seed))
    known = verdicts({"eonlib": run, "stock": stock}[library])
    rest = {each: found.pop(each) for each in found.keys() - known.keys()}
    assert len(found) > 400 and found.items() <= known.items()
    assert {check for *_, check in rest} <= {*DRAWN} and bool(rest) == (library == "eonlib")
    assert set(rest.values()) <= {("passed", True)}


SCHLICK, DIELECTRIC = (
    f"{name}_bsdf, scatter_mode R" for name in ("generalized_schlick", "dielectric")
)
# Checks, subjects and seeds that draw rare cases: the first cells of an albedo table, a Schlick
# curve below 0, a critical angle, lobes that are almost never sampled, and a lobe whose fitted
# albedo is 0.
RARE = (
    ("methods", SCHLICK, 4),
    ("layer", SCHLICK, 12),
    ("domain", SCHLICK, 9),
    ("anisotropy", DIELECTRIC, 9),
    ("sample", "layer, under a colored sum", 7),
    ("sample", "generalized_schlick_bsdf, thin film", 7),
)


@pytest.mark.parametrize(("check", "title", "seed"), RARE)
def test_no_seed_accuses_eonlib_at_the_end_of_a_domain(gl, check, title, seed):
    result = Verdicts(lambda name: gl)(check, title, seed=seed)
    assert result.verdict == "passed", result.worst


class Counting(GlHost):
    """OpenGL host that records the largest number of direction pairs in one call."""

    largest = 0

    def evaluate(self, shader, wo, *rest, **options):
        self.largest = max(self.largest, len(wo))
        return super().evaluate(shader, wo, *rest, **options)


def test_numbers_of_samples_change_with_the_seed(gl):
    sizes = []
    for seed in (1, *SEEDS):
        with Counting() as host:
            Verdicts(lambda name, host=host: host)("value", "burley_diffuse_bsdf", seed=seed)
        sizes.append(host.largest)
    assert len(set(sizes)) == len(sizes)
    assert min(sizes) >= 0.875 * max(sizes)


def test_the_command_takes_a_seed_and_refuses_one_below_0():
    node = "burley_diffuse_bsdf"
    told = command.run("check", "--node", node, "--seed", 7, "--json").stdout
    [seven] = [each["worst"] for each in json.loads(told)["results"] if each["check"] == "value"]
    for seed in (7, 8):
        results = mxeon.check(None, ["gl"], nodes=[node], seed=seed).results
        [worst] = [each.worst for each in results if each.check == "value"]
        assert (worst == seven) == (seed == 7)
    with pytest.raises(InputError, match="seed must be at least 0; got -1"):
        mxeon.check(seed=-1)
