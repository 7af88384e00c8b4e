# SPDX-License-Identifier: Apache-2.0
"""The host of shadewire, a MaterialX compiler written in Rust that has its own closures.

shadewire reads a document and returns a library of GLSL functions, which run as on the host `gl`.
The returned text stays unchanged, because inputs that vary are connected to geometric properties. A
renderer has to define a function for each of these properties.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import TypeAlias

import MaterialX as mx
import numpy as np
from numpy.typing import ArrayLike

from mxeon.errors import NotRun, install
from mxeon.hosts import base, fragment
from mxeon.hosts.base import Array, Identity, Query, RendererWarning
from mxeon.hosts.calls import GRAPH, NORMAL, SURFACE, TANGENT
from mxeon.hosts.gl import GlHost
from mxeon.shaders.generation import Shader
from mxeon.shaders.inner_lobes import SUBSURFACE, inner_lobes
from mxeon.shaders.methods import Methods
from mxeon.shaders.nodes import FRAME_INPUTS
from mxeon.shaders.scene import VIEW, Scene, sphere, tangents

try:
    from shadewire import ShadewireError, glsl, mtlx, version
except ImportError:
    mtlx = None

MODELS = ("surface", "surface_unlit")  # surfaces with a tree of closures or only emission
SKIPPED = ": not evaluated"  # end of shadewire's comment on a lobe that stays black
EMITTED = "shadewire_eval_emission(surface, V, N)"
BSDF = "shadewire_eval_bsdf(surface, L, V, N)"
# Expression of the response for each branch. Two branches have no response in shadewire.
RESPONSES = {
    "direct": f"{BSDF}.response",
    "environment": "shadewire_eval_albedo(surface, V, N)",
    "transmission": "vec3(0.0)",
    "emission": "vec3(0.0)",
    GRAPH: EMITTED,
}
# Expressions of the outputs that are the same in all branches.
OUTPUTS = {"throughput": f"{BSDF}.throughput", "radiance": EMITTED}
FRAME = """vec3 host_normal, host_tangent;
vec3 shadewire_host_normal_world() { return host_normal; }
vec3 shadewire_host_tangent_world() { return host_tangent; }
vec3 shadewire_host_bitangent_world() { return cross(host_normal, host_tangent); }
"""
PROPERTY = "{0} host_{1};\n{0} shadewire_host_geomprop_{1}() {{ return host_{1}; }}\n"
TYPES = {"float": "float", "boolean": "bool", "integer": "int", "vector2": "vec2"}  # others: vec3

Properties: TypeAlias = Mapping[str, tuple[str, str]]  # name -> key and type of an input


class ShadewireHost(base.Host):
    name = "shadewire"
    target = "glsl"
    default, fixed = Methods("prefilter"), True  # shadewire uses MaterialX's fit of albedos

    def __init__(self) -> None:
        if mtlx is None:
            raise NotRun(f"shadewire: the package is not installed; {install('shadewire')}")
        self._gl = GlHost()

    def identity(self) -> Identity:
        gl = self._gl.identity()
        return Identity(self.name, f"shadewire {version()}, OpenGL {gl.version}", gl.device)

    def close(self) -> None:
        self._gl.close()

    def execute(self, source: str, function: str, *arguments: ArrayLike) -> Array:
        return self._gl.execute(source, function, *arguments)

    def picture(self, shader: Shader, scene: Scene) -> Array:
        self.refuse_paths(scene)
        self.refuse_shape(scene)
        if scene.environment is not None:
            raise NotRun("shadewire: light must be distant; it cannot look up environments")
        points = sphere(scene.size)
        normal = points.normal[points.mask]
        frame = {SURFACE: normal, "normal": normal, "tangent": tangents(normal)}
        value = f"{EMITTED} + {np.pi} * {RESPONSES['direct']}" if scene.light else EMITTED
        directions = np.array([VIEW]), np.array([scene.light or VIEW])
        image = np.zeros((*points.mask.shape, 3), np.float32)
        image[points.mask] = self._evaluated(shader, *directions, frame, value)
        return image

    def unread(self, shader: Shader) -> str:
        if SUBSURFACE in inner_lobes(shader):
            return "subsurface scattering is Lambertian, as its source says"
        return ""

    def _values(self, query: Query) -> Array:
        shader, wo, wi, inputs, branch, output, irradiance, _ = query
        value = OUTPUTS.get(output) or RESPONSES.get(branch)
        if value is None or irradiance is not None:
            raise self._unsupported("environment lookups, only albedos", "gl")
        return self._evaluated(shader, wo, wi, inputs, value)

    def _evaluated(
        self, shader: Shader, wo: Array, wi: Array, inputs: base.Inputs, value: str
    ) -> Array:
        document, properties = _connected(shader, inputs.keys())
        tangent = inputs.get("tangent", inputs.get("curve_direction", TANGENT))
        arguments: dict[str, tuple[str, ArrayLike]] = {
            "V": ("vector3", wo),
            "L": ("vector3", wi),
            "N": ("vector3", inputs.get(SURFACE, NORMAL)),
            "normal": ("vector3", inputs.get("normal", NORMAL)),
            "tangent": ("vector3", tangent),
            **{name: (kind, inputs[key]) for name, (key, kind) in properties.items()},
        }
        material = shader.element if shader.document.getMaterialNodes() else ""
        text = _compiled(document, material) + FRAME
        for name, (_, kind) in properties.items():
            text += PROPERTY.format(TYPES.get(kind, "vec3"), name)
        needed = set(re.findall(r"shadewire_host_\w+(?=\(\);)", text))
        if missing := needed - set(re.findall(r"shadewire_host_\w+(?=\(\) \{)", text)):
            raise NotRun(
                f"shadewire: its source calls {', '.join(sorted(missing))}, which mxeon does not define"
            )
        body = [f"host_{name} = {name};" for name in [*arguments][3:]]
        body.append("Surface surface = shadewire_eval_surface();")
        body.append(f"mxeon_out = vec4({value}, 1.0);")
        return self._gl.drawn(*fragment.evaluation(text, arguments, body, self.target))


def _connected(shader: Shader, varying: Collection[str]) -> tuple[str, Properties]:
    """Text of a shader's document, in which the `varying` inputs read geometric properties.

    Normals and tangents stay unconnected, because the renderer supplies them. Also returns the
    properties. The document contains the definitions of the library.
    """
    document = mx.createDocument()
    document.copyContentFrom(shader.document)
    document.setDataLibrary(shader.document.getDataLibrary())
    properties: dict[str, tuple[str, str]] = {}
    nodes = [each for each in document.traverseTree() if each.isA(mx.Node)]
    for node in nodes:
        definition = node.getNodeDef()
        for port in definition.getActiveInputs() if definition else ():
            name, kind = port.getName(), port.getType()
            keys = [key for key in (f"{node.getNamePath()}/{name}", name) if key in varying]
            current = node.getInput(name)
            linked = current is not None and current.getValue() is None
            if keys and kind in fragment.FETCH and name not in FRAME_INPUTS and not linked:
                title = f"own_{len(properties)}"
                properties[title] = keys[0], kind
                node.removeInput(name)
                source = node.getParent().addNode("geompropvalue", f"mxeon_{title}", kind)
                source.setInputValue("geomprop", title)
                node.addInput(name, kind).setConnectedNode(source)
    for folder in shader.folders:
        for file in sorted(Path(folder).rglob("*.mtlx")):
            mx.prependXInclude(document, str(file))
    return mx.writeToXmlString(document), properties


def _compiled(document: str, material: str) -> str:
    """The text that shadewire generates for a material of a document, without the first line.

    An empty name selects the only material. Raises NotRun if shadewire refuses the document, and warns
    of a lobe that shadewire leaves black.
    """
    try:
        ir = mtlx.to_ir(document, "", material or None, models=MODELS, values_as_uniforms=False)
        _, text = glsl.compile(ir, 430).code.split("\n", 1)
    except ShadewireError as error:
        raise NotRun(f"shadewire: {error}") from None
    for line in text.splitlines():
        if line.endswith(SKIPPED):
            warnings.warn(RendererWarning(f"its text says {line.strip()!r}"), stacklevel=2)
    return str(text)
