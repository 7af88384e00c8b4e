# SPDX-License-Identifier: Apache-2.0
"""Rows of pbrlib's sheens and diffuse nodes but the rough ones."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mxeon.models.core.arrays import Array
from mxeon.models.core.edges import at_most, cosine
from mxeon.models.core.namespaces import array_namespace
from mxeon.models.diffuse.burley import burley_albedo_dir, burley_brdf
from mxeon.models.diffuse.translucent import translucent_btdf
from mxeon.models.microfacet import materialx_fits
from mxeon.models.nodes.node import Inputs, PbrNode, Variant
from mxeon.models.sheen import (
    conty_kulla_albedo_dir,
    conty_kulla_brdf,
    zeltner_albedo_dir,
    zeltner_brdf,
)


def _bounded(albedo: Callable[[Array, Array], Array]) -> Callable[[Array, Array], Array]:
    """An albedo that counts as 1 where it exceeds 1; the text is silent on it."""
    return lambda mu, roughness: at_most(albedo(mu, roughness), 1.0)


def _tinted(
    albedo: Callable[[Array, Array], Array],
) -> Callable[[Array, Inputs], Array]:
    """Albedo of a lobe of one roughness times its color."""

    def tinted(wo: Array, inputs: Inputs) -> Array:
        white = albedo(cosine(wo[:, 2]), inputs["roughness"])
        tinted: Array = white[..., np.newaxis] * inputs["color"]
        return tinted

    return tinted


def untinted(
    albedo: Callable[[Array, Array], Array],
) -> Callable[[Array, Inputs], Array]:
    """Albedo of a lobe of one roughness without its color."""

    def untinted(wo: Array, inputs: Inputs) -> Array:
        white = albedo(cosine(wo[:, 2]), inputs["roughness"])
        return np.repeat(white[..., np.newaxis], 3, axis=-1)

    return untinted


def _sheen(
    brdf: Callable[..., Array],
) -> Callable[[Array, Array, Inputs], Array]:
    """Values of a lobe of a color and a roughness."""
    return lambda wo, wi, inputs: brdf(wo, wi, inputs["color"], inputs["roughness"])


COLOR_ROUGHNESS = ("color", "roughness")
LOBE_NODES = (
    PbrNode(
        "burley",
        "Burley diffuse",
        "burley_diffuse_bsdf",
        COLOR_ROUGHNESS,
        _sheen(burley_brdf),
        lambda wo, inputs: burley_albedo_dir(
            cosine(wo[:, 2]), inputs["color"], inputs["roughness"]
        ),
        variants=(
            Variant("MaterialX's fit of its albedo", albedo=materialx_fits.burley_albedo),
            Variant(
                "Burley diffuse of roughness 0, without retro-reflection",
                lambda wo, wi, inputs: burley_brdf(wo, wi, inputs["color"], np.zeros(len(wo))),
            ),
            Variant("Lambert", lambda wo, wi, inputs: inputs["color"] / np.pi),
        ),
    ),
    PbrNode(
        "translucent",
        "Lambert transmission",
        "translucent_bsdf",
        ("color",),
        lambda wo, wi, inputs: translucent_btdf(wo, wi, inputs["color"]),
        lambda wo, inputs: array_namespace(wo).broadcast_to(inputs["color"], wo.shape),
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
            Variant("Zeltner sheen", _sheen(zeltner_brdf), _tinted(zeltner_albedo_dir)),
            Variant(
                "its albedo without the color", albedo=untinted(_bounded(conty_kulla_albedo_dir))
            ),
            Variant(
                "MaterialX's fit of its albedo",
                albedo=lambda wo, inputs: np.asarray(
                    materialx_fits.conty_kulla_albedo(wo, inputs) * inputs["color"]
                ),
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
        variants=(
            Variant(
                "Conty-Kulla sheen",
                _sheen(conty_kulla_brdf),
                _tinted(_bounded(conty_kulla_albedo_dir)),
            ),
            Variant("its albedo without the color", albedo=untinted(zeltner_albedo_dir)),
        ),
    ),
)
