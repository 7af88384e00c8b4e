# SPDX-License-Identifier: Apache-2.0
"""Shader source from a MaterialX document: `generate`, for every target MaterialX has."""

import re
import warnings
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import lru_cache
from importlib import import_module
from types import MappingProxyType

import MaterialX as mx
import MaterialX.PyMaterialXGenShader as mx_gen

from mxeon.errors import DocumentError, InputError
from mxeon.shaders.document.graph_size import check_expansion
from mxeon.shaders.document.notes import warn_of_files
from mxeon.shaders.document.policy import DEFAULT
from mxeon.shaders.document.reading import label, read_document
from mxeon.shaders.document.references import foreign_code
from mxeon.shaders.document.values import plain
from mxeon.shaders.library import check_closure_calls, load_library
from mxeon.shaders.targets import CLASSES

GENERATORS = {}
for _target, (_module, _name) in CLASSES.items():
    with suppress(ModuleNotFoundError, AttributeError):
        GENERATORS[_target] = getattr(import_module(f"MaterialX.PyMaterialX{_module}"), _name)
TARGETS = tuple(GENERATORS)
STAGES = ("pixel", "vertex")

# What OSL or MDL does not take as the name of a shader.
RESERVED = frozenset(
    [
        "and",
        "auto",
        "bool",
        "break",
        "bsdf",
        "bsdf_measurement",
        "case",
        "cast",
        "char",
        "class",
        "closure",
        "color",
        "const",
        "continue",
        "default",
        "delete",
        "displacement",
        "do",
        "double",
        "edf",
        "else",
        "emit",
        "enum",
        "export",
        "extern",
        "false",
        "float",
        "float2",
        "float3",
        "float4",
        "for",
        "friend",
        "goto",
        "hair_bsdf",
        "if",
        "illuminance",
        "illuminate",
        "import",
        "in",
        "inline",
        "int",
        "int2",
        "int3",
        "int4",
        "intensity_mode",
        "let",
        "light_profile",
        "long",
        "material",
        "matrix",
        "mdl",
        "module",
        "mutable",
        "new",
        "normal",
        "not",
        "operator",
        "or",
        "output",
        "package",
        "point",
        "private",
        "protected",
        "public",
        "return",
        "shader",
        "short",
        "signed",
        "sizeof",
        "static",
        "string",
        "struct",
        "surface",
        "switch",
        "template",
        "texture_2d",
        "this",
        "throw",
        "true",
        "try",
        "typedef",
        "typename",
        "uniform",
        "union",
        "unsigned",
        "using",
        "varying",
        "vdf",
        "vector",
        "virtual",
        "void",
        "volatile",
        "volume",
        "while",
    ]
)

CYCLES_APPROXIMATION = (
    "Cycles has no closure for qualitative Oren-Nayar; where energy_compensation is false, pairs "
    "with s < 0 are darker than the model"
)

# Calls of the Cycles profile's closure, whose last two arguments are the flag and the result.
CYCLES_CALL = re.compile(r"\boren_nayar_diffuse_bsdf_cycles\([^;{]*?(\w+), *\w+\);")


class ApproximationWarning(UserWarning):
    """A shader that has to use the nearest thing its renderer offers.

    Attributes
    ----------
    element : str
        Name path of the renderable element.
    approximation : str
        What is used in place of what.
    """

    def __init__(self, element, approximation):
        super().__init__(f"{element}: {approximation}")
        self.element = element
        self.approximation = approximation


class CodeWarning(UserWarning):
    """Shaders that hold code which their document brings along."""


@dataclass(frozen=True)
class Input:
    """A public input of a generated shader.

    Attributes
    ----------
    name : str
        The variable in the source.
    type : str
        MaterialX type word.
    value : float, int, bool, str, tuple or None
        The default, as `mxeon.values.plain` has it: a matrix is the flat tuple of its numbers, row
        after row, which GLSL takes as the columns of its own; a structure the tuple of its members.
    path : str
        The element of the document that it comes from.
    """

    name: str
    type: str
    value: object
    path: str


