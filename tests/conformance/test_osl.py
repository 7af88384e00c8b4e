# SPDX-License-Identifier: Apache-2.0
"""OSL closures of eonlib's nodes pass their checks, and wrong OSL fails the intended check."""

from copy import copy
from dataclasses import replace

import numpy as np
import pytest

from mxeon.conformance.reference.closures import evaluate
from mxeon.hosts.base import Query
from mxeon.shaders.generation import generate
from mxeon.shaders.library import examples_folder
from tests.support.cases import pairs
from tests.support.verdicts import FAILED, PASSED, Verdicts, said

# These bundled documents use no images. The reference supports images only on a sphere.
EXAMPLES = (
    *("brushed_metal_wedge", "layered_white_furnace", "mixed_lobes", "openpbr_rough_base"),
    *("plaster", "standard_surface_rough_base", "tempered_steel", "velvet"),
)
# These nodes use the input `color82`, which no OSL closure has.
COLOR82 = ("brushed_schlick_smooth", "brushed_schlick_rough")
# Error relative to the larger of 1 and pi f cos. An argument has 16 float32 roundings. A microfacet
# distribution amplifies the relative error of alpha by 4.
GRAPH = 64 * 2.0**-24
# Mutations of the generated OSL, by node title and check: the original code and its replacement.
WRONG = {
    ("oren_nayar_diffuse_bsdf, energy_compensation true", "value"):
        ('"energy_compensation"', '"energy_conservation"'),
    ("oren_nayar_diffuse_bsdf, energy_compensation true", "frame"):
        ("transform(geomprop_Nworld_space, N)", "N * 0 + vector(0, 0, 1)"),
    ("oren_nayar_diffuse_bsdf, energy_compensation false", "value"): ("lobe_weight * ", ""),
    ("eon_diffuse_bsdf", "value"): ('"energy_compensation", 1', '"energy_compensation", 1.0'),
    ("eon_diffuse_bsdf", "frame"): ("oren_nayar_diffuse_bsdf(", "oren_nayar_diffuse_bsdf(-"),
    ("eon_diffuse_bsdf", "inputs"): ("oren_nayar_diffuse_bsdf(", "oren_nayar_diffuse_bsdf(N + 0 * "),
    ("burley_diffuse_bsdf", "value"): ("lobe_roughness)", "sqrt(lobe_roughness))"),
    ("translucent_bsdf", "value"):
        ("lobe_weight * translucent_bsdf(geomprop_Nworld_out1, lobe_color)",
         "lobe_weight * burley_diffuse_bsdf(geomprop_Nworld_out1, lobe_color, 0)"),
    ("sheen_bsdf, mode conty_kulla", "value"): ('"mode", zeltner', '"mode", 1 - zeltner'),
    ("sheen_bsdf, mode zeltner", "value"): ("float r = roughness", "float r = sqrt(roughness)"),
    ("dielectric_bsdf, scatter_mode R", "value"): ("roughness.y, ior,", "roughness.y, 1.0 / ior,"),
    ("dielectric_bsdf, scatter_mode RT", "kept"): ('scatter_mode == "R" ?', 'scatter_mode == "" ?'),
    ("conductor_bsdf", "value"): ("lobe_ior, lobe_extinction", "lobe_extinction, lobe_ior"),
    ("conductor_bsdf", "shape"): ('lobe_distribution = "ggx"', 'lobe_distribution = "beckmann"'),
    ("conductor_bsdf", "frame"): ("transform(geomprop_Tworld_space, normalize(dPdu))", "vector(1, 0, 0)"),
    ("conductor_bsdf, thin film", "value"):
        (', "thinfilm_thickness", lobe_thinfilm_thickness, "thinfilm_ior", lobe_thinfilm_ior', ""),
    ("layer", "combination"): ("layer(top_out, base_out)", "layer(base_out, top_out)"),
    ("mix", "combination"): ("mix(base_out, top_out", "mix(top_out, base_out"),
    ("add", "combination"): ("top_out + base_out", "top_out + top_out"),
    ("multiply, in2 color3", "combination"): ("lobe_in2 * top_out", "lobe_in2[0] * top_out"),
    ("layer, under a mix of a sum", "combination"): ("layer(mixed_out, base_out)", "layer(sum_out, base_out)"),
    ("chiang_hair_bsdf", "value"): ("roughness_R.x, roughness_TT.x", "roughness_TT.x, roughness_R.x"),
    ("uniform_edf", "radiance"): ("uniform_edf(emission_color)", "(1.0 / M_PI) * uniform_edf(emission_color)"),
    ("conical_edf", "radiance"): ("dot(axis, -I)", "dot(axis, I)"),
    ("generalized_schlick_edf", "radiance"): ("base * f", "base"),
    ("mix, EDF", "radiance"): ("mix(second_out, first_out", "mix(first_out, second_out"),
    ("absorption_vdf", "transmittance"): ("color(0.0), medium_absorption", "medium_absorption, color(1.0)"),
    ("anisotropic_vdf", "transmittance"): ("extinction = absorption + scattering", "extinction = absorption"),
    ("mix, VDF", "transmittance"): ("mix(second_out, first_out", "mix(first_out, second_out"),
    ("subsurface_bsdf", "value"): ("N, albedo, radius", "N, sqrt(albedo), radius"),
}  # fmt: skip
NAMED = {
    ("eon_diffuse_bsdf", "value"): "osl: the shader does not compile: ",
    ("eon_diffuse_bsdf", "frame"): "osl: normal of oren_nayar_diffuse_bsdf must be the node's",
    ("eon_diffuse_bsdf", "inputs"): "inputs without effect: normal",
    ("layer", "combination"): "fault: top and base are exchanged (rms ",
    ("mix", "combination"): "fault: top and base are exchanged (rms ",
    ("conductor_bsdf", "shape"): "distribution of conductor_bsdf must be ggx",
    ("conductor_bsdf", "value"): "fault: ior and extinction are exchanged (rms ",
    ("sheen_bsdf, mode conty_kulla", "value"): "best match: Zeltner sheen (rms ",
    ("dielectric_bsdf, scatter_mode RT", "kept"): "mode R transmits light",
    ("oren_nayar_diffuse_bsdf, energy_compensation false", "value"): "fault: the weight is ignored",
}
RIGHT = (
    *(key for key in WRONG if key[1] != "kept"),
    *((title, "combination") for title in ("multiply, in2 float", "mix, of a layer under a sum")),
    *((title, "radiance") for title in ("add, EDF", "multiply, EDF, in2 color3")),
    *((title, "transmittance") for title in ("add, VDF", "multiply, VDF, in2 float")),
    *((f"dielectric_bsdf, scatter_mode {mode}", "transmitted") for mode in ("T", "RT")),
    *((f"{node}, every lobe", "lobes") for node in ("standard_surface", "UsdPreviewSurface", "gltf_pbr")),
    ("dielectric_bsdf, thin film", "value"), ("artistic_ior, ior", "output"), ("artistic_ior, extinction", "output"),
)  # fmt: skip


