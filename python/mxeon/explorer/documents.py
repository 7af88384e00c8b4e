# SPDX-License-Identifier: Apache-2.0
"""Sources that documents add to a page: generated ESSL, and inputs with their ranges."""

import math
import warnings
from base64 import b64encode
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from xml.etree import ElementTree

import MaterialX as mx
import numpy as np
import OpenImageIO as oiio

from mxeon.conformance import words
from mxeon.conformance.pictures import judge_document
from mxeon.conformance.reference import Reference
from mxeon.conformance.results import DIFFERS, FAILED, NOT_RUN, PASSED
from mxeon.conformance.results.known_issues import issues
from mxeon.conformance.run.plan import read_documents
from mxeon.errors import InterfaceError, MxeonError, printable
from mxeon.explorer import data
from mxeon.explorer.references import LOBES, lobes_of, reference_of
from mxeon.hosts import open_host
from mxeon.hosts.textures import check_images, image_files, read_latlong, read_texture
from mxeon.shaders.document.policy import DEFAULT, Policy
from mxeon.shaders.document.values import Plain, flat
from mxeon.shaders.generation import Input, Shader, generate
from mxeon.shaders.nodes import DIFFUSE_NODES, EON, FLAG, OREN_NAYAR

LIBRARIES = ("eonlib", "stock")
LAYOUT = ("comment", "newline")
# Maximum number of a document's materials that are judged, because judging a material takes 2 s.
REFERENCES = 20
LARGEST_IMAGE = 256  # maximum texels on a side; such an image has a quarter of a mebibyte
ALL_IMAGES = 64 * LARGEST_IMAGE**2  # maximum texels of a document, which add 22 MB to a page
RANGE = (("uimin", "uisoftmin"), ("uimax", "uisoftmax"))

# Intended models of the diffuse nodes, with the input energy_compensation on and off.
MEANT = {OREN_NAYAR: data.Models("eon", "qon"), EON: data.Models("eon", "eon")}


