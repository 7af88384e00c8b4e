# SPDX-License-Identifier: Apache-2.0
"""testrender as a host: what is missing is said, and its scenes are what its source says they are.

Programs that read and write the same files stand in for those of OSL, which were not run.
"""

import sys
from contextlib import closing
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from mxeon.conformance.checks.nodes import SUBJECTS
from mxeon.conformance.checks.probes import PlaneProbe
from mxeon.conformance.results import FAILED, PASSED
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import make_plan
from mxeon.errors import NotRun, ShaderError
from mxeon.shaders.document.policy import DEFAULT
from mxeon.shaders.generation import generate
from mxeon.shaders.hosts import testrender
from mxeon.shaders.plane import plane_pairs
from mxeon.shaders.scene import SIDE

STAND_INS = {
    "testrender": f'exec {sys.executable} {Path(__file__).parents[1] / "support" / "testrender.py"} "$@"',
    "oslc": """[ "$1" = --version ] && exec echo 1.14.8
        [ -f "${2#-I}/mx_funcs.h" ] || exit 2
        grep -n no_such_function "$3" && exit 1
        cp "$3" "${3%.osl}.oso" """,
}
EON = SUBJECTS[0].title


@pytest.fixture(autouse=True)
def programs(tmp_path, monkeypatch):
    """The stand-ins, named by their variables."""
    for name, variable in testrender.PROGRAMS.items():
        path = tmp_path / name
        path.write_text(f"#!/bin/sh\n{STAND_INS[name]}\n")
        path.chmod(0o755)
        monkeypatch.setenv(variable, str(path))
    return tmp_path


@pytest.fixture
def host(programs):
    host = testrender.Host()
    yield host
    host.close()


@pytest.mark.parametrize("name, variable", testrender.PROGRAMS.items())
def test_a_missing_program_is_not_run_and_names_the_remedy(monkeypatch, tmp_path, name, variable):
    monkeypatch.delenv(variable)
    monkeypatch.setenv("PATH", str(tmp_path / "nothing"))
    with pytest.raises(NotRun, match=f"no program '{name}'; build Open Shading .* in {variable}"):
        testrender.Host()


def test_a_program_that_fails_is_not_run_with_its_words(host, programs):
    (programs / "testrender").write_text("#!/bin/sh\necho no such option; exit 1\n")
    shader = generate(SUBJECTS[0].document(), "osl")[0]
    with pytest.raises(
        NotRun,
        match="exit status 1, not verified against a real build; last output: no such option",
    ):
        host.plane(shader, SIDE)


def test_what_oslc_refuses_is_a_shader_error(host):
    shader = generate(SUBJECTS[0].document(), "osl")[0]
    wrong = shader.stages["pixel"].replace("mx_surface(", "no_such_function(")
    with pytest.raises(ShaderError, match="oslc: .*no_such_function"):
        host.plane(replace(shader, stages={"pixel": wrong}), SIDE)


def test_a_program_may_be_named_from_here(monkeypatch, programs):
    monkeypatch.chdir(programs)
    for name, variable in testrender.PROGRAMS.items():
        monkeypatch.setenv(variable, f"./{name}")
    shader = generate(SUBJECTS[0].document(), "osl")[0]
    with closing(testrender.Host()) as host:
        assert host.plane(shader, replace(SIDE, size=4)).shape == (16, 3)


def test_its_identity_says_that_no_real_build_has_run(host):
    assert host.identity().version == "OSL 1.14.8, not verified against a real build"


def test_the_plane_is_seen_at_all_angles():
    scene = PlaneProbe.scenes[1]
    wo, wi = plane_pairs(scene)
    assert wo[:, 2].min() < 0.1 and wo[:, 2].max() > 0.8
    np.testing.assert_allclose(np.linalg.norm(wo, axis=1), 1.0, atol=1e-12)
    assert ((wo * wi).sum(axis=1) < 0.0).any() and ((wo * wi).sum(axis=1) > 0.5).any()


def verdicts(library, *keys):
    """Verdict and diagnosis of checks of the node with the flag, by key."""
    items = make_plan([], ["testrender"], [library]).tasks
    with closing(Judge(DEFAULT)) as judge:
        chosen = [each for each in items if (each.subject, each.check) in product([EON], keys)]
        results = [result for item in chosen for result in judge.work(item).results]
    return {each.check: (each.verdict, each.diagnosis) for each in results}


def test_a_right_renderer_passes_with_eonlib():
    found = verdicts("eonlib", "value", "environment", "inputs")
    assert found == dict.fromkeys(("value", "environment", "inputs"), (PASSED, ""))


def test_stock_materialx_is_found_to_drop_the_flag():
    verdict, diagnosis = verdicts("stock", "value")["value"]
    assert verdict == FAILED and "qualitative Oren-Nayar (QON)" in diagnosis
