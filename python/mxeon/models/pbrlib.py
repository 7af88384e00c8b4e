# SPDX-License-Identifier: Apache-2.0
"""The BSDF nodes of pbrlib, one row for each mode, as functions of the values of their inputs.

Inputs come as a mapping by the names of the node's ports, each (N,) or (N, components). The node's
`weight` is left to the caller, since every node has it.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import TypeAlias

import numpy as np

from mxeon.models import materialx_fits
from mxeon.models.arrays import Array
from mxeon.models.burley import burley_albedo_dir, burley_brdf
from mxeon.models.fresnel import fresnel_dielectric
from mxeon.models.microfacet import conductor_brdf, dielectric_brdf, generalized_schlick_brdf
from mxeon.models.microfacet_albedo import (
    conductor_albedo_dir,
    dielectric_albedo_dir,
    generalized_schlick_albedo_dir,
)
from mxeon.models.microfacet_defects import MICROFACET_DEFECTS, MicrofacetDefect
from mxeon.models.sheen import (
    conty_kulla_albedo_dir,
    conty_kulla_brdf,
    zeltner_albedo_dir,
    zeltner_brdf,
)
from mxeon.models.translucent import translucent_btdf

Inputs: TypeAlias = Mapping[str, Array]


@dataclass(frozen=True)
class Variant:
    """Another function that a shader may have in place of a node's own.

    Attributes
    ----------
    title : str
    value : callable (wo, wi, inputs) -> ndarray, shape (N, 3), or None
        As in PbrNode; None where its values are the node's.
    albedo : callable (wo, inputs) -> ndarray, shape (N, 3), or None
    permitted : bool
        Whether the specification leaves it open.
    """

    title: str
    value: Callable[[Array, Array, Inputs], Array] | None = None
    albedo: Callable[[Array, Inputs], Array] | None = None
    permitted: bool = False


@dataclass(frozen=True)
class PbrNode:
    """A mode of a BSDF node, by [MaterialXPBR2026].

    Attributes
    ----------
    name, title : str
        One word, and the name in print.
    category : str
        Category of the node.
    inputs : tuple of str
        Names of the inputs that the functions read.
    value : callable (wo, wi, inputs) -> ndarray, shape (N, 3)
        BSDF in 1/sr without the cosine, for weight 1.
    albedo : callable (wo, inputs) -> ndarray, shape (N, 3)
        Directional albedo E for weight 1, with all tints; 1 where its integral exceeds 1. Of
        anisotropic microfacets it is that at the geometric mean of both alphas, as G2 is.
    integral : callable (wo, inputs) -> ndarray, shape (N, 3), or None
        The integral of its values, where that is another number for some inputs.
    fixed : mapping of str to str
        Inputs that select the mode.
    layerable : bool
        Whether it lets 1 - E through to what lies below; another node lets nothing through.
    transmits : bool
        Whether it scatters light from below the horizon in place of light from above.
    fitted : bool
        Whether a shader needs a fit for its albedo.
    reciprocal : bool
        Whether exchanging the directions does not change the value.
    mirror : mapping of str to value
        Inputs with which it reflects all light; none if there are none.
    variants : tuple of Variant
    """

    name: str
    title: str
    category: str
    inputs: tuple[str, ...]
    value: Callable[[Array, Array, Inputs], Array]
    albedo: Callable[[Array, Inputs], Array]
    integral: Callable[[Array, Inputs], Array] | None = None
    fixed: Mapping[str, str] = field(default_factory=dict)
    layerable: bool = False
    transmits: bool = False
    fitted: bool = False
    reciprocal: bool = True
    mirror: Mapping[str, object] = field(default_factory=dict)
    variants: tuple[Variant, ...] = ()


def node(name: str) -> PbrNode:
    """The row of NODES with this name.

    Raises
    ------
    ValueError
        If there is none; lists the names.

    Examples
    --------
    >>> node("zeltner").category
    'sheen_bsdf'
    """
    rows = {row.name: row for row in NODES}
    if name not in rows:
        raise ValueError(f"node must be one of {', '.join(rows)}; got {name!r}")
    return rows[name]


def _bounded(albedo: Callable[[Array, Array], Array]) -> Callable[[Array, Array], Array]:
    """An albedo that counts as 1 where it exceeds 1; the text is silent on it."""
    return lambda mu, roughness: np.minimum(albedo(mu, roughness), 1.0)


def _tinted(
    albedo: Callable[[Array, Array], Array],
) -> Callable[[Array, Inputs], Array]:
    """Albedo of a lobe of one roughness times its color."""

    def tinted(wo: Array, inputs: Inputs) -> Array:
        white = albedo(np.minimum(wo[:, 2], 1.0), inputs["roughness"])
        return np.asarray(white[..., np.newaxis] * inputs["color"])

    return tinted


def _untinted(
    albedo: Callable[[Array, Array], Array],
) -> Callable[[Array, Inputs], Array]:
    """Albedo of a lobe of one roughness without its color."""

    def untinted(wo: Array, inputs: Inputs) -> Array:
        white = albedo(np.minimum(wo[:, 2], 1.0), inputs["roughness"])
        return np.repeat(white[..., np.newaxis], 3, axis=-1)

    return untinted


def _sheen(
    brdf: Callable[..., Array],
) -> Callable[[Array, Array, Inputs], Array]:
    """Values of a lobe of a color and a roughness."""
    return lambda wo, wi, inputs: brdf(wo, wi, inputs["color"], inputs["roughness"])


def _colored(albedo: Callable[[Array, Inputs], Array]) -> Callable[[Array, Inputs], Array]:
    """An albedo times the color."""
    return lambda wo, inputs: np.asarray(albedo(wo, inputs) * inputs["color"])


def _variants(category: str) -> tuple[Variant, ...]:
    """Known variants of a microfacet node; the text leaves the form of the compensation open."""
    return tuple(
        Variant(each.title, partial(_defect, each, category), permitted=each.name in OPEN)
        for each in MICROFACET_DEFECTS
    )


def _defect(defect: MicrofacetDefect, category: str, wo: Array, wi: Array, inputs: Inputs) -> Array:
    return defect.value(category, wo, wi, inputs)


def _isotropic(inputs: Inputs) -> Array:
    """Geometric mean of the two components of a roughness, twice."""
    mean = np.sqrt(inputs["roughness"].prod(axis=-1, keepdims=True))
    return np.repeat(mean, 2, axis=-1)


def _schlick(inputs: Inputs) -> tuple[Array, Array, Array]:
    """The colors of the generalized Schlick curve."""
    return inputs["color0"], inputs["color82"], inputs["color90"]


OPEN = ("compensation_half", "compensation_f0", "compensation_view", "compensation_fitted")
WHITE = (1.0, 1.0, 1.0)
COLOR_ROUGHNESS = ("color", "roughness")
MICROFACET = (
    PbrNode(
        "dielectric",
        "dielectric microfacets",
        "dielectric_bsdf",
        ("tint", "ior", "roughness"),
        lambda wo, wi, inputs: dielectric_brdf(
            wo, wi, inputs["tint"], inputs["roughness"], inputs["ior"]
        ),
        lambda wo, inputs: dielectric_albedo_dir(
            wo, inputs["tint"], _isotropic(inputs), inputs["ior"]
        ),
        lambda wo, inputs: dielectric_albedo_dir(
            wo, inputs["tint"], inputs["roughness"], inputs["ior"]
        ),
        fixed={"scatter_mode": "R"},
        layerable=True,
        reciprocal=False,
        mirror={"ior": 0.0, "tint": WHITE},
        variants=(
            *_variants("dielectric_bsdf"),
            Variant(
                "MaterialX's fit of its albedo without the tint",
                albedo=lambda wo, inputs: materialx_fits.layer_albedo(
                    wo,
                    inputs,
                    fresnel_dielectric(1.0, inputs["ior"])[:, np.newaxis],
                    1.0,
                    fresnel_dielectric(np.minimum(wo[:, 2], 1.0), inputs["ior"])[:, np.newaxis],
                ),
            ),
        ),
    ),
    PbrNode(
        "conductor",
        "conductor microfacets",
        "conductor_bsdf",
        ("ior", "extinction", "roughness"),
        lambda wo, wi, inputs: conductor_brdf(
            wo, wi, inputs["roughness"], inputs["ior"], inputs["extinction"]
        ),
        lambda wo, inputs: conductor_albedo_dir(
            wo, _isotropic(inputs), inputs["ior"], inputs["extinction"]
        ),
        lambda wo, inputs: conductor_albedo_dir(
            wo, inputs["roughness"], inputs["ior"], inputs["extinction"]
        ),
        reciprocal=False,
        mirror={"ior": (0.0, 0.0, 0.0)},
        variants=_variants("conductor_bsdf"),
    ),
    PbrNode(
        "schlick",
        "generalized Schlick microfacets",
        "generalized_schlick_bsdf",
        ("color0", "color82", "color90", "exponent", "roughness"),
        lambda wo, wi, inputs: generalized_schlick_brdf(
            wo, wi, *_schlick(inputs), inputs["roughness"], inputs["exponent"]
        ),
        lambda wo, inputs: generalized_schlick_albedo_dir(
            wo, *_schlick(inputs), _isotropic(inputs), inputs["exponent"]
        ),
        lambda wo, inputs: generalized_schlick_albedo_dir(
            wo, *_schlick(inputs), inputs["roughness"], inputs["exponent"]
        ),
        fixed={"scatter_mode": "R"},
        layerable=True,
        reciprocal=False,
        mirror=dict.fromkeys(("color0", "color82", "color90"), WHITE),
        variants=_variants("generalized_schlick_bsdf"),
    ),
)
NODES = (
    PbrNode(
        "burley",
        "Burley diffuse",
        "burley_diffuse_bsdf",
        COLOR_ROUGHNESS,
        _sheen(burley_brdf),
        lambda wo, inputs: burley_albedo_dir(
            np.minimum(wo[:, 2], 1.0), inputs["color"], inputs["roughness"]
        ),
        variants=(Variant("MaterialX's fit of its albedo", albedo=materialx_fits.burley_albedo),),
    ),
    PbrNode(
        "translucent",
        "Lambert transmission",
        "translucent_bsdf",
        ("color",),
        lambda wo, wi, inputs: translucent_btdf(wo, wi, inputs["color"]),
        lambda wo, inputs: np.broadcast_to(inputs["color"], wo.shape),
        transmits=True,
    ),
    PbrNode(
        "conty_kulla",
        "Conty-Kulla sheen",
        "sheen_bsdf",
        COLOR_ROUGHNESS,
        _sheen(conty_kulla_brdf),
        _tinted(_bounded(conty_kulla_albedo_dir)),
        _tinted(conty_kulla_albedo_dir),
        fixed={"mode": "conty_kulla"},
        layerable=True,
        fitted=True,
        variants=(
            Variant(
                "its albedo without the color", albedo=_untinted(_bounded(conty_kulla_albedo_dir))
            ),
            Variant(
                "MaterialX's fit of its albedo", albedo=_colored(materialx_fits.conty_kulla_albedo)
            ),
            Variant(
                "MaterialX's fit of its albedo without the color",
                albedo=materialx_fits.conty_kulla_albedo,
            ),
        ),
    ),
    PbrNode(
        "zeltner",
        "Zeltner sheen",
        "sheen_bsdf",
        COLOR_ROUGHNESS,
        _sheen(zeltner_brdf),
        _tinted(zeltner_albedo_dir),
        fixed={"mode": "zeltner"},
        layerable=True,
        reciprocal=False,
        variants=(Variant("its albedo without the color", albedo=_untinted(zeltner_albedo_dir)),),
    ),
    *MICROFACET,
)