@dataclass(frozen=True)
class Shader:
    """Generated source.

    Attributes
    ----------
    name : str
        Valid as an identifier and a file name; unique within the document.
    element : str
        Name path of the renderable element.
    target : str
        One of TARGETS.
    stages : mapping of str to str
        Source text under "pixel" and, for targets with rasterisation, "vertex".
    inputs : tuple of Input
    document : MaterialX.Document
        What it was generated from, with its data library.
    """

    name: str
    element: str
    target: str
    stages: Mapping[str, str]
    inputs: tuple[Input, ...]
    document: mx.Document = field(repr=False, compare=False)


def generate(
    document,
    target,
    element=None,
    *,
    library="eonlib",
    profile=None,
    lights=False,
    policy=DEFAULT,
):
    """The shaders of a document, one for each renderable element.

    Parameters
    ----------
    document : path-like, str or MaterialX.Document
        A file, XML text, or a document; see `mxeon.shaders.document.read_document`.
    target : str
        glsl, essl, vulkan, wgsl, msl, slang, osl or mdl.
    element : str or None
        Name or name path of one renderable element; None for all.
    library : str
        "eonlib", "stock" for MaterialX as it comes, or a folder; see `load_library`.
    profile : str or None
        "cycles" makes osl for Blender's Cycles.
    lights : bool
        Whether a shader of a rasterised target gets MaterialX's directional light, as light type 1.
    policy : Policy
        What the document may do, and how large it may be.

    Returns
    -------
    tuple of Shader

    Raises
    ------
    ValueError
        If the target, the library, the profile or the element is unknown; lists the known ones.
    DocumentError
        If no shader can be made from the document.
    InterfaceError
        If this MaterialX calls closures in another way than eonlib's sources define them.

    Warns
    -----
    ApproximationWarning
        If the profile cannot express a model that the document asks for.
    CodeWarning
        If the document brings shader code of its own, which has to be permitted.
    MissingFileWarning
        If a file that a shader names is not there; the name stays as it is.
    DocumentWarning
        As `mxeon.shaders.document.read_document` does.

    Examples
    --------
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
    if target not in GENERATORS:
        raise InputError(f"target must be one of {', '.join(TARGETS)}; got {target!r}")
    document = read_document(document, library, profile, policy)
    found = renderable(document)
    chosen = _chosen(found, element)
    check_expansion(document, chosen, policy, label(document))
    names = _names(found)
    generator = _generator(document, target, library, profile)
    context = _context(document, target, generator, lights, policy.path)
    shaders = tuple(
        _generate(document, each, names[each.getNamePath()], target, generator, context)
        for each in chosen
    )
    _warn_of_code(document)
    warn_of_files(shaders, document)
    if profile == "cycles" and target == "osl":
        _warn_of_approximation(shaders)
    return shaders


def renderable(document, element=None):
    """The renderable elements of a document, or the one that is called `element`.

    Raises
    ------
    DocumentError
        If there is none.
    ValueError
        If there is none of that name or name path; lists the known ones.
    """
    found = mx_gen.findRenderableElements(document)
    if not found:
        raise DocumentError(
            f"{label(document)}: must contain a renderable element (a surfacematerial, a surface "
            "shader or an output of one); there is none"
        )
    return _chosen(found, element)


def _chosen(found, element):
    """Those of the renderable elements that are called `element`; None for all."""
    if element is None:
        return found
    chosen = [each for each in found if element in (each.getName(), each.getNamePath())]
    if not chosen:
        known = ", ".join(each.getNamePath() for each in found)
        raise InputError(f"element must be one of {known}; got {element!r}")
    return chosen


def _generator(document, target, library, profile):
    """A generator that knows a document's types; the same for all that have none of their own."""
    if not any(each.isA(mx.TypeDef) for each in document.getChildren()):
        return _library_generator(target, library, profile)
    generator = _new_generator(target, library, profile)
    generator.registerTypeDefs(document)
    return generator


