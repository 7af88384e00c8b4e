# SPDX-License-Identifier: Apache-2.0
"""Documents whose patterns the reference does not know: the host's own values feed its lobes."""

import numpy as np
import pytest

from mxeon.conformance.pictures import judge_document
from mxeon.conformance.reference import Host as Reference
from mxeon.hosts import open_host
from mxeon.io.images import write_exr
from mxeon.shaders.nodes import SURFACE, document_text

LOBE = """<oren_nayar_diffuse_bsdf name="lobe" type="BSDF">
  <input name="color" type="color3" nodename="pattern"/>
  <input name="roughness" type="float" value="1"/>
  <input name="energy_compensation" type="boolean" value="true"/>
</oren_nayar_diffuse_bsdf>"""
NOISE = """<cellnoise2d name="noise" type="float">
  <input name="texcoord" type="vector2" nodename="placed"/>
</cellnoise2d>
<place2d name="placed" type="vector2">
  <input name="texcoord" type="vector2" nodename="where"/>
  <input name="scale" type="vector2" value="0.1, 0.1"/>
</place2d>
<texcoord name="where" type="vector2"/>
<convert name="pattern" type="color3"><input name="in" type="float" nodename="noise"/></convert>"""
TILED = """<tiledimage name="pattern" type="color3">
  <input name="file" type="filename" value="checks.exr"/>
  <input name="uvtiling" type="vector2" value="3, 2"/>
</tiledimage>"""


@pytest.fixture(scope="module")
def host():
    with open_host("gl") as engine:
        yield engine


def judged(host, tmp_path, text, library="eonlib"):
    path = tmp_path / "pattern.mtlx"
    path.write_text(text)
    return judge_document(path, host, Reference(), library)


def test_the_color_of_a_noise_comes_from_the_host(host, tmp_path):
    [result], pictures, _ = judged(host, tmp_path, document_text(NOISE + LOBE + SURFACE))
    assert (result.check, result.verdict) == ("picture", "passed")
    assert result.measured == ("lobe.color",)
    assert {picture.metadata["from the host"] for picture in pictures} == {"lobe.color"}
    assert np.ptp(pictures[0].reference[128]) > 0.5  # the pattern is there


def test_a_wrong_lobe_behind_a_measured_input_is_found(host, tmp_path):
    [result], _, _ = judged(host, tmp_path, document_text(NOISE + LOBE + SURFACE), "stock")
    assert (result.check, result.verdict, result.measured) == ("picture", "failed", ("lobe.color",))
    assert result.error > 100 * result.tolerance


def test_an_image_with_a_transform_comes_from_the_host(host, tmp_path):
    checks = np.indices((8, 8)).sum(axis=0)[..., np.newaxis] % 2 * np.array([0.8, 0.4, 0.2])
    write_exr(tmp_path / "checks.exr", checks.astype(np.float32), {})
    [result], _, _ = judged(host, tmp_path, document_text(TILED + LOBE + SURFACE))
    assert (result.check, result.verdict, result.measured) == ("picture", "passed", ("lobe.color",))


def test_a_pattern_alone_is_what_a_surface_emits_of_it(host, tmp_path):
    shown = '<output name="shown" type="float" nodename="noise"/>'
    text = f'<materialx version="1.39">{NOISE}{shown}</materialx>'
    [result], _, _ = judged(host, tmp_path, text)
    assert (result.check, result.verdict, result.measured) == ("picture", "passed", ("shown",))


def test_materials_that_vary_are_judged_and_compared_at_some_of_the_pixels(host, tmp_path):
    lobe = """<conductor_bsdf name="lobe" type="BSDF">
      <input name="roughness" type="vector2" nodename="rough"/>
    </conductor_bsdf>
    <convert name="rough" type="vector2"><input name="in" type="float" nodename="noise"/></convert>"""
    [result], pictures, _ = judged(host, tmp_path, document_text(NOISE + lobe + SURFACE))
    furnace = pictures[-1]
    assert 700 < furnace.judged.sum() < 900
    # The others are like their neighbors: they have the neighbors' difference, not their own.
    assert np.abs(furnace.image - furnace.reference).max() > 10.0 * result.tolerance
    assert np.nanmax(furnace.difference()) < 3.0 * result.tolerance
