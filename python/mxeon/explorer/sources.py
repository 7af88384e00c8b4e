# SPDX-License-Identifier: Apache-2.0
"""The materials of every page: the models, the renderers' variants, and lobes of both libraries."""

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from itertools import chain

from mxeon.conformance.results import FAILED, Result
from mxeon.explorer.data import ModelSource, ShaderSource
from mxeon.explorer.documents import LIBRARIES, shader_source
from mxeon.explorer.lobes import MATERIALS, ComparedMaterial
from mxeon.explorer.references import reference_of
from mxeon.models.table import KNOWN_DEFECTS, MODELS, model
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import FLAG

NODES = "Generated shaders"
FAMILY = "Models, eonlib's functions"
VARIANTS = "What renderers do instead"
RUN = "What the run found"

# The order in which models are offered: the two that the node can be come first.
FIRST = ("eon", "qon", "fon", "lambert")

# Renderers that do not have the model they should: title, the model they have, the one meant, and
# the page of docs/upstream that shows it.
RENDERERS = (
    ("MaterialX GLSL, flag on", "eon_clamped", "eon", "genglsl_clamped_dot"),
    ("MaterialX GLSL, flag off, in surroundings", "qon_fitted", "qon", "genglsl_qon_albedo_fit"),
    ("MaterialX OSL, flag on", "qon", "eon", "genosl_dropped_flag"),
    ("MaterialX MDL, flag on", "fon_white_lobe", "eon", "genmdl_white_lobe"),
    ("Blender Cycles, flag on", "eon_rho_cubed", "eon", "cycles_rho_cubed"),
    ("Blender Cycles, flag off", "eon_rho_cubed", "qon", "cycles_rho_cubed"),
    ("OpenPBR, thin-walled", "qon_tinted_twice", "eon", "openpbr_thin_walled_tint"),
    ("OpenPBR, thin-walled, tint repaired", "qon", "eon", "openpbr_thin_walled"),
)


def node_sources() -> tuple[ShaderSource, ...]:
    """Each of MATERIALS with eonlib and with stock MaterialX."""
    return tuple(chain.from_iterable(map(_material_sources, MATERIALS)))


@lru_cache
def _material_sources(material: ComparedMaterial) -> tuple[ShaderSource, ...]:
    """A material of every page with both libraries, and the pages on what stock's does wrong."""
    shaders = {
        library: generate(material.text, "essl", library=library, lights=True)[0]
        for library in LIBRARIES
    }
    reference = reference_of(shaders["eonlib"])
    return tuple(
        replace(
            shader_source(
                shader,
                material.text,
                f"{material.key}/{library}",
                f"{material.title}, {'stock MaterialX' if library == 'stock' else library}",
                NODES,
                library,
            ),
            reference=reference,
            pages=material.pages if library == "stock" else (),
        )
        for library, shader in shaders.items()
    )


def model_sources() -> tuple[ModelSource, ...]:
    """Every model of the family, and every renderer's variant."""
    names = [*FIRST, *(row.name for row in MODELS if row.name not in FIRST)]
    family = (ModelSource(f"model/{name}", model(name).title, FAMILY, name, name) for name in names)
    variants = (
        ModelSource(
            f"variant/{page}/{position}",
            f"{title}: {model(name).title}",
            VARIANTS,
            name,
            meant,
            pages=(page,),
        )
        for position, (title, name, meant, page) in enumerate(RENDERERS)
    )
    return (*family, *variants)


def run_sources(results: Iterable[Result]) -> tuple[ModelSource, ...]:
    """The model nearest to each failure of a run that a diagnosis explains."""
    names = {row.title: row.name for row in KNOWN_DEFECTS + MODELS}
    sources: dict[tuple[str, str, str], ModelSource] = {}
    for result in results:
        key = (result.host, result.library, result.subject)
        known = {title: far for title, far in result.distances.items() if title in names}
        if result.verdict != FAILED or not known or key in sources:
            continue
        name = names[min(known, key=known.__getitem__)]
        sources[key] = ModelSource(
            f"run/{len(sources)}",
            f"{result.location}, {result.subject}: {model(name).title}",
            RUN,
            name,
            _meant(result.subject, name),
            result.explanation,
        )
    return tuple(sources.values())


def _meant(subject: str, name: str) -> str:
    """The model that a subject of a run should be; the diagnosed one where it says nothing of it."""
    if FLAG in subject:
        return "eon" if f"{FLAG} true" in subject else "qon"
    return {"eon_clamped": "eon", "eon_rho_cubed": "eon", "fon_white_lobe": "eon"}.get(name, name)
