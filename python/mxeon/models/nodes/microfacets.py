# SPDX-License-Identifier: Apache-2.0
"""Rows of pbrlib's microfacet nodes, with and without a thin film, for each scatter mode.

A rasterizer has no light behind the surface and looks up an environment map instead. So for a
transmitting node, only the fraction and the direction of the transmitted light can be compared.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from mxeon.models import thin_film, transmission
from mxeon.models.core.arrays import Array, library
from mxeon.models.core.colorimetry import XYZ_TO_REC709
from mxeon.models.microfacet import CATEGORIES, Lobe, defects, node_albedo, node_brdf, uncompensated
from mxeon.models.microfacet.defects import UNCOMPENSATED, averaged_channels, layer_albedo
from mxeon.models.microfacet.fresnel import fresnel_conductor, fresnel_dielectric, fresnel_schlick
from mxeon.models.nodes.node import BLACK, WHITE, Inputs, PbrNode, Scattering, Variant, white
from mxeon.models.thin_film import FILM, Form, film_albedo_dir

# Names of permitted deviations. The specification does not define the form of the energy
# compensation. Since July 2026, an implementation note mentions MaterialX's masking of anisotropic
# facets.
OPEN = [
    f"compensation_{each}" for each in ["half", "f0", "view", "fitted", "average", "average_fitted"]
]
# Permitted deviations that only lobes with two different alphas reveal.
ANISOTROPIC = ["smith_mean", "smith_mean_fitted", "smith_mean_average"]
REFLECTION, NONE = {"scatter_mode": "R"}, dict[str, str]()


@dataclass(frozen=True)
class MicrofacetLobe:
    """Values and albedos of a microfacet node, under a thin film if the inputs include a film."""

    category: str
    fresnel: Callable[[Array, Inputs], Array]  # Fresnel reflectance F(mu, inputs)
    edge: str = ""  # input for F at grazing incidence; "" if this F is always 1

    def value(self, wo: Array, wi: Array, inputs: Inputs, terms: Lobe | None = None) -> Array:
        """BRDF of the node. If `terms` replace the specification's terms, a film is ignored."""
        if terms is None and _has_film(inputs):
            return thin_film.film_brdf(self.category, wo, wi, inputs)
        return node_brdf(self.category, wo, wi, inputs, terms)

    def albedo(self, wo: Array, inputs: Inputs, compensate: bool = True) -> Array:
        function = film_albedo_dir if _has_film(inputs) else node_albedo
        return function(self.category, wo, inputs, compensate=compensate)

    def ends(self, wo: Array, inputs: Inputs) -> tuple[Array, Array | float]:
        """Fresnel reflectance at normal incidence and at grazing incidence."""
        return self.fresnel(np.ones(len(wo)), inputs), inputs[self.edge] if self.edge else 1.0

    def fitted(self, wo: Array, inputs: Inputs) -> Array:
        """Albedo per channel, by the fit that MaterialX uses for the throughput."""
        fit = layer_albedo(wo, inputs, *self.ends(wo, inputs), self._at_view(wo, inputs))
        return np.asarray(fit * inputs.get("tint", np.ones(3)))

    def prefiltered(self, wo: Array, inputs: Inputs) -> Array:
        """Albedo by MaterialX's fit for prefiltered environments, with exact compensation."""
        whole, single = (self.albedo(wo, isotropic(inputs), each) for each in (True, False))
        ratio = np.divide(whole, single, out=np.ones(single.shape), where=single > 0.0)
        fit = layer_albedo(wo, inputs, *self.ends(wo, inputs), np.zeros(3))
        return np.asarray(fit * ratio * inputs.get("tint", np.ones(3)))

    def indirect(self, wo: Array, inputs: Inputs) -> Array:
        """Albedo whose compensation uses F(mu_o), as in MaterialX's indirect light."""
        return self._compensated(wo, inputs, self._at_view(wo, inputs))

    def averaged(self, wo: Array, inputs: Inputs) -> Array:
        """Albedo whose compensation averages F from F0 and F90, as in MaterialX after 1.39.5."""
        return self._compensated(wo, inputs, defects.schlick_average(*self.ends(wo, inputs)))

    def _compensated(self, wo: Array, inputs: Inputs, F: Array) -> Array:
        single = self.albedo(wo, isotropic(inputs), compensate=False)
        return np.asarray(single * defects.fitted_compensation(wo, inputs, F))

    def _at_view(self, wo: Array, inputs: Inputs) -> Array:
        return self.fresnel(np.minimum(wo[:, 2], 1.0), inputs)


