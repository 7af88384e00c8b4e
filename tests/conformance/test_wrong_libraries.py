# SPDX-License-Identifier: Apache-2.0
"""A fault in a copy of a library fails the intended check, and the diagnosis names the fault."""

import pytest

from mxeon import check
from mxeon.cli.answer import answer
from mxeon.conformance.run import texts_not_run
from mxeon.conformance.run.plan import make_plan
from mxeon.shaders.library import read_library
from mxeon.shaders.methods import Methods
from mxeon.shaders.nodes import EON, INVERSIONS
from mxeon.shaders.released_graphs import installed
from tests.support.plans import keep, keep_checks
from tests.support.verdicts import (
    DIFFERS,
    EVERY_NODE,
    FAILED,
    NOT_RUN,
    PASSED,
    SHADER_FUNCTIONS,
    has,
    said,
)
from tests.support.wrong_libraries import (
    copy_of_eonlib,
    copy_of_stock,
    place_of,
    replace_text,
    wrong_stock,
)

ON = "oren_nayar_diffuse_bsdf, energy_compensation true"
MDL = "libraries/diffuse/eonlib_genmdl_impl.mtlx"
DEFINITIONS, GRAPHS = "libraries/diffuse/eonlib_defs.mtlx", "libraries/diffuse/eonlib_ng.mtlx"
FLAG = "{{energy_compensation}}"


@pytest.fixture
def copy(tmp_path):
    """Function that replaces code in a copy of eonlib and returns the copy's path."""
    library = copy_of_eonlib(tmp_path)

    def edited(file="", old="", new=""):
        if file:
            replace_text(tmp_path, old, new, file)
        return str(library)

    return edited


def failed(results):
    """Diagnoses of all failed results, by check."""
    return {each.check: said(each) for each in results if each.verdict == FAILED}


# --- definitions --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "old, new, words",
    [
        ('roughness" type="float" value="0.0"', 'roughness" type="float" value="0.3"',
         "the default of roughness of ND_oren_nayar_diffuse_bsdf is 0.3 instead of 0"),
        ('boolean" value="false"', 'boolean" value="true"',
         "the default of energy_compensation of ND_oren_nayar_diffuse_bsdf is true instead of false"),
        ('value="0.0" uimin="0.0" uimax="1.0"', 'value="0.0" uimin="0.0" uimax="2.0"',
         "uimax of roughness of ND_oren_nayar_diffuse_bsdf is 2 instead of 1"),
        ('<input name="roughness"', '<input name="sigma"', "roughness of ND_oren_nayar_diffuse_bsdf is missing"),
        ('<nodedef name="ND_eon_diffuse_bsdf"', '<nodedef name="ND_eon_diffuse_bsdf" version="2.0"', "version of ND_eon_diffuse_bsdf is 2.0"),
    ],
)  # fmt: skip
def test_a_wrong_definition_is_named(judged, copy, old, new, words):
    found = judged("release", EVERY_NODE, library=copy(DEFINITIONS, old, new))
    assert found.verdict == FAILED and words in said(found)


@pytest.mark.parametrize(
    "title, check, old, new, verdict",
    [
        ("dielectric_bsdf, scatter_mode R", "sky", 'defaultgeomprop="Tworld"', 'defaultgeomprop="Bworld"', FAILED),
        ("standard_surface, every lobe", "lobes", '"thinfilm_thickness" type="float" value="0"',
         '"thinfilm_thickness" type="float" value="300"', FAILED),
        ("dielectric_bsdf, scatter_mode R", "value", 'defaultgeomprop="Tworld"', 'defaultgeomprop="Tobject"', NOT_RUN),
    ],
)  # fmt: skip
def test_a_wrong_default_fails_or_is_not_run(judged, tmp_path, title, check, old, new, verdict):
    library = wrong_stock(tmp_path, "pbrlib/pbrlib_defs.mtlx", (old, new))
    result = judged(check, title, library=library)
    assert result.verdict == verdict
    assert verdict == FAILED or "Tobject" in result.reason


