# SPDX-License-Identifier: Apache-2.0
"""All models, each as a `ShadingModel` with a name.

The inputs of a `ShadingModel` have MaterialX's names, order, units and defaults. The arguments of
the functions in `mxeon.models` may differ from MaterialX's inputs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from mxeon.models import coat, sampling, table
from mxeon.models.core.arguments import checked_choice, checked_directions, checked_sphere
from mxeon.models.core.arrays import Array, array_namespace, cosine, library, root
from mxeon.models.microfacet.fresnel import least_ior
from mxeon.models.nodes import PBR_NODES
from mxeon.models.nodes.lobes import HAIR_NODE, SUBSURFACE_NODE, hair_integral
from mxeon.models.nodes.microfacets import FILM_NODES, TRANSMISSION_NODES, TRANSMISSIONS
from mxeon.models.nodes.node import Inputs, Parameter, PbrNode, parameter
from mxeon.models.shading_model import ModelSampler, ShadingModel


def _cosine_sample(wo: Array, u: Array, inputs: Inputs) -> tuple[Array, Array]:
    checked_directions("wo", wo)
    return sampling.cosine_sample(u)


def _cosine_pdf(wo: Array, wi: Array, inputs: Inputs) -> Array:
    checked_directions("wo", wo)
    return sampling.cosine_pdf(wi)


def _back_sample(wo: Array, u: Array, inputs: Inputs) -> tuple[Array, Array]:
    wi, pdf = _cosine_sample(wo, u, inputs)
    return _mirrored(wi), pdf


def _sphere_sample(wo: Array, u: Array, inputs: Inputs) -> tuple[Array, Array]:
    u1, u2 = sampling.unpack_uniforms(u)
    wi = sampling.around(1.0 - 2.0 * u1, 2.0 * root(u1 * (1.0 - u1)), u2)
    return wi, _sphere_pdf(wo, wi, inputs)


def _sphere_pdf(wo: Array, wi: Array, inputs: Inputs) -> Array:
    checked_sphere("wo", wo)
    return 0.25 / np.pi + 0.0 * checked_sphere("wi", wi)[..., 0]


def _mirrored(w: Array) -> Array:
    return array_namespace(w).stack([w[..., 0], w[..., 1], -w[..., 2]], axis=-1)


COSINE = ModelSampler(_cosine_sample, _cosine_pdf)
BACK = ModelSampler(_back_sample, lambda wo, wi, i: _cosine_pdf(wo, _mirrored(wi), i), side=-1.0)
EON = ModelSampler(
    lambda wo, u, i: sampling.eon_sample(wo, u, i["roughness"], rho=i["color"].mean(axis=-1)),
    lambda wo, wi, i: sampling.eon_pdf(wo, wi, i["roughness"], rho=i["color"].mean(axis=-1)),
)
ZELTNER = ModelSampler(
    lambda wo, u, i: sampling.zeltner_sample(wo, u, i["roughness"]),
    lambda wo, wi, i: sampling.zeltner_pdf(wo, wi, i["roughness"]),
)
GGX = ModelSampler(
    lambda wo, u, i: sampling.ggx_sample(wo, u, i["roughness"]),
    lambda wo, wi, i: sampling.ggx_pdf(wo, wi, i["roughness"]),
    side=None,
)
SPHERE = ModelSampler(_sphere_sample, _sphere_pdf, side=None)
FACETS = ("dielectric", "conductor", "schlick")
# For each name of a model, a sampler. All other models have the sampler COSINE.
SAMPLERS = {
    "translucent": BACK,
    "hair": SPHERE,
    "eon": EON,
    "zeltner": ZELTNER,
    **dict.fromkeys((*FACETS, *(f"{name}_film" for name in FACETS)), GGX),
}

# For each node category, the name of the model that implements the node's default mode.
NODES_BY_CATEGORY = {
    "oren_nayar_diffuse_bsdf": "qon",
    "eon_diffuse_bsdf": "eon",
    "generalized_schlick": "schlick",
    # Rows are read in reverse order, so that a node's first mode overwrites the node's other modes.
    **{row.category: row.name for row in reversed((*PBR_NODES, SUBSURFACE_NODE, HAIR_NODE))},
}

# Other names of models. Messages about an unknown name use these names to suggest a model.
ALSO = {
    **dict.fromkeys(("dielectric", "conductor", "schlick"), "ggx"),
    "burley": "disney",
    "conty_kulla": "charlie imageworks",
}


def model(name: str) -> ShadingModel:
    """The model with this name, such as a rough diffuse model or a node of pbrlib.

    - `name`: One of `model_names()`, such as "eon", "dielectric" or "zeltner". The category of a
      node, such as "conductor_bsdf", selects the node's default mode.

    Raises `ValueError`, which suggests similar names, if the name is unknown.

        >>> gold = model("conductor")
        >>> gold
        conductor: conductor microfacets; brdf, bsdf, albedo_dir, sample, pdf
          ior = (0.183, 0.421, 1.373), in [0, 1e50]
          extinction = (3.424, 2.346, 1.77), in [0, 1e50]
          roughness = (0.05, 0.05), in [0, 1]
        >>> gold.brdf([0.6, 0.0, 0.8], [-0.6, 0.0, 0.8], roughness=0.3).round(4)
        array([1.4723, 1.1829, 0.5437])
    """
    titles = {each.name: f"{each.title} {ALSO.get(each.name, '')}" for each in MODELS.values()}
    checked_choice("model", name, (*MODELS, *NODES_BY_CATEGORY), titles, "mxeon.model_names()")
    return MODELS[NODES_BY_CATEGORY.get(name, name)]


def model_names() -> tuple[str, ...]:
    """Names accepted by `model`.

    >>> model_names()[:2]
    ('lambert', 'oren_nayar')
    """
    return tuple(MODELS)


def _inputs(row: PbrNode) -> tuple[Parameter, ...]:
    return tuple(parameter(row.category, name) for name in row.inputs)


def _scattering_model(row: PbrNode) -> ShadingModel:
    lights = "all sides" if row.name == HAIR_NODE.name else "back" if row.transmits else "front"
    sampler = SAMPLERS.get(row.name, COSINE)
    return ShadingModel(row, row.parameters or _inputs(row), sampler, lights)


def _transmission_model(row: PbrNode) -> ShadingModel:
    """The model of a node in scatter mode T or RT; the BTDF is for radiance, not for importance."""
    passing, mode = TRANSMISSIONS[row.category], row.fixed["scatter_mode"]
    reflected = row.integral or row.albedo

    def value(wo: Array, wi: Array, inputs: Inputs) -> Array:
        if mode == "T":
            return passing.value(wo, wi, inputs)
        xp, (x, y, z) = array_namespace(wi), (wi[:, 0], wi[:, 1], wi[:, 2])
        back = passing.value(wo, xp.stack([x, y, -xp.abs(z)], axis=1), inputs)
        front = row.value(wo, xp.stack([x, y, xp.abs(z)], axis=1), inputs)
        return xp.where(z[:, np.newaxis] < 0.0, back, front)

    def albedo(wo: Array, inputs: Inputs) -> Array:
        # The interface divides radiance by ior^2. The integral of the BTDF is therefore the
        # transmitted fraction of the energy, times 1 / ior^2.
        ior = passing.ior(inputs)[:, np.newaxis]
        ior = array_namespace(ior).maximum(ior, least_ior(ior))
        passed: Array = passing.passed(wo, inputs, True) / ior**2
        return passed if mode == "T" else passed + reflected(wo, inputs)

    title = f"{row.title}, scatter mode {mode}"
    return ShadingModel(
        replace(row, title=title, value=value, albedo=albedo, integral=None),
        _inputs(row),
        lights="back" if mode == "T" else "all sides",
    )


def _coated_model(name: str, title: str) -> ShadingModel:
    """Model of a rough interface over EON. The roughness of the interface is `alpha`."""
    inputs = (
        parameter("oren_nayar_diffuse_bsdf", "color", "rho"),
        parameter("oren_nayar_diffuse_bsdf", "roughness"),
        Parameter("alpha", 0.05, "coat_alpha"),
        Parameter("ior", 1.5, "coat_ior"),
    )
    functions = ("brdf", "albedo_dir", "albedo_avg", "sample", "pdf")
    brdf, albedo_dir, albedo_avg, sample, pdf = (getattr(coat, f"{name}_{f}") for f in functions)
    row = PbrNode(
        name,
        title,
        "layer_bsdf",
        tuple(each.name for each in inputs),
        lambda wo, wi, i: _per_coat(brdf, i, wo, wi),
        lambda wo, i: _per_coat(albedo_dir, i, cosine(wo[:, 2])),
        average=lambda i: _per_coat(albedo_avg, i),
    )
    sampler = ModelSampler(
        lambda wo, u, i: _per_coat(sample, i, wo, u),
        lambda wo, wi, i: _per_coat(pdf, i, wo, wi),
        side=None,
    )
    return ShadingModel(row, inputs, sampler)


def _per_coat(function: Callable[..., Any], inputs: Inputs, *vectors: Array) -> Any:
    """Call a function of `mxeon.models.coat` once for each pair of alpha and ior."""
    # For arrays of libraries other than NumPy, `function` requires a single alpha and a single ior.
    *others, alpha, ior = (*vectors, *inputs.values())
    if len(alpha) == len(ior) == 1 or library(alpha) or library(ior):
        return function(*others, *(each[0] if len(each) == 1 else each for each in (alpha, ior)))
    pairs = np.stack(np.broadcast_arrays(alpha, ior), axis=-1)
    if not vectors:  # each coat has its own average albedo
        others = [np.broadcast_to(each, (len(pairs), *each.shape[1:])) for each in others]
    coats, which = np.unique(pairs, axis=0, return_inverse=True)
    rows = [np.flatnonzero(which.reshape(-1) == k) for k in range(len(coats))]
    order = np.argsort(np.concatenate(rows))
    parts = [
        function(*(each if len(each) == 1 else each[chosen] for each in others), *coat)
        for chosen, coat in zip(rows, coats, strict=True)
    ]
    if isinstance(parts[0], tuple):
        return tuple(np.concatenate(each)[order] for each in zip(*parts, strict=True))
    return np.concatenate(parts)[order]


MODELS = {
    each.name: each
    for each in (
        *map(_scattering_model, table.DIFFUSE_MODELS + table.KNOWN_DEFECTS),
        *map(_scattering_model, table.OTHERS + table.PARAMETRIZATIONS),
        _coated_model("dielectric_over_eon", "dielectric over EON"),
        _coated_model("varnished", "EON under a varnish"),
        *map(_scattering_model, (*PBR_NODES, *FILM_NODES, SUBSURFACE_NODE)),
        _scattering_model(replace(HAIR_NODE, albedo=hair_integral)),
        *map(_transmission_model, TRANSMISSION_NODES),
    )
}
