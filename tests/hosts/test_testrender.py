# SPDX-License-Identifier: Apache-2.0
"""testrender as a host: judged with the real programs where they are named, else by a recording.

The recording holds what OSL's programs printed and rendered; see `tests.support.osl`.
"""

import os
from contextlib import closing
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

import tests.support.osl as osl
from mxeon.conformance.accuracy.diffuse import TESTRENDER
from mxeon.conformance.functions.shader_functions import FUNCTION_CHECKS
from mxeon.conformance.nodes.diffuse import SUBJECTS
from mxeon.conformance.probes.pictures import PlaneProbe
from mxeon.conformance.results import FAILED, PASSED
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import make_plan
from mxeon.errors import NotRun, ShaderError
from mxeon.hosts import testrender
from mxeon.hosts.base import RendererWarning
from mxeon.hosts.testrender import calls, programs
from mxeon.models import eon_brdf
from mxeon.shaders.document.policy import DEFAULT
from mxeon.shaders.plane import plane_pairs

EON = SUBJECTS[0].title
REAL = all(os.environ.get(variable) for variable in programs.VARIABLES.values())
real = pytest.mark.skipif(not REAL, reason="its variables name no build of OSL")


@pytest.fixture
def replay(tmp_path, monkeypatch):
    """Programs that replay the recording, named by their variables; their folder."""
    for variable, path in osl.write_replay(tmp_path).items():
        monkeypatch.setenv(variable, path)
    return tmp_path


@pytest.fixture
def host(replay):
    with testrender.Host() as host:
        yield host


@pytest.mark.parametrize("name", ("oslc", "testrender"))
def test_a_missing_program_is_not_run_and_names_the_remedy(replay, monkeypatch, tmp_path, name):
    variable = programs.VARIABLES[name]
    monkeypatch.delenv(variable)
    monkeypatch.setenv("PATH", str(tmp_path / "nothing"))
    with pytest.raises(NotRun, match=f"no program '{name}'; build Open Shading .* in {variable}"):
        testrender.Host()


@pytest.mark.parametrize("line", ("ERROR: lobes are lost", "a.h:7: Assertion 'ok' failed"))
def test_what_a_program_reports_and_goes_on_after_is_not_run(tmp_path, line):
    program = tmp_path / "testrender"
    program.write_text(f'#!/bin/sh\necho "{line}"\n')
    program.chmod(0o755)
    with pytest.raises(NotRun, match=line):
        programs.output([str(program)])


def test_a_program_without_a_version_is_not_run(replay):
    (replay / "oslc").write_text("#!/bin/sh\necho another compiler\n")
    with pytest.raises(NotRun, match="must be OSL's compiler; its help names no version"):
        testrender.Host()


def test_a_program_that_fails_is_not_run_with_its_words(host, replay):
    (replay / "testrender").write_text("#!/bin/sh\necho no such option; exit 1\n")
    with pytest.raises(NotRun, match="exit status 1; last output: no such option"):
        host.plane(osl.shader(), osl.LIGHT)


def test_what_oslc_refuses_is_a_shader_error(host):
    shader = osl.shader()
    wrong = shader.stages["pixel"].replace("mx_surface(", "no_such_function(")
    with pytest.raises(ShaderError, match="oslc: .*no_such_function"):
        host.plane(replace(shader, stages={"pixel": wrong}), osl.LIGHT)


def test_a_program_may_be_named_from_here(monkeypatch, replay):
    monkeypatch.chdir(replay)
    for name, variable in programs.VARIABLES.items():
        monkeypatch.setenv(variable, f"./{name}")
    with closing(testrender.Host()) as host, pytest.warns(RendererWarning):
        assert host.plane(osl.shader(), osl.LIGHT).shape == (256, 3)


def test_its_identity_is_the_version_that_the_help_states(host):
    assert host.identity().version == "Open Shading Language 1.15.6.0"


def test_the_programs_have_every_option_that_the_host_uses():
    options = osl.facts()["options"]
    assert {"-t NTHREADS", "--res W H", "-aa N"} <= set(options["testrender"])
    assert {"-t NTHREADS", "--res XRES YRES", "-d NAME", "--center"} <= set(options["testshade"])
    assert "-o VARIABLE FILENAME" in options["testshade"]