def isotropic(inputs: Inputs) -> dict[str, Array]:
    """Inputs with both roughnesses replaced by the geometric mean of the roughnesses."""
    mean = np.sqrt(inputs["roughness"].prod(axis=-1, keepdims=True))
    return {**inputs, "roughness": np.repeat(mean, 2, axis=-1)}


def undipped(inputs: Inputs) -> dict[str, Array]:
    """Inputs with color82 = 1, which removes the dip of the Fresnel curve at 82 degrees."""
    return {**inputs, "color82": np.ones((1, 3))}


def _schlick(inputs: Inputs) -> tuple[Array, Array, Array]:
    return inputs["color0"], inputs["color82"], inputs["color90"]


def _has_film(inputs: Inputs) -> bool:
    thickness = inputs.get("thinfilm_thickness", np.zeros(1))
    return bool(library(thickness) or np.any(thickness))


DIELECTRIC_LOBE = MicrofacetLobe(
    "dielectric_bsdf", lambda mu, i: fresnel_dielectric(mu, i["ior"])[:, np.newaxis]
)
CONDUCTOR_LOBE = MicrofacetLobe(
    "conductor_bsdf", lambda mu, i: fresnel_conductor(mu, i["ior"], i["extinction"])
)
SCHLICK_LOBE = MicrofacetLobe(
    "generalized_schlick_bsdf",
    lambda mu, i: fresnel_schlick(mu, *_schlick(i), i["exponent"]),
    edge="color90",
)

LOBES = {each.category: each for each in (DIELECTRIC_LOBE, CONDUCTOR_LOBE, SCHLICK_LOBE)}


def _row(
    name: str,
    title: str,
    lobe: MicrofacetLobe,
    *variants: Variant[Scattering],
    fixed: Mapping[str, str] = NONE,
    mirror: dict[str, ArrayLike],
) -> PbrNode:
    """Row of a node. A node can be layered over other nodes if `fixed` selects a scatter mode."""
    _, colors, numbers = CATEGORIES[lobe.category]
    known = (
        Variant(
            each.title,
            partial(lobe.value, terms=each.lobe),
            partial(lobe.albedo, compensate=False) if each.name == "no_compensation" else None,
            permitted=each.name in (*OPEN, *ANISOTROPIC),
            anisotropic=each.name in ANISOTROPIC,
        )
        for each in (*defects.MICROFACET_DEFECTS, *defects.FITTED_DEFECTS)
    )
    return PbrNode(
        name,
        title,
        lobe.category,
        (*colors, *numbers, "roughness"),
        lobe.value,
        lobe.albedo,
        lobe.albedo,
        fixed=fixed,
        layerable=bool(fixed),
        reciprocal=False,
        mirror=mirror,
        variants=(
            *known,
            Variant(
                "compensation with F at the view direction and MaterialX's fit of E_ss",
                albedo=lobe.indirect,
                permitted=True,
            ),
            Variant(
                "compensation with the average F0 + (F90 - F0) / 21 and MaterialX's fit of E_ss",
                albedo=lobe.averaged,
                permitted=True,
            ),
            Variant("MaterialX's fit of its albedo", albedo=lobe.fitted),
            *variants,
        ),
    )


