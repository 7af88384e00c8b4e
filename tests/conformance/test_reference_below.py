# SPDX-License-Identifier: Apache-2.0
"""What the reference shows of light that passes a surface: transmission, volumes and lobes below it."""

from dataclasses import replace

import numpy as np
import pytest

from mxeon.conformance.pictures import judge_document
from mxeon.conformance.reference import Host as Reference
from mxeon.hosts import open_host
from mxeon.shaders.generation import generate
from mxeon.shaders.scene import FURNACE, SIDE, sphere
from tests.support.documents import material

GLASS = """<dielectric_bsdf name="{name}" type="BSDF"><input name="tint" type="color3"
  value="0.2, 0.5, 0.9"/><input name="scatter_mode" type="string" value="{mode}"/></dielectric_bsdf>"""
FOG = """<anisotropic_vdf name="fog" type="VDF"><input name="scattering" type="vector3"
  value="0, 1, 0"/></anisotropic_vdf>"""
HAZE = """<layer name="lobe" type="BSDF"><input name="top" type="BSDF" nodename="glass"/>
  <input name="base" type="VDF" nodename="fog"/></layer>"""


def lit(text, scene):
    return Reference().picture(generate(material(text), "glsl")[0], replace(scene, size=32))


def test_what_is_transmitted_of_a_furnace_is_what_is_not_reflected():
    whole = GLASS.replace("0.2, 0.5, 0.9", "1, 1, 1").format(name="lobe", mode="RT")
    assert np.allclose(lit(whole, FURNACE)[sphere(32).mask], 1.0, atol=1e-9)
    assert not lit(GLASS.format(name="lobe", mode="T"), SIDE).any()


def test_a_volume_dims_what_is_transmitted_and_not_what_is_reflected():
    clear = lit(GLASS.format(name="lobe", mode="T"), FURNACE)
    foggy = lit(GLASS.format(name="glass", mode="T") + FOG + HAZE, FURNACE)
    assert np.allclose(foggy, clear * [1.0, np.exp(-1.0), 1.0], atol=1e-12)
    reflected = lit(GLASS.format(name="glass", mode="R") + FOG + HAZE, FURNACE)
    assert np.allclose(reflected, lit(GLASS.format(name="lobe", mode="R"), FURNACE))


@pytest.mark.parametrize(
    "node",
    [
        GLASS.format(name="lobe", mode="RT"),
        """<subsurface_bsdf name="lobe" type="BSDF"><input name="radius" type="color3"
        value="0.5, 0.2, 0.05"/></subsurface_bsdf>""",
        """<chiang_hair_bsdf name="lobe" type="BSDF"/>""",
    ],
    ids=["transmission", "subsurface", "hair"],
)
def test_lobes_below_the_surface_have_a_picture_like_gl(node, tmp_path):
    path = tmp_path / "inner.mtlx"
    path.write_text(material(node))
    [result], _, _ = judge_document(path, open_host("gl"), Reference(), "eonlib")
    assert (result.check, result.verdict) == ("picture", "passed")


@pytest.mark.parametrize("node", ["subsurface_bsdf", "dielectric_bsdf"])
def test_a_wrong_lobe_below_the_surface_is_found(node, tmp_path):
    rough = '<input name="roughness" type="vector2" value="0.8, 0.8"/></dielectric_bsdf>'
    glass = GLASS.format(name="lobe", mode="T").replace("</dielectric_bsdf>", rough)
    path = tmp_path / "inner.mtlx"
    lobes = {"dielectric_bsdf": glass, "subsurface_bsdf": f'<{node} name="lobe" type="BSDF"/>'}
    path.write_text(material(lobes[node]))
    [result], _, _ = judge_document(path, open_host("gl"), Reference(), "stock")
    assert (result.check, result.verdict) == ("picture", "failed")
