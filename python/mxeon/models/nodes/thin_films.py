# SPDX-License-Identifier: Apache-2.0
"""Rows of pbrlib's microfacet nodes under a thin film, scatter mode R."""

from __future__ import annotations

from functools import partial

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.core.colorimetry import XYZ_TO_REC709
from mxeon.models.microfacet.defects import averaged_channels, averaged_fitted, fitted_half
from mxeon.models.microfacet.lobe import Lobe
from mxeon.models.microfacet.materialx_fits import compensation, layer_albedo
from mxeon.models.nodes.microfacets import (
    CONDUCTOR,
    DIELECTRIC,
    MICROFACET_NODES,
    SCHLICK,
    BareLobe,
    isotropic,
)
from mxeon.models.nodes.node import Inputs, PbrNode, Scattering, Variant
from mxeon.models.thin_film import (
    CIE_RGB,
    MATERIALX,
    TEXT,
    Form,
    film_conductor,
    film_dielectric,
    film_schlick,
)
from mxeon.models.thin_film.lobe import FILM, film_albedo_dir, film_brdf

FITTED = Lobe(fitted_half)  # MaterialX's compensation
AVERAGED = Lobe(averaged_fitted)  # that of MaterialX after 1.39.5
OWN_MATRIX = Form(tuple(map(tuple, XYZ_TO_REC709.tolist())))
STOCK = Form(
    CIE_RGB, 2, True, 1.0, 0.01
)  # MaterialX's choices, with all of a Schlick substrate's reflectance
MIXED = Form(mixed=True)
# Title, form, and whether the text leaves it open.
FORMS = (
    ("MaterialX's matrix, orders and mixed channels", STOCK, True),
    ("half of the substrate's reflectance, and MaterialX's choices", MATERIALX, False),
    ("MaterialX's matrix, of CIE RGB", Form(CIE_RGB), True),
    ("the text's matrix, without an adaptation to white", OWN_MATRIX, True),
    ("two orders", Form(orders=2), True),
    ("the index of RGB channel k in XYZ value k", MIXED, True),
)


def _value(
    category: str, form: Form, lobe: Lobe | None, wo: Array, wi: Array, inputs: Inputs
) -> Array:
    return film_brdf(category, wo, wi, inputs, form, lobe)


def _bare(inputs: Inputs) -> dict[str, Array]:
    """Inputs with a film of thickness 0."""
    return {**inputs, FILM[0]: np.zeros_like(inputs[FILM[0]])}


def _reflectance(category: str, form: Form, wo: Array, inputs: Inputs) -> Array:
    """F of a film at the view direction, (N, 3)."""
    mu = np.minimum(wo[:, 2], 1.0)
    thickness, index = (inputs[name] for name in FILM)
    if category == "dielectric_bsdf":
        return film_dielectric(mu, thickness, index, inputs["ior"], form)
    if category == "conductor_bsdf":
        return film_conductor(mu, thickness, index, inputs["ior"], inputs["extinction"], form)
    color0, color82, color90 = (inputs[name] for name in ("color0", "color82", "color90"))
    return film_schlick(mu, thickness, index, color0, color82, color90, inputs["exponent"], form)


def _environment(category: str, form: Form, wo: Array, inputs: Inputs) -> Array:
    """Albedo of MaterialX's environment branch: F of the film at the view in the compensation."""
    F = _reflectance(category, form, wo, inputs)
    single = film_albedo_dir(category, wo, isotropic(inputs), form, compensate=False)
    return np.asarray(single * compensation(wo, inputs, F))


def _fitted(lobe: BareLobe, form: Form, wo: Array, inputs: Inputs) -> Array:
    """Albedo of MaterialX's throughput: the bare lobe's fit, with F of the film at the view."""
    F0 = lobe.fresnel(np.ones(len(wo)), inputs)
    F90 = inputs[lobe.edge] if lobe.edge else 1.0
    albedo = layer_albedo(wo, inputs, F0, F90, _reflectance(lobe.category, form, wo, inputs))
    return averaged_channels(albedo) if lobe.edge else albedo


def _variants(row: PbrNode) -> tuple[Variant[Scattering], ...]:
    """Other films that a shader may have, each with either compensation."""
    variants: list[Variant[Scattering]] = [
        Variant("no film", lambda wo, wi, inputs: row.value(wo, wi, _bare(inputs))),
        Variant(
            "its albedo without the film", albedo=lambda wo, inputs: row.albedo(wo, _bare(inputs))
        ),
        Variant(
            "MaterialX's compensation",
            partial(_value, row.category, TEXT, FITTED),
            permitted=True,
        ),
    ]
    lobe = {each.category: each for each in (DIELECTRIC, CONDUCTOR, SCHLICK)}[row.category]
    schlick = lobe is SCHLICK
    for title, form, permitted in FORMS[: 2 if schlick else 1]:
        albedo = partial(_environment, row.category, form)
        variants.append(Variant(f"{title}, under an environment", None, albedo, permitted))
        fitted = partial(_fitted, lobe, form)
        words = "the bare lobe's fit, and the film in the compensation"
        variants.append(Variant(f"{title}: {words}", albedo=fitted))
    for title, form, permitted in FORMS:
        one = form == MIXED and row.category == "dielectric_bsdf"  # index of all channels
        if one or (form.share != 1.0 and not schlick):
            continue
        later = ((", and F averaged from F0 and F90", AVERAGED),) if form == STOCK else ()
        for words, terms in (("", None), (", and its compensation", FITTED), *later):
            value = partial(_value, row.category, form, terms)
            variants.append(Variant(f"{title}{words}", value, permitted=permitted))
    return tuple(variants)


def _filmed(row: PbrNode) -> PbrNode:
    """A row under a film."""

    def albedo(wo: Array, inputs: Inputs) -> Array:
        return film_albedo_dir(row.category, wo, isotropic(inputs))

    def integral(wo: Array, inputs: Inputs) -> Array:
        return film_albedo_dir(row.category, wo, inputs)

    return PbrNode(
        f"{row.name}_film",
        f"{row.title} under a thin film",
        row.category,
        (*row.inputs, *FILM),
        partial(_value, row.category, TEXT, None),
        albedo,
        integral,
        fixed=row.fixed,
        layerable=row.layerable,
        reciprocal=False,
        mirror=row.mirror,
        variants=_variants(row),
    )


FILM_NODES = tuple(map(_filmed, MICROFACET_NODES))