def test_an_implementation_with_the_function_of_another_node_fails_on_its_target_alone(
    judged, copy
):
    row = (
        '<implementation name="IM_burley_diffuse_bsdf_genmsl" nodedef="ND_burley_diffuse_bsdf" '
        'file="../../genglsl/translucent_bsdf.glsl" function="translucent_bsdf" target="genmsl" />'
    )
    file, end = "libraries/pbrlib/eonlib_pbrlib_genglsl_impl.mtlx", "</materialx>"
    library = copy(file, end, f"{row}{end}")
    assert judged("value", "translucent_bsdf", library=library).verdict == PASSED
    found = judged.texts("source", library)
    [wrong] = (each for each in found.values() if each.verdict != PASSED)
    assert (wrong.subject, wrong.verdict) == ("burley_diffuse_bsdf, msl", FAILED)
    assert "translucent_bsdf" in said(wrong)


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
        ("28.0", "27.0", "multiscatter_tint is not that of EON, rho^2 <E> / (1 - rho (1 - <E>)): error up to"),
        (FLAG + " ?", "false ?", "rho^2 <E> / (1 - rho (1 - <E>)), but 0: error up to"),
        ("roughness: {{roughness}}", "roughness: 0.5", "roughness is not the node's roughness, but 0.5"),
        ("df::diffuse_reflection_bsdf", "df::difuse_reflection_bsdf",
         "function df::difuse_reflection_bsdf is unknown; known are color, float3, "),
        ("normal: {{normal}}", "normal: {{color}}", "normal is not the node's normal: error up to"),
        ("weight: {{weight}}", "weight: 1.0", "weight is not the node's weight, but 1: error up to"),
        ("tint: {{color}}", "tint: {{roughness}}", "color is not the node's color: error up to"),
        ("roughness: {{roughness}}", "roughness: {{color}}", "roughness is a float but receives a color"),
        (", normal: {{normal}}", "", "normal is not passed"),
    ],
)  # fmt: skip
def test_a_wrong_closure_is_told_by_its_argument(judged, copy, old, new, words):
    results = judged.texts("closure", copy(MDL, old, new)).values()
    [wrong] = [each for each in results if each.verdict == FAILED and each.subject.startswith(ON)]
    assert wrong.subject == f"{ON}, mdl" and words in said(wrong)


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
         {"samples": "ltc_ma has an error of", "densities": "also wrong because of it: ltc_density, ltc_pdf, cltc_pdf"}),
        ("eon_sampling", "return mu_i * parts", "return parts", {"densities": "eon_pdf has an error of"}),
        ("eon_sampling", "* (1.0 / upper)", "* upper", {"samples": "eon_draw has an error of"}),
        ("oren_nayar_family", "0.0571085289", "0.0571656374",
         {"twins": "fon_loss_approx has an error of", "parts": "fon_loss_approx has an error of"}),
        ("eon", "EON_P0 0.318309971", "EON_P0 0.318628281",
         {"twins": "fon_loss has an error of", "loss": "fon_loss has an error of",
          "densities": "fon_loss has an error of", "samples": "fon_loss has an error of"}),
        ("eon_sampling", "float eon_pdf(", "float eon_density(",
         {"densities": "eon_pdf is not defined as in eonlib"}),
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
    "node, old, new, cause",
    [
        (INVERSIONS[0], "0.2877934092108062", "0.2880812026", f"the equations of {INVERSIONS[0]}"),
        (INVERSIONS[1], "0.07248821245692394", "0.0725607007", f"the equations of {INVERSIONS[1]}"),
        (INVERSIONS[1], "invert", "absval", "not finite"),
    ],
)
def test_a_wrong_inversion_node_fails(judged, copy, node, old, new, cause):
    result = judged("output", node, library=copy(GRAPHS, old, new))
    assert result.verdict == FAILED and has(result, cause)


def test_a_definition_that_the_documents_do_not_fit_is_named_before_they_are_refused(
    copy, monkeypatch
):
    keep_checks(monkeypatch, "release", "value")
    old = 'energy_compensation" type="boolean"'
    library = copy(DEFINITIONS, old, old.replace("tion", "ton"))
    wrong = [row for row in check(None, ["gl"], [library]).results if row.verdict == FAILED]
    assert wrong[0].check == "release"
    assert "energy_compensation of ND_oren_nayar_diffuse_bsdf is missing" in said(wrong[0])
    assert any(has(row, "own_document_refused") for row in wrong[1:])


