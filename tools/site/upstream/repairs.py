# SPDX-License-Identifier: Apache-2.0
"""Changes of upstream files: the smallest repairs of renderers from npm, and copies with them."""

import os
import shutil
from dataclasses import dataclass
from pathlib import Path

from mxeon.errors import NotRun
from mxeon.hosts.browser import packages_folder


@dataclass(frozen=True)
class Repair:
    """A change of one file of a package.

    Attributes
    ----------
    page : str
        The page on the defect.
    package, file : str
        Name of the package, and path inside it.
    old, new : str
        Text of the file, and what takes its place wherever it occurs.
    """

    page: str
    package: str
    file: str
    old: str
    new: str


MATERIALX = "MaterialX"
THREE, BABYLON = "three", "@babylonjs/core"
MAPPINGS = "examples/jsm/loaders/materialx/MaterialXSurfaceMappings.js"
COLOR = "\tmaterial.colorNode = mul( inputs.base_weight, inputs.base_color );\n"
LOADED = (
    "\tif ( isMeaningfulNode( inputs.base_diffuse_roughness ) ) "
    "material.diffuseRoughnessNode = inputs.base_diffuse_roughness;\n"
)

# Share of the light of uniform surroundings that EON reflects, over that of Lambert.
SHARE = """
#if BASE_DIFFUSE_MODEL==BRDF_DIFFUSE_MODEL_EON && !defined(USE_IRRADIANCE_DOMINANT_DIRECTION) && !defined(REALTIME_FILTERING)
{{{float} single=E_FON_approx(clamp(dot({normal},viewDirectionW),0.0,1.0),diffuseRoughness);\
{float} average=(1.0+constant2_FON*diffuseRoughness)/(1.0+constant1_FON*diffuseRoughness);\
environmentIrradiance*=single+surfaceAlbedo*average*(1.0-single)/(vec3{f}(1.0)-surfaceAlbedo*(1.0-average));}}
#endif
"""
GLSL, WGSL = {"float": "float", "f": ""}, {"float": "let", "f": "f"}


def _surroundings(file: str, text: str, rest: str, words: dict[str, str]) -> Repair:
    """EON in surroundings, after the line that scales the irradiance."""
    added = SHARE.format(**words).replace("\\\n", "")
    return Repair("babylon_flat_surroundings", BABYLON, file, text + rest, text + added + rest)


PBR, OPEN_PBR = "ShadersInclude/pbrBlockReflection.js", "ShadersInclude/openpbrIblFunctions.js"
DIRECT = "ShadersInclude/pbrDirectLightingFunctions.js"
SCALED, END = "environmentIrradiance*=vReflectionInfos.x;", "return environmentIrradiance;}"
COLORED = "environmentIrradiance*=vReflectionColor.rgb*vReflectionInfos.x;"
FACED, FLAT = {"normal": "surfaceNormal"}, {"normal": "normalW"}
THREE_REPAIRS = (
    Repair("three_materialx_roughness", THREE, MAPPINGS, COLOR, COLOR + LOADED),
    Repair(
        "three_materialx_roughness",
        THREE,
        MAPPINGS,
        "\t'base_color',\n\t'specular_weight',\n",
        "\t'base_color',\n\t'base_diffuse_roughness',\n\t'specular_weight',\n",
    ),
)
REPAIRS = (
    *THREE_REPAIRS,
    Repair(
        "babylon_reflectance_floor",
        BABYLON,
        f"Shaders/{DIRECT}",
        "clamp(info.surfaceAlbedo,vec3(0.1),",
        "clamp(info.surfaceAlbedo,vec3(0.0001),",
    ),
    Repair(
        "babylon_reflectance_floor",
        BABYLON,
        f"ShadersWGSL/{DIRECT}",
        "clamp(info.surfaceAlbedo,vec3f(0.1),",
        "clamp(info.surfaceAlbedo,vec3f(0.0001),",
    ),
    _surroundings(f"Shaders/{PBR}", COLORED, "", GLSL | FLAT),
    _surroundings(f"ShadersWGSL/{PBR}", COLORED, "", WGSL | FLAT),
    _surroundings(f"Shaders/{OPEN_PBR}", SCALED, END, GLSL | FACED),
    _surroundings(
        f"ShadersWGSL/{OPEN_PBR}",
        "environmentIrradiance*=reflectionInfos.x;",
        END,
        WGSL | FACED,
    ),
)

PATHTRACER, SHADER = "three-gpu-pathtracer", "src/shader"
PATHTRACER_REPAIRS = (
    Repair(
        "pathtracer_webgl_retro",
        PATHTRACER,
        f"{SHADER}/bsdf/bsdf_functions.glsl.js",
        "float rr = 0.5 + 2.0 * surf.roughness * fl * fl;",
        "float rr = 2.0 * surf.roughness * dot( wi, wh ) * dot( wi, wh );",
    ),
    Repair(
        "pathtracer_webgl_nan",
        PATHTRACER,
        f"{SHADER}/common/fresnel_functions.glsl.js",
        "float sinThetaISq = 1.0f - cosThetaI * cosThetaI;",
        "float sinThetaISq = max( 0.0, 1.0f - cosThetaI * cosThetaI );",
    ),
    Repair(
        "pathtracer_webgl_nan",
        PATHTRACER,
        f"{SHADER}/common/fresnel_functions.glsl.js",
        "float sinTheta = sqrt( 1.0 - cosTheta * cosTheta );",
        "float sinTheta = sqrt( max( 0.0, 1.0 - cosTheta * cosTheta ) );",
    ),
)


# Blender's kernel, whose sources lie in its module.
CYCLES_REPAIRS = (
    Repair(
        "cycles_rho_cubed",
        "cycles",
        "closure/bsdf_oren_nayar.h",
        "M_1_PI_F * sqr(albedo) *",
        "M_1_PI_F * albedo *",
    ),
)


def kernel() -> Path:
    """Folder of the sources of Cycles' kernel in Blender's module.

    Raises
    ------
    NotRun
        If it is not installed beside this checkout.
    """
    beside = Path(__file__).parents[3] / ".venv-cycles"
    folder = "lib/*/site-packages/bpy/*/scripts/addons_core/cycles/source/kernel"
    found = list(beside.glob(folder))
    if not found:
        raise NotRun(f"no folder {beside / folder}")
    return found[0]


def library(page: str, file: str, old: str, new: str) -> Repair:
    """A change of a file of MaterialX's data library."""
    return Repair(page, MATERIALX, f"libraries/{file}", old, new)


def glsl(page: str, file: str, old: str, new: str) -> Repair:
    """A change of a file of pbrlib's GLSL."""
    return library(page, f"pbrlib/genglsl/{file}", old, new)


def copied(package: str, folder: Path) -> Path:
    """A node_modules in a folder whose package is a tree of links to the installed one."""
    installed = packages_folder() / "node_modules" / package
    ignored = shutil.ignore_patterns("*.d.ts", "*.map")
    target = folder / "node_modules" / package
    shutil.copytree(installed, target, copy_function=os.symlink, ignore=ignored)
    return folder / "node_modules"


def repair(modules: Path, change: Repair) -> None:
    """Apply a change to a copy.

    Raises
    ------
    ValueError
        If the file does not hold the old text.
    """
    path = modules / change.package / change.file
    text = path.read_text(encoding="utf-8")
    if change.old not in text:
        raise ValueError(f"{change.file} must hold {change.old!r}")
    path.unlink()  # a link to the installed file
    path.write_text(text.replace(change.old, change.new), encoding="utf-8")
