# SPDX-License-Identifier: Apache-2.0
"""Sources on every page: models, wrong variants of models, and lobes of both libraries."""

from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import chain
from pathlib import Path

from mxeon.conformance import backends
from mxeon.conformance.case import Case, make_case
from mxeon.conformance.diagnosis import ALBEDO, INEXACT, VALUE
from mxeon.conformance.results import known_issues
from mxeon.conformance.specs.diffuse import DIFFUSE
from mxeon.conformance.specs.diffuse import VALUE as VALUE_ERROR
from mxeon.errors import NotRun
from mxeon.explorer.data import Models, ModelSource, ShaderSource
from mxeon.explorer.documents import LIBRARIES, checked_materials, path_texts, shader_source
from mxeon.explorer.references import reference_of
from mxeon.hosts import open_host
from mxeon.hosts.base import Inputs
from mxeon.jobs.signals import temporary_folder
from mxeon.models.table import DIFFUSE_MODELS, KNOWN_DEFECTS, diffuse_model
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import (
    FLAG,
    OREN_NAYAR,
    document_text,
    input_types,
    material_text,
    node_text,
)

ROUGH: Inputs = {"roughness": (0.5, 0.5)}
REFLECTS: Inputs = {"scatter_mode": "R"}
FILM: Inputs = {"thinfilm_thickness": 420.0, "thinfilm_ior": 1.4}
COPPER: Inputs = {"ior": (0.216, 0.905, 1.137), "extinction": (3.67, 2.59, 2.43), **ROUGH}
BRONZE: Inputs = {"color0": (0.85, 0.55, 0.25), "color82": (0.9, 0.8, 0.7), **ROUGH}
GLASS: Inputs = {"ior": 1.5, **REFLECTS, **ROUGH}
VELVET: Inputs = {"color": (0.75, 0.12, 0.2), "roughness": 0.4}
LACQUER = """    <input name="base_color" type="color3" value="0.55, 0.12, 0.08" />
    <input name="base_diffuse_roughness" type="float" value="0.8" />
    <input name="specular_roughness" type="float" value="0.5" />
    <input name="coat_weight" type="float" value="0.5" />
    <input name="coat_roughness" type="float" value="0.3" />
    <input name="fuzz_weight" type="float" value="0.4" />
    <input name="fuzz_color" type="color3" value="0.9, 0.75, 0.6" />
"""


@dataclass(frozen=True)
class ComparedMaterial:
    key: str  # name of the material in addresses of the page
    title: str
    text: str  # a MaterialX document
    subjects: tuple[str, ...]  # titles of the material's nodes in checks

    @property
    def pages(self) -> tuple[str, ...]:
        """Names of pages on defects of this material in MaterialX's GLSL."""
        pages = [
            issue.page
            for issue in known_issues.issues().values()
            if "webgl" in issue.hosts
            and issue.library == "stock"
            and {subject for _, subject in (*issue.rows, *issue.implied)} & set(self.subjects)
        ]
        return tuple(dict.fromkeys(pages))


def _lobe(key: str, title: str, category: str, inputs: Inputs, *modes: str) -> ComparedMaterial:
    """A material with one BSDF node. Checks identify the node by category and modes."""
    text = material_text(category, inputs, types=input_types(category))
    subjects = tuple(f"{category}, {mode}" for mode in modes) or (category,)
    return ComparedMaterial(key, title, text, subjects)


DIFFUSE_INPUTS: Inputs = {"color": (0.8, 0.4, 0.1), "roughness": 1.0, FLAG: True}
HAIR: Inputs = {
    "absorption_coefficient": (0.25, 0.6, 1.4),
    **dict.fromkeys(("roughness_R", "roughness_TT", "roughness_TRT"), (0.1, 0.3)),
}
SHEEN, DIELECTRIC_BSDF, CONDUCTOR_BSDF = "sheen_bsdf", "dielectric_bsdf", "conductor_bsdf"
SCHLICK_BSDF, FILMED = "generalized_schlick_bsdf", "thin film"
CONTY_KULLA, ZELTNER = ({**VELVET, "mode": mode} for mode in ("conty_kulla", "zeltner"))
MATERIALS = (
    _lobe("shader", "Rough diffuse", OREN_NAYAR, DIFFUSE_INPUTS, f"{FLAG} true", f"{FLAG} false"),
    _lobe("lobe/sheen", "Sheen, Conty-Kulla", SHEEN, CONTY_KULLA, "mode conty_kulla"),
    _lobe("lobe/sheen_zeltner", "Sheen, Zeltner", SHEEN, ZELTNER, "mode zeltner"),
    _lobe("lobe/dielectric", "Dielectric", DIELECTRIC_BSDF, GLASS, "scatter_mode R"),
    _lobe("lobe/conductor", "Conductor", CONDUCTOR_BSDF, COPPER),
    _lobe("lobe/schlick", "Schlick", SCHLICK_BSDF, {**BRONZE, **REFLECTS}, "scatter_mode R"),
    _lobe("lobe/film_dielectric", "Film on dielectric", DIELECTRIC_BSDF, {**GLASS, **FILM}, FILMED),
    _lobe("lobe/film_conductor", "Film on conductor", CONDUCTOR_BSDF, {**COPPER, **FILM}, FILMED),
    _lobe(
        "lobe/film_schlick", "Film on Schlick", SCHLICK_BSDF, {**BRONZE, **FILM, **REFLECTS}, FILMED
    ),
    _lobe("lobe/hair", "Hair", "chiang_hair_bsdf", HAIR),
    ComparedMaterial(
        "lobe/openpbr",
        "OpenPBR",
        document_text(node_text("open_pbr_surface", "surfaceshader", "shading", LACQUER)),
        ("open_pbr_surface, every lobe",),
    ),
)