# --- MaterialX's libraries against the release ----------------------------------------------------

BXDF, STDLIB, LIB = "bxdf", "stdlib/genglsl", "pbrlib/genglsl/lib/"
SWITCH = '<input name="{}" type="color3" nodename="artistic_ior" output="ior" />\n      <input name="{}" type="color3" nodename="convert_ior" />'
COAT = '<input name="in" type="float" interfacename="{}" />\n    </invert>\n    <convert name="coat_roughness_vector"'
UV = '<output name="r" type="float" nodename="image_bias_separate" output="{}" />\n    <output name="g" type="float" nodename="image_bias_separate" output="{}" />'
TOP = '<input name="top" type="BSDF" nodename="coat_{}" />'
HALVED = (
    TOP.format("half")
    + '\n<input name="base" type="BSDF" nodename="metallic_mix" /></layer><multiply name="coat_half" type="BSDF"><input name="in1" type="BSDF" nodename="coat_bsdf" /><input name="in2" type="float" value="{}" /></multiply><layer name="unused" type="BSDF">'
)
# Changes of MaterialX: the file, the original code, and the replacement. The diagnosis must contain
# the other fields: the node, a part of the node, the wrong value, the released value.
CHANGED = {
    "mode of LamaConductor": (f"{BXDF}/lama/lama_conductor.mtlx", SWITCH.format("in1", "in2"), SWITCH.format("in2", "in1"), "LamaConductor", "in1 of eta_switch", "convert_ior"),
    "coat of Disney": (f"{BXDF}/disney_principled.mtlx", COAT.format("clearcoatGloss"), COAT.format("clearcoat"), "disney_principled", "in of coat_roughness", "the input clearcoat", "the input clearcoatGloss"),
    "halved lobe": (f"{BXDF}/disney_principled.mtlx", TOP.format("bsdf"), HALVED.format("0.5"), "disney_principled", "top of coat_layer"),
    "translation": (f"{BXDF}/translation/standard_surface_to_gltf_pbr.mtlx", '"in1" type="float" interfacename="sheen_roughness"', '"in1" type="float" interfacename="sheen"', "standard_surface_to_gltf_pbr", "in1 of sheen_roughness"),
    "channels": (f"{BXDF}/usd_preview_surface.mtlx", UV.format("outr", "outg"), UV.format("outg", "outr"), "UsdUVTexture", "output r of IMP_UsdUVTexture_22"),
    "opacity of LamaSurface": (f"{BXDF}/lama/lama_surface.mtlx", 'interfacename="presence"', 'value="0.9"', "LamaSurface", "opacity of front"),
    "place of an image": (f"{STDLIB}/lib/mx_transform_uv.glsl", "uv * uv_scale", "uv * 0.5 * uv_scale", "image"),
    "default": ("pbrlib/pbrlib_defs.mtlx", "0.183, 0.421, 1.373", "0.193, 0.421, 1.373", "the default of ior of ND_conductor_bsdf", "0.193, 0.421, 1.373", "0.183, 0.421, 1.373"),
    "unit": ("stdlib/stdlib_defs.mtlx", '"centimeter" scale="0.01"', '"centimeter" scale="0.1"', "scale of unit centimeter", "0.1", "0.01"),
    "color space": ("cmlib/cmlib_ng.mtlx", "1.705050992658, -0.130256417507", "1.705050992658, 0.130256417507", "acescg_to_lin_rec709", "value of mat"),
    "pattern": (f"{STDLIB}/mx_smoothstep_float.glsl", "smoothstep(low, high, val)", "smoothstep(low, high, val * val)", "smoothstep"),
    "shared text": (f"{STDLIB}/lib/mx_noise.glsl", "6.0 - 15.0) + 10.0", "6.0 - 15.0) + 10.1", "noise2d"),
    "alpha": (f"{STDLIB}/mx_surface_unlit.glsl", "transmission * transmission_color", "vec3(transmission)", "surface_unlit"),
    "emission": (f"{STDLIB}/mx_surface_unlit.glsl", "emission_color * opacity", "emission_color", "surface_unlit"),
    "code": (f"{STDLIB}/stdlib_genglsl_impl.mtlx", '"{{outlow}} + ({{in}} - {{inlow}})', '"{{outlow}} + ({{in}} - {{outlow}})', "remap"),
}  # fmt: skip
SQUARED = '{} name="roughness_anisotropic_squared" type="vector2">'
HARMLESS = {
    f"{BXDF}/lama/lama_conductor.mtlx": {
        SQUARED.format("<power"): SQUARED.format("<multiply"),
        'type="float" value="2" />\n    </power>': 'type="vector2" nodename="roughness_linear" />\n    </multiply>',
    },
    f"{BXDF}/disney_principled.mtlx": {"coat_roughness_vector": "rough", TOP.format("bsdf"): HALVED.format("1.0")},
    f"{STDLIB}/mx_smoothstep_float.glsl": {"result = 1.0;": "result = 0.5 + 0.5; // the upper end"},
    "cmlib/cmlib_ng.mtlx": {'value="1.8"': 'value="1.80"'},
    "stdlib/stdlib_defs.mtlx": {'scale="0.0254"': 'scale="0.02540"'},
    "pbrlib/pbrlib_defs.mtlx": {'uimin="0.0"': 'uimin="0.00" uifolder="lobe"'},
}  # fmt: skip


