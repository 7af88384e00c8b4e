# SPDX-License-Identifier: Apache-2.0
"""The host testrender runs the programs that environment variables name, or replays a recording.

`tests.support.osl` contains recorded output of OSL's testrender.
"""

import os
from dataclasses import replace

import numpy as np
import pytest

import tests.support.osl as osl
from mxeon.errors import NotRun, ShaderError
from mxeon.hosts import testrender
from mxeon.models import eon_brdf
from tests.support.verdicts import FAILED, PASSED, has

EON = "oren_nayar_diffuse_bsdf, energy_compensation true"
# Error of pi f cos for a light at distance 1/2: 8 times the 3 roundings in a point at distance 40,
# plus the error of OpenImageIO's arc cosine.
FLAT = 2e-4
REAL = all(os.environ.get(variable) for variable in testrender.VARIABLES.values())
real = pytest.mark.skipif(not REAL, reason="its variables name no build of OSL")


@pytest.fixture
def replay(tmp_path, monkeypatch):
    """Folder with stand-ins for OSL's programs, which return the recorded output."""
    for variable, path in osl.write_replay(tmp_path).items():
        monkeypatch.setenv(variable, path)
    return tmp_path


@pytest.fixture
def host(replay):
    with testrender.TestrenderHost() as host:
        yield host


@pytest.mark.parametrize("name", ("oslc", "testrender"))
def test_a_missing_program_is_not_run_and_names_the_remedy(replay, monkeypatch, tmp_path, name):
    variable = testrender.VARIABLES[name]
    monkeypatch.delenv(variable)
    monkeypatch.setenv("PATH", str(tmp_path / "nothing"))
    with pytest.raises(NotRun, match=f"no program '{name}'; build Open Shading .* in {variable}"):
        testrender.TestrenderHost()


@pytest.mark.parametrize("line", ("ERROR: lobes are lost", "a.h:7: Assertion 'ok' failed"))
def test_what_a_program_reports_and_goes_on_after_is_an_error_with_its_words(tmp_path, line):
    program = tmp_path / "testrender"
    program.write_text(f'#!/bin/sh\necho "{line}"\n')
    program.chmod(0o755)
    with pytest.raises(ShaderError, match=line):
        testrender.output([str(program)])


def test_a_program_that_fails_is_not_run_with_its_words(host, replay):
    (replay / "testrender").write_text("#!/bin/sh\necho no such option; exit 1\n")
    with pytest.raises(NotRun, match="exit status 1; last output: no such option"):
        osl.values(host)


def test_what_oslc_refuses_is_a_shader_error(host):
    shader = osl.shader()
    wrong = shader.stages["pixel"].replace("mx_surface(", "no_such_function(")
    with pytest.raises(ShaderError, match="oslc: .*no_such_function"):
        pairs = osl.VIEWS, osl.LIGHTS
        host.evaluate(replace(shader, stages={"pixel": wrong}), *pairs, {}, "direct")


@pytest.mark.filterwarnings("ignore::mxeon.hosts.base.RendererWarning")
def test_the_recorded_picture_is_the_model(host):
    values = np.pi * osl.values(host)
    wo, wi = osl.VIEWS, osl.LIGHTS
    color, roughness = osl.INPUTS["color"], osl.INPUTS["roughness"]
    expected = np.pi * eon_brdf(wo, wi, np.array(color), roughness) * wi[:, 2:]
    error = np.abs(values - expected).max()
    assert 0.0 < error < FLAT  # half floats would have an error of 2^-11
    swapped = np.pi * eon_brdf(wo, wi, np.array(color[::-1]), roughness) * wi[:, 2:]
    assert np.abs(values - swapped).max() > FLAT


QON = "qualitative Oren-Nayar (QON)"


@real
@pytest.mark.parametrize(
    "library, subject, check, model",
    [
        *(("eonlib", EON, check, "") for check in ("value", "environment", "inputs")),
        *(("eonlib", shader, "lobe", "") for shader in ("open_pbr_surface", "UsdPreviewSurface")),
        ("eonlib", "shader twins", "twins", ""),
        ("stock", EON, "value", QON),
        ("stock", "open_pbr_surface", "lobe", QON),
    ],
)
def test_the_real_renderer_is_judged(judged, library, subject, check, model):
    for result in judged.all(check, subject, "testrender", library):
        assert result.verdict == (FAILED if model else PASSED)
        if model:
            assert has(result, "model", model) and result.pages == ("genosl_dropped_flag",)
