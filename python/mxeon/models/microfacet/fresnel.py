# SPDX-License-Identifier: Apache-2.0
"""Fresnel reflectances of the microfacet nodes of pbrlib, and their hemispherical averages.

F_ss, the cosine-weighted average over the hemisphere, is 2 times the integral of F(mu) mu.

- `mu` (...): Cosine between direction and microfacet normal, in [0, 1].
- `ior`, `extinction` (..., C): Complex index of refraction per channel, in [0, 1e50]; a number is
  one channel.
- `color0`, `color82`, `color90` (..., C): Reflectance r0 along the normal, multiplier at acos(1/7),
  and reflectance r90 at grazing, per channel, in [0, 1]; a number is one channel.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mxeon.models.core.arguments import checked, checked_vector
from mxeon.models.core.arrays import Array, ArrayLike, Numbers
from mxeon.models.core.evaluation import evaluate_material
from mxeon.models.core.namespaces import any_array
from mxeon.models.core.shapes import channel_count
from mxeon.models.microfacet import fresnel_formulas as formulas


@any_array
def fresnel_dielectric(mu: ArrayLike, ior: ArrayLike) -> Array:
    """Fresnel reflectance of a dielectric for unpolarized light.

    - `ior`: Index of refraction relative to the exterior medium, in [0, 1e50].

    Result: in [0, 1]. `ior` 0 disables the Fresnel curve: F is 1, as the equations give it. Below 1
    the light comes from the denser side, and F is 1 from the critical angle on. At 1 there is no
    interface, and F is 0 at grazing too. Of negative numbers the specification says nothing; here
    they are refused. Accuracy: relative error below 2.2e-14 for `ior` >= 1. Below, F has an
    infinite slope at the critical angle: there the result belongs to arguments that differ by a
    rounding. [MaterialX2026], Dielectric Fresnel Equations; dielectric_bsdf.

        >>> fresnel_dielectric([1.0, 0.5, 0.0], 1.5).round(6)
        array([0.04    , 0.089187, 1.      ])
    """
    numbers = {"mu": checked("mu", mu), "ior": checked("ior", ior)}
    return _number(formulas.dielectric, numbers)


@any_array
def fresnel_dielectric_avg(ior: ArrayLike) -> Array:
    """Average Fresnel reflectance F_ss of a dielectric, in closed form.

    - `ior` (...): Index of refraction relative to the exterior medium, in [0, 1e50].

    Result (...): in [0, 1]. Accuracy: relative error below 2.2e-14. Form: Walsh's result in
    log(ior), with every cancellation near 1 taken out; below 1 from the other side of the
    interface, ior^2 (1 - F_ss(1 / ior)) = 1 - F_ss(ior). [Walsh1926]; [MaterialX2026], Energy
    Compensation.

        >>> fresnel_dielectric_avg([0.0, 1.0, 1.5]).round(6)
        array([1.      , 0.      , 0.091778])
    """
    return _number(formulas.dielectric_avg, {"ior": checked("ior", ior)})


@any_array
def fresnel_conductor(mu: ArrayLike, ior: ArrayLike, extinction: ArrayLike) -> Array:
    """Fresnel reflectance of a conductor for unpolarized light.

    Result (..., C): in [0, 1]. Without extinction it is `fresnel_dielectric`. Accuracy: absolute
    error below 1e-12, but for the critical angle of a dielectric that absorbs next to nothing.
    [MaterialX2026], Conductor Fresnel Equations.

        >>> fresnel_conductor(0.5, [0.183, 1.373], [3.424, 1.770]).round(6)
        array([0.93869 , 0.412954])
    """
    vectors = {"ior": _color("ior", ior), "extinction": _color("extinction", extinction)}
    return _colors(formulas.conductor, vectors, {"mu": checked("mu", mu)})


@any_array
def fresnel_conductor_avg(ior: ArrayLike, extinction: ArrayLike) -> Array:
    """Average Fresnel reflectance F_ss of a conductor, by quadrature.

    Result (..., C): in [0, 1]. Accuracy: absolute error below 1e-12. [MaterialX2026], Energy
    Compensation; Conductor Fresnel Equations.

        >>> fresnel_conductor_avg([0.183, 1.373], [3.424, 1.770]).round(6)
        array([0.942313, 0.411657])
    """
    vectors = {"ior": _color("ior", ior), "extinction": _color("extinction", extinction)}
    return _colors(formulas.conductor_avg, vectors, {})


@any_array
def fresnel_schlick(
    mu: ArrayLike,
    color0: ArrayLike,
    color82: ArrayLike,
    color90: ArrayLike,
    exponent: ArrayLike,
) -> Array:
    """Fresnel reflectance by the generalized Schlick curve with Hoffman's dip.

        F = r0 + (r90 - r0) (1 - mu)^q - a mu (1 - mu)^6

    - `exponent` (...): q, in [0, 1e50]; at 0 the curve is r90, along the normal too.

    Result (..., C): at most 1; below 0 for some colors. The specification does not clamp F, and
    neither does this function: where `color0` is dark, `color82` small and `color90` bright, it
    falls below 0, to -0.127 at mu = 0.26 for 0, 0 and 1 with exponent 5. It never exceeds 1.
    [MaterialX2026], Generalized Schlick Equations.

        >>> fresnel_schlick(0.5, [0.9, 0.2], [0.5, 1.0], 1.0, 5.0).round(6)
        array([0.837879, 0.225   ])
    """
    vectors = _schlick_colors(color0, color82, color90)
    numbers = {"mu": checked("mu", mu), "exponent": checked("exponent", exponent)}
    return _colors(formulas.schlick, vectors, numbers)


@any_array
def fresnel_schlick_avg(
    color0: ArrayLike, color82: ArrayLike, color90: ArrayLike, exponent: ArrayLike
) -> Array:
    """Average Fresnel reflectance F_ss of the generalized Schlick curve, in closed form.

        F_ss = r0 + 2 (r90 - r0) / ((q + 1) (q + 2)) - a / 126

    - `exponent` (...): q, in [0, 1e50].

    Result (..., C): of the curve as it is, not clamped. Accuracy: absolute error below 2.2e-14.
    [MaterialX2026], Energy Compensation; Generalized Schlick Equations.

        >>> fresnel_schlick_avg([0.9, 0.2], [0.5, 1.0], 1.0, 5.0).round(6)
        array([0.838481, 0.238095])
    """
    vectors = _schlick_colors(color0, color82, color90)
    numbers = {"exponent": checked("exponent", exponent)}
    return _colors(formulas.schlick_avg, vectors, numbers)


def _color(name: str, value: ArrayLike) -> Numbers:
    """Checked argument with an axis of channels."""
    return checked_vector(name, value)


def _schlick_colors(
    color0: ArrayLike, color82: ArrayLike, color90: ArrayLike
) -> dict[str, Numbers]:
    """Checked colors of the generalized Schlick curve, by name."""
    colors = {"color0": color0, "color82": color82, "color90": color90}
    return {name: _color(name, value) for name, value in colors.items()}


def _number(formula: Callable[..., Array], numbers: dict[str, Numbers]) -> Array:
    """Formula without channels over arguments that broadcast."""
    values = evaluate_material(lambda **parts: formula(**parts)[np.newaxis], {}, numbers, 1)
    return values[..., 0][()]


def _colors(
    formula: Callable[..., Array], vectors: dict[str, Numbers], numbers: dict[str, Numbers]
) -> Array:
    """Formula over arguments that broadcast, colors among them."""
    return evaluate_material(formula, vectors, numbers, channel_count(vectors))