@lru_cache
def measured_models(library: str, node: str) -> Models | None:
    """The models nearest to a node on the host gl, with energy_compensation on and off.

    None if gl does not run here, or if no known model is close.
    """
    try:
        with open_host("gl") as host:
            names = [
                _nearest(make_case(backends.Evaluating, host, spec, library))
                for spec in DIFFUSE
                if spec.node == node
            ]
    except NotRun:
        return None
    return Models(names[0], names[-1]) if all(names) else None


def _nearest(case: Case) -> str:
    """Name of the model with the nearest values. Among models of equal BRDF, compare albedos."""
    rows = {row.title: row for row in KNOWN_DEFECTS + DIFFUSE_MODELS}
    value, albedo = (
        min(diagnosis.distances.items(), key=lambda item: item[1], default=("", float("inf")))
        for diagnosis in (VALUE.diagnose(case), ALBEDO.diagnose(case))
    )
    if value[1] > INEXACT * VALUE_ERROR.value:
        return ""
    same = albedo[0] and rows[albedo[0]].brdf_of == rows[value[0]].brdf_of
    return rows[albedo[0] if same else value[0]].name


GENERATED = "Generated shaders"
FAMILY = "Models, eonlib's functions"
VARIANTS = "What renderers do instead"

# The first models on the page. A rough diffuse node has one of the first two models.
FIRST = ("eon", "qon", "fon", "lambert")

# Renderers with a wrong model: title, actual and intended model, and page of docs/upstream.
RENDERERS = (
    (f"MaterialX GLSL, {FLAG} true", "eon_clamped", "eon", "genglsl_clamped_dot"),
    (
        f"MaterialX GLSL, {FLAG} false, in an environment",
        "qon_fitted",
        "qon",
        "genglsl_qon_albedo_fit",
    ),
    (f"MaterialX OSL, {FLAG} true", "qon", "eon", "genosl_dropped_flag"),
    (f"MaterialX MDL, {FLAG} true", "fon_white_lobe", "eon", "genmdl_white_lobe"),
    (f"Blender Cycles, {FLAG} true", "eon_rho_cubed", "eon", "cycles_rho_cubed"),
    (f"Blender Cycles, {FLAG} false", "eon_rho_cubed", "qon", "cycles_rho_cubed"),
    ("OpenPBR, thin-walled", "qon_tinted_twice", "eon", "openpbr_thin_walled_tint"),
    ("OpenPBR, thin-walled, tint repaired", "qon", "eon", "openpbr_thin_walled"),
)


def node_sources() -> tuple[ShaderSource, ...]:
    """Sources of all MATERIALS, with eonlib and with stock MaterialX."""
    return tuple(chain.from_iterable(map(_material_sources, MATERIALS)))


@lru_cache
def _material_sources(material: ComparedMaterial) -> tuple[ShaderSource, ...]:
    """Sources of a material with eonlib and with stock MaterialX."""
    shaders = {
        library: generate(material.text, "essl", library=library, lights=True)[0]
        for library in LIBRARIES
    }
    reference = reference_of(shaders["eonlib"])
    [paths] = path_texts(material.text).values()
    # Only references of single lobes have permitted forms. `mxeon check` judges other materials.
    several = reference and not reference.forms and OREN_NAYAR not in material.text
    judged = LIBRARIES if several else ()
    with temporary_folder("mxeon-explore-") as folder:
        file = Path(folder, "material.mtlx")
        file.write_text(material.text, encoding="utf-8")
        checked = {name: [*checked_materials(str(file), name).values()] for name in judged}
    return tuple(
        replace(
            shader_source(
                shader,
                material.text,
                f"{material.key}/{library}",
                f"{material.title}, {'stock MaterialX' if library == 'stock' else library}",
                GENERATED,
                library,
            ),
            reference=reference,
            checked=next(iter(checked.get(library, ())), None),
            pages=material.pages if library == "stock" else (),
            paths=paths if library == "eonlib" else "",
        )
        for library, shader in shaders.items()
    )


def model_sources() -> tuple[ModelSource, ...]:
    """Sources of the models, and of the variants that renderers implement instead of the models."""
    names = [*FIRST, *(row.name for row in DIFFUSE_MODELS if row.name not in FIRST)]
    family = (
        ModelSource(f"model/{name}", diffuse_model(name).title, FAMILY, name, name)
        for name in names
    )
    variants = (
        ModelSource(
            f"variant/{page}/{position}",
            f"{title}: {diffuse_model(name).title}",
            VARIANTS,
            name,
            meant,
            pages=(page,),
        )
        for position, (title, name, meant, page) in enumerate(RENDERERS)
    )
    return (*family, *variants)
