# SPDX-License-Identifier: Apache-2.0
"""Rows of pbrlib's microfacet nodes, scatter mode R.

Their functions have a thin film where the inputs have `thinfilm_thickness` and `thinfilm_ior`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.core.namespaces import library
from mxeon.models.microfacet import conductor_brdf, dielectric_brdf, generalized_schlick_brdf
from mxeon.models.microfacet.albedo import (
    conductor_albedo_dir,
    dielectric_albedo_dir,
    generalized_schlick_albedo_dir,
)
from mxeon.models.microfacet.defects import (
    FITTED_DEFECTS,
    MICROFACET_DEFECTS,
    averaged_channels,
    schlick_average,
)
from mxeon.models.microfacet.fresnel import fresnel_conductor, fresnel_dielectric, fresnel_schlick
from mxeon.models.microfacet.materialx_fits import compensation, layer_albedo
from mxeon.models.nodes.node import Inputs, PbrNode, Scattering, Variant
from mxeon.models.thin_film.lobe import film_albedo_dir, film_brdf

# Forms of the energy compensation, which the text leaves open.
OPEN = (
    "compensation_half",
    "compensation_f0",
    "compensation_view",
    "compensation_fitted",
    "compensation_average",
    "compensation_average_fitted",
)
WHITE, BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class BareLobe:
    """Functions of a microfacet node by its inputs."""

    category: str
    value: Callable[[Array, Array, Inputs], Array]
    albedo: Callable[..., Array]
    fresnel: Callable[[Array, Inputs], Array]  # its curve F
    edge: str = ""  # name of the input that is F at grazing; "" where F is 1 there

    def fitted(self, wo: Array, inputs: Inputs) -> Array:
        """Albedo as MaterialX's throughput takes it, per channel and without a tint."""
        F0 = self.fresnel(np.ones(len(wo)), inputs)
        F90 = inputs[self.edge] if self.edge else 1.0
        return layer_albedo(wo, inputs, F0, F90, self._at_view(wo, inputs))

    def indirect(self, wo: Array, inputs: Inputs) -> Array:
        """Albedo with the compensation of MaterialX's indirect branch: F at the view direction."""
        return self._compensated(wo, inputs, self._at_view(wo, inputs))

    def averaged(self, wo: Array, inputs: Inputs) -> Array:
        """The same with the average of F by its ends, as in MaterialX after 1.39.5."""
        F0 = self.fresnel(np.ones(len(wo)), inputs)
        average = schlick_average(F0, inputs[self.edge] if self.edge else 1.0)
        return self._compensated(wo, inputs, average)

    def _compensated(self, wo: Array, inputs: Inputs, F: Array) -> Array:
        single = self.albedo(wo, isotropic(inputs), compensate=False)
        return np.asarray(single * compensation(wo, inputs, F))

    def _at_view(self, wo: Array, inputs: Inputs) -> Array:
        return self.fresnel(np.minimum(wo[:, 2], 1.0), inputs)


def isotropic(inputs: Inputs) -> dict[str, Array]:
    """Inputs with the geometric mean of the roughness in both directions."""
    mean = np.sqrt(inputs["roughness"].prod(axis=-1, keepdims=True))
    return {**inputs, "roughness": np.repeat(mean, 2, axis=-1)}


def white(inputs: Inputs) -> dict[str, Array]:
    """Inputs without the tint."""
    return {**inputs, "tint": np.ones(3)}


def undipped(inputs: Inputs) -> dict[str, Array]:
    """Inputs without a dip at 82 degrees."""
    return {**inputs, "color82": np.ones((1, 3))}


def _schlick(inputs: Inputs) -> tuple[Array, Array, Array]:
    return inputs["color0"], inputs["color82"], inputs["color90"]


def _has_film(inputs: Inputs) -> bool:
    thickness = inputs.get("thinfilm_thickness", np.zeros(1))
    return bool(library(thickness) or np.any(thickness))


def _filmed_value(
    category: str, bare: Callable[[Array, Array, Inputs], Array]
) -> Callable[[Array, Array, Inputs], Array]:
    """Values of a node, under a thin film where its inputs have one."""

    def value(wo: Array, wi: Array, inputs: Inputs) -> Array:
        film = _has_film(inputs)
        return film_brdf(category, wo, wi, inputs) if film else bare(wo, wi, inputs)

    return value


def _filmed_albedo(category: str, bare: Callable[..., Array]) -> Callable[..., Array]:
    """Albedo of a node, under a thin film where its inputs have one."""

    def albedo(wo: Array, inputs: Inputs, compensate: bool = True) -> Array:
        if _has_film(inputs):
            return film_albedo_dir(category, wo, inputs, compensate=compensate)
        return bare(wo, inputs, compensate=compensate)

    return albedo


