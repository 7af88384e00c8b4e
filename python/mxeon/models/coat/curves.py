# SPDX-License-Identifier: Apache-2.0
"""What a dielectric reflects, over the viewer's cosine: one integral at some cosines, interpolated.

Where there is one dielectric, its albedo and energy compensation depend on the viewer's cosine alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, wraps
from inspect import signature
from typing import ParamSpec, TypeVar, cast

import numpy as np

from mxeon.models.core.arguments import checked, checked_directions
from mxeon.models.core.arrays import Array, ArrayLike, Numbers
from mxeon.models.core.chebyshev import chebyshev_coefficients, chebyshev_nodes, chebyshev_sum
from mxeon.models.core.edges import at_least_0, at_most, cosine, cube_root, root
from mxeon.models.core.namespaces import any_array, array_namespace, library, like
from mxeon.models.microfacet.fresnel_formulas import dielectric, dielectric_avg
from mxeon.models.microfacet.slopes import slope_nodes

P = ParamSpec("P")
R = TypeVar("R")

NODES = 40  # of the curves, in the cube root of a logarithmic scale of the cosine
KEPT = 64  # dielectrics whose curves are kept


@dataclass(frozen=True)
class Coat:
    """A dielectric's curves over the viewer's cosine.

    - `alpha`, `average`: GGX roughness, which sets the scale of the cosine, and F_ss.
    - `missing`, `reflected`, `edge`: Coefficients of (1 - E_ss) / E_ss, of E_r, and of the facets'
      mean of (1 - c)^5, which is E of a metal with Schlick's curve that is black along the normal.
    """

    alpha: float | Array
    average: float | Array
    missing: list[float] | Array
    reflected: list[float] | Array
    edge: list[float] | Array

    def at(self, mu: Array) -> tuple[Array, Array]:
        """(1 - E_ss) / E_ss, and E_r, both not below 0."""
        missing, reflected = self._sums(mu, self.missing, self.reflected)
        return missing, at_most(reflected, 1.0)

    def edge_at(self, mu: Array) -> Array:
        """The facets' mean of (1 - c)^5."""
        [edge] = self._sums(mu, self.edge)
        return edge

    def _sums(self, mu: Array, *curves: list[float] | Array) -> list[Array]:
        """Curves at these cosines, not below 0."""
        x = place(mu, self.alpha)
        return [at_least_0(chebyshev_sum(cast(Array, each), x)) for each in curves]


def place(mu: Array, alpha: float | Array) -> Array:
    """Cosine on the scale of the curves, in [0, 1]: the cube root spreads terms like mu log(mu) at 0."""
    extent = array_namespace(alpha).asinh(1.0 / alpha)
    return cube_root(array_namespace(mu, alpha).asinh(mu / alpha) / extent)


def curves(alpha: Array, ior: Array) -> Array:
    """Coefficients of the curves of a `Coat`, shape (NODES, 3).

    Accuracy: error of the curves below 2e-7 for alpha >= 0.01 and ior in [1, 4], 5e-8 of it that of
    the slopes at grazing.
    """
    xp, x = array_namespace(alpha), like(chebyshev_nodes(NODES), alpha)
    mu = at_most(alpha * xp.sinh(xp.asinh(1.0 / alpha) * x**3), 1.0)
    zero = 0.0 * mu
    wo = xp.stack([root((1.0 - mu) * (1.0 + mu)), zero, mu])
    c, weight = slope_nodes(wo, xp.stack([zero + alpha, zero + alpha]), isotropic=True)
    missing = 1.0 / xp.sum(weight, axis=(0, 1)) - 1.0
    single = xp.sum(dielectric(c, zero + ior) * weight, axis=(0, 1))
    edge = xp.sum((1.0 - c) ** 5 * weight, axis=(0, 1))
    values = xp.stack([missing, single * (1.0 + dielectric_avg(ior) * missing), edge], axis=-1)
    matrix = like(chebyshev_coefficients(np.eye(NODES)), mu)
    return xp.tensordot(matrix, values, axes=1)


@lru_cache(maxsize=KEPT)
def constant_coat(alpha: float, ior: float) -> Coat:
    """Curves of a dielectric that does not change."""
    index = np.asarray(ior)
    return Coat(alpha, float(dielectric_avg(index)), *curves(np.asarray(alpha), index).T.tolist())


@any_array
def coat_of(alpha: float, ior: float) -> Coat:
    """Curves of a dielectric, checked; for arrays of other libraries with gradients, and anew each time."""
    numbers = checked_scalar("alpha", alpha, "coat_alpha"), checked_scalar("ior", ior, "coat_ior")
    if not library(numbers[0]):
        return constant_coat(*map(float, numbers))
    rows = curves(*numbers)
    return Coat(numbers[0], dielectric_avg(numbers[1]), rows[:, 0], rows[:, 1], rows[:, 2])


def checked_scalar(name: str, value: ArrayLike, quantity: str = "") -> Numbers:
    """Argument that is one number for all pairs, checked."""
    number = checked(name, value, quantity)
    if number.ndim:
        raise ValueError(
            f"{name} must be one number, for all pairs; got shape {tuple(number.shape)}"
        )
    return number


@any_array
def _brought(*arguments: ArrayLike) -> tuple[ArrayLike, ...]:
    """Arguments in one library."""
    return arguments


def of_one_coat(function: Callable[P, R]) -> Callable[P, R]:
    """Function of arrays of any library, which are brought to one.

    Parameters annotated as `float` are the numbers of the coat, which stay as they are where they are plain.
    """
    parameters = signature(function)
    types = {each.name: each.annotation for each in parameters.parameters.values()}
    own = [name for name, kind in types.items() if kind in (float, "float")]

    @wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        call = parameters.bind(*args, **kwargs).arguments
        plain = {name: call.pop(name) for name in own if not library(call[name])}
        brought = dict(zip(call, _brought(*call.values()), strict=True))
        return cast(Callable[..., R], function)(**brought, **plain)

    return wrapper


@any_array
def unpack_cosine(wo: ArrayLike) -> Array:
    """Cosine of directions to the viewer, checked."""
    return clipped(checked_directions("wo", wo)[..., 2])


def clipped(z: Array) -> Array:
    """Height as a cosine."""
    return cosine(at_least_0(z))
