# SPDX-License-Identifier: Apache-2.0
"""Write the files of the kit: documents, scenes, a mesh and a page of instructions."""

import json
import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from os import PathLike
from pathlib import Path
from string import Template
from typing import Any

import mxeon
from mxeon.errors import InputError
from mxeon.io.files import below, check_output, write_text
from mxeon.kit.scenes import Mesh, mesh_layer, scene_layer, to_obj, unit_sphere
from mxeon.kit.views import MATERIALS, USUAL, View, views
from mxeon.names import meant
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.document.references import files_read
from mxeon.shaders.library import load_library
from mxeon.shaders.nodes import FLAG, INPUT_TYPES, OREN_NAYAR, material_text
from mxeon.shaders.scene import Scene

KIT_FORMAT = 1
DESCRIPTION = "kit.json"
RENDERS = "renders"
README = "README.md"


@dataclass(frozen=True)
class KitNode:
    """The BSDF node of a kit's materials."""

    category: str = OREN_NAYAR
    definition: str = f"ND_{OREN_NAYAR}"  # nodedef
    flagged: bool = True  # whether the node has the input energy_compensation
    folders: tuple[str, ...] = ()  # library and folders with the node's definition


def kit_node(category: str, definitions: tuple[str, ...] = (), library: str = "eonlib") -> KitNode:
    """Find a BSDF node with color and roughness in MaterialX, in `library` or in `definitions`."""
    needed = {"color": "color3", "roughness": "float"}
    data = load_library(library, None, definitions)
    reason = ""
    for each in data.getMatchingNodeDefs(category):
        ports = {port.getName(): port.getType() for port in each.getActiveInputs()}
        missing = [name for name, kind in needed.items() if ports.get(name) != kind]
        if each.getType() == "BSDF" and not missing:
            flagged = ports.get(FLAG) == "boolean"
            return KitNode(category, each.getName(), flagged, (library, *definitions))
        reason = f", which lacks {' and '.join(missing)}" if missing else ", which is no BSDF"
    known = {each.getNodeString() for each in data.getNodeDefs() if each.getType() == "BSDF"}
    reason = reason or meant(category, known) or ": load its definition by --definitions FOLDER"
    raise InputError(
        "node must be a BSDF with the inputs color (color3) and roughness (float); "
        f"got {category!r}{reason}"
    )


def export_kit(folder: str | PathLike[str], size: int = USUAL, node: KitNode = KitNode()) -> Path:
    """Write the kit and return the path of README.md. Pictures in an earlier kit are kept.

    Raises InputError if the size is out of range, if the folder has no name or contains other files
    than a kit, or if a link has the name of a file of the kit.
    """
    read = files_read([], Policy(), node.folders).values()
    check_output(folder, read, replaced=["*", "*/*"], apart=True)
    is_kit = os.path.lexists(Path(folder, DESCRIPTION))
    if os.path.isdir(folder) and os.listdir(folder) and not is_kit:
        raise InputError(f"{folder}: must be new, empty or a kit; it holds other files")
    pictures, mesh = views(size), unit_sphere()
    numbers = description(pictures, size, node.category)
    texts = {
        "sphere.obj": to_obj(mesh),
        "sphere.usda": mesh_layer(mesh),
        DESCRIPTION: json.dumps(numbers, indent=1) + "\n",
        README: _page(pictures, size, mesh, node.category),
    }
    for each in MATERIALS:
        inputs: dict[str, Any] = {"color": each.color, "roughness": each.roughness}
        if node.flagged:
            inputs[FLAG] = each.energy_compensation
        text = material_text(node.category, inputs, each.name, INPUT_TYPES)
        texts[f"materials/{each.name}.mtlx"] = text
    for view in pictures:
        texts[f"scenes/{view.name}.usda"] = scene_layer(view, node.definition, node.flagged)
    paths = {below(folder, name): text for name, text in texts.items()}
    for path, text in paths.items():
        write_text(path, text)
    below(folder, RENDERS).mkdir(exist_ok=True)
    return Path(folder, README)


def description(pictures: Sequence[View], size: int, node: str) -> dict[str, Any]:
    """The content of kit.json.

    The number `format` increases when a key changes or is removed. A distant light has `direction`,
    the unit vector toward the light, and `irradiance`. An environment has `radiance`.
    """
    scenes = {view.scene.name: view.scene for view in pictures}
    return {
        "format": KIT_FORMAT,
        "mxeon": mxeon.__version__,
        "size": size,
        "camera": {
            "projection": "orthographic",
            "looks_along": [0, 0, -1],
            "up": [0, 1, 0],
            "frame": [[-1, -1], [1, 1]],
        },
        "sphere": {"center": [0, 0, 0], "radius": 1, "mesh": "sphere.obj"},
        "materials": {
            each.name: {
                "file": f"materials/{each.name}.mtlx",
                "node": node,
                "color": each.color,
                "roughness": each.roughness,
                "energy_compensation": each.energy_compensation,
            }
            for each in MATERIALS
        },
        "scenes": {
            name: {"environment": {"radiance": scene.environment}}
            if scene.light is None
            else {"distant": {"direction": scene.light, "irradiance": math.pi}}
            for name, scene in scenes.items()
        },
        "pictures": [
            {
                "material": view.material.name,
                "scene": view.scene.name,
                "file": f"{RENDERS}/{view.name}.exr",
            }
            for view in pictures
        ],
    }


def _page(pictures: Sequence[View], size: int, mesh: Mesh, node: str) -> str:
    text = files("mxeon.kit").joinpath("templates", "kit.md").read_text(encoding="utf-8")
    rows = [
        f"| `{RENDERS}/{view.name}.exr` | {view.material.name} | {view.scene.name} |"
        for view in pictures
    ]
    materials = [
        f"| {each.name} | {', '.join(map(str, each.color))} | {each.roughness} "
        f"| {str(each.energy_compensation).lower()} |"
        for each in MATERIALS
    ]
    scenes = {view.scene.name: view.scene for view in pictures}
    lights = [f"| {name} | {_light_in_words(scene)} |" for name, scene in scenes.items()]
    return Template(text).substitute(
        version=mxeon.__version__,
        size=size,
        count=len(pictures),
        pictures="\n".join(rows),
        materials="\n".join(materials),
        lights="\n".join(lights),
        triangles=len(mesh.triangles),
        depth=f"{mesh.depth:.1e}",
        node=node,
    )


def _light_in_words(scene: Scene) -> str:
    if scene.light is None:
        return f"uniform environment of radiance {scene.environment:g} on all sides"
    direction = ", ".join(f"{each:.6f}" for each in scene.light)
    return f"distant light of irradiance pi, without angular size, in direction ({direction})"
