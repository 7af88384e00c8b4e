# SPDX-License-Identifier: Apache-2.0
"""The half of the `eevee` host that runs in Blender's Python, started by its path.

It reads one JSON object per line on standard input and answers each with one on standard output:
first `{"version": ...}`, then `{}` per request. The process ends when standard input does.
"""

from __future__ import annotations

import json
import math
import os
import sys
from typing import Any, TypeAlias

# Blender prints on standard output as soon as it is imported: that goes to standard error.
REPLIES = os.fdopen(os.dup(1), "w", buffering=1)
os.dup2(2, 1)

import bpy  # noqa: E402
import numpy as np  # noqa: E402
from mathutils import Vector  # noqa: E402

Blender: TypeAlias = Any  # an object of bpy, which has no types
Values: TypeAlias = dict[str, Any]  # by name, of a request in JSON

KINDS = ("objects", "cameras", "meshes", "materials", "lights", "worlds", "images")


def empty_scene(size: int, path: str) -> Blender:
    """A scene that EEVEE draws to a linear float32 file, the square [-1, 1]^2 seen along -z."""
    bpy.data.batch_remove([each for kind in KINDS for each in getattr(bpy.data, kind)])
    scene = bpy.context.scene
    render = scene.render
    render.engine = "BLENDER_EEVEE"
    render.filepath = path
    render.resolution_x = render.resolution_y = size
    render.film_transparent = True
    render.filter_size = 0.01
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_mode = "RGB"
    render.image_settings.color_depth = "32"
    render.image_settings.exr_codec = "NONE"
    scene.eevee.taa_render_samples = 1
    scene.eevee.use_shadows = scene.eevee.use_raytracing = False
    scene.eevee.light_threshold = 0.0
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 2.0
    camera.location.z = 2.0
    scene.collection.objects.link(camera)
    scene.camera = camera
    return scene


def material_of(kind: str, **inputs: object) -> Blender:
    """A material whose surface is a node of a kind, with some of its inputs set."""
    material = bpy.data.materials.new("material")
    tree = material.node_tree
    tree.nodes.clear()
    node, output = tree.nodes.new(kind), tree.nodes.new("ShaderNodeOutputMaterial")
    for name, value in inputs.items():
        node.inputs[name].default_value = (*value, 1.0) if isinstance(value, list) else value
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def add_light(scene: Blender, direction: list[float]) -> None:
    """Add a distant light of irradiance pi that shines from a direction."""
    sun = bpy.data.lights.new("light", "SUN")
    sun.angle, sun.energy, sun.use_shadow = 0.0, math.pi, False
    light = bpy.data.objects.new("light", sun)
    light.rotation_mode = "QUATERNION"
    light.rotation_quaternion = Vector(direction).to_track_quat("Z", "Y")
    scene.collection.objects.link(light)


def add_environment(scene: Blender, radiance: float) -> None:
    world = bpy.data.worlds.new("environment")
    inputs = world.node_tree.nodes["Background"].inputs
    inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    inputs["Strength"].default_value = radiance
    scene.world = world


def render(
    output: str,
    material: Values,
    mesh: str,
    size: int,
    light: list[float] | None,
    environment: float | None,
    samples: int,
) -> None:
    """Draw the mesh with a node on it, and write the picture's numbers, row 0 at the top."""
    path = f"{output}.exr"
    scene, data = empty_scene(size, path), np.load(mesh)
    polyhedron = bpy.data.meshes.new("polyhedron")
    polyhedron.from_pydata(data["vertices"].tolist(), [], data["triangles"].tolist())
    polyhedron.materials.append(material_of(**material))
    scene.collection.objects.link(bpy.data.objects.new("polyhedron", polyhedron))
    if light is not None:
        add_light(scene, light)
    add_environment(scene, environment or 0.0)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.zeros(4 * size * size, np.float32)
    image.pixels.foreach_get(pixels)
    np.save(output, pixels.reshape(size, size, 4)[::-1, :, :3])


def main() -> None:
    """Serve requests until standard input ends."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    print(json.dumps({"version": bpy.app.version_string}), file=REPLIES)
    for line in sys.stdin:
        render(**json.loads(line))
        print("{}", file=REPLIES)


if __name__ == "__main__":
    main()
