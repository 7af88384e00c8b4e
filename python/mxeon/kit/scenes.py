# SPDX-License-Identifier: Apache-2.0
"""The scenes of the kit as USD text, written without USD, and a mesh of the unit sphere.

The mesh is for renderers without an exact sphere. Each vertex is on the sphere and equals the
normal at that vertex, so the interpolated normal at a point has the direction of the point.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from mxeon.kit.views import View

SUBDIVISIONS = 5  # 20,480 triangles of about two degrees; another step quarters the error

MESH = """#usda 1.0
(
    defaultPrim = "sphere"
    metersPerUnit = 1
    upAxis = "Y"
)

def Mesh "sphere"
{{
    int[] faceVertexCounts = [{counts}]
    int[] faceVertexIndices = [{indices}]
    point3f[] points = [{points}]
    normal3f[] normals = [{points}] (
        interpolation = "vertex"
    )
    float3[] extent = [(-1, -1, -1), (1, 1, 1)]
    uniform token subdivisionScheme = "none"
}}
"""

SCENE = """#usda 1.0
(
    defaultPrim = "world"
    doc = "{name}: one picture of the mxeon kit, {size} x {size} pixels"
    metersPerUnit = 1
    upAxis = "Y"
)

def Xform "world"
{{
    def Camera "camera"
    {{
        token projection = "orthographic"
        # Tenths of a unit: the frame is the square [-1, 1]^2.
        float horizontalAperture = 20
        float verticalAperture = 20
        float2 clippingRange = (0.1, 100)
        double3 xformOp:translate = (0, 0, 4)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }}

    def "sphere" (
        prepend apiSchemas = ["MaterialBindingAPI"]
        references = @../sphere.usda@
    )
    {{
        rel material:binding = </world/material>
    }}

{light}

    def Material "material"
    {{
        token outputs:mtlx:surface.connect = </world/material/surface.outputs:out>

        def Shader "surface"
        {{
            uniform token info:id = "ND_surface"
            token inputs:bsdf.connect = </world/material/lobe.outputs:out>
            token outputs:out
        }}

        def Shader "lobe"
        {{
            uniform token info:id = "{node}"
            color3f inputs:color = {color}
            float inputs:roughness = {roughness!r}
{flag}            token outputs:out
        }}
    }}
}}

def Scope "Render"
{{
    def RenderSettings "settings"
    {{
        rel camera = </world/camera>
        int2 resolution = ({size}, {size})
        bool instantaneousShutter = 1
    }}
}}
"""

FLAG = "            bool inputs:energy_compensation = {flag:d}\n"

DISTANT = """    def DistantLight "light"
    {{
        # Irradiance pi on a surface that faces the light, which stands in +z of its own frame.
        float inputs:angle = 0
        float inputs:intensity = {irradiance!r}
        bool inputs:normalize = 1
        matrix4d xformOp:transform = ( {rows}, (0, 0, 0, 1) )
        uniform token[] xformOpOrder = ["xformOp:transform"]
    }}"""

DOME = """    def DomeLight "light"
    {{
        float inputs:intensity = {radiance!r}
    }}"""


@dataclass(frozen=True)
class Mesh:
    """Triangles between points of the unit sphere."""

    vertices: NDArray[np.float64]  # (V, 3), positions and normals
    triangles: NDArray[np.int64]  # (T, 3), counter-clockwise as seen from outside

    @property
    def depth(self) -> float:
        """Largest distance of a triangle from the sphere."""
        a, b, c = np.moveaxis(self.vertices[self.triangles], 1, 0)
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        return float(1.0 - (normal * a).sum(axis=1).min())


def unit_sphere() -> Mesh:
    """The unit sphere as an icosahedron in which each triangle is repeatedly split into four."""
    golden = (1.0 + np.sqrt(5.0)) / 2.0
    rectangle = np.array([[0, 1, golden], [0, -1, golden], [0, 1, -golden], [0, -1, -golden]])
    vertices = np.concatenate([np.roll(rectangle, shift, axis=1) for shift in range(3)])
    mesh = Mesh(_on_sphere(vertices), _faces(vertices))
    for _ in range(SUBDIVISIONS):
        # Each triangle is split into four, and the midpoints of edges are moved onto the sphere.
        edges = mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]]
        pairs, place = np.unique(np.sort(edges.reshape(-1, 2), axis=1), axis=0, return_inverse=True)
        middles = _on_sphere(mesh.vertices[pairs].sum(axis=1))
        (a, b, c), (d, e, f) = mesh.triangles.T, place.reshape(-1, 3).T + len(mesh.vertices)
        parts = [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
        triangles = np.concatenate([np.stack(part, axis=1) for part in parts])
        mesh = Mesh(np.concatenate([mesh.vertices, middles]), triangles)
    return mesh


def _faces(vertices: NDArray[np.float64]) -> NDArray[np.int64]:
    """Triangles between vertices at a distance of 2, oriented outward."""
    near = np.isclose(np.linalg.norm(vertices[:, None] - vertices, axis=-1), 2.0)
    triples = combinations(range(len(vertices)), 3)
    faces = np.array(
        [each for each in triples if all(near[pair] for pair in combinations(each, 2))]
    )
    outward = np.linalg.det(vertices[faces]) > 0.0
    return np.where(outward[:, None], faces, faces[:, ::-1])


def _on_sphere(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(points / np.linalg.norm(points, axis=1, keepdims=True))


def to_obj(mesh: Mesh) -> str:
    """A mesh as Wavefront OBJ, with normals and smooth shading."""
    rows = [f"{x:.9f} {y:.9f} {z:.9f}" for x, y, z in mesh.vertices]
    corners = [" ".join(f"{each}//{each}" for each in row) for row in mesh.triangles + 1]
    lines = ["# Unit sphere around the origin; normals are positions.", "o sphere", "s 1"]
    lines += [f"v {row}" for row in rows] + [f"vn {row}" for row in rows]
    return "\n".join(lines + [f"f {row}" for row in corners]) + "\n"


def mesh_layer(mesh: Mesh) -> str:
    return MESH.format(
        counts=", ".join(["3"] * len(mesh.triangles)),
        indices=", ".join(map(str, mesh.triangles.ravel())),
        points=", ".join(f"({x:.9f}, {y:.9f}, {z:.9f})" for x, y, z in mesh.vertices),
    )


def scene_layer(view: View, node: str, flagged: bool) -> str:
    """The USD scene of a picture. A node with the input energy_compensation is `flagged`."""
    material, scene = view.material, view.scene
    if scene.light is None:
        light = DOME.format(radiance=scene.environment)
    else:
        # The frame is right-handed, with z along the direction of the light.
        z = np.array(scene.light)
        x = np.cross(np.eye(3)[np.abs(z).argmin()], z)
        x /= np.linalg.norm(x)
        frame = np.stack([x, np.cross(z, x), z])
        rows = ", ".join(str((*row, 0.0)) for row in frame.tolist())
        light = DISTANT.format(irradiance=float(np.pi), rows=rows)
    return SCENE.format(
        name=view.name,
        size=scene.size,
        light=light,
        color=material.color,
        roughness=material.roughness,
        node=node,
        flag=FLAG.format(flag=material.energy_compensation) if flagged else "",
    )
