# SPDX-License-Identifier: Apache-2.0
"""A microfacet lobe put together from its terms, and its evaluation over arguments."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from mxeon.models.core.arguments import checked_directions, checked_roughness, checked_switch
from mxeon.models.core.arrays import Array, ArrayLike, Numbers
from mxeon.models.core.evaluation import evaluate_material
from mxeon.models.core.namespaces import array_namespace
from mxeon.models.core.shapes import channel_count, lead_shape, refuse_ambiguous
from mxeon.models.microfacet import fresnel_formulas as fresnel
from mxeon.models.microfacet import ggx_formulas as ggx
from mxeon.models.microfacet.missing import missing_light


@dataclass(frozen=True)
class Curve:
    """Fresnel curve of a node.

    - `critical`: `critical(**material)`, shape (...): square of the cosine below which F is 1, if
      above 0.
    """

    at: Callable[..., Array]  # `at(cosine, **material)`, shape (C, ...): F, without a tint
    average: Callable[..., Array]  # `average(**material)`, shape (C, ...): F_ss
    critical: Callable[..., Array] = lambda **material: np.zeros(1)


# `material` may hold a tint, which F leaves alone.
DIELECTRIC = Curve(
    lambda c, ior, tint: fresnel.dielectric(c, ior)[np.newaxis],
    lambda ior, tint: fresnel.dielectric_avg(ior)[np.newaxis],
    lambda ior, tint: (1.0 - ior) * (1.0 + ior),
)
CONDUCTOR = Curve(fresnel.conductor, fresnel.conductor_avg)
SCHLICK = Curve(fresnel.schlick, fresnel.schlick_avg)
WHITE = Curve(lambda c, tint: 1.0 + 0.0 * c[np.newaxis], lambda tint: np.ones(1))


@dataclass(frozen=True)
class Pair:
    """Directions and roughness of a block, components first, and the Fresnel curve with its inputs."""

    wo: Array
    wi: Array
    roughness: Array
    cosine: Array
    curve: Curve
    material: Mapping[str, Array]


def compensation(pair: Pair) -> Array:
    """1 + F_ss (1 - E_ss) / E_ss: [MaterialX2026], Energy Compensation."""
    return 1.0 + pair.curve.average(**pair.material) * missing(pair.wo[2], pair.roughness)


def uncompensated(pair: Pair) -> float:
    """1, for a value as it is."""
    return 1.0


def visibility(pair: Pair) -> Array:
    """G2 / (4 mu_o mu_i) at sqrt(alpha_x alpha_y), of the specification."""
    return ggx.visibility(pair.wo[2], pair.wi[2], ggx.mean_alpha(pair.roughness))


def missing(mu_o: Array, roughness: Array) -> Array:
    """(1 - E_ss) / E_ss at alpha = sqrt(alpha_x alpha_y), to 1e-10."""
    return missing_light(mu_o, ggx.mean_alpha(roughness))


@dataclass(frozen=True)
class Lobe:
    """Terms of a microfacet BRDF, those of [MaterialX2026] unless replaced.

    - `alpha`: alpha as the lobe takes it, of the input `roughness`.
    """

    factor: Callable[[Pair], Array | float] = compensation  # compensation of a Pair
    visibility: Callable[[Pair], Array] = visibility  # G2 / (4 mu_o mu_i) of a Pair
    alpha: Callable[[Array], Array] = lambda roughness: roughness
    scale: float = 1.0

    def value(self, pair: Pair, wh: Array) -> Array:
        """BRDF of a block, shape (C, ...)."""
        F = pair.curve.at(pair.cosine, **pair.material)
        lobe = self.scale * ggx.ndf(wh, pair.roughness) * self.visibility(pair)
        f: Array = F * lobe * self.factor(pair)
        return f * pair.material["tint"] if "tint" in pair.material else f


def evaluate_lobe(
    lobe: Lobe,
    curve: Curve,
    wo: ArrayLike,
    wi: ArrayLike,
    roughness: ArrayLike,
    vectors: Mapping[str, Numbers],
    numbers: Mapping[str, Numbers],
    retroreflective: bool = False,
) -> Array:
    """Values of a lobe, shape (..., C); `vectors` and `numbers` are checked inputs of the curve."""
    directions = {"wo": checked_directions("wo", wo), "wi": checked_directions("wi", wi)}
    pairs = {"roughness": checked_roughness(roughness)}
    checked_switch("retroreflective", retroreflective)
    lead = lead_shape(directions | pairs, numbers)
    for name, color in vectors.items():
        refuse_ambiguous(name, color, lead)

    def value(wo: Array, wi: Array, roughness: Array, **material: Array) -> Array:
        if retroreflective:
            wo = array_namespace(wo).stack([-wo[0], -wo[1], wo[2]])
        wh, cosine = ggx.half_vector(wo, wi)
        return lobe.value(Pair(wo, wi, lobe.alpha(roughness), cosine, curve, material), wh)

    return evaluate_material(
        value, directions | pairs | dict(vectors), numbers, channel_count(vectors)
    )
