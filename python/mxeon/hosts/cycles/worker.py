# SPDX-License-Identifier: Apache-2.0
"""Code of the hosts `cycles`, `osl` and `eevee` that runs in Blender's Python.

`mxeon.hosts.process` starts this script.
"""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import bpy  # the first import, because it makes Blender's other modules importable

# isort: split
import _cycles
import bmesh
import numpy as np
from mathutils import Vector

Blender: TypeAlias = Any  # an object of bpy, which has no types
JsonObject: TypeAlias = dict[str, Any]

# Script nodes determine sockets with the module `oslquery`, from Blender's own Python folder.
BUNDLED = Path(bpy.utils.resource_path("LOCAL"), "python", "lib")
sys.path.extend(str(folder) for folder in BUNDLED.glob("python*/site-packages"))


SUBDIVISIONS = 7  # results in 81,920 triangles with edges within 1e-4 of the sphere
KINDS = ("objects", "cameras", "meshes", "pointclouds", "materials", "lights", "worlds", "images")


def unit_scene(distance: float) -> Blender:
    """An empty scene with an orthographic camera at z = `distance` that sees [-1, 1]^2.

    The objects of earlier requests are removed one by one, because reloading Blender's settings
    would take as long as a picture.
    """
    bpy.data.batch_remove([each for kind in KINDS for each in getattr(bpy.data, kind)])
    scene = bpy.context.scene
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type = "ORTHO"
    camera.data.ortho_scale = 2.0
    camera.location.z = distance
    scene.collection.objects.link(camera)
    scene.camera = camera
    return scene


def set_output(scene: Blender, path: str, size: int) -> None:
    """Make `scene` render to a linear float32 RGB file with a black background."""
    render = scene.render
    render.filepath = path
    render.resolution_x = render.resolution_y = size
    render.film_transparent = True
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_mode = "RGB"
    render.image_settings.color_depth = "32"
    render.image_settings.exr_codec = "NONE"


def add_sphere(scene: Blender, radius: float, material: Blender) -> None:
    """Add an exact sphere with `material` around the origin, as a point cloud of one point."""
    mesh = bpy.data.meshes.new("sphere")
    mesh.from_pydata([(0.0, 0.0, 0.0)], [], [])
    sphere = bpy.data.objects.new("sphere", mesh)
    scene.collection.objects.link(sphere)
    sphere.select_set(True)
    bpy.context.view_layer.objects.active = sphere
    bpy.ops.object.convert(target="POINTCLOUD")
    points = bpy.context.view_layer.objects.active.data
    points.attributes.new("radius", "FLOAT", "POINT").data[0].value = radius
    points.materials.append(material)


def add_mesh(scene: Blender, radius: float, material: Blender) -> None:
    """Add a sphere of smooth triangles with `material` around the origin."""
    mesh, builder = bpy.data.meshes.new("sphere"), bmesh.new()
    bmesh.ops.create_icosphere(builder, subdivisions=SUBDIVISIONS, radius=radius)
    builder.to_mesh(mesh)
    builder.free()
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new("sphere", mesh))


def add_triangles(
    scene: Blender, points: Sequence[Any], triangles: Sequence[Any], material: Blender
) -> Blender:
    """Add an object of triangles with `material`, and return the object."""
    mesh = bpy.data.meshes.new("triangles")
    mesh.from_pydata(points, [], triangles)
    mesh.materials.append(material)
    added = bpy.data.objects.new("triangles", mesh)
    scene.collection.objects.link(added)
    return added


def add_lamp(scene: Blender, distance: float) -> None:
    """Add a point light at (-distance, 0, 0), with irradiance 1 at the origin."""
    lamp = bpy.data.lights.new("light", "POINT")
    lamp.shadow_soft_size = 0.0
    lamp.energy = 4.0 * math.pi * distance * distance
    light = bpy.data.objects.new("light", lamp)
    light.location.x = -distance
    scene.collection.objects.link(light)


def new_material(kind: str, inputs: JsonObject, shader: str = "") -> Blender:
    """A material whose surface is a node, or the output of a compiled OSL file."""
    material = bpy.data.materials.new("material")
    tree = material.node_tree
    tree.nodes.clear()
    node = tree.nodes.new(kind)
    if shader:
        node.mode = "EXTERNAL"
        node.filepath = shader
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    surface = tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"]
    tree.links.new(node.outputs[0], surface)
    return material


