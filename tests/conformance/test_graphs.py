# SPDX-License-Identifier: Apache-2.0
"""The check `release` names the part of a surface shader's graph or definition that is wrong."""

import shutil

import pytest

from tests.support.verdicts import DIFFERS, EVERY_NODE, FAILED, PASSED, has, said
from tests.support.wheels import wheel
from tests.support.wrong_libraries import copy_of_stock, wrong_stock

FILES = {
    "open_pbr_surface": "bxdf/open_pbr_surface.mtlx",
    "standard_surface": "bxdf/standard_surface.mtlx",
    "gltf_pbr": "bxdf/gltf_pbr.mtlx",
    "UsdPreviewSurface": "bxdf/usd_preview_surface.mtlx",
}
# Errors to put into graphs, by node category: the original code, the replacement, and words of the
# expected diagnosis.
WRONG = {
    "open_pbr_surface": (
        ('value="1000.0" />', 'value="100.0" />', "in2 of thin_film_thickness_nm is 100 instead of 1000"),
        ('<generalized_schlick_bsdf name="metal_bsdf_tf" type="BSDF">\n      <input name="weight" type="float" interfacename="specular_weight" />',
         '<generalized_schlick_bsdf name="metal_bsdf_tf" type="BSDF">',
         "weight of metal_bsdf_tf is missing instead of the input specular_weight"),
        ('nodename="fuzz_bsdf" />\n      <input name="base" type="BSDF" nodename="coat_layer" />',
         'nodename="coat_layer" />\n      <input name="base" type="BSDF" nodename="fuzz_bsdf" />',
         "top of fuzz_layer is coat_layer instead of fuzz_bsdf, base of fuzz_layer is fuzz_bsdf instead of coat_layer"),
        ('name="coat_roughness" type="float" value="0.0"', 'name="coat_roughness" type="float" value="0.1"',
         "the default of coat_roughness of ND_open_pbr_surface_surfaceshader is 0.1 instead of 0"),
        ('nodename="alpha_x" />\n      <input name="in2" type="float" nodename="alpha_y" />',
         'nodename="alpha_y" />\n      <input name="in2" type="float" nodename="alpha_x" />',
         "in1 of result is alpha_y instead of alpha_x"),
        ('<input name="absorption" type="vector3" nodename="if_volume_absorption" />\n      <input name="scattering" type="vector3" nodename="if_volume_scattering" />',
         '<input name="absorption" type="vector3" nodename="if_volume_scattering" />\n      <input name="scattering" type="vector3" nodename="if_volume_absorption" />',
         "absorption of dielectric_volume is if_volume_scattering instead of if_volume_absorption"),
        ('interfacename="geometry_coat_tangent"', 'interfacename="geometry_tangent"',
         "tangent of coat_bsdf is the input geometry_tangent instead of the input geometry_coat_tangent"),
        ('<input name="thin_walled" type="boolean" interfacename="geometry_thin_walled" />', "",
         "thin_walled of shader_constructor is missing instead of the input geometry_thin_walled"),
        ('interfacename="transmission_depth" />\n      <input name="value2" type="float" value="0.0" />',
         'interfacename="transmission_depth" />\n      <input name="value2" type="float" value="0.1" />',
         "value2 of if_volume_absorption is 0.1 instead of 0"),
    ),
    "standard_surface": (
        ('interfacename="coat_rotation"', 'interfacename="specular_rotation"',
         "in1 of coat_tangent_rotate_degree is the input specular_rotation instead of the input coat_rotation"),
        ('nodename="transmission_roughness" />\n      <input name="normal" type="vector3" interfacename="normal" />\n      <input name="tangent" type="vector3" nodename="main_tangent" />',
         'nodename="transmission_roughness" />\n      <input name="normal" type="vector3" interfacename="normal" />',
         "tangent of transmission_bsdf is missing instead of main_tangent"),
        ('type="color3" nodename="opacity_luminance" />', 'type="color3" interfacename="opacity" />',
         "in of opacity_luminance_float is the input opacity instead of opacity_luminance"),
    ),
    "gltf_pbr": (
        ('<input name="bg" type="BSDF" nodename="reflection_bsdf" />\n      <input name="fg" type="BSDF" nodename="tf_reflection_bsdf" />',
         '<input name="fg" type="BSDF" nodename="reflection_bsdf" />\n      <input name="bg" type="BSDF" nodename="tf_reflection_bsdf" />',
         "bg of mix_iridescent_dielectric_reflection is tf_reflection_bsdf instead of reflection_bsdf"),
        ('value="-57.295780" />', 'value="57.295780" />', "in2 of rad_2_deg is 57.29578 instead of -57.29578"),
    ),
    "UsdPreviewSurface": (
        ('<input name="mix" type="float" nodename="use_specular_workflow_float" />', '<input name="mix" type="float" value="1.0" />',
         "mix of diffuse_bsdf_weight is 1 instead of use_specular_workflow_float"),
        ("ifgreatereq", "ifgreater", "cutout_opacity is ifgreater instead of ifgreatereq"),
    ),
}  # fmt: skip
ROWS = [
    pytest.param(node, *row, id=f"{node}, {row[2]}", marks=[pytest.mark.whole] * (number > 0))
    for node, rows in WRONG.items()
    for number, row in enumerate(rows)
]


@pytest.mark.parametrize(("node", "old", "new", "words"), ROWS)
def test_a_wrong_part_of_a_graph_is_named(judged, tmp_path, node, old, new, words):
    result = judged("release", EVERY_NODE, library=wrong_stock(tmp_path, FILES[node], (old, new)))
    assert result.verdict == FAILED and result.control.caught
    assert words in said(result)


def test_a_graph_that_is_written_differently_passes(judged, tmp_path):
    inputs = (f'<input name="{port}" type="float" nodename="R" />\n' for port in ("in1", "in2"))
    product = '<multiply name="R_sq" type="float">\n      {}      {}    </multiply>'.format(*inputs)
    power = (
        '<power name="R_sq" type="float"><input name="in1" type="float" nodename="size" />'
        '<input name="in2" type="float" value="2.0" /></power>'
        '<absval name="size" type="float"><input name="in" type="float" nodename="R" /></absval>'
    )
    library = wrong_stock(tmp_path, FILES["UsdPreviewSurface"], (product, power))
    assert judged("release", EVERY_NODE, library=library).verdict == PASSED


def test_another_version_of_a_node_differs(judged, tmp_path):
    changes = (('version="1.1.1"', 'version="1.2"'), ('value="1000.0" />', 'value="100.0" />'))
    library = wrong_stock(tmp_path, FILES["open_pbr_surface"], *changes)
    result = judged("release", EVERY_NODE, library=library)
    assert result.verdict == DIFFERS and has(result, "newer", "open_pbr_surface")
    assert has(result, "in2 of thin_film_thickness_nm", "100")


def test_the_graph_of_an_older_release_differs(judged, tmp_path):
    file = f"libraries/{FILES['open_pbr_surface']}"
    copy_of_stock(tmp_path, FILES["open_pbr_surface"])
    shutil.copy(wheel("1.39.3") / "MaterialX" / file, tmp_path / FILES["open_pbr_surface"])
    result = judged("release", EVERY_NODE, library=str(tmp_path))
    assert result.verdict == DIFFERS and has(result, "newer", "open_pbr_surface")