@pytest.mark.whole
@pytest.mark.parametrize("name", CHANGED)
def test_what_differs_from_the_release_is_named_with_its_size(judged, tmp_path, name):
    file, old, new, *wanted = CHANGED[name]
    result = judged("release", EVERY_NODE, library=wrong_stock(tmp_path, file, (old, new)))
    assert result.verdict == FAILED and result.control.caught
    assert has(result, "release", *wanted)
    assert all(each.values[0] > 0.005 for each in result.diagnosis.causes if each.names[0])


def test_a_graph_of_two_versions_of_a_node_is_reported_once(judged, tmp_path):
    old = '<input name="mix" type="float" interfacename="metalness" />'
    new = '<input name="mix" type="float" interfacename="coat" />'
    library = wrong_stock(tmp_path, f"{BXDF}/standard_surface.mtlx", (old, new))
    result = judged("release", EVERY_NODE, library=library)
    assert [each.names[0] for each in result.diagnosis.causes] == ["standard_surface"]
    assert "1 more with the same source" in said(result)


def test_an_opaque_node_need_not_clamp_weights_outside_the_range_of_the_text(judged, tmp_path):
    """In MaterialX's pull request 3022, the throughput is 1 - weight and is not clamped."""
    text = "bsdf.throughput = vec3({});"
    for passed, verdict in (("1.0 - weight", DIFFERS), ("1.0 - weight * weight", FAILED)):
        edit = text.format("0.0"), text.format(passed)
        library = wrong_stock(tmp_path / verdict, "pbrlib/genglsl/mx_translucent_bsdf.glsl", edit)
        result = judged("throughput", "translucent_bsdf", library=library)
        assert result.verdict == verdict
        assert has(result, "weight_unlimited") == (verdict == DIFFERS)
        assert not (result.pages and verdict == DIFFERS)


@pytest.mark.parametrize("node, wrong", [("conductor_bsdf", True), ("translucent_bsdf", False)])
def test_a_requested_node_of_a_folder_is_compared_with_the_release(
    monkeypatch, tmp_path, node, wrong
):
    keep(monkeypatch, lambda task: task.check == "release")
    file, old, new, words, *values = CHANGED["default"]
    library = wrong_stock(tmp_path, file, (old, new))
    copy_of_stock(tmp_path, "pbrlib/genosl", "pbrlib/genglsl")
    run = check(None, ["gl"], library, nodes=[node], workers=0)
    [result] = run.results
    assert (result.verdict == FAILED) == wrong and result.control.caught
    assert not wrong or has(result, "release", words, *values)
    assert dict(run.unjudged) == {"osl": "no host for it ran"}
    assert dict(texts_not_run({"osl"}, {"genosl", "genglsl"})) == {"glsl": "no host for it ran"}


