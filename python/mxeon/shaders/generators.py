# SPDX-License-Identifier: Apache-2.0
"""MaterialX's shader generators, set up for a target, a data library and a document."""

import os
import sys
import tempfile
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, nullcontext, suppress
from functools import cache, lru_cache
from importlib import import_module

import MaterialX as mx
import MaterialX.PyMaterialXGenShader as mx_gen

from mxeon.errors import NotRun
from mxeon.shaders.library import LOADED, environment_folders, load_library
from mxeon.shaders.library_tree import search_path
from mxeon.shaders.methods import UNCHOSEN, Methods
from mxeon.shaders.options import set_options
from mxeon.shaders.targets import CLASSES

GENERATORS: dict[str, type[mx_gen.ShaderGenerator]] = {}
for _target, (_module, _name) in CLASSES.items():
    with suppress(ModuleNotFoundError, AttributeError):
        GENERATORS[_target] = getattr(import_module(f"MaterialX.PyMaterialX{_module}"), _name)
TARGETS = tuple(GENERATORS)
HARDWARE = tuple(
    target for target, each in GENERATORS.items() if issubclass(each, mx_gen.HwShaderGenerator)
)

LIGHTS = ("directional", "point", "spot")  # light types 1, 2 and 3
CLIENT_OPTIONS = ("hwShadowMap", "hwAmbientOcclusion", "hwTransparency")
BOOLEANS = "WGSL does not allow boolean types"  # MaterialX prints a warning for each boolean


def generator_of(
    document: mx.Document,
    target: str,
    library: str,
    profile: str | None,
    definitions: tuple[str, ...] = (),
) -> mx_gen.ShaderGenerator:
    """A generator with a document's types. Documents that define no types share a generator."""
    if not any(each.isA(mx.TypeDef) for each in document.getChildren()):
        return _library_generator(target, library, profile, definitions)
    generator = new_generator(load_library(library, profile, definitions), target)
    generator.registerTypeDefs(document)
    return generator


@lru_cache(maxsize=LOADED)
def _library_generator(
    target: str, library: str, profile: str | None, definitions: tuple[str, ...]
) -> mx_gen.ShaderGenerator:
    return new_generator(load_library(library, profile, definitions), target)


def new_generator(data: mx.Document, target: str) -> mx_gen.ShaderGenerator:
    """A generator with the types, color system and unit system of a data library."""
    generator = GENERATORS[target].create()
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


def context_of(
    document: mx.Document,
    target: str,
    generator: mx_gen.ShaderGenerator,
    library: str,
    lights: bool,
    path: Iterable[str],
    profile: str | None = None,
    uniforms: bool = False,
    methods: Methods = UNCHOSEN,
    client: Collection[str] = (),
) -> mx_gen.GenContext:
    """A generator's context for one document only, because contexts cache implementations by name.

    With `lights`, MaterialX's directional light is bound as light type 1 on rasterized targets.
    `client` lists options to turn on. With any of these options, `lights` also binds point and spot
    lights; see `mxeon.shaders.scene.Client`. `path` lists folders of source files, which are
    searched after the library's folders.
    """
    context = mx_gen.GenContext(generator)
    for each in environment_folders(library) if methods.searched else ():
        context.registerSourceCodeSearchPath(mx.FilePath(str(each)))
    context.registerSourceCodeSearchPath(search_path(library))
    for folder in path:
        context.registerSourceCodeSearchPath(mx.FilePath(folder))
    context.getOptions().targetDistanceUnit = "meter"
    # In MaterialX, v = 0 is the bottom of an image. In OSL's texture(), v = 0 is the top.
    context.getOptions().fileTextureVerticalFlip = target == "osl"
    if profile == "path":  # the path tracer does the lighting
        none = mx_gen.HwSpecularEnvironmentMethod.SPECULAR_ENVIRONMENT_NONE
        context.getOptions().hwSpecularEnvironmentMethod = none
        context.getOptions().hwTransparency = True
        if not uniforms:
            context.getOptions().shaderInterfaceType = (
                mx_gen.ShaderInterfaceType.SHADER_INTERFACE_REDUCED
            )
    if methods != UNCHOSEN:
        try:
            set_options(context.getOptions(), **methods.settings)  # type: ignore[arg-type]
        except LookupError as error:
            raise NotRun(str(error)) from None
    if lights and isinstance(generator, mx_gen.HwShaderGenerator):
        for number, name in enumerate(LIGHTS if client else LIGHTS[:1], start=1):
            light = document.getNodeDef(f"ND_{name}_light")
            mx_gen.HwShaderGenerator.bindLightShader(light, number, context)
    for name in client:
        setattr(context.getOptions(), name, True)
    return context


def generated(
    generator: mx_gen.ShaderGenerator, name: str, element: mx.Element, context: mx_gen.GenContext
) -> mx_gen.Shader:
    """Generate the shader of an element, without MaterialX's warnings about booleans in WGSL."""
    wordy = isinstance(generator, GENERATORS.get("wgsl", ()))
    with without_lines(BOOLEANS) if wordy else nullcontext():
        return generator.generate(name, element, context)


@cache
def tokens_of(target: str, library: str, profile: str | None) -> Mapping[str, str]:
    """Values of the tokens in includes, read from a generator that has generated a shader."""
    document = mx.createDocument()
    document.setDataLibrary(load_library(library, profile))
    generator = generator_of(document, target, library, profile)
    surface = document.addNode("surface", "surface", "surfaceshader")
    context = context_of(document, target, generator, library, False, ())
    generated(generator, "surface", surface, context)
    return dict(generator.getTokenSubstitutions())


ERROR = 2  # file descriptor of the error output


@contextmanager
def without_lines(words: str) -> Iterator[None]:
    """A context that removes lines containing `words` from the process's error output.

    All other lines are written at the end of the context.
    """
    if sys.stderr is None:
        yield
        return
    sys.stderr.flush()
    output = os.dup(ERROR)
    with tempfile.TemporaryFile() as file:
        os.dup2(file.fileno(), ERROR)
        try:
            yield
        finally:
            os.dup2(output, ERROR)
            os.close(output)
            file.seek(0)
            remaining = [line for line in file if words.encode() not in line]
            os.write(ERROR, b"".join(remaining))