@pytest.mark.filterwarnings("ignore::mxeon.hosts.base.RendererWarning")
def test_the_recorded_picture_is_the_model(host):
    values = host.plane(osl.shader(), osl.LIGHT)
    wo, wi = plane_pairs(osl.LIGHT)
    color, roughness = osl.INPUTS["color"], osl.INPUTS["roughness"]
    expected = np.pi * eon_brdf(wo, wi, np.array(color), roughness) * wi[:, 2:]
    error = np.abs(values / expected - 1.0).max()
    assert 0.0 < error < TESTRENDER.value  # floats: half floats are off by 2^-11
    swapped = np.pi * eon_brdf(wo, wi, np.array(color[::-1]), roughness) * wi[:, 2:]
    assert np.abs(values / swapped - 1.0).max() > TESTRENDER.value


def test_what_the_renderer_warns_of_is_passed_on(host):
    with pytest.warns(RendererWarning, match="testrender: WARNING: Unsupported closure keyword"):
        host.plane(osl.shader(), osl.LIGHT)


def test_the_plane_is_seen_at_all_angles():
    scene = PlaneProbe.scenes[1]
    wo, wi = plane_pairs(scene)
    assert wo[:, 2].min() < 0.1 and wo[:, 2].max() > 0.8
    np.testing.assert_allclose(np.linalg.norm(wo, axis=1), 1.0, atol=1e-12)
    assert ((wo * wi).sum(axis=1) < 0.0).any() and ((wo * wi).sum(axis=1) > 0.5).any()


def test_a_called_function_reads_a_texel_for_each_argument():
    text = calls.text("float twice(float x) { return 2.0 * x; }", "twice", [("float", "x")])
    assert 'float mxeon_x = (float) (float) texture("x.tif", u, v' in text
    assert "result = (color) twice(mxeon_x);" in text


def verdicts(library, subject, keys):
    """Verdict and diagnosis of checks of a subject, by key."""
    tasks = make_plan([], ["testrender"], [library]).tasks
    with closing(Judge(DEFAULT)) as judge:
        chosen = [task for task in tasks if (task.subject, task.check) in product([subject], keys)]
        results = [result for task in chosen for result in judge.work(task).results]
    assert len(results) == len(keys)
    return {result.check: (result.verdict, result.explanation) for result in results}


@real
def test_the_real_renderer_passes_with_eonlib():
    keys = ("value", "environment", "inputs")
    assert verdicts("eonlib", EON, keys) == dict.fromkeys(keys, (PASSED, ""))


@real
def test_the_real_renderer_shows_that_stock_materialx_drops_the_flag():
    verdict, diagnosis = verdicts("stock", EON, ["value"])["value"]
    assert verdict == FAILED and "qualitative Oren-Nayar (QON)" in diagnosis


@real
def test_surface_shaders_are_judged_on_the_real_renderer():
    assert verdicts("eonlib", "open_pbr_surface", ["lobe"])["lobe"] == (PASSED, "")
    verdict, diagnosis = verdicts("stock", "open_pbr_surface", ["lobe"])["lobe"]
    assert verdict == FAILED and "qualitative Oren-Nayar (QON)" in diagnosis
    assert "docs/upstream/genosl_dropped_flag.md" in diagnosis


def test_what_a_renderer_warns_of_is_in_the_diagnosis(replay, monkeypatch):
    monkeypatch.setattr(PlaneProbe, "scenes", (osl.LIGHT,))
    monkeypatch.setattr(PlaneProbe, "size", osl.LIGHT.size)
    diagnosis = verdicts("eonlib", EON, ["lambert"])["lambert"][1]  # the picture is of roughness 1
    assert diagnosis.endswith(osl.facts()["warning"])


@real
def test_the_functions_of_eonlib_are_the_models_in_testshade():
    keys = [check.key for check in FUNCTION_CHECKS]
    found = verdicts("eonlib", "shader twins", keys)
    assert found == dict.fromkeys(keys, (PASSED, ""))
