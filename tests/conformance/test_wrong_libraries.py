# SPDX-License-Identifier: Apache-2.0
"""Copies of the library with one fault each: the check that finds it, and the words that name it."""

import pytest

from mxeon import check
from mxeon.shaders.nodes import EON, INVERSIONS
from tests.support.plans import keep_checks
from tests.support.verdicts import FAILED, NOT_RUN, PASSED, SHADER_FUNCTIONS, has, said
from tests.support.wrong_libraries import copy_of_eonlib, copy_of_stock, place_of, replace_text

ON, OFF = (f"oren_nayar_diffuse_bsdf, energy_compensation {flag}" for flag in ("true", "false"))
MDL = "libraries/diffuse/eonlib_genmdl_impl.mtlx"
DEFINITIONS, GRAPHS = "libraries/diffuse/eonlib_defs.mtlx", "libraries/diffuse/eonlib_ng.mtlx"
FLAG = "{{energy_compensation}}"


@pytest.fixture
def copy(tmp_path):
    """A function that copies the library with a text replaced wherever it stands in a file."""
    library = copy_of_eonlib(tmp_path)

    def edited(file="", old="", new=""):
        if file:
            replace_text(tmp_path, old, new, file)
        return str(library)

    return edited


def failed(results):
    """Words on each result that failed, by check."""
    return {each.check: said(each) for each in results if each.verdict == FAILED}


# --- definitions --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "old, new, words",
    [
        ('roughness" type="float" value="0.0"', 'roughness" type="float" value="0.3"',
         "default of roughness is 0.3; pbrlib says 0.0"),
        ('boolean" value="false"', 'boolean" value="true"',
         "default of energy_compensation is true; pbrlib says false"),
        ('value="0.0" uimin="0.0" uimax="1.0"', 'value="0.0" uimin="0.0" uimax="2.0"',
         "upper end of the range of roughness is 2.0; pbrlib says 1.0"),
        ('<input name="roughness"', '<input name="sigma"', "the list of inputs is weight, color, sigma, normal, energy_compensation; pbrlib says weight, color, r"),
    ],
)  # fmt: skip
def test_a_wrong_definition_is_told_from_the_specification(judged, copy, old, new, words):
    results = judged.texts("definition", copy(DEFINITIONS, old, new))
    found = results["oren_nayar_diffuse_bsdf, definition"]
    assert found.verdict == FAILED and words in said(found)


@pytest.mark.parametrize(
    "title, check, old, new, cause",
    [
        ("dielectric_bsdf, scatter_mode R", "sky", '"tangent" type="vector3" defaultgeomprop="Tworld"',
         '"tangent" type="vector3" defaultgeomprop="Bworld"', ("default of tangent of dielectric_bsdf", "Bworld", "Tworld")),
        ("standard_surface, every lobe", "lobes", '"thinfilm_thickness" type="float" value="0"',
         '"thinfilm_thickness" type="float" value="300"', ("default of thinfilm_thickness of dielectric_bsdf", "300")),
        ("dielectric_bsdf, scatter_mode R", "value", '"tangent" type="vector3" defaultgeomprop="Tworld"',
         '"tangent" type="vector3" defaultgeomprop="Tobject"', ()),
    ],
)  # fmt: skip
def test_a_wrong_default_is_the_cause_of_failures(judged, tmp_path, title, check, old, new, cause):
    file = "pbrlib/pbrlib_defs.mtlx"
    replace_text(copy_of_stock(tmp_path, file), old, new, file)
    result = judged(check, title, library=str(tmp_path))
    assert result.verdict == (FAILED if cause else NOT_RUN)
    assert has(result, *cause) and (cause or "Tobject" in result.reason)


def test_an_input_of_another_type_is_not_run_and_says_so(judged, copy):
    narrow = 'name="weight" type="float" value="1.0" uimin="0.0" uimax="1.0"'
    wide = narrow.replace("float", "color3").replace('.0"', '.0, 0.0, 0.0"')
    library = copy(DEFINITIONS, narrow, wide)
    found = judged("value", EON, "gl", library)
    assert found.verdict == NOT_RUN
    assert "input weight must have the type float" in found.reason


# --- closures -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "old, new, words",
    [
        ("28.0", "27.0", "multiscatter_tint is not that of EON, rho^2 <E> / (1 - rho (1 - <E>)): off by up to"),
        (FLAG + " ?", "false ?", "rho^2 <E> / (1 - rho (1 - <E>)), but 0: off by up to"),
        ("roughness: {{roughness}}", "roughness: 0.5", "roughness is not the node's roughness, but 0.5"),
        ("df::diffuse_reflection_bsdf", "df::difuse_reflection_bsdf",
         "function df::difuse_reflection_bsdf is unknown; known are color, float3, "),
        ("normal: {{normal}}", "normal: {{color}}", "normal is not the node's normal: off by up to"),
        ("weight: {{weight}}", "weight: 1.0", "weight is not the node's weight, but 1: off"),
        ("tint: {{color}}", "tint: {{roughness}}", "color is not the node's color: off by up to"),
        ("roughness: {{roughness}}", "roughness: {{color}}", "roughness is a float but receives a color"),
        (", normal: {{normal}}", "", "normal is not passed"),
    ],
)  # fmt: skip
def test_a_wrong_closure_is_told_by_its_argument(judged, copy, old, new, words):
    results = judged.texts("closure", copy(MDL, old, new))
    wrong = {
        each.subject: said(each)
        for each in results.values()
        if each.verdict == FAILED and each.subject.startswith(ON)
    }
    assert set(wrong) == {f"{ON}, mdl"} and words in wrong[f"{ON}, mdl"]


