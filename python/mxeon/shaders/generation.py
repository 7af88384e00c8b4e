# SPDX-License-Identifier: Apache-2.0
"""Shader source from a MaterialX document, for all MaterialX targets."""

import os
import re
import warnings
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, partial
from types import MappingProxyType

import MaterialX as mx
import MaterialX.PyMaterialXGenShader as mx_gen

from mxeon.errors import DocumentError, InputError, InterfaceError, NotRun, assert_known
from mxeon.io.files import AnyPath, one_name
from mxeon.shaders import path_tracing
from mxeon.shaders.closure_calls import check_closure_calls, unreplaced_token
from mxeon.shaders.document.notes import CodeWarning, warn_of_files, warn_of_names
from mxeon.shaders.document.policy import DEFAULT, Policy
from mxeon.shaders.document.reading import read_document
from mxeon.shaders.document.sources import check_sources
from mxeon.shaders.document.values import Plain, label, plain
from mxeon.shaders.generators import (
    GENERATORS,
    HARDWARE,
    TARGETS,
    context_of,
    generated,
    generator_of,
    tokens_of,
)
from mxeon.shaders.library import (
    environment_folders,
    has_profile,
    library_name,
    load_library,
    own_folders,
)
from mxeon.shaders.library_tree import root, with_user_paths
from mxeon.shaders.methods import UNCHOSEN, UNTABLED, Methods, assert_generated
from mxeon.shaders.targets import PATH_TRACED

__all__ = [
    "GENERATORS",
    "TARGETS",
    "ApproximationWarning",
    "CodeWarning",
    "Input",
    "Shader",
    "generate",
]

STAGES = ("pixel", "vertex")

CYCLES_APPROXIMATION = (
    "Cycles has no closure for qualitative Oren-Nayar; where energy_compensation is false, pairs "
    "with s < 0 are darker than the model"
)

# Matches a call whose last two arguments are `energy_compensation` and the result.
CYCLES_CALL = re.compile(r"\boren_nayar_diffuse_bsdf_cycles\([^;{]*?(\w+), *\w+\);")

# Matches calls of MaterialX's functions.
CALLED = re.compile(r"\b(mx_\w+)\s*\(")
DEFINED = re.compile(r"(?:#define|\b(?!return\b|else\b)\w+)\s+(mx_\w+)")


class ApproximationWarning(UserWarning):
    """A renderer only approximates a shader's model. The message states the difference."""

    def __init__(self, element: str, approximation: str) -> None:
        super().__init__(f"{element}: {approximation}")
        self.element = element
        self.approximation = approximation


@dataclass(frozen=True)
class Input:
    """A public input of a generated shader.

    - `name`: Name of the variable in the source.
    - `type`: MaterialX's name of the input's type.
    - `value`: The default value. A color, vector or array is a tuple of components. A matrix is a
      tuple of numbers, row by row, which GLSL interprets as columns. A structure is a tuple of the
      members' values.
    - `path`: Name path of the input's element in the document.
    """

    name: str
    type: str
    value: Plain
    path: str


@dataclass(frozen=True)
class Shader:
    """A generated shader.

    - `name`: Name of the shader, valid as an identifier and a file name, and unique within the
      document.
    - `element`: Name path of the renderable element.
    - `target`: One of TARGETS.
    - `stages`: Source text under "pixel" and, for targets with rasterization, "vertex".
    - `document`: The checked source document with its data library.
    - `folders`: Folders of the library that are loaded before MaterialX's libraries.
    - `root`: Folder whose subfolder `libraries` replaces MaterialX's libraries; "" if there is
      none.
    - `methods`: The chosen methods of the generator.
    - `table`: Pixel stage with which a client draws the table of albedos, if the method is "table".
    """

    name: str
    element: str
    target: str
    stages: Mapping[str, str] = field(repr=False)
    inputs: tuple[Input, ...] = field(repr=False)
    document: mx.Document = field(repr=False, compare=False)
    folders: tuple[str, ...] = field(default=(), repr=False)
    root: str = field(default="", repr=False)
    methods: Methods = UNCHOSEN
    table: str = field(default="", repr=False, compare=False)