def _new_generator(target, library, profile):
    """A generator with the types, the colour system and the unit system of a data library."""
    data, generator = load_library(library, profile), GENERATORS[target].create()
    generator.registerTypeDefs(data)
    colors = mx_gen.DefaultColorManagementSystem.create(generator.getTarget())
    colors.loadLibrary(data)
    generator.setColorManagementSystem(colors)
    units = mx_gen.UnitSystem.create(generator.getTarget())
    converters = mx.UnitConverterRegistry.create()
    for name in ("distance", "angle"):
        definition = data.getUnitTypeDef(name)
        converters.addUnitConverter(definition, mx.LinearUnitConverter.create(definition))
    units.loadLibrary(data)
    units.setUnitConverterRegistry(converters)
    generator.setUnitSystem(units)
    return generator


_library_generator = lru_cache(maxsize=None)(_new_generator)


def _context(document, target, generator, lights, path):
    """A context for one document: it remembers implementations by name."""
    context = mx_gen.GenContext(generator)
    context.registerSourceCodeSearchPath(mx.getDefaultDataSearchPath())
    for folder in path:
        context.registerSourceCodeSearchPath(mx.FilePath(folder))
    context.getOptions().targetDistanceUnit = "meter"
    # MaterialX has v = 0 at the bottom of an image, OSL's texture() at the top.
    context.getOptions().fileTextureVerticalFlip = target == "osl"
    if lights and isinstance(generator, mx_gen.HwShaderGenerator):
        light = document.getNodeDef("ND_directional_light")
        mx_gen.HwShaderGenerator.bindLightShader(light, 1, context)
    return context


def _names(elements):
    """Names for shaders by name path: identifiers in every language, no two alike."""
    names, taken, last = {}, set(), {}
    for element in elements:
        stem = re.sub(r"\W", "_", element.getNamePath(), flags=re.ASCII)
        if stem[0].isdigit() or stem in RESERVED:
            stem = f"shader_{stem}"
        name = last.get(stem, stem)  # all before it are taken
        while name in taken:
            name = mx.incrementName(name)
        names[element.getNamePath()] = last[stem] = name
        taken.add(name)
    return names


def _generate(document, element, name, target, generator, context):
    path = element.getNamePath()
    try:
        shader = generator.generate(name, element, context)
    except (mx.Exception, LookupError) as error:
        reason = str(error).strip().splitlines()[0]
        raise DocumentError(
            f'{label(document)}: element "{path}" must give {target}; {reason}'
        ) from None
    stages = {stage: shader.getSourceCode(stage) for stage in STAGES if shader.hasStage(stage)}
    check_closure_calls(stages["pixel"], target)
    return Shader(name, path, target, MappingProxyType(stages), _inputs(shader, document), document)


def _inputs(shader, document):
    stage = shader.getStage("pixel")
    blocks = stage.getUniformBlocks() | stage.getInputBlocks()  # MDL has them as inputs
    return tuple(
        Input(port.getVariable(), kind.getName(), plain(port.getValue(), document), path)
        for name, block in blocks.items()
        if name != "PrivateUniforms"
        for port in block
        if (path := port.getPath()) and not (kind := port.getType()).isClosure()
    )


def _warn_of_code(document):
    names = ", ".join(each.getName() for each in foreign_code(document))
    if names:
        warnings.warn(
            CodeWarning(f"{label(document)}: brings code of its own: {names}"), stacklevel=3
        )


def _warn_of_approximation(shaders):
    for shader in shaders:
        values = {each.name: each.value for each in shader.inputs}
        flags = CYCLES_CALL.findall(shader.stages["pixel"])
        if not all(values.get(flag, flag == "1") for flag in flags):
            warnings.warn(ApproximationWarning(shader.element, CYCLES_APPROXIMATION), stacklevel=3)
