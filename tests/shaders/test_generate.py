# SPDX-License-Identifier: Apache-2.0
"""Generated shaders of all targets have all inputs and compile with the installed compilers."""

import json
import os
import re
import shutil
import subprocess
import warnings
from dataclasses import replace
from pathlib import Path

import MaterialX as mx
import MaterialX.PyMaterialXGenGlsl as mx_glsl
import MaterialX.PyMaterialXGenShader as mx_gen
import pytest

from mxeon.conformance.specs import ABSENT, ALL
from mxeon.errors import InputError, NotRun
from mxeon.hosts.cycles.process import interpreter
from mxeon.shaders.document.reading import read_document
from mxeon.shaders.generation import TARGETS, ApproximationWarning, generate
from mxeon.shaders.generators import ERROR, without_lines
from mxeon.shaders.library import examples_folder, load_library, source_folder
from mxeon.shaders.methods import Methods
from mxeon.shaders.nodes import EON, OREN_NAYAR
from mxeon.shaders.options import unbound_members
from tests.support.availability import available, program
from tests.support.command import output
from tests.support.documents import lobe, material, surface

EXAMPLES = sorted(examples_folder().glob("*.mtlx"))
RASTERISED = ("glsl", "essl", "vulkan", "wgsl", "msl", "slang")
SOURCES = sorted((source_folder("eonlib") / "genglsl").rglob("*.glsl"))
OSL_SOURCES = sorted((source_folder("eonlib") / "genosl").rglob("*.osl"))
CONSTANT = {"const", "uniform", "struct", "in", "constant", "precision"}
VALIDATED = {"glsl": (), "essl": (), "vulkan": ("-V",)}
SURFACES = ("open_pbr_surface", "standard_surface", "gltf_pbr", "UsdPreviewSurface")
COMPILE = """
import json, sys
import bpy, _cycles
compiled = {path: _cycles.osl_compile(path, path.replace(".osl", ".oso")) for path in sys.argv[1:]}
print(json.dumps([path for path in compiled if not compiled[path]]))
"""

of_each_example = pytest.mark.parametrize("path", EXAMPLES)


def pixel(text, target, **options):
    """Source of the pixel stage of a document that has a single material."""
    [shader] = generate(text, target, **options)
    return shader.stages["pixel"]


def kept(source):
    """Variables at global scope that are not constant; in MSL, members of the context struct."""
    ignored = r"//.*|/\*[\s\S]*?\*/|^ *#.*(\\\n.*)*|struct GlobalContext\s*{"
    text = re.sub(ignored, "", source, flags=re.MULTILINE)
    while "{" in text and (bare := re.sub(r"{[^{}]*}", ";", text)) != text:
        text = bare
    declarations = (each.split("=")[0].split("[")[0].split() for each in text.split(";"))
    return {
        " ".join(words)
        for words in declarations
        if len(words) > 1 and "(" not in "".join(words) and not {*words} & CONSTANT
    }


def validate(shader, target, folder):
    """Assert that glslangValidator accepts both stages of a shader."""
    files = []
    for stage, suffix in (("pixel", "frag"), ("vertex", "vert")):
        files.append(folder / f"{shader.name}.{suffix}")
        files[-1].write_text(shader.stages[stage])
    output(program("glslangValidator"), *VALIDATED[target], *files, cwd=folder)


def every_lobe():
    """Material that adds all BSDF nodes of pbrlib and the EON node, and names of the nodes."""
    stock = load_library("stock").getNodeDefs()
    names = sorted({each.getNodeString() for each in stock if each.getAttribute("bsdf")} | {EON})
    nodes, total = "", ""
    for name in names:
        operands = f'<input name="in2" type="BSDF" nodename="{name}_lobe"/>'
        if total:
            operands += f'<input name="in1" type="BSDF" nodename="{total}"/>'
        total = "lobe" if name == names[-1] else f"{name}_sum"
        nodes += lobe(name, f"{name}_lobe") + f'<add name="{total}" type="BSDF">{operands}</add>'
    return material(nodes), names


