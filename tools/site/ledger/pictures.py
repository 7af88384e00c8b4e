# SPDX-License-Identifier: Apache-2.0
"""Draw the pictures of the ledger: `python -m tools.site.ledger.pictures`.

Each shows a page's document on gl with the installed MaterialX, with the page's patch and its
prerequisites, and the difference of both.
"""

import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import MaterialX as mx
import numpy as np
from PIL import Image

from mxeon.hosts import open_host
from mxeon.hosts.points import visible
from mxeon.io.srgb import srgb_encoded
from mxeon.shaders.nodes import SURFACE, document_text, input_text, lobe_text, node_text
from mxeon.shaders.scene import SCENES
from tests.support.wheels import run
from tools.site.ledger import FOLDER, apply, linked, measured, needed, patches, write_measured

PICTURES = FOLDER / "pictures"
SIZE, QUALITY, BACKGROUND, LINE = 192, 90, 30, 4
WHITE = {"color": (1.0, 1.0, 1.0)}
BASE = lobe_text("oren_nayar_diffuse_bsdf", WHITE, "base")


def _operator(category: str, name: str, **inputs: str) -> str:
    """XML of a BSDF node with inputs that are node names or numbers."""
    text = "".join(
        input_text(each, "float", value)
        if value[0].isdigit()
        else f'    <input name="{each}" type="BSDF" nodename="{value}" />\n'
        for each, value in inputs.items()
    )
    return node_text(category, "BSDF", name, text)


def _lobe(category: str, inputs: Mapping[str, Any]) -> str:
    return document_text(lobe_text(category, inputs) + SURFACE)


def _surface(category: str, inputs: Mapping[str, tuple[str, Any]]) -> str:
    text = "".join(input_text(name, kind, value) for name, (kind, value) in inputs.items())
    return document_text(node_text(category, "surfaceshader", "shading", text))


def _layered(*nodes: str) -> str:
    return document_text("".join((BASE, *nodes)) + SURFACE)


ROUGH = {"color": (0.8, 0.8, 0.8), "roughness": 1.0, "energy_compensation": True}
FILM = {
    "color0": (0.9, 0.9, 0.9),
    "roughness": (0.3, 0.3),
    "thinfilm_thickness": 550.0,
    "thinfilm_ior": 1.4,
}
GLASS = {"roughness": (0.8, 0.8), "scatter_mode": "RT"}
THIN = {
    "base_diffuse_roughness": ("float", 1.0),
    "specular_weight": ("float", 0.0),
    "subsurface_weight": ("float", 1.0),
    "subsurface_color": ("color3", (0.6, 0.4, 0.3)),
    "geometry_thin_walled": ("boolean", True),
}
SHEEN: dict[str, Any] = {"color": (0.8, 0.1, 0.1), "roughness": 0.5, "mode": "zeltner"}
FUZZ: dict[str, Any] = {"color": (1.0, 1.0, 1.0), "roughness": 1.0, "mode": "zeltner"}
LEAF = {"color": (0.4, 0.7, 0.2), "normal": (0.0, 0.0, -1.0)}
LOBES = ("roughness_R", "roughness_TT", "roughness_TRT")


def _hair(variance: float, scale: float) -> str:
    """White hair with the same variance and scale for all lobes."""
    clear = {"absorption_coefficient": (0.0, 0.0, 0.0)}
    return _lobe("chiang_hair_bsdf", {**dict.fromkeys(LOBES, (variance, scale)), **clear})