def test_texts_are_judged_after_the_release_was_loaded_anew(judged, tmp_path):
    """If MaterialX's release is no longer in the cache, a run loads the release again."""
    file, old, new, *wanted = CHANGED["alpha"]
    installed()
    read_library.cache_clear()
    result = judged("release", EVERY_NODE, library=wrong_stock(tmp_path, file, (old, new)))
    assert result.verdict == FAILED and has(result, "release", *wanted)


def test_what_is_written_differently_and_has_the_released_values_passes(judged, tmp_path):
    for file, texts in HARMLESS.items():
        library = wrong_stock(tmp_path, file, *texts.items())
    result = judged("release", EVERY_NODE, library=library)
    assert result.verdict == PASSED, said(result)


SHARED = ("genglsl/lib/eon.glsl", "genosl/lib/eon.osl")
ENTRY, PATHS = ("genglsl/oren_nayar_diffuse_bsdf.glsl",), ("genglsl/path/microfacets.glsl",)
LOSS = (
    "float P = EON_P0 + mu * (EON_P1 + mu * (EON_P2 + mu * (EON_P3 + mu * EON_P4)));",
    "float Q = EON_Q0 + mu * (EON_Q1 + mu * (EON_Q2 + mu * EON_Q3));",
)
SIGNATURE = """void oren_nayar_diffuse_bsdf(ClosureData closureData, float weight, vec3 color, float roughness,
                             vec3 N, bool energy_compensation, inout BSDF bsdf)"""
# Changes that leave eonlib's values unchanged: the files, the original code, the replacement.
REWRITTEN = {
    "a comment with braces": (SHARED, "// A_F of", "// void main() { } } /* A_F of"),
    "a renamed variable": (SHARED, "sigma2", "squared_sigma"),
    "more digits": (SHARED, "EON_PI 3.14159265358979", "EON_PI 3.1415926535897932385"),
    "an exponent": (SHARED, "1.0 - 0.5 * sigma2", "1.0 - 5.0e-1 * sigma2"),
    "line ends": (SHARED, "\n", "\r\n"),
    "an unused function": (SHARED, "// A_q of", "float eonlib_half(float x)\n{\n    return 0.5 * x;\n}\n\n// A_q of"),
    "exchanged statements": (SHARED, "\n    ".join(LOSS), "\n    ".join(LOSS[::-1])),
    "a named part": (SHARED, "return 1.0 / (1.0 + EON_C1 * roughness);", "float under = EON_C1 * roughness + 1.0;\n    return 1.0 / under;"),
    "another layout": (ENTRY, SIGNATURE, SIGNATURE.replace(" ", "\n\t").replace("float", "/* r */ float")),
    "a comment in the document": (("libraries/diffuse/eonlib_genglsl_impl.mtlx",), '<materialx version="1.39">', '<materialx version="1.39" ><!-- <implementation name="IM" /> -->'),
    "a whole number": ((DEFINITIONS,), 'value="0.0"', 'value="0"'),
    "a comment of the paths": (PATHS, "bool turned = distance(", "// material_pdf( { } }\n        bool turned = distance("),
    "a renamed variable of the paths": (PATHS, "returned", "sent_back"),
}  # fmt: skip


@pytest.mark.whole
@pytest.mark.parametrize("name", REWRITTEN)
def test_eonlib_written_differently_passes(judged, tmp_path, name):
    files, old, new = REWRITTEN[name]
    library = str(copy_of_eonlib(tmp_path))
    replace_text(tmp_path, old, new, *files)
    node = "dielectric_bsdf, scatter_mode R" if files == PATHS else ON
    results = [
        *judged.texts("languages", library).values(),
        *judged.all("twins", SHADER_FUNCTIONS, "gl", library),
        *(judged(key, node, library=library) for key in ("value", "states", "inputs", "sample")),
    ]
    failures = [(each.check, each.reason, said(each)) for each in results if each.verdict != PASSED]
    assert not failures