MICROFACET_NODES = (
    _row(
        "dielectric",
        "dielectric microfacets",
        DIELECTRIC_LOBE,
        fixed=REFLECTION,
        mirror={"ior": 0.0, "tint": WHITE},
    ),
    _row("conductor", "conductor microfacets", CONDUCTOR_LOBE, mirror={"ior": BLACK}),
    _row(
        "schlick",
        "generalized Schlick microfacets",
        SCHLICK_LOBE,
        Variant(
            "color82 counts as 1",
            lambda wo, wi, inputs: SCHLICK_LOBE.value(wo, wi, undipped(inputs)),
            lambda wo, inputs: SCHLICK_LOBE.albedo(wo, undipped(inputs)),
        ),
        Variant(
            "its albedo, averaged over the channels",
            albedo=lambda wo, inputs: averaged_channels(SCHLICK_LOBE.albedo(wo, inputs)),
        ),
        Variant(
            "MaterialX's fit of its albedo, averaged over the channels",
            albedo=lambda wo, inputs: averaged_channels(SCHLICK_LOBE.fitted(wo, inputs)),
        ),
        fixed=REFLECTION,
        mirror=dict.fromkeys(("color0", "color82", "color90"), WHITE),
    ),
)


OWN_MATRIX = Form(tuple(map(tuple, XYZ_TO_REC709.tolist())))
STOCK = Form(
    thin_film.CIE_RGB, 2, True, 1.0, 0.01
)  # MaterialX's choices, but with the full reflectance of a Schlick substrate
MIXED = Form(mixed=True)
# Forms of the thin-film model. A row has a title, a form, and whether the form is permitted.
FORMS = (
    ("MaterialX's matrix, orders and mixed channels", STOCK, True),
    ("half of the substrate's reflectance, and MaterialX's choices", thin_film.MATERIALX, False),
    ("MaterialX's matrix, of CIE RGB", Form(thin_film.CIE_RGB), True),
    ("the text's matrix, without an adaptation to white", OWN_MATRIX, True),
    ("two orders", Form(orders=2), True),
    ("the index of RGB channel k in XYZ value k", MIXED, True),
)


def _bare(inputs: Inputs) -> dict[str, Array]:
    """Inputs with a film thickness of 0, which removes the film."""
    return {**inputs, FILM[0]: np.zeros_like(inputs[FILM[0]])}


def _environment(category: str, form: Form, averaged: bool, wo: Array, inputs: Inputs) -> Array:
    """Albedo in MaterialX's environment, compensated with F(mu_o) or with an average F."""
    mu = np.ones(len(wo)) if averaged else np.minimum(wo[:, 2], 1.0)
    F = thin_film.film_reflectance(category, mu, inputs, form)
    F = defects.schlick_average(F, 1.0) if averaged else F
    single = film_albedo_dir(category, wo, isotropic(inputs), form, compensate=False)
    return np.asarray(single * defects.fitted_compensation(wo, inputs, F))


def _fitted(lobe: MicrofacetLobe, form: Form, wo: Array, inputs: Inputs) -> Array:
    """MaterialX's albedo in the throughput. Only the compensation factor depends on the film."""
    F = thin_film.film_reflectance(lobe.category, np.minimum(wo[:, 2], 1.0), inputs, form)
    albedo = layer_albedo(wo, inputs, *lobe.ends(wo, inputs), F)
    return averaged_channels(albedo) if lobe.edge else albedo