# The scene and the document of each page's picture; the page describes them in words.
PAGES = {
    "genglsl_clamped_dot": ("back", _lobe("oren_nayar_diffuse_bsdf", ROUGH)),
    "genglsl_film_half": (
        "side",
        _lobe("generalized_schlick_bsdf", FILM),
    ),
    "openpbr_thin_walled_tint": (
        "front",
        _surface("open_pbr_surface", THIN),
    ),
    "genglsl_transmission_masking": ("furnace", _lobe("dielectric_bsdf", GLASS)),
    "genglsl_multiply_throughput": (
        "side",
        _layered(
            lobe_text("sheen_bsdf", FUZZ, "fuzz"),
            _operator("multiply", "top", in1="fuzz", in2="0.0"),
            _operator("layer", "lobe", top="top", base="base"),
        ),
    ),
    "genglsl_translucent_side": (
        "side",
        _lobe("translucent_bsdf", LEAF),
    ),
    "genglsl_hair_uniform_lobe": ("side", _hair(0.1, 0.3)),
    "genglsl_hair_roughness": ("side", _hair(20.0, 5.0)),
    "openpbr_thin_walled": (
        "front",
        _surface("open_pbr_surface", {**THIN, "subsurface_color": ("color3", (1.0, 1.0, 1.0))}),
    ),
    "genglsl_add_throughput": (
        "furnace",
        _layered(
            lobe_text("sheen_bsdf", FUZZ, "one"),
            lobe_text("sheen_bsdf", FUZZ, "two"),
            lobe_text("sheen_bsdf", {"weight": 0.0}, "nothing"),
            _operator("add", "sum", in1="one", in2="two"),
            _operator("mix", "half", fg="sum", bg="nothing", mix="0.5"),
            _operator("layer", "lobe", top="half", base="base"),
        ),
    ),
}


def draw(folder: str, *pages: str) -> None:
    """Write pictures with the MaterialX of this process: an array for each page."""
    scenes = {each.name: each for each in SCENES}
    with open_host("gl") as host:
        for page in pages:
            scene, document = PAGES[page]
            [shader] = host.compile(document, library="stock")
            image = host.picture(shader, replace(scenes[scene], size=SIZE))
            np.save(Path(folder, f"{page}.npy"), image)


def measure(page: str) -> dict[str, str]:
    """Write a page's picture (stock, repaired and difference), and return its measurements."""
    with TemporaryDirectory(prefix="mxeon-picture-") as base:
        stock, own = (_drawn(page, Path(base, name), name == "own") for name in ("stock", "own"))
    # Only compare pixels on the sphere.
    mask = visible(SIZE, "sphere").mask
    apart = np.where(mask[..., None], np.abs(stock - own), 0.0)
    # Show white surroundings as gray, so that excess light is visible.
    gain = 0.5 if PAGES[page][0] == "furnace" else 1.0
    codes = [srgb_encoded(each) for each in (gain * stock, gain * own, apart / apart.max())]
    codes = [np.where(mask[..., None], each, np.uint8(BACKGROUND)) for each in codes]
    line = np.full((SIZE, LINE, 3), 255, np.uint8)
    picture = np.hstack([codes[0], line, codes[1], line, codes[2]])
    Image.fromarray(picture).save(PICTURES / f"{page}.webp", quality=QUALITY, method=6)
    figures = {"mean": apart[mask].mean(), "of": own[mask].mean(), "most": apart.max()}
    return {name: f"{value:.2g}" for name, value in figures.items()}


def _drawn(page: str, folder: Path, repair: bool) -> np.typing.NDArray[np.float32]:
    """A page's picture with MaterialX, or with the page's patch and its prerequisites."""
    package = linked(Path(mx.__file__).parent, folder / "MaterialX")
    if repair:
        names = needed(page)
        apply(package, *(path for each, path in patches("materialx").items() if each in names))
    done = run(folder, "draw", str(folder), page, module="tools.site.ledger.pictures")
    if done.returncode:
        raise RuntimeError(done.stderr)
    return np.asarray(np.load(folder / f"{page}.npy"))


def main() -> None:
    """Draw the pictures, and write their measurements."""
    found = measured()
    for page in PAGES:
        found[page] = found.get(page, {}) | {"picture": measure(page)}
    write_measured(found)


if __name__ == "__main__":
    draw(*sys.argv[2:]) if sys.argv[1:2] == ["draw"] else main()
