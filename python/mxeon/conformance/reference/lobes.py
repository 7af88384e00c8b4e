# SPDX-License-Identifier: Apache-2.0
"""Values and throughputs of one lobe at all the points of a picture, under each kind of light."""

from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from mxeon.models import table
from mxeon.models.layering import Bsdf, throughput
from mxeon.models.pbrlib import PbrNode

Values: TypeAlias = NDArray[np.float64]
Inputs: TypeAlias = Mapping[str, Values]

# A lobe of weight one from its node, its inputs, each one value or one for each point, and whether
# its throughput is asked for.
Lobe: TypeAlias = Callable[[PbrNode, Inputs, bool], Bsdf]

# An albedo is interpolated if its last coefficients are below this, far below a host's rounding.
TAIL = 1e-9
DEGREES = (32, 64, 128, 256)


def diffuse(name: str, category: str) -> PbrNode:
    """A model of the Oren-Nayar family as the row of a node."""
    model = table.model(name)
    return PbrNode(
        name,
        model.title,
        category,
        ("color", "roughness"),
        lambda wo, wi, inputs: model.brdf(wo, wi, inputs["color"], inputs["roughness"]),
        lambda wo, inputs: model.closed_albedo_dir(wo[:, 2], inputs["color"], inputs["roughness"]),
    )


def lit(wo: Values, wi: Values, irradiance: float) -> Lobe:
    """Lobe under a distant light: its irradiance times f |cos(theta_i)|, 0 on the dark side."""
    above = wo[:, 2] > 0.0

    def lobe(node: PbrNode, inputs: Inputs, layered: bool) -> Bsdf:
        value = np.zeros(wo.shape)
        shown = above & ((wi[:, 2] < 0.0) if node.transmits else (wi[:, 2] > 0.0))
        f = node.value(wo[shown], wi[shown], _at(inputs, shown))
        value[shown] = irradiance * f * np.abs(wi[shown, 2:])
        left = np.zeros(wo.shape)
        if layered and node.layerable:
            left[above] = throughput(_albedo(node, wo[above], inputs, above))
        return Bsdf(value, left)

    return lobe


def furnace(wo: Values, radiance: float) -> Lobe:
    """Lobe in a uniform environment: its directional albedo."""
    every = np.ones(len(wo), bool)

    def lobe(node: PbrNode, inputs: Inputs, layered: bool) -> Bsdf:
        albedo = _albedo(node, wo, inputs, every)
        left = throughput(albedo) if node.layerable else np.zeros(albedo.shape)
        return Bsdf(radiance * albedo, left)

    return lobe


def weighted(lobe: Bsdf, weight: Values, layerable: bool) -> Bsdf:
    """Lobe times its weight; what hides its base does so at any weight."""
    left = np.maximum(1.0 - weight * (1.0 - lobe.throughput), 0.0) if layerable else lobe.throughput
    return Bsdf(lobe.value * weight, left)


def _at(inputs: Inputs, points: NDArray[np.bool_]) -> dict[str, Values]:
    """Inputs at some of the points, each (M,) or (M, components)."""
    count = int(points.sum())
    return {
        name: value[points] if len(value) == len(points) else np.repeat(value, count, axis=0)
        for name, value in inputs.items()
    }


def _albedo(node: PbrNode, wo: Values, inputs: Inputs, points: NDArray[np.bool_]) -> Values:
    """Albedo at `points`, of which `wo` are the directions."""
    constant = all(len(value) == 1 for value in inputs.values())
    # Only albedos without a closed form take long.
    if not (node.fitted and constant and _turns(inputs)):
        return node.albedo(wo, _at(inputs, points))
    # The symmetric points of a sphere have cosines that differ by roundings.
    rounded = np.asarray(np.round(np.minimum(wo[:, 2], 1.0), 13), np.float64)
    mu, indices = np.unique(rounded, return_inverse=True)
    albedo = _interpolated(node, mu, inputs) if len(mu) > DEGREES[0] else None
    return (_over_cosines(node, mu, inputs) if albedo is None else albedo)[indices]


def _turns(inputs: Inputs) -> bool:
    """Whether a lobe stays itself when it is turned about the normal."""
    roughness = inputs.get("roughness", np.zeros((1, 1)))
    return roughness.ndim == 1 or bool(np.ptp(roughness[0]) == 0.0)


def _over_cosines(node: PbrNode, mu: Values, inputs: Inputs) -> Values:
    """Albedo of directions with these cosines."""
    wo = np.stack([np.sqrt((1.0 - mu) * (1.0 + mu)), np.zeros_like(mu), mu], axis=1)
    return node.albedo(wo, _at(inputs, np.ones(len(mu), bool)))


def _interpolated(node: PbrNode, mu: Values, inputs: Inputs) -> Values | None:
    """Albedo by Chebyshev interpolation in mu^(1/4), or None where it converges too slowly."""
    for degree in DEGREES:
        x = chebyshev.chebpts1(degree + 1)
        values = _over_cosines(node, (0.5 * (1.0 + x)) ** 4, inputs)
        scale = np.where(np.arange(degree + 1) == 0, 1.0, 2.0) / (degree + 1)
        coefficients = scale[:, None] * (chebyshev.chebvander(x, degree).T @ values)
        if np.abs(coefficients[-degree // 8 :]).max() < TAIL:
            result: Any = chebyshev.chebval(2.0 * mu**0.25 - 1.0, coefficients).T
            return np.asarray(result, np.float64)
    return None
