# SPDX-License-Identifier: Apache-2.0
"""Draws documents with the Hydra Storm that Blender's Python package holds, under one light.

    python tests/support/storm.py BPY LIBRARY FILE...     LIBRARY "" for MaterialX alone

Prints the color of each as JSON. The quad lies in the plane z = 0, its normal leans by LEAN towards x, the
light comes from LIGHT, and the viewer is far away along z.
"""

import json
import math
import os
import sys
from pathlib import Path

LEAN, LIGHT = math.radians(40.0), math.radians(110.0)
SIZE, FAR = 8, 1e6  # pixels; the view comes from the camera's position, in an orthographic one too
CORNERS = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]


def main(blender, library, *files):
    # Let OpenUSD find its plugins and the libraries.
    blender = Path(blender)
    os.environ["PXR_PLUGINPATH_NAME"] = str(blender / "lib" / "usd")
    os.environ["PXR_MTLX_STDLIB_SEARCH_PATHS"] = str(blender / "lib" / "materialx" / "libraries")
    os.environ["PXR_MTLX_PLUGIN_SEARCH_PATHS"] = library
    sys.path.insert(0, str(next(blender.glob("*/python/lib/python*/site-packages"))))
    # Open a context before USD looks for one.
    import moderngl

    context = moderngl.create_context(standalone=True, backend="egl", require=450)
    target = context.simple_framebuffer((SIZE, SIZE), 4, dtype="f4")
    print(json.dumps([draw(target, file) for file in files]))


def draw(target, file):
    """Color of the pixel in the middle."""
    import numpy as np
    from pxr import Gf, Tf, UsdImagingGL

    # Look along -z.
    frustum = Gf.Frustum()
    frustum.projectionType = Gf.Frustum.Orthographic
    frustum.window = Gf.Range2d((-0.5, -0.5), (0.5, 0.5))
    frustum.position = Gf.Vec3d(0.0, 0.0, FAR)
    frustum.nearFar = Gf.Range1d(FAR / 10.0, FAR * 2.0)
    engine = UsdImagingGL.Engine()
    engine.SetRendererAov("color")
    engine.SetCameraState(frustum.ComputeViewMatrix(), frustum.ComputeProjectionMatrix())
    engine.SetRenderViewport(Gf.Vec4d(0.0, 0.0, SIZE, SIZE))
    options = UsdImagingGL.RenderParams()
    options.colorCorrectionMode = "disabled"
    # Draw; in a core profile Storm asks for what OpenGL no longer has, and the picture is complete.
    target.clear(depth=1.0)
    target.use()
    scene = stage(file)
    try:
        engine.Render(scene.GetPseudoRoot(), options)
    except Tf.ErrorException as error:
        if "invalid enum" not in str(error):
            raise
    pixels = np.frombuffer(target.read(components=4, dtype="f4"), "f4").reshape(SIZE, SIZE, 4)
    return pixels[SIZE // 2, SIZE // 2].tolist()


def stage(file):
    """A quad with one normal, a distant light of irradiance pi, and the material of a document."""
    from pxr import Usd, UsdGeom, UsdLux, UsdShade

    scene = Usd.Stage.CreateInMemory()
    quad = UsdGeom.Mesh.Define(scene, "/quad")
    quad.CreatePointsAttr(CORNERS)
    quad.CreateFaceVertexCountsAttr([4])
    quad.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
    quad.CreateSubdivisionSchemeAttr("none")
    quad.CreateNormalsAttr([(math.sin(LEAN), 0.0, math.cos(LEAN))] * 4)
    quad.SetNormalsInterpolation("vertex")
    light = UsdLux.DistantLight.Define(scene, "/light")
    light.CreateIntensityAttr(math.pi)
    light.CreateNormalizeAttr(True)
    light.CreateAngleAttr(0.1)
    light.AddRotateYOp().Set(math.degrees(LIGHT))
    scene.OverridePrim("/look").GetReferences().AddReference(file, "/MaterialX")
    [material] = [each for each in scene.Traverse() if each.IsA(UsdShade.Material)]
    UsdShade.MaterialBindingAPI.Apply(quad.GetPrim()).Bind(UsdShade.Material(material))
    return scene


if __name__ == "__main__":
    main(*sys.argv[1:])