def test_a_closure_that_is_defined_elsewhere_is_not_run(judged, copy):
    library = copy(MDL, "df::weighted_layer", "mine::layered")
    result = judged.texts("closure", library)[f"{EON}, mdl"]
    assert result.verdict == NOT_RUN
    assert result.reason == "function mine::layered is not supported"


@pytest.mark.parametrize(
    ("old", "new", "verdict", "words"),
    [
        ("{{color}} *", "{{color}}.__class__ *", NOT_RUN, "Attribute in an expression is not supported"),
        ("28.0", "2.0 ** 9999.0", NOT_RUN, "'**' in an expression is not supported"),
        ("28.0", "9" * 20_000, NOT_RUN, "an expression must have at most 10000 characters; got"),
        ("28.0", "math::exec(28.0)", NOT_RUN, "function math::exec is not supported"),
        ("28.0", "(1 &lt; 2 ? 28.0 : 27.0)", PASSED, ""),
        ("28.0", "28.0 /* a comment */", PASSED, ""),
    ],
)  # fmt: skip
def test_the_expression_of_a_lobe_is_bounded_and_is_never_executed(
    judged, copy, old, new, verdict, words
):
    result = judged.texts("closure", copy(MDL, old, new))[f"{EON}, mdl"]
    assert result.verdict == verdict and words in (result.reason or said(result))


# --- shader functions ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    "file, old, new, words",
    [
        ("ltc_sampling", "0.303392", "0.303695",
         {"samples": "ltc_ma is off by", "densities": "with it ltc_density, ltc0_pdf, ltc_pdf"}),
        ("eon_sampling", "return mu_i * parts", "return parts", {"densities": "eon_pdf is off by"}),
        ("eon_sampling", "* (1.0 / upper)", "* upper", {"samples": "eon_draw is off by"}),
        ("oren_nayar_family", "0.0571085289", "0.0571656374",
         {"twins": "fon_loss_approx is off by", "parts": "fon_loss_approx is off by"}),
        ("eon", "EON_P0 0.318309971", "EON_P0 0.318628281",
         {"twins": "fon_loss is off by", "loss": "fon_loss is off by",
          "densities": "fon_loss is off by", "samples": "fon_loss is off by"}),
        ("eon_sampling", "float eon_pdf(", "float eon_density(",
         {"densities": "eon_pdf is not defined as eonlib has it"}),
    ],
)  # fmt: skip
def test_a_wrong_shader_function_is_named_by_its_cause(judged, copy, file, old, new, words):
    library = copy(place_of(file), old, new)
    found = failed(judged.all("twins", SHADER_FUNCTIONS, "gl", library))
    assert set(found) == set(words)
    assert all(words[key] in found[key] for key in words)


def test_shader_functions_that_do_not_compile_fail_with_the_words_of_the_compiler(judged, copy):
    library = copy("genglsl/lib/eon.glsl", "float m = 1.0 - mu;", "float m = 1.0 - nu;")
    found = failed(judged.all("twins", SHADER_FUNCTIONS, "gl", library))
    assert len(found) == 5 and all("nu" in words for words in found.values())


@pytest.mark.parametrize(
    "file, old, new, words",
    [
        ("eon", "0.33", "0.34", "qon_aq"),
        ("ltc_sampling", "0.5 + 0.5 / sqrt", "0.5 - 0.5 / sqrt", "cltc_kept_fraction"),
        ("eon", "#define EON_Q3 0.0571913429", "#define EON_Q3 0.0571913430", "EON_Q3"),
    ],
)
def test_functions_that_differ_in_osl_are_named(judged, copy, file, old, new, words):
    (result,) = judged.texts("languages", copy(place_of(file, "osl"), old, new)).values()
    assert result.verdict == FAILED and has(result, "different_in_osl", words)


# --- inversion nodes ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "node, old, new",
    [
        (INVERSIONS[0], "0.2877934092108062", "0.2880812026"),
        (INVERSIONS[1], "0.07248821245692394", "0.0725607007"),
        (INVERSIONS[1], '<invert name="dark"', '<absval name="dark"'),
    ],
)
def test_a_wrong_inversion_node_fails(judged, copy, node, old, new):
    library = copy(GRAPHS, old, new)
    if "invert" in old:
        library = copy(GRAPHS, "</invert>", "</absval>")
    result = judged("output", node, library=library)
    assert result.verdict == FAILED
    assert has(result, *(["not finite"] if "invert" in old else [f"the equations of {node}"]))


def test_a_definition_that_the_documents_do_not_fit_is_named_before_they_are_refused(
    copy, monkeypatch
):
    keep_checks(monkeypatch, "definition", "value")
    old = 'energy_compensation" type="boolean"'
    library = copy(DEFINITIONS, old, old.replace("tion", "ton"))
    wrong = [row for row in check(None, ["gl"], [library]).results if row.verdict == FAILED]
    assert wrong[0].check == "definition"
    assert "normal, energy_compensaton; pbrlib says" in said(wrong[0])
    assert any(has(row, "own_document_refused") for row in wrong[1:])
