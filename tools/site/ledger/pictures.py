# SPDX-License-Identifier: Apache-2.0
"""Draws the pictures of the ledger: `python -m tools.site.ledger.pictures`.

Each picture has three parts: a page's document rendered by gl with the installed MaterialX, the
same document with a repaired MaterialX, and the difference.
"""

import sys
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import MaterialX as mx
import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from mxeon.hosts import open_host
from mxeon.hosts.points import visible
from mxeon.io.srgb import srgb_encoded
from mxeon.shaders.nodes import SURFACE, Node, document_text, lobe_text, material_text, network_text
from mxeon.shaders.scene import SCENES
from tests.support.wheels import run
from tools.site.ledger import FOLDER, apply, linked, needed, patches

PICTURES = FOLDER / "pictures"
SIZE, LINE = 192, 4  # width of each part and of the line between parts, in pixels
QUALITY, BACKGROUND = 90, 30  # WebP quality, and sRGB value from 0 to 255
WHITE = {"color": (1.0, 1.0, 1.0)}
FUZZ = WHITE | {"roughness": 1.0, "mode": "zeltner"}
BASE = lobe_text("oren_nayar_diffuse_bsdf", WHITE, "base")
ROUGH = {"color": (0.8, 0.8, 0.8), "roughness": 1.0, "energy_compensation": True}
FILM = {
    "color0": (0.9, 0.9, 0.9),
    "roughness": (0.3, 0.3),
    "thinfilm_thickness": 550.0,
    "thinfilm_ior": 1.4,
}
LOBES = ("roughness_R", "roughness_TT", "roughness_TRT")
MULTIPLIED = {
    "top": Node("multiply", "BSDF", ("fuzz",)),
    "lobe": Node("layer", "BSDF", ("top", "base")),
}
ADDED = {
    "sum": Node("add", "BSDF", ("one", "two")),
    "half": Node("mix", "BSDF", ("sum", "nothing")),
    "lobe": Node("layer", "BSDF", ("half", "base")),
}


def hair(variance: float, scale: float) -> str:
    """A document with white hair in which all lobes have the same variance and scale."""
    inputs: dict[str, ArrayLike] = {"absorption_coefficient": (0.0, 0.0, 0.0)}
    return material_text("chiang_hair_bsdf", inputs | dict.fromkeys(LOBES, (variance, scale)))


def thin_wall(color: tuple[float, float, float]) -> str:
    inputs = (
        ("base_diffuse_roughness", "float", 1.0),
        ("specular_weight", "float", 0.0),
        ("subsurface_weight", "float", 1.0),
        ("subsurface_color", "color3", color),
        ("geometry_thin_walled", "boolean", True),
    )
    nodes = {"shading": Node("open_pbr_surface", "surfaceshader")}
    return document_text(network_text(nodes, inputs))


def layered(*nodes: str) -> str:
    return document_text("".join((BASE, *nodes)) + SURFACE)


# Scene and document for the picture of each page.
PAGES = {
    "genglsl_clamped_dot": ("back", material_text("oren_nayar_diffuse_bsdf", ROUGH)),
    "genglsl_film_half": ("side", material_text("generalized_schlick_bsdf", FILM)),
    "openpbr_thin_walled_tint": ("front", thin_wall((0.6, 0.4, 0.3))),
    "genglsl_transmission_masking": (
        "furnace",
        material_text("dielectric_bsdf", {"roughness": (0.8, 0.8), "scatter_mode": "RT"}),
    ),
    "genglsl_multiply_throughput": (
        "side",
        layered(
            lobe_text("sheen_bsdf", FUZZ, "fuzz"),
            network_text(MULTIPLIED, [("top/in2", "float", 0.0)]),
        ),
    ),
    "genglsl_translucent_side": (
        "side",
        material_text("translucent_bsdf", {"color": (0.4, 0.7, 0.2), "normal": (0.0, 0.0, -1.0)}),
    ),
    "genglsl_hair_uniform_lobe": ("side", hair(0.1, 0.3)),
    "genglsl_hair_roughness": ("side", hair(20.0, 5.0)),
    "openpbr_thin_walled": ("front", thin_wall((1.0, 1.0, 1.0))),
    "genglsl_add_throughput": (
        "furnace",
        layered(
            lobe_text("sheen_bsdf", FUZZ, "one"),
            lobe_text("sheen_bsdf", FUZZ, "two"),
            lobe_text("sheen_bsdf", {"weight": 0.0}, "nothing"),
            network_text(ADDED, [("half/mix", "float", 0.5)]),
        ),
    ),
}


def draw(folder: str, *pages: str) -> None:
    """Render pages' pictures with the MaterialX of this process, and save pictures as arrays."""
    scenes = {each.name: each for each in SCENES}
    with open_host("gl") as host:
        for page in pages:
            scene, document = PAGES[page]
            [shader] = host.compile(document, library="stock")
            image = host.picture(shader, replace(scenes[scene], size=SIZE))
            np.save(Path(folder, f"{page}.npy"), image)


def drawn(page: str, folder: Path, repair: bool) -> NDArray[np.float32]:
    """A page's picture with stock MaterialX, or with repaired MaterialX if `repair` is true."""
    package = linked(Path(mx.__file__).parent, folder / "MaterialX")
    if repair:
        names = needed(page)
        apply(package, *(path for each, path in patches("materialx").items() if each in names))
    done = run(folder, "draw", str(folder), page, module="tools.site.ledger.pictures")
    if done.returncode:
        raise RuntimeError(done.stderr)
    return np.asarray(np.load(folder / f"{page}.npy"))


def main() -> None:
    mask = visible(SIZE, "sphere").mask[..., None]
    for page, (scene, _) in PAGES.items():
        with TemporaryDirectory(prefix="mxeon-picture-") as base:
            stock, repaired = (
                drawn(page, Path(base, str(repair)), repair) for repair in (False, True)
            )
        change = np.where(mask, np.abs(stock - repaired), 0.0)
        # In a white environment, excess light is only visible at half the exposure.
        gain = 0.5 if scene == "furnace" else 1.0
        images = gain * stock, gain * repaired, change / change.max()
        a, b, c = (np.where(mask, srgb_encoded(each), np.uint8(BACKGROUND)) for each in images)
        line = np.full((SIZE, LINE, 3), 255, np.uint8)
        picture = np.hstack([a, line, b, line, c])
        Image.fromarray(picture).save(PICTURES / f"{page}.webp", quality=QUALITY, method=6)


if __name__ == "__main__":
    draw(*sys.argv[2:]) if sys.argv[1:2] == ["draw"] else main()