@pytest.mark.parametrize("title", ["generalized_schlick_bsdf, scatter_mode R", "conductor_bsdf"])
def test_directions_of_an_environment_by_other_points_pass(judged, tmp_path, title):
    """The R2 sequence covers the square as evenly as MaterialX's lattice does."""
    file = f"genglsl/environment/libraries/{LIB}mx_environment_fis.glsl"
    library = copy_of_eonlib(tmp_path)
    new = "fract(0.5 + float(i + 1) * vec2(0.7548776662466927, 0.5698402909980532))"
    replace_text(tmp_path, "mx_spherical_fibonacci(i, count)", new, file)
    methods = Methods("fis", searched=True)
    found = judged("environment", title, library=str(library), methods=methods)
    assert found.verdict == PASSED and found.control.caught


def test_an_older_library_and_text_that_nothing_evaluates_are_said_not_to_be_judged(
    judged, tmp_path
):
    file = "pbrlib/genglsl/mx_displacement_float.glsl"
    new = wrong_stock(tmp_path / "new", file, ("vec3(disp)", "vec3(-disp)"))
    old = wrong_stock(tmp_path / "old", "stdlib/stdlib_defs.mtlx", ("ND_flake2d", "ND_flake"))
    assert judged("release", EVERY_NODE, library=new).verdict == PASSED
    assert "genglsl of ND_displacement_float" in judged.unjudged("release", new)
    assert not judged.all("release", EVERY_NODE, "gl", old)
    assert any("definitions" in each for each in judged.unjudged("release", old))


def test_differences_of_a_newer_library_are_permitted(judged, tmp_path):
    distance = '<unittypedef name="distance" />'
    changes = (
        (distance, f'<nodedef name="ND_new" node="new" />{distance}'),
        ('scale="0.01"', 'scale="0.1"'),
    )
    library = wrong_stock(tmp_path, "stdlib/stdlib_defs.mtlx", *changes)
    result = judged("release", EVERY_NODE, library=library)
    assert result.verdict == DIFFERS and has(result, "newer", "new")


@pytest.mark.parametrize("guarded", [False, True])
def test_two_nodes_that_define_one_function_are_named(judged, copy, guarded):
    helper = "float mxeon_helper(float x)\n{\n    return x;\n}\n"
    if guarded:
        helper = f"#ifndef HELPER\n#define HELPER\n{helper}#endif\n"
    for name in ("sheen_bsdf", "translucent_bsdf"):
        library = copy(f"genglsl/{name}.glsl", f"void {name}(", f"{helper}void {name}(")
    result = judged.texts("clash", library)["every two nodes"]
    assert result.verdict == (PASSED if guarded else FAILED) and result.control.caught
    wanted = "ND_sheen_bsdf", "ND_translucent_bsdf", "mxeon_helper"
    assert guarded or has(result, "clash", *wanted)


def test_exchanged_arguments_of_a_call_in_mdl_are_named(judged, tmp_path):
    file = "pbrlib/genmdl/pbrlib_genmdl_impl.mtlx"
    old, new = "0:{{color0}}, mxp_color90:{{color90}}", "0:{{color90}}, mxp_color90:{{color0}}"
    library = wrong_stock(tmp_path, file, (old, new))
    result = judged.texts("arguments", library)["every node, mdl"]
    assert result.verdict == FAILED and result.control.caught
    assert has(result, "other_argument", "generalized_schlick_edf", "mxp_color0", "{{color90}}")


def test_a_run_says_which_texts_and_states_it_does_not_judge(monkeypatch):
    keep(monkeypatch, lambda task: task.check in ("source", "release"))
    run = check(None, ["gl"], "eonlib")
    assert run.passed and not run.sentence.startswith("All"), failed(run.results)
    unjudged = dict(run.unjudged)
    assert {"osl", "msl", "mdl"} <= unjudged.keys() and "glsl" not in unjudged
    assert any(each.startswith("not judged here: ") and "Metal" in each for each in answer(run))
    planned = dict(make_plan((), ("gl", "webgl"), ("eonlib",)).unjudged)
    assert "albedo tables on webgl" in planned and "albedo tables on gl" not in planned


