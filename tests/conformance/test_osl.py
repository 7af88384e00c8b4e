# SPDX-License-Identifier: Apache-2.0
"""Every node of eonlib's OSL by its closures, and wrong texts, compiled by the same OSL, that are noticed."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from mxeon.conformance.accuracy.accuracy import ACCURACY, GRAPH
from mxeon.conformance.accuracy.engine import widen_for_engine
from mxeon.conformance.checks import transmission_measures
from mxeon.conformance.nodes import kinds
from mxeon.conformance.probes.cases import frame_cases, value_cases
from mxeon.conformance.probes.families import ALL_SUBJECTS, ClosureProbe, probe_type_of
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.reference import Host as Reference
from mxeon.conformance.reference.closures import evaluated
from mxeon.conformance.results import PASSED
from mxeon.conformance.run import check
from mxeon.conformance.samples.batch import Counts, directions
from mxeon.conformance.samples.measurement import Case, scaled
from mxeon.errors import ShaderError
from mxeon.hosts.base import Host
from mxeon.shaders.generation import Shader, generate
from mxeon.shaders.library import examples_folder

# Bundled documents without images, which the reference reads on a sphere alone.
EXAMPLES = (
    "brushed_metal_wedge.mtlx",
    "layered_white_furnace.mtlx",
    "mixed_lobes.mtlx",
    "openpbr_rough_base.mtlx",
    "plaster.mtlx",
    "standard_surface_rough_base.mtlx",
    "tempered_steel.mtlx",
    "velvet.mtlx",
)
COLOR82 = ("brushed_schlick_smooth", "brushed_schlick_rough")  # which no closure carries
FEW = Counts(48, 48, albedos=4, mirrored=48)
SUBJECTS = {each.title: each for each in ALL_SUBJECTS}
WEIGHT = ("weight * ", "")
TWICE = ("weight * ", "weight * weight * ")
HALF = ("weight * ", "0.5 * weight * ")
SHEENS = (("result = weight * ", "result = "), ('"mode", zeltner', '"mode", 1 - zeltner'))
R, T, RT = (f"dielectric_bsdf, scatter_mode {mode}" for mode in ("R", "T", "RT"))
EON, QON = (f"oren_nayar_diffuse_bsdf, energy_compensation {flag}" for flag in ("true", "false"))
# Title -> wrong changes of the generated text, each noticed by the values.
WRONG: dict[str, tuple[tuple[str, str], ...]] = {
    EON: (
        WEIGHT,
        TWICE,
        (', "energy_compensation", lobe_energy_compensation', ""),
        ("lobe_energy_compensation)", "1 - lobe_energy_compensation)"),
        ("lobe_color, lobe_roughness", "lobe_color, 0.5"),
        ("lobe_color, lobe_roughness", "lobe_color * lobe_color, lobe_roughness"),
        ("lobe_color, lobe_roughness", "lobe_color, lobe_roughness * lobe_roughness"),
        ('"energy_compensation"', '"energy_conservation"'),
    ),
    QON: (WEIGHT, (", lobe_energy_compensation)", ", 1)")),
    "eon_diffuse_bsdf": (WEIGHT, (', "energy_compensation", 1', "")),
    "burley_diffuse_bsdf": (
        WEIGHT,
        ("burley_diffuse_bsdf(geom", "oren_nayar_diffuse_bsdf(geom"),
        ("lobe_roughness)", "sqrt(lobe_roughness))"),
        ("lobe_color, lobe", "color(lobe_color[0]), lobe"),
    ),
    "translucent_bsdf": (
        HALF,
        (
            "lobe_weight * translucent_bsdf(geomprop_Nworld_out1, lobe_color)",
            "lobe_weight * burley_diffuse_bsdf(geomprop_Nworld_out1, lobe_color, 0)",
        ),
    ),
    "sheen_bsdf, mode conty_kulla": SHEENS,
    "sheen_bsdf, mode zeltner": (
        *SHEENS,
        ("float r = roughness", "float r = sqrt(roughness)"),
        ('sheen_bsdf(N, c, r, "mode", zeltner)', "sheen_bsdf(N, c, r)"),
        ('mode == "zeltner"', 'mode == "Zeltner"'),
    ),
    R: (
        ("weight * dielectric", "dielectric"),
        ("roughness.x, roughness.y, ior", "roughness.y, roughness.x, ior"),
        ("roughness.x, roughness.y, ior", "roughness.x, roughness.x, ior"),
        ("roughness.y, ior,", "roughness.y, 1.5,"),
        ("roughness.y, ior,", "roughness.y, 1.0 / ior,"),
        (
            'scatter_mode == "T" ? color(0.0) : tint',
            'scatter_mode == "T" ? color(0.0) : color(1.0)',
        ),
        ('scatter_mode == "T" ?', 'scatter_mode == "R" ?'),
        ("weight * generalized", "generalized"),  # where the index is 0
        ("schlick_bsdf(N, U, reflection", "schlick_bsdf(N, U, color(1.0)"),
        (
            "reflection, transmission, roughness.x, roughness.y, ior",
            "transmission, reflection, roughness.x, roughness.y, ior",
        ),
    ),
    RT: (('scatter_mode == "T" ?', 'scatter_mode != "R" ?'),),
    "conductor_bsdf": (
        WEIGHT,
        ("lobe_ior, lobe_extinction", "lobe_extinction, lobe_ior"),
        ("lobe_ior, lobe_extinction", "color(lobe_ior[0]), lobe_extinction"),
        ("lobe_ior, lobe_extinction", "lobe_ior, color(0.0)"),
        ("lobe_roughness.x, lobe_roughness.y", "lobe_roughness.x, lobe_roughness.x"),
    ),
    "conductor_bsdf, thin film": (
        (', "thinfilm_thickness", lobe_thinfilm_thickness, "thinfilm_ior", lobe_thinfilm_ior', ""),
        ('lobe_thinfilm_thickness, "', '0.001 * lobe_thinfilm_thickness, "'),
        ('"thinfilm_ior", lobe_thinfilm_ior', '"thinfilm_ior", 1.5'),
    ),
    "dielectric_bsdf, thin film": (
        (
            '"thinfilm_thickness", thinfilm_thickness, "thinfilm_ior", thinfilm_ior',
            '"thinfilm_thickness", thinfilm_thickness',
        ),
    ),
    "layer": (
        ("layer(top_out, base_out)", "layer(base_out, top_out)"),
        ("layer(top_out, base_out)", "(top_out + base_out)"),
        ("layer(top_out, base_out)", "mix(top_out, base_out, 0.5)"),
        ("layer(top_out, base_out)", "top_out"),
    ),
    "mix": (
        ("mix(base_out, top_out", "mix(top_out, base_out"),
        ("lobe_mix)", "lobe_mix * lobe_mix)"),
        ("mix(base_out, top_out, lobe_mix)", "((1 - lobe_mix) * base_out + top_out)"),
    ),
    "add": (
        ("top_out + base_out", "top_out + top_out"),
        ("(top_out + base_out)", "layer(top_out, base_out)"),
    ),
    "multiply, in2 float": (
        ("lobe_in2 * top_out", "top_out"),
        ("lobe_in2 * ", "lobe_in2 * lobe_in2 * "),
    ),
    "multiply, in2 color3": (
        ("lobe_in2 * top_out", "lobe_in2[0] * top_out"),
        ("lobe_in2 * ", "sqrt(lobe_in2) * "),
    ),
    "multiply, of a sum": (("lobe_in2 * sum_out", "lobe_in2 * top_out"),),
    "mix, of a sum": (("mix(top_out, sum_out", "mix(sum_out, top_out"),),
    "layer, under a mix of a sum": (("layer(mixed_out, base_out)", "layer(sum_out, base_out)"),),
    "mix, of a layer under a sum": (("layer(sum_out, base_out)", "layer(top_out, base_out)"),),
    "layer, under a colored sum": (("layer(sum_out, base_out)", "layer(base_out, sum_out)"),),
    "chiang_hair_bsdf": (
        ("roughness_R.x, roughness_TT.x", "roughness_TT.x, roughness_R.x"),
        ("tint_R, tint_TT, tint_TRT, ior", "tint_TT, tint_R, tint_TRT, ior"),
        ("roughness_TRT.y", "roughness_TT.y"),
        ("cuticle_angle, abs", "1.0 - cuticle_angle, abs"),
        ("absorption_coefficient);", "2.0 * absorption_coefficient);"),
    ),
    "uniform_edf": (("uniform_edf(emission_color)", "(1.0 / M_PI) * uniform_edf(emission_color)"),),
    "conical_edf": (
        ("dot(axis, -I)", "dot(axis, I)"),
        ("inner_angle, outer_angle) *", "outer_angle, inner_angle) *"),
    ),
    "generalized_schlick_edf": (
        ("base * f", "base"),
        ("fabs(dot(N,-I))", "fabs(dot(N,vector(0, 0, 1)))"),
    ),
    "mix, EDF": (("mix(second_out, first_out", "mix(first_out, second_out"),),
    "add, EDF": (("first_out + second_out", "first_out + first_out"),),
    "multiply, EDF, in2 color3": (("emission_in2 * first_out", "first_out"),),
    "absorption_vdf": (
        ("color(0.0), medium_absorption", "medium_absorption, color(1.0)"),
        ("medium_absorption, 0.0", "sqrt(medium_absorption), 0.0"),
    ),
    "anisotropic_vdf": (("extinction = absorption + scattering", "extinction = absorption"),),
    "mix, VDF": (("mix(second_out, first_out", "mix(first_out, second_out"),),
    "add, VDF": (("first_out + second_out", "first_out + first_out"),),
    "multiply, VDF, in2 float": (("medium_in2 * first_out", "first_out"),),
    "subsurface_bsdf": (
        ("weight * subsurface", "subsurface"),
        ("N, albedo, radius", "N, sqrt(albedo), radius"),
    ),
    "standard_surface, every lobe": (),
    "UsdPreviewSurface, every lobe": (),
    "gltf_pbr, every lobe": (),
}
AXES = {  # wrong changes that turned frames show
    EON: (("transform(geomprop_Nworld_space, N)", "N * 0 + vector(0, 0, 1)"),),
    "conductor_bsdf": (("transform(geomprop_Tworld_space, normalize(dPdu))", "vector(1, 0, 0)"),),
}


class Changed(Host):
    """The host with a change in the texts that it generates."""

    name, target, language = "osl", "osl", "osl"

    def __init__(self, host, old="", new=""):
        self._host, self._old, self._new = host, old, new

    def identity(self):
        return self._host.identity()

    def compile(self, document, element=None, **options):
        [shader] = self._host.compile(document, element, **options)
        text = shader.stages["pixel"]
        assert self._old in text, f"{self._old} is not in the text"
        return (replace(shader, stages={"pixel": text.replace(self._old, self._new)}),)

    def trees(self, shader, wo, inputs):
        return self._host.trees(shader, wo, inputs)

    def execute(self, source, function, *arguments):
        return self._host.execute(source, function, *arguments)


def probe_of(host: Host, title: str, library: str = "eonlib") -> Probe:
    probe = probe_type_of(SUBJECTS[title], ClosureProbe)
    assert probe
    counts = None if SUBJECTS[title].kind == kinds.SURFACE_SHADER else FEW
    return probe(host, SUBJECTS[title], library, counts)


def first_case(probe: Probe) -> list[Case]:
    """Values of the random pairs alone: one run of OSL."""
    return list(islice(value_cases(probe), 1))


def excess(probe: Probe, host: Host, cases=first_case, quantity="value") -> float:
    """Largest error of a probe over its tolerance; infinity where OSL refuses the text."""
    tolerance = ACCURACY[probe.kind].of(quantity)
    tolerance = widen_for_engine(tolerance, probe.subject, probe.kind, evaluated(host))
    try:
        found = list(cases(probe))
    except ShaderError:
        return np.inf
    return (
        max(float(tolerance.metric(case.measured, case.expected).max()) for case in found)
        / tolerance.value
    )


def rows(table: dict[str, tuple[tuple[str, str], ...]]) -> list[tuple[str, str, str]]:
    return [(title, *change) for title, changes in table.items() for change in changes]


@pytest.mark.parametrize("title", WRONG)
def test_the_closures_of_eonlib_are_those_of_the_equations(hosts, title):
    host = hosts("osl")
    assert excess(probe_of(host, title), host) <= 1.0


@pytest.mark.parametrize(("title", "old", "new"), rows(WRONG))
def test_a_wrong_text_is_noticed(hosts, title, old, new):
    host = hosts("osl")
    assert excess(probe_of(Changed(host, old, new), title), host) > 1.0


@pytest.mark.parametrize(("title", "old", "new"), rows(AXES))
def test_a_wrong_frame_is_noticed(hosts, title, old, new):
    host = hosts("osl")
    assert excess(probe_of(host, title), host, frame_cases, "frame") <= 1.0
    assert excess(probe_of(Changed(host, old, new), title), host, frame_cases, "frame") > 1.0


@pytest.mark.parametrize("title", ("sheen_bsdf, mode zeltner", "sheen_bsdf, mode conty_kulla"))
def test_the_repair_on_its_page_gives_a_sheen_its_mode(hosts, title):
    host = hosts("osl")
    mode = Changed(host, "lobe_roughness)", 'lobe_roughness, "mode", lobe_mode == "zeltner")')
    stock = excess(probe_of(host, title, "stock"), host)
    assert (stock > 1.0) == title.endswith("zeltner")
    assert excess(probe_of(mode, title, "stock"), host) <= 1.0


def largest_kept(probe: Probe) -> float:
    """The largest error of what a mode with transmission reflects and lets through."""
    cases = transmission_measures.kept(probe)
    return max(float(scaled(case.measured, case.expected).max()) for case in cases)


def test_mode_r_that_transmits_is_noticed(hosts):
    host = hosts("osl")
    wrong = Changed(host, 'scatter_mode == "R" ?', 'scatter_mode == "" ?')
    for judged, right in ((host, True), (wrong, False)):
        assert (excess(probe_of(judged, RT), host, transmission_measures.kept) <= 1.0) == right


def test_mode_t_of_schlicks_curve_reflects_nothing(hosts):
    host, title = hosts("osl"), "generalized_schlick_bsdf, scatter_mode T"
    assert largest_kept(probe_of(host, title)) == 0.0
    tinted = Changed(host, '"T") ? color(0.0)', '"T") ? color(0.5)')
    assert largest_kept(probe_of(tinted, title)) > 0.01


def test_every_check_of_an_artistic_index_is_run():
    run = check((), ["osl"], nodes=["artistic_ior"])
    assert {each.verdict for each in run.results} == {PASSED}


def shown(name: str) -> list[tuple[Shader, Shader]]:
    """Shaders of a bundled document for OSL, each with one for the reference."""
    file = examples_folder() / name
    return list(zip(generate(file, "osl"), generate(file, "glsl"), strict=True))


@pytest.mark.parametrize("file", EXAMPLES, ids=str)
def test_an_example_is_what_its_document_says(hosts, file):
    host = evaluated(hosts("osl"))
    wo, wi = (directions(np.random.default_rng(seed), 16) for seed in (1, 2))
    for osl, other in shown(file):
        told = np.pi * host.evaluate(osl, wo, wi, {}, "direct")
        expected = np.pi * Reference().evaluate(other, wo, wi, {}, "direct")
        error = GRAPH.metric(told, expected).max()
        assert (error <= GRAPH.value) == (osl.name not in COLOR82)