def add_light(scene: Blender, direction: tuple[float, float, float], shadow: bool = True) -> None:
    """Add a distant light of irradiance pi that shines from `direction`."""
    sun = bpy.data.lights.new("light", "SUN")
    sun.angle = 0.0
    sun.energy = math.pi
    sun.use_shadow = shadow
    light = bpy.data.objects.new("light", sun)
    light.rotation_mode = "QUATERNION"
    light.rotation_quaternion = Vector(direction).to_track_quat("Z", "Y")
    scene.collection.objects.link(light)


def add_environment(scene: Blender, radiance: float) -> None:
    world = bpy.data.worlds.new("environment")
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = radiance
    scene.world = world


def render(
    output: str,
    size: int,
    samples: int,
    bounces: int,
    radius: float,
    light: tuple[float, float, float] | None,
    environment: float | None,
    body: str,
    shader: str | None = None,
    native: JsonObject | None = None,
    width: float = 2.0,
    triangles: str | None = None,
    lamp: float | None = None,
) -> None:
    """Render the OSL file `shader`, or a Blender node, on a body or on the triangles in a file.

    Every sample is at the center of a pixel. The body is "points" (an exact sphere), "mesh" (a
    sphere of triangles) or "plane" (a triangle that fills the picture).
    """
    compiled = ""
    if shader:
        compiled = os.path.splitext(shader)[0] + ".oso"
        if not _cycles.osl_compile(shader, compiled):
            raise SyntaxError(shader)
    scene = unit_scene(2.0 * radius)
    set_output(scene, output, size)
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.shading_system = native is None  # whether to use OSL
    cycles.samples = samples
    cycles.use_adaptive_sampling = False
    cycles.light_sampling_threshold = 0.0
    cycles.use_denoising = False
    cycles.sample_clamp_indirect = 0.0
    cycles.max_bounces = bounces
    cycles.diffuse_bounces = cycles.glossy_bounces = bounces
    cycles.transmission_bounces = cycles.volume_bounces = bounces
    cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    cycles.filter_width = 0.01
    material = new_material(
        **(native or {"kind": "ShaderNodeScript", "inputs": {}}), shader=compiled
    )
    if triangles:
        scene.camera.data.ortho_scale = width
        scene.camera.data.clip_end = 2.0 * scene.camera.location.z
        points = np.load(triangles).reshape(-1, 3)
        rows = np.arange(len(points)).reshape(-1, 3)
        added = add_triangles(scene, points.tolist(), rows.tolist(), material)
        # The triangles neither shadow nor light each other.
        added.visible_diffuse = added.visible_glossy = added.visible_transmission = False
        added.visible_shadow = False
    elif body == "plane":
        corners = [(-3.0, -1.0, 0.0), (3.0, -1.0, 0.0), (0.0, 5.0, 0.0)]
        add_triangles(scene, corners, [(0, 1, 2)], material)
    else:
        (add_mesh if body == "mesh" else add_sphere)(scene, radius, material)
    if lamp:
        add_lamp(scene, lamp)
    if light:
        add_light(scene, light)
    if environment:
        add_environment(scene, environment)
    bpy.ops.render.render(write_still=True)


def draw(
    output: str,
    material: JsonObject,
    mesh: str,
    size: int,
    light: tuple[float, float, float] | None,
    environment: float | None,
    samples: int,
) -> None:
    """Render the mesh of a file in EEVEE, shaded by a node. Row 0 of the pixels is at the top."""
    path, data, scene = f"{output}.exr", np.load(mesh), unit_scene(2.0)
    set_output(scene, path, size)
    scene.render.engine = "BLENDER_EEVEE"
    scene.render.filter_size = 0.01
    scene.eevee.taa_render_samples = samples
    scene.eevee.use_shadows = scene.eevee.use_raytracing = False
    scene.eevee.light_threshold = 0.0
    kind = material.pop("kind")
    inputs = {k: (*v, 1.0) if isinstance(v, list) else v for k, v in material.items()}
    mesh_data = data["vertices"].tolist(), data["triangles"].tolist()
    add_triangles(scene, *mesh_data, new_material(kind, inputs))
    if light is not None:
        add_light(scene, light, shadow=False)
    add_environment(scene, environment or 0.0)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.zeros(4 * size * size, np.float32)
    image.pixels.foreach_get(pixels)
    np.save(output, pixels.reshape(size, size, 4)[::-1, :, :3])


def start() -> tuple[dict[str, str], Callable[..., None], tuple[type[Exception], ...]]:
    bpy.ops.wm.read_factory_settings(use_empty=True)

    def answer(**request: Any) -> None:
        draw(**request) if "mesh" in request else render(**request)

    return {"version": bpy.app.version_string}, answer, (SyntaxError,)
