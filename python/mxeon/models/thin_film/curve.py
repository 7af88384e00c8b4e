# SPDX-License-Identifier: Apache-2.0
"""Fresnel curves of the microfacet nodes under a thin film, in linear RGB, and their averages.

The specification leaves four things open, which a Form says: the matrix to RGB, the number of orders,
what becomes of an index for each color channel in a sum over CIE XYZ, and of values outside [0, 1],
which it clamps at the very end.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import TypeAlias

import numpy as np
from numpy.polynomial import legendre

from mxeon.models.core.arrays import Array
from mxeon.models.core.colorimetry import XYZ_TO_REC709, XYZ_TO_REC709_E
from mxeon.models.core.edges import within
from mxeon.models.core.namespaces import NUMPY, array_namespace, like
from mxeon.models.microfacet import fresnel_formulas as fresnel
from mxeon.models.microfacet.lobe import CONDUCTOR, DIELECTRIC, SCHLICK, Curve
from mxeon.models.thin_film import formulas as film

# Gauss-Legendre in the cosine: nodes of the curve, and of the polynomial through it, which is clamped.
NODES, FINE = 14, 200

Polarizations: TypeAlias = tuple[film.Interface, film.Interface]


@dataclass(frozen=True)
class Form:
    """Choices that the specification leaves to implementations, and a defect.

    - `matrix`: From CIE XYZ to linear RGB, by rows.
    - `orders`: M; None sums all orders.
    - `mixed`: Whether the index of RGB channel k enters XYZ value k. If not, each RGB channel has
      its index in all of XYZ, so that a film that vanishes leaves the channels alone.
    - `share`: Factor of the Schlick substrate's reflectance in each polarization; by the text 1.
    - `least`: Reflectance from which on color0 is turned into the index of a Schlick substrate.
    - `clamped`: Whether values outside [0, 1] are clamped, as the text does.
    """

    matrix: tuple[tuple[float, ...], ...] = tuple(map(tuple, XYZ_TO_REC709_E.tolist()))
    orders: int | None = None
    mixed: bool = False
    share: float = 1.0
    least: float = 0.0
    clamped: bool = True


# XYZ to CIE RGB of white E, of MaterialX 1.39.5.
CIE_RGB = (
    (2.3706743, -0.9000405, -0.4706338),
    (-0.5138850, 1.4253036, 0.0885814),
    (0.0052982, -0.0146949, 1.0093968),
)
TEXT = Form()
PRINTED = Form(tuple(map(tuple, XYZ_TO_REC709.tolist())), 2, True)
MATERIALX = Form(CIE_RGB, 2, True, 0.5, 0.01)


def film_curve(category: str, form: Form = TEXT) -> Curve:
    """Curve of a microfacet node that has `thinfilm_thickness` and `thinfilm_ior` beside its inputs.

    Where the thickness is 0 it is the node's own.
    """
    bare = CURVES[category]

    def at(
        mu: Array, *, thinfilm_thickness: Array, thinfilm_ior: Array, **material: Array
    ) -> Array:
        def coated() -> Array:
            return _airy(category, form, mu, thinfilm_thickness, thinfilm_ior, material)

        return _where_coated(thinfilm_thickness, coated, bare.at(mu, **material))

    # Average it over the cosine: the clamp has kinks, which a polynomial through the curve has not.
    def average(*, thinfilm_thickness: Array, thinfilm_ior: Array, **material: Array) -> Array:
        def coated() -> Array:
            film = thinfilm_thickness, thinfilm_ior
            curve = _fine(category, without_clamp(form), film, material)
            # Clamp it there, and sum.
            kept = within(curve) if form.clamped else curve
            return array_namespace(curve).tensordot(like(_rule()[2], curve), kept, axes=1)

        return _where_coated(thinfilm_thickness, coated, bare.average(**material))

    return Curve(at, average)


def _where_coated(thickness: Array, coated: Callable[[], Array], plain: Array) -> Array:
    """Values of films where there is one, and plain ones; films take long, and are left out if there is none."""
    xp = array_namespace(thickness, plain)
    if xp is not NUMPY or (thickness > 0.0).any():
        return xp.where(thickness > 0.0, coated(), plain)
    return np.broadcast_to(plain, np.broadcast_shapes(thickness.shape, plain.shape))


def _fine(
    category: str, form: Form, film: tuple[Array, Array], material: dict[str, Array]
) -> Array:
    """The curve at the cosines of a fine rule from those of nodes, shape (FINE, 3, ...), all at once."""
    mu, between, _ = (like(each, film[1]) for each in _rule())
    channels = {k for k, v in material.items() if k in COLORS[category]}
    axes = max((v.ndim - 1 for k, v in material.items() if k in channels), default=film[0].ndim)
    spread = {k: v[:, np.newaxis] if k in channels else v for k, v in material.items()}
    nodes = array_namespace(mu).reshape(mu, (-1, *(1,) * max(axes, film[0].ndim, film[1].ndim)))
    curve = _airy(category, form, nodes, *film, spread)
    return array_namespace(curve).tensordot(between, curve, axes=((1,), (1,)))


@cache
def _rule() -> tuple[Array, Array, Array]:
    """Cosines of nodes, the matrix from values there to those of a fine rule, and its shares."""
    x, w = legendre.leggauss(NODES)
    fine, weight = legendre.leggauss(FINE)
    degree = np.arange(NODES)
    moments = (degree + 0.5)[:, np.newaxis] * legendre.legvander(x, NODES - 1).T * w
    between = legendre.legvander(fine, NODES - 1) @ moments
    return 0.5 * (1.0 + x), between, 0.5 * weight * (1.0 + fine)


def without_clamp(form: Form) -> Form:
    """The form with values outside [0, 1] as they are."""
    return replace(form, clamped=False)


def _airy(
    category: str,
    form: Form,
    mu: Array,
    thickness: Array,
    film_ior: Array,
    material: dict[str, Array],
) -> Array:
    """F_airy in linear RGB, shape (3, ...)."""
    inputs = {k: v for k, v in material.items() if k != "tint"}
    opd = film.path_difference(mu, thickness, film_ior)
    p, s = SUBSTRATES[category](mu, film_ior, form, **inputs)
    xyz = film.tristimulus(p, opd, form.orders) + film.tristimulus(s, opd, form.orders)
    rgb = _to_rgb(0.5 * xyz, form)
    return within(rgb) if form.clamped else rgb


def _to_rgb(xyz: Array, form: Form) -> Array:
    """RGB, shape (3, ...), of XYZ of the substrate of each channel, shape (3, channels, ...)."""
    xp, matrix = array_namespace(xyz), np.array(form.matrix)
    xyz = xp.broadcast_to(xyz, (3, 3, *xyz.shape[2:]))
    if form.mixed:
        diagonal = xp.stack([xyz[k, k, ...] for k in range(3)])
        return xp.tensordot(like(matrix, xyz), diagonal, axes=1)
    weights = like(matrix.T.reshape(3, 3, *(1,) * (xyz.ndim - 2)), xyz)
    return xp.sum(weights * xyz, axis=0)


def _dielectric(mu: Array, film_ior: Array, _: Form, ior: Array) -> Polarizations:
    none = like(np.zeros(1), ior)
    return film.over_index(mu[np.newaxis], film_ior[np.newaxis], ior[np.newaxis], none)


def _conductor(mu: Array, film_ior: Array, _: Form, ior: Array, extinction: Array) -> Polarizations:
    return film.over_index(mu[np.newaxis], film_ior[np.newaxis], ior, extinction)


def _schlick(
    mu: Array,
    film_ior: Array,
    form: Form,
    color0: Array,
    color82: Array,
    color90: Array,
    exponent: Array,
) -> Polarizations:
    mu_t = film.refracted(mu, film_ior)
    F = form.share * fresnel.schlick(mu_t, color0, color82, color90, exponent)
    base = array_namespace(color0).maximum(color0, form.least)
    return film.over_schlick(mu[np.newaxis], film_ior[np.newaxis], F, base)


CURVES = {
    "dielectric_bsdf": DIELECTRIC,
    "conductor_bsdf": CONDUCTOR,
    "generalized_schlick_bsdf": SCHLICK,
}
# Inputs of each curve that have channels.
COLORS = {
    "dielectric_bsdf": ("tint",),
    "conductor_bsdf": ("ior", "extinction"),
    "generalized_schlick_bsdf": ("color0", "color82", "color90"),
}
SUBSTRATES: dict[str, Callable[..., Polarizations]] = {
    "dielectric_bsdf": _dielectric,
    "conductor_bsdf": _conductor,
    "generalized_schlick_bsdf": _schlick,
}
