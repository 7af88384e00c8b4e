# SPDX-License-Identifier: Apache-2.0
"""Renders a kit with Blender's Cycles, as an external renderer that uses only the kit's files.

    PYTHON_WITH_BPY external_renderer.py KIT OSL_FOLDER SAMPLES

The materials are OSL files OSL_FOLDER/NAME.osl, made from the kit's MaterialX documents.
"""

import json
import os
import sys
from pathlib import Path

import bpy  # isort: skip  # bpy comes first, because its folder contains the other modules
import _cycles
from mathutils import Vector

BUNDLED = Path(bpy.utils.resource_path("LOCAL"), "python", "lib")
sys.path.extend(str(folder) for folder in BUNDLED.glob("python*/site-packages"))


def set_up(kit, folder):
    """Create the scene with the camera, the sphere mesh and the picture format of the kit."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type = "ORTHO"
    (left, _), (right, _) = kit["camera"]["frame"]
    camera.data.ortho_scale = right - left
    camera.location.z = 4.0
    scene.collection.objects.link(camera)
    scene.camera = camera
    mesh = str(folder / kit["sphere"]["mesh"])
    bpy.ops.wm.obj_import(filepath=mesh, forward_axis="NEGATIVE_Z", up_axis="Y")
    sphere = bpy.context.selected_objects[0]
    sphere.rotation_euler = (0.0, 0.0, 0.0)
    render = scene.render
    render.resolution_x = render.resolution_y = kit["size"]
    render.film_transparent = True
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_mode = "RGB"
    render.image_settings.color_depth = "32"
    return scene, sphere


def set_cycles(scene, samples):
    """Set up Cycles with OSL and a box filter of one pixel."""
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.shading_system = True
    cycles.samples = samples
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.sampling_pattern = "TABULATED_SOBOL"
    cycles.max_bounces = 1


def set_material(sphere, source):
    compiled = source.with_suffix(".oso")
    assert _cycles.osl_compile(str(source), str(compiled))
    material = bpy.data.materials.new("material")
    nodes = material.node_tree.nodes
    nodes.clear()
    script = nodes.new("ShaderNodeScript")
    script.mode = "EXTERNAL"
    script.filepath = str(compiled)
    surface = nodes.new("ShaderNodeOutputMaterial").inputs["Surface"]
    material.node_tree.links.new(script.outputs[0], surface)
    sphere.data.materials.clear()
    sphere.data.materials.append(material)


def set_light(scene, description):
    for lamp in list(bpy.data.lights):
        bpy.data.lights.remove(lamp)
    scene.world = bpy.data.worlds.new("world")
    background = scene.world.node_tree.nodes["Background"].inputs
    background["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    background["Strength"].default_value = description.get("environment", {}).get("radiance", 0.0)
    if "distant" in description:
        sun = bpy.data.lights.new("sun", "SUN")
        sun.angle, sun.energy = 0.0, description["distant"]["irradiance"]
        lamp = bpy.data.objects.new("sun", sun)
        lamp.rotation_mode = "QUATERNION"
        direction = Vector(description["distant"]["direction"])
        lamp.rotation_quaternion = direction.to_track_quat("Z", "Y")
        scene.collection.objects.link(lamp)


def main(folder, sources, samples):
    kit = json.loads((folder / "kit.json").read_text())
    scene, sphere = set_up(kit, folder)
    for number, picture in enumerate(kit["pictures"]):
        description = kit["scenes"][picture["scene"]]
        set_cycles(scene, samples if "environment" in description else 16)
        scene.cycles.seed = number
        set_material(sphere, sources / f"{picture['material']}.osl")
        set_light(scene, description)
        scene.render.filepath = str(folder / picture["file"])
        bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]))
    sys.stdout.flush()
    os._exit(0)  # skips Blender's slow shutdown