@of_each_example
@pytest.mark.parametrize("target", sorted({*TARGETS} - {*VALIDATED}))
def test_every_example_becomes_shaders_on_every_other_target(path, target):
    for shader in generate(path, target):
        assert list(shader.stages) == ["pixel", "vertex"][: 1 + (target in RASTERISED)]
        assert all(shader.stages.values())


@pytest.mark.parametrize("category", SURFACES)
@pytest.mark.parametrize("target", TARGETS)
def test_the_surfaces_of_materialx_are_made_on_every_target(category, target):
    assert pixel(surface(category), target)


@pytest.mark.parametrize("target", VALIDATED)
def test_our_nodes_compile_together_with_every_bsdf_node_of_pbrlib(target, tmp_path):
    text, names = every_lobe()
    assert {OREN_NAYAR, EON, "burley_diffuse_bsdf", "subsurface_bsdf"} < set(names)
    [shader] = generate(text, target, lights=True)
    validate(shader, target, tmp_path)
    assert all(f"{name}_lobe_" in shader.stages["pixel"] for name in names)


def translated(source, language, folder):
    """Error output of the tools that translate a pixel stage or compile HLSL; empty on success."""
    compiler, translator = program("glslangValidator"), program("spirv-cross")
    glsl, module, text = (folder / f"pixel.{suffix}" for suffix in ("frag", "spv", language))
    glsl.write_text(source, encoding="utf-8")
    steps = [
        [compiler, "-V", "--quiet", "-o", module, glsl],
        [translator, module, f"--{language}", "--output", text],
    ]
    if language == "hlsl":
        steps[1] += ["--shader-model", "50"]
        parse = [compiler, "-D", "-V", "--quiet", "-S", "frag", "-e", "main"]
        steps.append([*parse, "-o", folder / "parsed.spv", text])
    for step in steps:
        done = subprocess.run(step, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode:
            return done.stdout + done.stderr
    return ""


@pytest.mark.whole
@pytest.mark.parametrize("language", ("hlsl", "msl"))
@pytest.mark.parametrize("spec", [spec for spec in ALL if spec not in ABSENT])
def test_every_node_and_surface_translates_from_spirv(spec, language, tmp_path):
    source = pixel(spec.within("eonlib").document(), "vulkan", lights=True)
    assert translated(source, language, tmp_path) == ""
    if spec.title == "gltf_pbr" and language == "hlsl":  # control: HLSL has no asinh
        wrong = source.replace("step(vec2(0.0), v)", "asinh(v)")
        assert wrong != source and "not supported on HLSL" in translated(wrong, language, tmp_path)


@pytest.mark.parametrize("path", SOURCES)
def test_a_source_keeps_no_state(path):
    text = path.read_text(encoding="utf-8")
    if path.stem == "head":  # only this file may keep state
        text = re.sub(r"^\w+ path_\w+;.*$", "", text, flags=re.MULTILINE)
    assert kept(text) == set() and not re.search(r"\bstatic\b", text)
    assert kept(text + "vec3 last = vec3(0.0);\nfloat value;") == {"vec3 last", "float value"}


# Patterns of wrong code, by title. Tests search the source, because some engines hide errors.
WRONG = {
    "a derivative after a return, which some pixels have taken": r"(?s)\breturn;(?:(?!\n}).)*\b(?:fwidth|dFd[xy])\(",
    "the half vector of opposite directions": r"normalize\(w[io] \+ w[io]\)",
    "a loop without a count": r"\bwhile \((?![ip] < )",
    "a header above the includes, which end up between it and its code": r"\A.*\n//(?:.*\n)*#include",
}


@pytest.mark.parametrize("wrong", WRONG.values(), ids=WRONG)
def test_no_source_has(wrong):
    texts = {path.name: path.read_text(encoding="utf-8") for path in SOURCES}
    assert [name for name, text in texts.items() if re.search(wrong, text)] == []


# Names of functions, structures, macros and global variables in source code.
NAMES = r"(?m)^(?:closure )?(?:#define |struct |\w+ (?=\w+(?:\(|;|\[|$)))(\w+)"


def test_no_name_in_a_source_is_one_that_materialx_makes_for_a_node():
    """MaterialX names the variables of a node's inputs and outputs `node_input`, `node_output`."""
    ports = {
        f"_{port.getName()}"
        for nodedef in load_library().getNodeDefs()
        for port in (*nodedef.getActiveInputs(), *nodedef.getActiveOutputs())
        # MaterialX makes no variables for inputs of the types BSDF, EDF and VDF.
        if port.getType() not in ("BSDF", "EDF", "VDF") or "out" in port.getName()
    }
    texts = [path.read_text(encoding="utf-8") for path in (*SOURCES, *OSL_SOURCES)]
    # The test must find the two forbidden names in this control.
    texts.append("vec3 thin_film_weight(float r)\n{\n}\nstruct hair_scale\n{")
    names = [name for text in texts for name in re.findall(NAMES, text)]
    found = [name for name in names if name.endswith((*ports,))]
    assert found == ["thin_film_weight", "hair_scale"]


def test_a_source_needs_each_file_of_materialx_that_it_includes():
    """MaterialX writes included files into every shader, whether functions are called or not."""
    texts = {path.name: path.read_text(encoding="utf-8") for path in SOURCES}
    unused = []
    for name, text in texts.items():
        users = (each for each in texts.values() if re.search(rf'["/]{name}"', each))
        words = {*re.findall(r"\w+", " ".join((text, *users)))}
        for file in re.findall(r'#include "(libraries/.*)"', text):
            included = (Path(mx.__file__).parent / file).read_text(encoding="utf-8")
            if words.isdisjoint(re.findall(NAMES, included)):
                unused.append((name, file))
    assert unused == []


# Patterns of code that is invalid in Metal, each with an example: structures have no constructor
# functions, and array parameters need an address space.
NOT_METAL = {
    "ThinFilmComplex(re, im)": r"\b(?!GlobalContext)({})\(",
    "void f(float a, vec3 A[4])": r"[(,]\s*(?!(?:const )?(?:thread|device|constant) )(?:const )?\w+ \w+\[\d*\]\s*[,)]",
}


@pytest.mark.parametrize("wrong, pattern", NOT_METAL.items(), ids=NOT_METAL)
def test_metal_gets_what_is_valid_there(wrong, pattern):
    source = pixel(every_lobe()[0], "msl")
    pattern = pattern.format("|".join(re.findall(r"\bstruct (\w+)", source)))
    assert re.search(pattern, source) is None
    assert re.search(pattern, source + wrong)


@of_each_example
@pytest.mark.parametrize("target", VALIDATED)
def test_every_example_compiles(path, target, tmp_path):
    for shader in generate(path, target):
        validate(shader, target, tmp_path)


@pytest.mark.parametrize("target", VALIDATED)
def test_a_wrong_shader_does_not_compile(target, tmp_path):
    [shader] = generate(material(lobe()), target)
    wrong = shader.stages | {"pixel": shader.stages["pixel"].replace("vec3 eon_brdf_mu", "vec3 x")}
    with pytest.raises(AssertionError, match="'eon_brdf_mu' : no matching overloaded function"):
        validate(replace(shader, stages=wrong), target, tmp_path)


def test_generated_osl_compiles(tmp_path):
    with available("cycles"):
        python = interpreter()
    headers = mx.getDefaultDataSearchPath().find("libraries/stdlib/genosl/include").asString()
    shutil.copytree(headers, tmp_path, dirs_exist_ok=True)
    sources = [*EXAMPLES, every_lobe()[0], *map(surface, SURFACES)]
    written = []
    for number, source in enumerate(sources):
        for profile in (None, "cycles"):
            with warnings.catch_warnings(action="ignore", category=ApproximationWarning):
                shaders = generate(source, "osl", profile=profile)
            for shader in shaders:
                written.append(tmp_path / f"{number}_{profile}_{shader.name}.osl")
                written[-1].write_text(shader.stages["pixel"])
    wrong = tmp_path / "wrong.osl"
    wrong.write_text("shader wrong() { none(); }")
    *_, refused = output(python, "-c", COMPILE, *written, wrong).splitlines()
    assert json.loads(refused) == [str(wrong)]


@pytest.mark.parametrize("flag", ["false", "true"])
def test_the_profile_warns_of_qon_alone(flag):
    text = material(lobe(energy_compensation=flag))
    with warnings.catch_warnings(record=True, action="always") as caught:
        generate(text, "osl", profile="cycles")
    assert [each.category for each in caught] == [ApproximationWarning] * (flag == "false")


@of_each_example
def test_every_example_is_valid_and_renders_all_its_materials_and_nothing_else(path):
    document = read_document(path).content
    assert document.validate() == (True, "")
    assert document.getVersionString() == "1.39"
    assert document.getColorSpace() == "lin_rec709"
    found = mx_gen.findRenderableElements(document)
    assert found and found == document.getMaterialNodes()


def test_lines_with_the_words_are_left_out_of_what_libraries_print(capfd):
    with without_lines("of no use"):
        os.write(ERROR, b"this is of no use\nthis is\n")
    assert capfd.readouterr().err == "this is\n"
    generate(material(lobe()), "wgsl")  # MaterialX prints a line about boolean inputs in WGSL
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("target", RASTERISED)
def test_the_methods_of_a_client_are_those_of_the_text(target):
    glass = material(lobe("dielectric_bsdf", scatter_mode="RT"))
    methods = Methods("prefilter", "opacity", "monteCarlo", 6, False)
    text = generate(glass, target, methods=methods)[0].stages["pixel"]
    assert "#define DIRECTIONAL_ALBEDO_METHOD 2\n" in text
    assert "#define AIRY_FRESNEL_ITERATIONS 6\n" in text
    assert "mx_latlong_alpha_to_lod(" in text
    assert re.search(r"transparency \+= \w+\.response", text)
    default = generate(glass, target)[0].stages["pixel"]
    assert "transparency +=" not in default
    assert generate(glass, target, methods=Methods("fis"))[0].stages["pixel"] == default
    searched = generate(glass, target, methods=Methods(searched=True))[0].stages["pixel"]
    assert "#define MX_REFRACTION_UNMASKED" in searched and "define MX_REF" not in default
    with pytest.raises(NotRun, match="reads .*refractionTwoSided without declaring it"):
        generate(glass, target, methods=Methods("none"))


def test_a_method_that_the_text_does_not_have_is_refused(monkeypatch):
    glass = material(lobe("dielectric_bsdf", scatter_mode="RT"))
    monkeypatch.setattr("mxeon.shaders.generators.set_options", lambda options, **chosen: None)
    for methods in (Methods("prefilter"), Methods("", "opacity"), Methods(albedo="table")):
        with pytest.raises(NotRun, match="MaterialX's generator wrote"):
            generate(glass, "glsl", methods=methods)
    with pytest.raises(InputError, match="only rasterized targets have methods"):
        generate(glass, "osl", methods=Methods("fis"))


def test_options_of_another_layout_are_refused():
    context = mx_gen.GenContext(mx_glsl.GlslShaderGenerator.create())
    unbound_members(context.getOptions(), 3)[2] = 3
    with pytest.raises(LookupError, match="keeps options without a Python binding elsewhere"):
        unbound_members(context.getOptions(), 3)