def _film_variants(row: PbrNode) -> tuple[Variant[Scattering], ...]:
    """Variants with the thin-film models of shaders and several forms of energy compensation."""
    variants: list[Variant[Scattering]] = [
        Variant("no film", lambda wo, wi, inputs: row.value(wo, wi, _bare(inputs))),
        Variant(
            "its albedo without the film", albedo=lambda wo, inputs: row.albedo(wo, _bare(inputs))
        ),
        Variant(
            UNCOMPENSATED,
            partial(thin_film.film_brdf, row.category, lobe=Lobe(uncompensated)),
            partial(film_albedo_dir, row.category, compensate=False),
        ),
        Variant(
            "MaterialX's compensation",
            partial(thin_film.film_brdf, row.category, lobe=Lobe(defects.FITTED.factor)),
            permitted=True,
        ),
    ]
    lobe = LOBES[row.category]
    schlick = lobe is SCHLICK_LOBE
    for title, form, permitted in FORMS[: 2 if schlick else 1]:
        for averaged, words in ((False, ""), (True, ", with F averaged from F0 and F90")):
            albedo = partial(_environment, row.category, form, averaged)
            name = f"{title}{words}, under an environment"
            variants.append(Variant(name, None, albedo, permitted))
        fitted = partial(_fitted, lobe, form)
        words = "the bare lobe's fit, and the film in the compensation"
        variants.append(Variant(f"{title}: {words}", albedo=fitted))
    for title, form, permitted in FORMS:
        one = form == MIXED and row.category == "dielectric_bsdf"  # the channels are equal
        if one or (form.share != 1.0 and not schlick):
            continue
        lobes: list[tuple[str, Lobe | None, bool]] = [(title, None, False)]
        later = ((", with F averaged from F0 and F90", defects.AVERAGED),) if form == STOCK else ()
        for words, terms in ((", with MaterialX's compensation", defects.FITTED), *later):
            lobes.append((f"{title}{words}", Lobe(terms.factor), False))
            if form in (STOCK, thin_film.MATERIALX):
                lobes.append((f"{defects.MEAN_ALPHA}, and {title}{words}", terms, True))
        for name, lobe_terms, anisotropic in lobes:
            value = partial(thin_film.film_brdf, row.category, form=form, lobe=lobe_terms)
            variants.append(Variant(name, value, permitted=permitted, anisotropic=anisotropic))
    return tuple(variants)


def _filmed(row: PbrNode) -> PbrNode:
    return replace(
        row,
        name=f"{row.name}_film",
        title=f"{row.title} under a thin film",
        inputs=(*row.inputs, *FILM),
        value=partial(thin_film.film_brdf, row.category),
        albedo=partial(film_albedo_dir, row.category),
        integral=partial(film_albedo_dir, row.category),
        variants=_film_variants(row),
    )


FILM_NODES = tuple(map(_filmed, MICROFACET_NODES))


MODES = ("T", "RT")


@dataclass(frozen=True)
class Transmission:
    """Functions that evaluate a transmitting node for given inputs.

    - `passed`: Fraction of the light from wo that the BTDF transmits, tint included. If the third
      argument, `shadow`, is false, the fraction is the mean of 1 - F over the visible facets.
    - `reflected`: Directional albedo of the reflection, with compensation and without tint.
    """

    value: Callable[[Array, Array, Inputs], Array]  # BTDF for radiance, tint included
    passed: Callable[[Array, Inputs, bool], Array]
    reflected: Callable[[Array, Inputs], Array]
    tint: Callable[[Inputs], Array]
    fresnel: Callable[[Array, Inputs], Array]
    ior: Callable[[Inputs], Array]  # index of refraction of the surface


TRANSMISSIONS = {
    DIELECTRIC_LOBE.category: Transmission(
        lambda wo, wi, i: transmission.dielectric_btdf(wo, wi, i["tint"], i["roughness"], i["ior"]),
        lambda wo, i, shadow: transmission.dielectric_transmittance_dir(
            wo, i["tint"], i["roughness"], i["ior"], shadow
        ),
        lambda wo, i: DIELECTRIC_LOBE.albedo(wo, white(i)),
        lambda i: i["tint"],
        DIELECTRIC_LOBE.fresnel,
        lambda i: i["ior"],
    ),
    SCHLICK_LOBE.category: Transmission(
        lambda wo, wi, i: transmission.generalized_schlick_btdf(
            wo, wi, *_schlick(i), i["roughness"], i["exponent"]
        ),
        lambda wo, i, shadow: transmission.generalized_schlick_transmittance_dir(
            wo, *_schlick(i), i["roughness"], i["exponent"], shadow=shadow
        ),
        SCHLICK_LOBE.albedo,
        lambda i: 0.0 * i["color0"] + 1.0,
        SCHLICK_LOBE.fresnel,
        lambda i: transmission.schlick_ior(i["color0"])[..., 0],
    ),
}


TRANSMISSION_NODES = tuple(
    replace(row, name=f"{row.name}_{mode.lower()}", fixed={"scatter_mode": mode})
    for row in MICROFACET_NODES
    if row.category in TRANSMISSIONS
    for mode in MODES
)
