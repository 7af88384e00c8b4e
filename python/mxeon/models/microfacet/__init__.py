# SPDX-License-Identifier: Apache-2.0
"""BRDFs and albedos of pbrlib's microfacet nodes. BRDFs are in 1/sr and without the cosine.

All functions broadcast and accept the ends of every range. A surface with alpha 0 is a mirror. The
value of a mirror, a delta function, counts as 0, and the albedo of a mirror is F(mu_o). If both
directions graze the surface, the value is unbounded and counts as 0; any finite value would do,
because the cosine is 0. The energy compensation takes (1 - E_ss) / E_ss, accurate to 1e-10, from a
table that the first call computes; `mxeon.models.ggx_albedo_dir` computes E_ss by quadrature.
Albedos are integrals over the slopes of microfacets, as accurate as `ggx_albedo_dir_anisotropic`.
In retroreflective mode, wo is mirrored about the normal. The albedo stays the same, since half a
turn about the normal maps the surface onto itself.

- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, tangent
  +x, z >= 0.
- `tint` (..., C): Color per channel, in [0, 1]; a number is one channel.
- `roughness` (..., 2) or (): alpha along tangent and bitangent, in [0, 1]; a number is isotropic.
- `ior`, `extinction` (..., C): Complex index of refraction relative to the exterior medium, per
  channel, in [0, 1e50]. A dielectric has one `ior` for all channels, (...); with `ior` 0, the
  reflectance F of the dielectric is 1.
- `color0`, `color82`, `color90` (..., C): Reflectance along the normal, multiplier at the angle
  acos(1/7), and reflectance at grazing incidence, per channel, in [0, 1]; a number is one channel.
- `exponent` (...): Exponent of the Schlick curve, in [0, 1e50].
- `retroreflective`: Whether light is reflected back toward its source.
- `compensate`: Whether to apply the energy compensation. The BRDF without compensation is
  reciprocal.

Result (..., C): An albedo, or the BRDF in 1/sr. The BRDF is at least 0 and has no upper bound at
grazing angles and for small alpha. Raises `ValueError`, which names the first bad element, if an
argument leaves its range or the shapes do not broadcast.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from mxeon.models.core import arguments, arrays
from mxeon.models.core.arguments import (
    channel_count,
    checked_directions,
    checked_roughness,
    lead_shape,
)
from mxeon.models.core.arrays import Array, ArrayLike, Numbers, any_array, array_namespace
from mxeon.models.core.chebyshev import chebyshev_coefficients, chebyshev_nodes, chebyshev_sum
from mxeon.models.core.evaluation import evaluate_material, evaluate_number
from mxeon.models.microfacet import fresnel, ggx
from mxeon.models.microfacet.ggx import albedo, missing_light
from mxeon.models.microfacet.slopes import slope_nodes, transmitting_nodes


@dataclass(frozen=True)
class Curve:
    """Fresnel curve of a node."""

    at: Callable[..., Array]  # `at(cosine, **material)`, shape (C, ...): F without the tint
    average: Callable[..., Array]  # `average(**material)`, shape (C, ...): F_ss
    # `critical(**material)`, shape (...): square of the cosine of the critical angle. The result is
    # 0 or negative if there is no critical angle.
    critical: Callable[..., Array] = lambda **material: np.zeros(1)


# The tint is an input of some curves, but does not change F.
DIELECTRIC_CURVE = Curve(
    lambda c, ior, tint: fresnel.dielectric(c, ior)[np.newaxis],
    lambda ior, tint: fresnel.dielectric_avg(ior)[np.newaxis],
    lambda ior, tint: (1.0 - ior) * (1.0 + ior),
)
CONDUCTOR_CURVE = Curve(fresnel.conductor, fresnel.conductor_avg)
SCHLICK_CURVE = Curve(
    lambda c, **material: arrays.at_least_0(fresnel.schlick(c, **material)),
    lambda **material: arrays.at_least_0(fresnel.schlick_avg(**material)),
)
WHITE_CURVE = Curve(lambda c, tint: 1.0 + 0.0 * c[np.newaxis], lambda tint: np.ones(1))


@dataclass(frozen=True)
class Pair:
    """Arguments of a microfacet BRDF. Components of directions and roughnesses are on axis 0."""

    wo: Array
    wi: Array
    roughness: Array
    cosine: Array
    curve: Curve
    material: Mapping[str, Array]


def compensation(pair: Pair) -> Array:
    """Factor 1 + F_ss (1 - E_ss) / E_ss of [MaterialX2026], Energy Compensation."""
    return 1.0 + pair.curve.average(**pair.material) * missing(pair)


def uncompensated(pair: Pair) -> float:
    return 1.0


def visibility(pair: Pair) -> Array:
    """G2 / (4 mu_o mu_i) as in the specification since July 2026."""
    return ggx.visibility_anisotropic(pair.wo, pair.wi, pair.roughness)


def missing(pair: Pair) -> Array:
    """(1 - E_ss) / E_ss; the error is below 1e-10 if both alphas are equal."""
    return missing_of(pair.wo, pair.roughness)


# For at least MANY directions and one roughness, a polynomial in `_series_variables` replaces the
# quadrature, unless the last coefficients exceed TAIL. DEGREES are the degrees of the polynomial.
DEGREES, TAIL = (32, 16), 5e-6
MANY = (DEGREES[0] + 1) * (DEGREES[1] + 1)


@lru_cache(maxsize=8)
def _anisotropic_missing(rows: bytes) -> Array:
    """(1 - E_ss) / E_ss, shape (N,); `rows` (5, N) holds x, y, z of wo and both alphas."""
    columns = np.frombuffer(rows).reshape(5, -1)
    E = evaluate_number(
        lambda wo, roughness: slope_nodes(wo, roughness)[1].sum(axis=(0, 1)),
        {"wo": columns[:3].T, "roughness": columns[3:].T},
        {},
        QUADRATURE_BLOCK,
    )
    return np.asarray((1.0 - E) / E)


@lru_cache(maxsize=8)
def _series(roughness: tuple[float, float]) -> Array | None:
    """Chebyshev coefficients of (1 - E_ss) / E_ss; None if the coefficients decay too slowly."""
    s, turn = np.meshgrid(*(chebyshev_nodes(degree + 1) for degree in DEGREES), indexing="ij")
    squares = turn / roughness[0], (1.0 - turn) / roughness[1]
    cos_phi, sin_phi = (np.sqrt(each / sum(squares)) for each in squares)
    alpha = np.hypot(roughness[0] * cos_phi, roughness[1] * sin_phi)
    mu = s**3 * alpha / (1.0 + alpha - s**3)
    sine = np.sqrt((1.0 - mu) * (1.0 + mu))
    rows = np.broadcast_arrays(sine * cos_phi, sine * sin_phi, mu, *roughness)
    values = _anisotropic_missing(np.stack(rows).tobytes()).reshape(s.shape)
    series = chebyshev_coefficients(chebyshev_coefficients(values).T).T
    return series if max(abs(series[-4:]).max(), abs(series[:, -2:]).max()) < TAIL else None


def _series_variables(wo: Array, roughness: Array) -> tuple[Array, Array]:
    """Two variables in [0, 1], of which (1 - E_ss) / E_ss is a smooth function.

    The first variable is the cube root of mu (1 + a) / (mu + a), where a is alpha along the azimuth
    of wo. The second variable grows with the square of the cosine of this azimuth.
    """
    x, y = (np.square(wo[k]) * roughness[k] for k in (0, 1))
    sine = np.maximum(np.hypot(wo[0], wo[1]), 1e-150)
    alpha = np.hypot(wo[0] * roughness[0], wo[1] * roughness[1]) / sine
    s = np.minimum(wo[2] * (1.0 + alpha) / np.maximum(wo[2] + alpha, 1e-300), 1.0)
    return np.cbrt(s), x / np.maximum(x + y, 1e-300)


def _missing_by_views(rows: Array) -> Array:
    """(1 - E_ss) / E_ss by one quadrature per direction, or by a polynomial for many directions."""
    wo, alphas = rows[:3], rows[3:]
    uniform = rows.shape[1] >= MANY and not np.ptp(alphas, axis=1).any() and alphas.all()
    if uniform and (series := _series((float(alphas[0, 0]), float(alphas[1, 0])))) is not None:
        s, turn = _series_variables(wo, alphas[:, 0])
        lines = chebyshev_sum(series[:, :, np.newaxis], s)
        return np.asarray(np.maximum(chebyshev_sum(lines, turn), 0.0))
    views, indices = np.unique(rows, axis=1, return_inverse=True)
    return _anisotropic_missing(views.tobytes())[indices.reshape(-1)]


def missing_of(wo: Array, roughness: Array) -> Array:
    """(1 - E_ss) / E_ss for valid float64 arrays, with components on the first axis."""
    isotropic = missing_light(wo[2], ggx.mean_alpha(roughness))
    if array_namespace(wo, roughness) is arrays.NUMPY:
        anisotropic = roughness[0] != roughness[1]
        if not np.any(anisotropic):
            return isotropic
        shape = np.broadcast_shapes(wo.shape[1:], anisotropic.shape)
        total, selected = (
            np.broadcast_to(isotropic, shape).copy(),
            np.broadcast_to(anisotropic, shape),
        )
        # Directions that are mirror images of each other have the same E_ss.
        views = (abs(wo[0]), abs(wo[1]), wo[2])
        rows = [np.broadcast_to(each, shape)[selected] for each in (*views, *roughness)]
        total[selected] = _missing_by_views(np.stack(rows))
        return total
    # If both alphas are equal, `at_both - at_mean` is 0, but has nonzero derivatives.
    mean = ggx.mean_alpha(roughness)
    xp = array_namespace(wo, roughness)
    at_both, at_mean = (
        1.0 / xp.sum(slope_nodes(wo, alphas)[1], axis=(0, 1)) - 1.0
        for alphas in (roughness, xp.stack([mean, mean]))
    )
    return xp.where(roughness[0] == roughness[1], isotropic + (at_both - at_mean), at_both)


@dataclass(frozen=True)
class Lobe:
    """Terms of a microfacet BRDF, by default the terms of [MaterialX2026]."""

    factor: Callable[[Pair], Array | float] = compensation
    visibility: Callable[[Pair], Array] = visibility  # G2 / (4 mu_o mu_i)
    alpha: Callable[[Array], Array] = lambda roughness: roughness  # converts roughness to alpha
    scale: float = 1.0

    def value(self, pair: Pair, wh: Array) -> Array:
        """BRDF for a block of directions, shape (C, ...)."""
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
    """BRDF of a lobe, shape (..., C).

    - `vectors`, `numbers`: Validated inputs of the Fresnel curve; only `vectors` have channels.
    """
    directions = {"wo": checked_directions("wo", wo), "wi": checked_directions("wi", wi)}
    pairs = {"roughness": checked_roughness(roughness)}
    arguments.checked_switch("retroreflective", retroreflective)
    lead = lead_shape(directions | pairs, numbers)
    for name, color in vectors.items():
        arguments.refuse_ambiguous(name, color, lead)

    def value(wo: Array, wi: Array, roughness: Array, **material: Array) -> Array:
        if retroreflective:
            wo = array_namespace(wo).stack([-wo[0], -wo[1], wo[2]])
        wh, cosine = ggx.half_vector(wo, wi)
        return lobe.value(Pair(wo, wi, lobe.alpha(roughness), cosine, curve, material), wh)

    return evaluate_material(
        value, directions | pairs | dict(vectors), numbers, channel_count(vectors)
    )


Color = tuple[float, float, float]
ONE: Color = (1.0, 1.0, 1.0)
GOLD: dict[str, Color] = {"ior": (0.183, 0.421, 1.373), "extinction": (3.424, 2.346, 1.770)}
# For each node: the Fresnel curve, the defaults of inputs with channels, and the defaults of inputs
# without channels.
CATEGORIES: dict[str, tuple[Curve, dict[str, Color], dict[str, float]]] = {
    "dielectric_bsdf": (DIELECTRIC_CURVE, {"tint": ONE}, {"ior": 1.5}),
    "conductor_bsdf": (CONDUCTOR_CURVE, GOLD, {}),
    "generalized_schlick_bsdf": (
        SCHLICK_CURVE,
        {"color0": ONE, "color82": ONE, "color90": ONE},
        {"exponent": 5.0},
    ),
}


def _material(
    category: str, inputs: Mapping[str, ArrayLike]
) -> tuple[Curve, dict[str, Numbers], dict[str, Numbers]]:
    """Fresnel curve of a node, inputs with channels and inputs without channels, validated."""
    curve, colors, numbers = CATEGORIES[category]
    vectors = arguments.checked_vectors({name: inputs[name] for name in colors})
    return curve, vectors, arguments.checked_all({name: inputs[name] for name in numbers})


@any_array
def node_brdf(
    category: str,
    wo: ArrayLike,
    wi: ArrayLike,
    inputs: Mapping[str, ArrayLike],
    lobe: Lobe | None = None,
    retroreflective: bool = False,
) -> Array:
    """BRDF of the node `category`, a key of CATEGORIES; inputs that the node lacks are ignored."""
    material = _material(category, inputs)
    return evaluate_lobe(
        lobe or Lobe(), material[0], wo, wi, inputs["roughness"], *material[1:], retroreflective
    )


@any_array
def node_albedo(
    category: str,
    wo: ArrayLike,
    inputs: Mapping[str, ArrayLike],
    compensate: bool = True,
    summed: bool = False,
) -> Array:
    """Directional albedo of `node_brdf`.

    - `summed`: Whether to sum as MaterialX sums an environment; `slope_nodes` explains how.
    """
    curve, vectors, numbers = _material(category, inputs)
    return lobe_albedo(curve, wo, inputs["roughness"], vectors, numbers, compensate, summed)


@any_array
def dielectric_brdf(
    wo: ArrayLike,
    wi: ArrayLike,
    tint: ArrayLike,
    roughness: ArrayLike,
    ior: ArrayLike,
    retroreflective: bool = False,
    compensate: bool = True,
) -> Array:
    """Reflection of `dielectric_bsdf`, scatter mode R, with energy compensation.

        f = tint D F G2 / (4 mu_o mu_i) (1 + F_ss (1 - E_ss) / E_ss)

    If `ior` < 1, light comes from the denser medium, and F is 1 beyond the critical angle. A
    negative `ior`, which stock MaterialX squares, is rejected. Accuracy: the relative error of the
    compensation factor is below 1e-10. At alpha >= 0.05, the relative error of the other factors is
    below 2e-14. [MaterialX2026], sections Microfacet BRDF, Energy Compensation and dielectric_bsdf.

        >>> dielectric_brdf([0.6, 0.0, 0.8], [-0.6, 0.0, 0.8], 1.0, [0.3, 0.3], 1.5).round(6)
        array([0.060074])
    """
    inputs = {"tint": tint, "ior": ior, "roughness": roughness}
    return node_brdf("dielectric_bsdf", wo, wi, inputs, _lobe(compensate), retroreflective)


@any_array
def conductor_brdf(
    wo: ArrayLike,
    wi: ArrayLike,
    roughness: ArrayLike,
    ior: ArrayLike,
    extinction: ArrayLike,
    retroreflective: bool = False,
    compensate: bool = True,
) -> Array:
    """Reflection of `conductor_bsdf` with energy compensation.

        f = D F G2 / (4 mu_o mu_i) (1 + F_ss (1 - E_ss) / E_ss)

    [MaterialX2026], sections Microfacet BRDF, Energy Compensation and conductor_bsdf.

        >>> wo, wi, gold = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8], ([0.183, 1.373], [3.424, 1.770])
        >>> conductor_brdf(wo, wi, [0.3, 0.3], *gold).round(6)
        array([1.472308, 0.543655])
    """
    inputs = {"ior": ior, "extinction": extinction, "roughness": roughness}
    return node_brdf("conductor_bsdf", wo, wi, inputs, _lobe(compensate), retroreflective)


@any_array
def generalized_schlick_brdf(
    wo: ArrayLike,
    wi: ArrayLike,
    color0: ArrayLike,
    color82: ArrayLike,
    color90: ArrayLike,
    roughness: ArrayLike,
    exponent: ArrayLike,
    retroreflective: bool = False,
    compensate: bool = True,
) -> Array:
    """Reflection of `generalized_schlick_bsdf`, scatter mode R, with energy compensation.

        f = D F G2 / (4 mu_o mu_i) (1 + F_ss (1 - E_ss) / E_ss)

    As in OpenPBR, F is 0 where the published curve is negative; `mxeon.models.fresnel_schlick` has
    an example. F_ss is 0 where the closed form of F_ss is negative. [MaterialX2026], sections
    Microfacet BRDF and generalized_schlick_bsdf.

        >>> wo, wi = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]
        >>> generalized_schlick_brdf(wo, wi, [0.9, 0.2], 0.5, 1.0, [0.3, 0.3], 5.0).round(6)
        array([1.382929, 0.278522])
    """
    inputs = {"color0": color0, "color82": color82, "color90": color90}
    inputs |= {"roughness": roughness, "exponent": exponent}
    return node_brdf("generalized_schlick_bsdf", wo, wi, inputs, _lobe(compensate), retroreflective)


def _lobe(compensate: bool) -> Lobe:
    arguments.checked_switch("compensate", compensate)
    return Lobe() if compensate else Lobe(factor=uncompensated)


QUADRATURE_BLOCK = 2**3  # elements per block of a quadrature over slopes


@any_array
def dielectric_albedo_dir(
    wo: ArrayLike, tint: ArrayLike, roughness: ArrayLike, ior: ArrayLike, compensate: bool = True
) -> Array:
    """Directional albedo of `dielectric_brdf`, by quadrature.

    For `ior` < 1, the slope of F is infinite at the critical angle, so the quadrature is split at
    this angle. The error of isotropic lobes is below 1e-10. At alpha 0, the albedo is tint F(mu_o).
    [MaterialX2026], section Directional Albedo and Energy Conservation.

        >>> dielectric_albedo_dir([0.6, 0.0, 0.8], 1.0, [0.3, 0.3], 1.5).round(6)
        array([0.040169])
    """
    inputs = {"tint": tint, "ior": ior, "roughness": roughness}
    return node_albedo("dielectric_bsdf", wo, inputs, compensate)


@any_array
def conductor_albedo_dir(
    wo: ArrayLike,
    roughness: ArrayLike,
    ior: ArrayLike,
    extinction: ArrayLike,
    compensate: bool = True,
) -> Array:
    """Directional albedo of `conductor_brdf`, by quadrature.

    [MaterialX2026], section Directional Albedo and Energy Conservation.

        >>> gold = [0.183, 1.373], [3.424, 1.770]
        >>> conductor_albedo_dir([0.6, 0.0, 0.8], [0.3, 0.3], *gold).round(6)
        array([0.935317, 0.347053])
    """
    inputs = {"ior": ior, "extinction": extinction, "roughness": roughness}
    return node_albedo("conductor_bsdf", wo, inputs, compensate)


@any_array
def generalized_schlick_albedo_dir(
    wo: ArrayLike,
    color0: ArrayLike,
    color82: ArrayLike,
    color90: ArrayLike,
    roughness: ArrayLike,
    exponent: ArrayLike,
    compensate: bool = True,
) -> Array:
    """Directional albedo of `generalized_schlick_brdf`, by quadrature.

    [MaterialX2026], section Directional Albedo and Energy Conservation.

        >>> wo, roughness = [0.6, 0.0, 0.8], [0.3, 0.3]
        >>> generalized_schlick_albedo_dir(wo, [1.0, 0.2], 1.0, 1.0, roughness, 5.0).round(6)
        array([1.      , 0.179402])
    """
    inputs = {"color0": color0, "color82": color82, "color90": color90}
    inputs |= {"roughness": roughness, "exponent": exponent}
    return node_albedo("generalized_schlick_bsdf", wo, inputs, compensate)


@any_array
def ggx_albedo_dir_anisotropic(wo: ArrayLike, roughness: ArrayLike) -> Array:
    """Directional albedo of anisotropic GGX at unit Fresnel reflectance, by quadrature.

    Accuracy: the error is below 5e-6 for mu_o >= 1e-4 and roughness >= 1e-4. Cosines below 1e-12
    are raised to 1e-12. [MaterialX2026], sections Energy Compensation and Height-Correlated Smith
    Masking-Shadowing.

        >>> ggx_albedo_dir_anisotropic([[0.6, 0.0, 0.8], [0.0, 0.6, 0.8]], [0.1, 0.5]).round(6)
        array([0.815356, 0.804722])
    """
    tint = {"tint": arrays.like(np.ones(1), checked_directions("wo", wo))}
    return lobe_albedo(WHITE_CURVE, wo, roughness, tint, {}, False)[..., 0][()]


def lobe_albedo(
    curve: Curve,
    wo: ArrayLike,
    roughness: ArrayLike,
    vectors: Mapping[str, Numbers],
    numbers: Mapping[str, Numbers],
    compensate: bool,
    summed: bool = False,
) -> Array:
    """Directional albedo of a lobe, shape (..., C).

    - `vectors`, `numbers`: Validated inputs of the Fresnel curve; only `vectors` have channels.
    """
    wo, roughness = checked_directions("wo", wo), checked_roughness(roughness)
    arguments.checked_switch("compensate", compensate)

    def value(
        wo: Array, roughness: Array, unseen: Array, average: Array, **material: Array
    ) -> Array:
        c, weight = slope_nodes(wo, roughness, summed=summed)
        xp, new = array_namespace(c), (slice(None), np.newaxis, np.newaxis)
        spread = {k: v[new] if k in vectors else v for k, v in material.items()}
        E = xp.sum(curve.at(c, **spread) * weight, axis=(1, 2))
        squared = curve.critical(**material)
        if not summed and (arrays.library(squared) or np.any(squared > 0.0)):
            # The albedo is the albedo of lossless facets, minus the light transmitted by facets
            # whose cosine exceeds the critical cosine.
            alpha, isotropic = 0.5 * (roughness[0] + roughness[1]), roughness[0] == roughness[1]
            lossless = xp.where(isotropic, albedo(wo[2], alpha), xp.sum(weight, axis=(0, 1)))
            c, weight = transmitting_nodes(wo, roughness, arrays.at_least_0(squared))
            lost = xp.sum((1.0 - curve.at(c, **spread)) * weight, axis=(1, 2))
            E = xp.where(squared > 0.0, lossless - lost, E)
        E = E * (1.0 + average * unseen) if compensate else E
        return E * material["tint"] if "tint" in material else E

    views = {"wo": wo, "roughness": roughness}
    lead_shape(views | dict(vectors), numbers)  # raises an error that names the arguments
    # The compensation does not depend on the slopes, so one value per direction suffices.
    channels, unseen, average = channel_count(vectors), np.zeros(()), np.zeros(1)
    if compensate:
        unseen = evaluate_number(missing_of, views, {})
        average = evaluate_material(curve.average, vectors, numbers, channels)
    columns = {**views, **vectors, "average": average}
    return evaluate_material(
        value, columns, {"unseen": unseen, **numbers}, channels, QUADRATURE_BLOCK
    )
