# SPDX-License-Identifier: Apache-2.0
"""The scenes of the kit in USD's text form, written without USD."""

import numpy as np

from mxeon.kit.mesh import Mesh
from mxeon.kit.views import View

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


def mesh_layer(mesh: Mesh) -> str:
    return MESH.format(
        counts=", ".join(["3"] * len(mesh.triangles)),
        indices=", ".join(map(str, mesh.triangles.ravel())),
        points=", ".join(f"({x:.9f}, {y:.9f}, {z:.9f})" for x, y, z in mesh.vertices),
    )


def scene_layer(view: View, node: str, flagged: bool) -> str:
    """The USD scene of a picture; `flagged` nodes have the input energy_compensation."""
    material, scene = view.material, view.scene
    if scene.light is None:
        light = DOME.format(radiance=scene.environment)
    else:
        # Build a right-handed frame with z along the direction.
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