DIELECTRIC = BareLobe(
    "dielectric_bsdf",
    _filmed_value(
        "dielectric_bsdf",
        lambda wo, wi, i: dielectric_brdf(wo, wi, i["tint"], i["roughness"], i["ior"]),
    ),
    _filmed_albedo(
        "dielectric_bsdf",
        lambda wo, i, **how: dielectric_albedo_dir(wo, i["tint"], i["roughness"], i["ior"], **how),
    ),
    lambda mu, i: fresnel_dielectric(mu, i["ior"])[:, np.newaxis],
)
CONDUCTOR = BareLobe(
    "conductor_bsdf",
    _filmed_value(
        "conductor_bsdf",
        lambda wo, wi, i: conductor_brdf(wo, wi, i["roughness"], i["ior"], i["extinction"]),
    ),
    _filmed_albedo(
        "conductor_bsdf",
        lambda wo, i, **how: conductor_albedo_dir(
            wo, i["roughness"], i["ior"], i["extinction"], **how
        ),
    ),
    lambda mu, i: fresnel_conductor(mu, i["ior"], i["extinction"]),
)
SCHLICK = BareLobe(
    "generalized_schlick_bsdf",
    _filmed_value(
        "generalized_schlick_bsdf",
        lambda wo, wi, i: generalized_schlick_brdf(
            wo, wi, *_schlick(i), i["roughness"], i["exponent"]
        ),
    ),
    _filmed_albedo(
        "generalized_schlick_bsdf",
        lambda wo, i, **how: generalized_schlick_albedo_dir(
            wo, *_schlick(i), i["roughness"], i["exponent"], **how
        ),
    ),
    lambda mu, i: fresnel_schlick(mu, *_schlick(i), i["exponent"]),
    edge="color90",
)


def _variants(lobe: BareLobe) -> tuple[Variant[Scattering], ...]:
    """Functions that a shader may have instead of a microfacet node's own."""
    values = (
        Variant(
            each.title,
            partial(each.value, lobe.category),
            permitted=each.name in OPEN,
        )
        for each in (*MICROFACET_DEFECTS, *FITTED_DEFECTS)
    )
    return (
        *values,
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
        Variant("MaterialX's fit of its albedo without a tint", albedo=lobe.fitted),
    )


MICROFACET_NODES = (
    PbrNode(
        "dielectric",
        "dielectric microfacets",
        DIELECTRIC.category,
        ("tint", "ior", "roughness"),
        DIELECTRIC.value,
        lambda wo, inputs: DIELECTRIC.albedo(wo, isotropic(inputs)),
        DIELECTRIC.albedo,
        fixed={"scatter_mode": "R"},
        layerable=True,
        reciprocal=False,
        mirror={"ior": 0.0, "tint": WHITE},
        variants=(
            *_variants(DIELECTRIC),
            Variant(
                "its albedo without the tint",
                albedo=lambda wo, inputs: DIELECTRIC.albedo(wo, isotropic(white(inputs))),
            ),
        ),
    ),
    PbrNode(
        "conductor",
        "conductor microfacets",
        CONDUCTOR.category,
        ("ior", "extinction", "roughness"),
        CONDUCTOR.value,
        lambda wo, inputs: CONDUCTOR.albedo(wo, isotropic(inputs)),
        CONDUCTOR.albedo,
        reciprocal=False,
        mirror={"ior": BLACK},
        variants=_variants(CONDUCTOR),
    ),
    PbrNode(
        "schlick",
        "generalized Schlick microfacets",
        SCHLICK.category,
        ("color0", "color82", "color90", "exponent", "roughness"),
        SCHLICK.value,
        lambda wo, inputs: SCHLICK.albedo(wo, isotropic(inputs)),
        SCHLICK.albedo,
        fixed={"scatter_mode": "R"},
        layerable=True,
        reciprocal=False,
        mirror=dict.fromkeys(("color0", "color82", "color90"), WHITE),
        variants=(
            *_variants(SCHLICK),
            Variant(
                "color82 counts as 1",
                lambda wo, wi, inputs: SCHLICK.value(wo, wi, undipped(inputs)),
                lambda wo, inputs: SCHLICK.albedo(wo, isotropic(undipped(inputs))),
            ),
            Variant(
                "its albedo, averaged over the channels",
                albedo=lambda wo, inputs: averaged_channels(SCHLICK.albedo(wo, isotropic(inputs))),
            ),
            Variant(
                "MaterialX's fit of its albedo, averaged over the channels",
                albedo=lambda wo, inputs: averaged_channels(SCHLICK.fitted(wo, inputs)),
            ),
        ),
    ),
)
