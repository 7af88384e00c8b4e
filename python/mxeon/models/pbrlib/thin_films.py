# SPDX-License-Identifier: Apache-2.0
"""Rows of pbrlib's microfacet nodes under a thin film, scatter mode R."""

from functools import partial

import numpy as np

from mxeon.models.arrays import Array
from mxeon.models.colorimetry import XYZ_TO_REC709
from mxeon.models.microfacet_defects import fitted_half
from mxeon.models.microfacet_film import FILM, film_albedo_dir, film_brdf
from mxeon.models.microfacet_lobe import Lobe
from mxeon.models.pbrlib.microfacets import MICROFACET_NODES, isotropic
from mxeon.models.pbrlib.node import Inputs, PbrNode, Variant
from mxeon.models.thin_film_curve import CIE_RGB, MATERIALX, TEXT, Form

FITTED = Lobe(fitted_half)  # MaterialX's compensation
OWN_MATRIX = Form(tuple(map(tuple, XYZ_TO_REC709.tolist())))
STOCK = Form(
    CIE_RGB, 2, True, 1.0, 0.01
)  # MaterialX's choices, with all of a Schlick substrate's reflectance
# Title, form, and whether the text leaves it open.
FORMS = (
    ("MaterialX's matrix, orders and mixed channels", STOCK, True),
    ("half of the substrate's reflectance, and MaterialX's choices", MATERIALX, False),
    ("MaterialX's matrix, of CIE RGB", Form(CIE_RGB), True),
    ("the text's matrix, without an adaptation to white", OWN_MATRIX, True),
    ("two orders", Form(orders=2), True),
    ("the index of RGB channel k in XYZ value k", Form(mixed=True), True),
)


def _value(
    category: str, form: Form, lobe: Lobe | None, wo: Array, wi: Array, inputs: Inputs
) -> Array:
    return film_brdf(category, wo, wi, inputs, form, lobe)


def _bare(inputs: Inputs) -> dict[str, Array]:
    """Inputs with a film of thickness 0."""
    return {**inputs, FILM[0]: np.zeros_like(inputs[FILM[0]])}


def _no_film(row: PbrNode, wo: Array, wi: Array, inputs: Inputs) -> Array:
    return row.value(wo, wi, _bare(inputs))


def _variants(row: PbrNode) -> tuple[Variant, ...]:
    """Other films that a shader may have, each with either compensation."""
    variants = [
        Variant("no film", partial(_no_film, row)),
        Variant(
            "its albedo without the film", albedo=lambda wo, inputs: row.albedo(wo, _bare(inputs))
        ),
        Variant(
            "MaterialX's compensation",
            partial(_value, row.category, TEXT, FITTED),
            permitted=True,
        ),
    ]
    for title, form, permitted in FORMS:
        if form.share != 1.0 and row.category != "generalized_schlick_bsdf":
            continue
        for words, lobe in (("", None), (", and its compensation", FITTED)):
            value = partial(_value, row.category, form, lobe)
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