def generate(
    document: AnyPath | mx.Document,
    target: str,
    element: str | None = None,
    *,
    library: AnyPath = "eonlib",
    profile: str | None = None,
    lights: bool = False,
    uniforms: bool = False,
    methods: Methods | None = None,
    policy: Policy | None = None,
    client: Collection[str] = (),
) -> tuple[Shader, ...]:
    """Shaders of a document, one for each renderable element.

    - `document`: A file, XML text, or a document; see
      `mxeon.shaders.document.reading.read_document`.
    - `target`: glsl, essl, vulkan, wgsl, msl, slang, osl or mdl.
    - `element`: Name or name path of one renderable element; None for all.
    - `library`: "eonlib", "stock" for unmodified MaterialX, or a folder; see `load_library`.
    - `profile`: "cycles" for OSL that Blender's Cycles compiles; "path" for text to include in a
      path tracer, in glsl, essl, vulkan or slang.
    - `lights`: Whether shaders of rasterized targets include MaterialX's directional light, as
      light type 1.
    - `uniforms`: Whether the profile "path" keeps inputs as uniforms instead of literals.
    - `methods`: How shaders of rasterized targets compute lighting; None for MaterialX's defaults.
    - `policy`: Permissions, limits and search path; None for `Policy()`.
    - `client`: Options from `mxeon.shaders.generators.CLIENT_OPTIONS` to turn on: a shadow map,
      ambient occlusion and transparency. Any option also adds point and spot lights, as types 2 and 3.

    Raises ValueError if the target, the library, the profile or the element is unknown; DocumentError
    if no shader can be generated from the document; InterfaceError if MaterialX calls closures with
    other arguments than eonlib's sources define.

    Warns ApproximationWarning if the profile cannot express one of the document's models;
    CodeWarning if the document contains its own shader code, which the policy must permit;
    MissingFileWarning if a shader names a file that does not exist (the shader keeps the name);
    DocumentWarning if MaterialX misreads a part of the document or gives a node the values of
    another node.

        >>> text = '''<materialx version="1.39">
        ...   <eon_diffuse_bsdf name="clay" type="BSDF"/>
        ...   <surface name="shading" type="surfaceshader">
        ...     <input name="bsdf" type="BSDF" nodename="clay"/>
        ...   </surface>
        ...   <surfacematerial name="look" type="material">
        ...     <input name="surfaceshader" type="surfaceshader" nodename="shading"/>
        ...   </surfacematerial>
        ... </materialx>'''
        >>> [shader.name for shader in generate(text, "osl")]
        ['look']
    """
    policy, library = policy or DEFAULT, one_name("library", library)
    methods = methods or UNCHOSEN
    assert_known("target", target, TARGETS)
    if os.path.isdir(library) and root(library):
        check_generator(library, target)
    if methods != UNCHOSEN and (target not in HARDWARE or profile):
        raise InputError(f"{target}: only rasterized targets have methods; got {methods}")
    if methods.searched and not environment_folders(library):
        raise NotRun(f"library {library}: has no genglsl/environment to search")
    if profile == "path":
        assert_known("target of the profile path", target, PATH_TRACED)
        if not has_profile(library_name(library), profile):
            raise InputError(
                f"library {library}: must have genglsl/path for the profile path; use --library eonlib"
            )
    checked = read_document(document, library, profile, policy)
    content, names = checked.content, shader_names(checked.renderables)
    generator = generator_of(content, target, library, profile, policy.definitions)
    context = context_of(
        content, target, generator, library, lights, policy.path, profile, uniforms, methods, client
    )
    table = ""
    if methods.albedo == "table":
        table = _table_text(target, generator, library, methods)
    elements: Sequence[mx.TypedElement] = checked.renderables
    if element is not None:
        paths = [each.getNamePath() for each in elements]
        elements = [each for each in elements if element in (each.getName(), each.getNamePath())]
        if not elements:
            assert_known("element", element, paths)
    tokens = partial(tokens_of, target, library, profile)
    searched = map(str, environment_folders(library) if methods.searched else ())
    folders = (*policy.definitions, *own_folders(library), *searched)
    shaders = []
    check_sources(content, context, policy, tokens, len(elements), checked.nodes)
    for each in elements:
        path = each.getNamePath()
        try:
            source = generated(generator, names[path], each, context)
        except (mx.Exception, LookupError) as error:
            reason = with_user_paths(library, str(error).strip().splitlines()[0])
            if "nodedef" in reason:
                reason += ": load further definitions by --definitions FOLDER"
            raise DocumentError(
                f'{label(content)}: element "{path}" must generate {target}; {reason}'
            ) from None
        check_closure_calls(source.getStage("pixel"), target, library, profile)
        stages = MappingProxyType(
            {stage: source.getSourceCode(stage) for stage in STAGES if source.hasStage(stage)}
        )
        if methods != UNCHOSEN:
            assert_generated(stages["pixel"], methods)
        if token := unreplaced_token("\n".join(stages.values())):
            raise InterfaceError(
                f"{target}: the generator of MaterialX {mx.getVersionString()} does not replace "
                f"{token} in the library's sources; use a library for this version"
            )
        inputs, name = _inputs(source, content), source.getName()
        if profile == "path":
            stages = MappingProxyType(
                {"pixel": path_tracing.path_text(stages["pixel"], target, each, library)}
            )
        whole = root(library)
        shaders.append(
            Shader(name, path, target, stages, inputs, content, folders, whole, methods, table)
        )
    files = [
        (port.path, str(port.value))
        for shader in shaders
        for port in shader.inputs
        if port.type == "filename" and port.value
    ]
    warn_of_files(files, content)
    warn_of_names(elements, content)
    if profile == "cycles" and target == "osl":
        for shader in shaders:
            values = {port.name: port.value for port in shader.inputs}
            flags = CYCLES_CALL.findall(shader.stages["pixel"])
            if not all(values.get(flag, flag == "1") for flag in flags):
                note = ApproximationWarning(shader.element, CYCLES_APPROXIMATION)
                warnings.warn(note, stacklevel=2)
    return tuple(shaders)