# --- resources that a client binds ----------------------------------------------------------------

FRAME, STATES = ("client", "surface, a client's frame"), "states"
CLEAR, MIRROR = "dielectric_bsdf, scatter_mode T", "generalized_schlick_bsdf, scatter_mode R"


@pytest.mark.whole
@pytest.mark.parametrize(
    "part, old, new, check, title, words",
    [
        ("lights/genglsl/mx_point_light.glsl", "pow(distance + 1.0,", "pow(distance,", *FRAME, ("a point light", "three lights")),
        ("lights/genglsl/mx_spot_light.glsl", "pow(distance + 1.0, light.decay_rate + M_FLOAT_EPS)", "mx_square(distance + 1.0)", *FRAME, ("a spot light", "three lights")),
        ("lights/genglsl/mx_spot_light.glsl", "smoothstep(low, high,", "smoothstep(high, low,", *FRAME, ("a spot light", "three lights")),
        ("lights/genglsl/mx_directional_light.glsl", "-light.direction", "light.direction", *FRAME, ("a directional light", "three lights")),
        (f"{LIB}mx_shadow.glsl", "variance + mx_square(d)", "variance + d", *FRAME, ("a shadow map",)),
        (f"{LIB}mx_environment_fis.glsl", "Li * $envLightIntensity", "Li", *FRAME, ("another intensity of the environment",)),
        (f"{LIB}mx_environment_none.glsl", "irradiance(vec3 N)\n{\n    return vec3(0.0)", "irradiance(vec3 N)\n{\n    return vec3(0.01)", *FRAME,
         ("premultiplied mixes without an environment",)),
        ("stdlib/genglsl/mx_mix_surfaceshader.glsl", "mix(bg.transparency, fg.transparency, w)", "mix(fg.transparency, bg.transparency, w)", *FRAME,
         ("an opacity below 1",)),
        ("stdlib/genglsl/mx_mix_surfaceshader.glsl", "mix(bg.color, fg.color, w)", "bg.color", *FRAME, ()),
        (f"{LIB}mx_microfacet_specular.glsl", "mx_matrix_mul(transform, vec4(dir,0.0))", "mx_matrix_mul(vec4(dir,0.0), transform)", STATES, "conductor_bsdf",
         ("an environment: turned",)),
        (f"{LIB}mx_environment_fis.glsl", "radiance) * $envLightIntensity", "radiance)", STATES, CLEAR, ("an environment: dim and two-sided",)),
        (f"{LIB}mx_environment_prefilter.glsl", "Li * FG * $envLightIntensity", "Li * FG", "methods", MIRROR, ("environment prefilter",)),
        (f"{LIB}mx_microfacet_specular.glsl", "    // Return the final directional albedo.", "    AB *= 0.5;", "methods", MIRROR, ("albedo montecarlo",)),
        (f"{LIB}mx_generate_albedo_table.glsl", "mx_ggx_dir_albedo(uv.x, uv.y,", "mx_ggx_dir_albedo(uv.y, uv.x,", "methods", MIRROR, ("albedo table",)),
        (f"{LIB}mx_microfacet_specular.glsl", "vec2(NdotV, alpha)).rg", "vec2(alpha, NdotV)).rg", "methods", MIRROR, ("albedo table",)),
        (f"{LIB}mx_transmission_refract.glsl", "tint = mx_square(tint);", "", STATES, CLEAR, ("an environment: dim and two-sided",)),
    ],
)  # fmt: skip
def test_a_wrong_library_is_told_by_what_a_client_binds(
    judged, tmp_path, part, old, new, check, title, words
):
    result = judged(check, title, "gl", wrong_stock(tmp_path, part, (old, new)))
    assert result.verdict == FAILED and has(result, *words)


@pytest.mark.parametrize("library", ["eonlib", "stock"])
def test_a_frame_shows_what_a_client_binds(judged, library):
    result = judged(*FRAME, "gl", library)
    assert result.verdict == PASSED and result.control.caught