@pytest.fixture
def changed(hosts):
    """Function that replaces part of the generated OSL, and returns a judge of the changed OSL."""
    host = hosts("osl")

    def change(old, new):
        def compile_text(document, element=None, **options):
            [shader] = host.compile(document, element, **options)
            return (replace(shader, stages={"pixel": shader.stages["pixel"].replace(old, new)}),)

        wrong = copy(host)
        wrong.compile = compile_text
        return Verdicts(lambda name: wrong)

    return change


@pytest.mark.parametrize(("title", "check"), RIGHT)
def test_the_closures_of_eonlib_are_those_of_the_equations(judged, title, check):
    result = judged(check, title, "osl")
    assert result.verdict == PASSED and result.control.caught, said(result)


@pytest.mark.parametrize(("title", "check"), WRONG)
def test_a_wrong_text_is_noticed_and_named(changed, title, check):
    result = changed(*WRONG[title, check])(check, title, "osl")
    assert result.verdict == FAILED and NAMED.get((title, check), "") in said(result)


def test_the_repair_on_its_page_gives_a_sheen_its_mode(judged, changed):
    titles = ("sheen_bsdf, mode conty_kulla", "sheen_bsdf, mode zeltner")
    found = [judged("value", title, "osl", "stock").verdict for title in titles]
    assert found == [PASSED, FAILED]
    repaired = changed("lobe_roughness)", 'lobe_roughness, "mode", lobe_mode == "zeltner")')
    assert repaired("value", titles[1], "osl", "stock").verdict == PASSED


@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_is_what_its_document_says(hosts, reference, name):
    file, host = examples_folder() / f"{name}.mtlx", hosts("osl")
    wo, wi = np.float32(pairs(16, seed=1)[:2])
    for osl, other in zip(generate(file, "osl"), generate(file, "glsl"), strict=True):
        expected = np.pi * reference.evaluate(other, wo, wi, {}, "direct")
        query = Query(osl, wo, wi, {}, "direct", "response", None)
        error = np.abs(np.pi * evaluate(host.trees(osl, wo, {}), query) - expected)
        largest = (error / np.maximum(np.abs(expected), 1.0)).max()
        assert (largest <= GRAPH) == (osl.name not in COLOR82)