def _table_text(
    target: str, generator: mx_gen.ShaderGenerator, library: str, methods: Methods
) -> str:
    """Text of a pixel stage that computes a library's table of albedos by Monte Carlo sampling."""
    document = mx.createDocument()
    output = document.addOutput("table", "color3")
    output.setConnectedNode(document.addNode("constant", "color", "color3"))
    document.setDataLibrary(load_library(library))
    sampled = replace(methods, albedo="monteCarlo")
    context = context_of(document, target, generator, library, False, (), methods=sampled)
    context.getOptions().hwWriteAlbedoTable = True
    text = generated(generator, "table", output, context).getSourceCode("pixel")
    defect, reason, page = UNTABLED.get(target, (None, "", ""))
    if defect and defect in text:
        raise NotRun(
            f"albedo table: MaterialX's shader for {target} {reason}; see docs/upstream/{page}.md"
        )
    return str(text)


@cache
def check_generator(library: str, target: str) -> None:
    """Raise InterfaceError unless a generator can use a library that replaces MaterialX's own."""
    document = mx.createDocument()
    document.setDataLibrary(load_library(library))
    surface = document.addNode("surface", "surface", "surfaceshader")
    lobe = document.addNode("oren_nayar_diffuse_bsdf", "lobe", "BSDF")
    surface.addInput("bsdf", "BSDF").setConnectedNode(lobe)
    generator = generator_of(document, target, library, None)
    try:
        context = context_of(document, target, generator, library, True, ())
        shader = generated(generator, "surface", surface, context)
        stages = () if target in ("osl", "mdl") else filter(shader.hasStage, STAGES)
        text = "\n".join(map(shader.getSourceCode, stages))
        missing = {*CALLED.findall(text)} - {*DEFINED.findall(text)}
        reason = f"it has no {min(missing)}, which {target} calls" if missing else ""
        if token := unreplaced_token(text):
            reason = f"{target} does not replace its {token}"
    except (mx.Exception, LookupError) as error:
        reason = with_user_paths(library, str(error).strip().splitlines()[0])
    if reason:
        raise InterfaceError(
            f"library {library}: cannot be combined with the generator of MaterialX "
            f"{mx.getVersionString()}; {reason}: pass the right MaterialX build with --materialx"
        )


def _inputs(shader: mx_gen.Shader, document: mx.Document) -> tuple[Input, ...]:
    """Inputs of a shader. An input that the document lacks has the variable's name as its path."""
    stage = shader.getStage("pixel")
    blocks = stage.getUniformBlocks() | stage.getInputBlocks()  # MDL declares uniforms as inputs
    return tuple(
        Input(port.getVariable(), kind.getName(), plain(port.getValue(), document), path)
        for name, block in blocks.items()
        if name != "PrivateUniforms"
        for port in block
        if (path := port.getPath() or (name == "PublicUniforms" and port.getVariable()))
        and not (kind := port.getType()).isClosure()
    )


# Words that OSL or MDL does not accept as the name of a shader.
RESERVED = frozenset(
    """
    and auto bool break bsdf bsdf_measurement case cast char class closure color const continue
    default delete displacement do double edf else emit enum export extern false float float2
    float3 float4 for friend goto hair_bsdf if illuminance illuminate import in inline int int2
    int3 int4 intensity_mode let light_profile long material matrix mdl module mutable new normal
    not operator or output package point private protected public return shader short signed
    sizeof static string struct surface switch template texture_2d this throw true try typedef
    typename uniform union unsigned using varying vdf vector virtual void volatile volume while
    """.split()  # noqa: SIM905
)


def shader_names(elements: Iterable[mx.TypedElement]) -> dict[str, str]:
    """Distinct names of the shaders of renderable elements, keyed by the elements' name paths."""
    names: dict[str, str] = {}
    last: dict[str, str] = {}  # last name used for each stem
    used: set[str] = set()
    for element in elements:
        stem = re.sub(r"\W", "_", element.getNamePath(), flags=re.ASCII)
        if stem[0].isdigit() or stem in RESERVED:
            stem = f"shader_{stem}"
        name = last.get(stem, stem)
        while name in used:
            name = mx.incrementName(name)
        names[element.getNamePath()] = last[stem] = name
        used.add(name)
    return names