def document_sources(
    file: str, policy: Policy = DEFAULT, library: str = LIBRARIES[1]
) -> tuple[data.ShaderSource, ...]:
    """Sources of a document's materials, with eonlib and, if possible, with `library`.

    Raises DocumentError if no shader can be generated with eonlib, or ImageError for a bad image.
    """
    name = " ".join(printable(Path(file).name).split())
    sources: list[data.ShaderSource] = []
    contents = read_documents([file], [LIBRARIES[0]], policy, 0, 0.0).contents
    titles = contents.get(file, ())
    # Both libraries share references, keyed by element, and images, keyed by file.
    references: dict[str, data.ReferenceTable | None] = {}
    images: dict[str, data.Texels | None] = {}
    for half, each in zip(LIBRARIES, (LIBRARIES[0], library), strict=True):
        try:
            shaders = generate(file, "essl", library=each, lights=True, policy=policy)
        except MxeonError:
            if half == LIBRARIES[0] or library != LIBRARIES[1]:
                raise
            continue  # stock MaterialX lacks a node
        # Read each image once, and limit the size of each image so that all images fit.
        check_images(shaders, policy)
        names = image_files(shaders)
        side = min(LARGEST_IMAGE, math.isqrt(ALL_IMAGES // max(len(names), 1)))
        images |= {name: _texels(name, side) for name in names if name not in images}
        text = document_text(shaders[0].document) if shaders else ""  # shared by both libraries
        if half == LIBRARIES[0]:
            references = {one.element: reference_of(one) for one in shaders[:REFERENCES]}
        checked = checked_materials(file, each, policy) if len(shaders) <= REFERENCES else {}
        paths = path_texts(file, policy) if half == LIBRARIES[0] else {}
        for shader in shaders:
            title = f"{shader.element}, {Path(each).name.replace(',', ' ')}"
            key = f"{shader.name}/{half}"
            source = shader_source(shader, text, key, title, name, each, images)
            reference = references.get(shader.element)
            found = checked.get(shader.element)
            pages = _pages(titles, each) if found and found.kind in ("wrong", "differs") else ()
            path = paths.get(shader.element, "")
            sources.append(
                replace(source, reference=reference, checked=found, pages=pages, paths=path)
            )
    return tuple(sources)


SKY_ROWS = 128  # twice the rows of the page's built-in environment


def sky_of(file: str) -> data.Texels:
    """Read a latitude-longitude image. The middle of the image faces the viewer."""
    pixels = read_latlong(file)
    whole = oiio.ImageBuf(np.ascontiguousarray(np.roll(pixels, pixels.shape[1] // 2, axis=1)))
    area = oiio.ROI(0, 2 * SKY_ROWS, 0, SKY_ROWS, 0, 1, 0, 3)
    small = oiio.ImageBufAlgo.resize(whole, filtername="box", roi=area)
    rgba = np.ones((SKY_ROWS, 2 * SKY_ROWS, 4), "<f4")
    rgba[..., :3] = np.asarray(small.get_pixels(oiio.FLOAT))
    return data.Texels(2 * SKY_ROWS, SKY_ROWS, b64encode(rgba.tobytes()).decode())


def path_texts(document: str, policy: Policy = DEFAULT) -> dict[str, str]:
    """Path-tracing code of materials, keyed by element; empty if a material mixes surfaces."""
    with warnings.catch_warnings(), suppress(InterfaceError):
        warnings.simplefilter("ignore")  # the warnings were already reported
        made = generate(document, "essl", profile="path", uniforms=True, policy=policy)
        return {each.element: each.stages["pixel"] for each in made}
    return {}


KINDS = {PASSED: "correct", DIFFERS: "differs", FAILED: "wrong", NOT_RUN: "unknown"}


def checked_materials(file: str, library: str, policy: Policy = DEFAULT) -> dict[str, data.Checked]:
    """Verdicts of `mxeon check` on the host gl, keyed by element; empty if gl does not run."""
    try:
        with open_host("gl") as host, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the warnings were already reported
            results, _, _ = judge_document(Path(file), host, Reference(), library, policy)
    except MxeonError:  # gl is missing, or the document has an error that was already reported
        return {}
    return {
        each.element: data.Checked(
            "unknown"
            if each.check == "finite"
            else "within"
            if each.verdict == PASSED and each.difference and each.difference.is_visible
            else KINDS[each.verdict],
            f"mxeon check: {words.look(each)}.",
        )
        for each in results
    }


def _pages(titles: Iterable[str], library: str) -> tuple[str, ...]:
    """Names of pages on defects that change pictures of nodes with the given titles."""
    return tuple(
        issue.page
        for issue in issues().values()
        if "webgl" in issue.hosts
        and issue.library == library
        and not (issue.kind or issue.differs)
        and {subject for _, subject in issue.rows}.intersection(titles)
    )


def document_text(document: mx.Document) -> str:
    """XML of a document and its includes. MaterialX's writer does not escape `<` in attributes."""
    root = _tree(document)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def _tree(element: mx.Element) -> ElementTree.Element:
    """Copy an element and its children, without comments and empty lines."""
    name = {"name": element.getName()} if element.getName() else {}
    attributes = {name: element.getAttribute(name) for name in element.getAttributeNames()}
    tree = ElementTree.Element(element.getCategory(), name | attributes)
    tree.extend(_tree(each) for each in element.getChildren() if each.getCategory() not in LAYOUT)
    return tree


def shader_source(
    shader: Shader,
    document: str,
    name: str,
    title: str,
    group: str,
    library: str,
    images: Mapping[str, data.Texels | None] = MappingProxyType({}),
) -> data.ShaderSource:
    """The page's source for a generated ESSL shader. `images` has images, keyed by file."""
    source = data.ShaderSource(
        id=name,
        title=title,
        group=group,
        library=library,
        pixel=shader.stages["pixel"],
        inputs=_by_effect(tuple(_ports(shader, images)), shader.document),
        controls=data.Controls(),
        document=document,
    )
    lobes = lobes_of(shader, (*LOBES, "EDF"))
    if len(lobes) != 1 or lobes[0].getCategory() not in DIFFUSE_NODES:
        return source
    [node] = lobes
    names = {port.path: port.name for port in source.inputs}
    path = node.getNamePath()
    color, roughness, flag = (
        names.get(f"{path}/{each}", "") for each in ("color", "roughness", FLAG)
    )
    source = replace(source, controls=data.Controls(color, roughness, flag))
    connected = any(
        each.getConnectedOutput() or each.getConnectedNode() for each in node.getInputs()
    )
    # A lobe's intended model is the model of the material only if weight and opacity are 1.
    factors = {port.path.rpartition("/")[2]: port.value for port in source.inputs}
    whole = factors.get("weight") == factors.get("opacity") == 1.0
    if connected or not (color and roughness and whole):
        return source
    return replace(source, meant=MEANT[node.getCategory()])


def _ports(shader: Shader, images: Mapping[str, data.Texels | None]) -> Iterator[data.ShaderInput]:
    """Inputs of a shader that are numbers or images. Members of structures are separate inputs."""
    for port in shader.inputs:
        if port.type == "filename":
            if port.value:
                yield replace(_port(shader, port), image=images.get(str(port.value)))
        else:
            for name, kind, value in flat(port.name, port.type, port.value, shader.document):
                yield replace(_port(shader, port), name=name, type=kind, value=_short(value))


def _by_effect(
    ports: tuple[data.ShaderInput, ...], document: mx.Document
) -> tuple[data.ShaderInput, ...]:
    """Sort inputs: first inputs set by the document, then defaults, then inputs without effect."""
    values = {port.path: port.value for port in ports}

    def rank(port: data.ShaderInput) -> int:
        node, _, name = port.path.rpartition("/")
        words = name.split("_")
        stems = ["_".join(words[:count]) for count in range(1, len(words))]
        gates = {"weight", *stems, *(f"{stem}_weight" for stem in stems)} - {name}
        unused = name == "default" and f"{node}/file" in values  # color if the image is missing
        if unused or any(values.get(f"{node}/{gate}") == 0.0 for gate in gates):
            return 2
        return 0 if document.getDescendant(port.path) else 1

    return tuple(sorted(ports, key=rank))


def _port(shader: Shader, port: Input) -> data.ShaderInput:
    """An input with its label and range, but without its value."""
    # Attributes come from the input's own element, or else from the definition of the node.
    parent, _, name = port.path.rpartition("/")
    node = shader.document.getDescendant(parent) if parent else None
    definition = node.getNodeDef() if isinstance(node, mx.Node) else None
    inputs = (
        shader.document.getDescendant(port.path),
        definition and definition.getActiveInput(name),
    )
    elements = [each for each in inputs if each is not None]

    def words(attribute: str) -> str:
        return next(filter(None, (each.getAttribute(attribute) for each in elements)), "")

    low, high = (_first_number(map(words, names)) for names in RANGE)
    if low is not None and high is not None and not math.isfinite(high - low):
        low = high = None  # the slider's length would overflow
    label = words("uiname") or name.replace("_", " ")
    # Hide enumerations, which are numbers in the shader, and frames of images, which are fixed.
    shown = not (words("enum") or port.type == "filename" or "frame" in port.path)
    return data.ShaderInput(port.name, port.type, None, port.path, label, low, high, shown=shown)


def _first_number(texts: Iterable[str]) -> float | None:
    """The number at the start of the first text that starts with a finite number."""
    for text in texts:
        with suppress(ValueError):
            if math.isfinite(value := float(text.split(",")[0])):
                return value
    return None


def _short(value: Plain) -> Plain:
    """Round a value to the fewest decimals that give the same float32."""
    if isinstance(value, tuple):
        return tuple(map(_short, value))
    return float(str(np.float32(value))) if isinstance(value, float) else value


def _texels(path: str, side: int) -> data.Texels | None:
    """Read an image, scaled down to at most `side` texels on a side; None for a missing file."""
    if not Path(path).is_file():
        return None
    pixels = read_texture(path)
    high, wide = (-(-size // side) for size in pixels.shape[:2])
    rows, columns = pixels.shape[0] // high, pixels.shape[1] // wide
    blocks = pixels[: rows * high, : columns * wide].reshape(rows, high, columns, wide, -1)
    mean = blocks.mean(axis=(1, 3))
    rgba = np.ones((rows, columns, 4))
    rgba[..., : mean.shape[-1]] = mean
    codes = np.rint(255.0 * np.clip(np.nan_to_num(rgba), 0.0, 1.0)).astype(np.uint8)
    return data.Texels(columns, rows, b64encode(codes.tobytes()).decode())
