# SPDX-License-Identifier: Apache-2.0
"""Transmission through microfacets of dielectrics and of the generalized Schlick node.

BTDFs are in 1/sr and without the cosine. `ior` is the index of refraction of wi's medium divided by
the index of wo's medium, so `ior` is the inverse of the node's index if wo is inside the solid. If
alpha is 0, or if the index of refraction is 1, so that light is not bent, the BTDF is a delta
function and counts as 0. BTDFs are for radiance, which is divided by ior^2 when light passes from
the medium of wi to the medium of wo. Hence the integral of BTDF times cosine over wi, multiplied by
ior^2, is the transmitted fraction of the energy. This fraction is the mean of (1 - F) G2 / G1(wo)
over the visible normals. The specification does not compensate for light that is lost between
facets.

- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, tangent
  +x; wo has z >= 0, wi has z <= 0.
- `tint` (..., C): Color per channel, in [0, 1]; a number is one channel.
- `roughness` (..., 2) or (): alpha along tangent and bitangent, in [0, 1]; a number is isotropic.
- `ior` (...): Index of refraction of the far side relative to wo's side, in [0, 1e50].
- `color0`, `color82`, `color90` (..., C): Reflectance along the normal, multiplier at the angle
  acos(1/7), and reflectance at grazing incidence, per channel, in [0, 1]; a number is one channel.
- `exponent` (...): Exponent of the Schlick curve, in [0, 1e50].
- `reading`: A key of READINGS. The reading of the specification of `generalized_schlick_bsdf`
  determines 1 - F and the index of refraction, which the node lacks.
- `shadow`: Whether facets on the far side shadow transmitted light, as in the BTDF. Without this
  shadowing, the transmitted fraction is the mean of 1 - F over the visible normals.
- `inside`: Whether wo is inside the solid, where light is totally reflected beyond the critical
  angle.

Raises `ValueError`, which names the first bad element or lists the readings, if an argument leaves
its range, the shapes do not broadcast or the reading is unknown.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from mxeon.models.core import arguments, arrays
from mxeon.models.core.arguments import (
    channel_count,
    checked,
    checked_directions,
    checked_roughness,
)
from mxeon.models.core.arrays import Array, ArrayLike, Numbers, any_array, array_namespace, within
from mxeon.models.core.chebyshev import chebyshev_coefficients, chebyshev_nodes, chebyshev_sum
from mxeon.models.core.evaluation import evaluate_material
from mxeon.models.microfacet import DIELECTRIC_CURVE, fresnel, ggx
from mxeon.models.microfacet.slopes import refracting_nodes
from mxeon.models.sampling import visible_normal


@any_array
def refraction_direction(wo: ArrayLike, normal: ArrayLike, ior: ArrayLike) -> Array:
    """Direction `wi` on the far side from which refracted light leaves along `wo`.

        cos_t = sqrt(1 - (1 - cos_o^2) / ior^2),  wi = -wo / ior + (cos_o / ior - cos_t) normal

    - `normal` (..., 3): Normal of the surface or microfacet, unit vector to 1e-6, z >= 0.

    Result (..., 3): unit vectors, or (0, 0, 0) if light is totally reflected or if wo is behind the
    normal. [MaterialX2026], section Reflection and Transmission; [Walter2007], Eq. (40).

        >>> refraction_direction([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], [1.5, 0.5]).round(6)
        array([[-0.4     , -0.      , -0.916515],
               [ 0.      ,  0.      ,  0.      ]])
    """
    vectors = {"wo": checked_directions("wo", wo), "normal": checked_directions("normal", normal)}
    return evaluate_material(refracted, vectors, {"ior": checked("ior", ior)}, 3)


def refracted(wo: Array, normal: Array, ior: Array) -> Array:
    """`refraction_direction` for valid float64 arrays, with components on the first axis."""
    xp = array_namespace(wo, normal, ior)
    least = fresnel.least_ior(wo)
    bends = ior > least  # an interface with a smaller index reflects all light
    inverse = 1.0 / arrays.guarded(xp.maximum(ior, least), bends, 1.0)
    cosine = xp.sum(wo * normal, axis=0)
    squared = 1.0 - inverse * inverse * (1.0 - cosine) * (1.0 + cosine)
    passes = (squared > 0.0) & (cosine > 0.0) & bends
    scale = inverse * cosine - arrays.root(xp.maximum(squared, 0.0))
    wi = scale * normal - inverse * wo
    return xp.where(passes, wi, 0.0)


def transmitting_facet(wo: Array, wi: Array, ior: Array) -> tuple[Array, Array, Array]:
    """For the facet that refracts wo to wi: normal wh, cosine |wo . wh| and Jacobian |d wh / d wi|.

    All three results are 0 if no microfacet refracts wo to wi. The Jacobian is
    n^2 |wi . wh| / |wo + n wi|^2 with n = ior: [Walter2007], Eq. (17).
    """
    xp = array_namespace(wo, wi, ior)
    total = wo + ior * wi
    length = arrays.root(xp.sum(total * total, axis=0))
    side_o, side_i = xp.sum(wo * total, axis=0), xp.sum(wi * total, axis=0)
    real = (length > 0.0) & (side_o * side_i < 0.0) & (side_o * total[2] > 0.0)
    scale = xp.where(real, 1.0, 0.0) / xp.where(length > 0.0, length, 1.0)
    normal = total * (scale * xp.where(total[2] < 0.0, -1.0, 1.0))
    cosine_o, cosine_i = (arrays.trimmed(xp.abs(side) * scale, 1.0) for side in (side_o, side_i))
    return normal, cosine_o, (ior * scale) ** 2 * cosine_i


@any_array
def dielectric_btdf(
    wo: ArrayLike,
    wi: ArrayLike,
    tint: ArrayLike,
    roughness: ArrayLike,
    ior: ArrayLike,
) -> Array:
    """Transmission of `dielectric_bsdf`, scatter modes T and RT.

        f = tint |wo . wh| |wi . wh| (1 - F) D G2 / (mu_o |mu_i| (wo . wh + ior wi . wh)^2)

    With `ior` 0, which disables the Fresnel curve of the node, F is 1, and nothing is transmitted.
    As in [Walter2007], f is 0 unless wo and wi lie on different sides of the microfacet. Without
    this condition, which the specification omits, f would be positive for pairs of directions that
    no facet connects. [MaterialX2026], sections Microfacet BTDF and dielectric_bsdf; [Walter2007],
    Eq. (21).

        >>> wo = [0.6, 0.0, 0.8]
        >>> wi = refraction_direction(wo, [0.0, 0.0, 1.0], 1.5)
        >>> dielectric_btdf(wo, wi, 1.0, [0.3, 0.3], 1.5).round(6)
        array([10.066984])
    """
    vectors = arguments.checked_vectors({"tint": tint})
    return evaluate_btdf(DIELECTRIC_CURVE.at, wo, wi, roughness, ior, vectors, {})


def evaluate_btdf(
    at: Callable[..., Array],
    wo: ArrayLike,
    wi: ArrayLike,
    roughness: ArrayLike,
    ior: ArrayLike,
    vectors: dict[str, Numbers],
    numbers: dict[str, Numbers],
) -> Array:
    """BTDF, shape (..., C), for the Fresnel reflectance F that `at` computes.

    - `at`: `at(cosine, ior=ior, **material)`, shape (C, ...), is F for the cosine wo . wh.
    """
    directions = {"wo": checked_directions("wo", wo), "wi": arguments.checked_transmitted("wi", wi)}
    pairs = {"roughness": checked_roughness(roughness)}

    def value(wo: Array, wi: Array, roughness: Array, ior: Array, **material: Array) -> Array:
        wh, cosine, jacobian = transmitting_facet(wo, wi, ior)
        F = at(cosine, ior=ior, **material)
        above = array_namespace(wi).stack([wi[0], wi[1], -wi[2]])
        G2 = ggx.visibility_anisotropic(wo, above, roughness)
        least = fresnel.least_ior(wo)
        bends = ior > least  # `ior` 0 transmits no light
        index = arrays.guarded(array_namespace(ior).maximum(ior, least), bends, 1.0)
        lobe = ggx.ndf(wh, roughness) * G2 / index**2
        f = (1.0 - F) * (4.0 * lobe * cosine * jacobian)
        return f * material["tint"] if "tint" in material else f

    return evaluate_material(
        value,
        directions | pairs | vectors,
        {"ior": checked("ior", ior), **numbers},
        channel_count(vectors),
    )


CAP_NODES = 48  # number of heights, and number of azimuths, on the spherical cap of visible normals
CAP_BLOCK = 2**4  # elements per block
# Largest 1 - ior^2 in the quadrature; if `ior` is below 3e-8, almost no light is transmitted.
MOST_SQUARED = 1.0 - 1e-15

# Values at each quadrature node: wo . wh, the cosine of wi, the length of (alpha_x x, alpha_y y, z)
# for wi = (x, y, z), and the weight.
Nodes: TypeAlias = tuple[Array, Array, Array, Array]


@any_array
def dielectric_transmittance_dir(
    wo: ArrayLike,
    tint: ArrayLike,
    roughness: ArrayLike,
    ior: ArrayLike,
    shadow: bool = True,
) -> Array:
    """Fraction of the light from `wo` that is transmitted, by quadrature.

        T(wo) = ior^2 integral of dielectric_btdf |mu_i| over the hemisphere of wi

    Result (..., C): in [0, 1] if alpha_x and alpha_y are equal; tint (1 - F(mu_o)) at alpha 0.
    Accuracy: the absolute error is below 2e-4 for `ior` >= 1, and below 1e-8 for `ior` < 1, where
    the quadrature is split at the critical angle, since the slope of F is infinite at that angle.
    The directional albedo of the BTDF for radiance is T / ior^2. [MaterialX2026], section
    Directional Albedo and Energy Conservation; [Walter2007], Eq. (21).

        >>> dielectric_transmittance_dir([0.6, 0.0, 0.8], 1.0, [0.3, 0.3], [1.5, 0.75]).round(3)
        array([[0.939],
               [0.732]])
    """
    vectors = arguments.checked_vectors({"tint": tint})
    numbers = {"ior": checked("ior", ior)}
    return evaluate_transmittance(DIELECTRIC_CURVE.at, wo, roughness, vectors, numbers, shadow)


def evaluate_transmittance(
    at: Callable[..., Array],
    wo: ArrayLike,
    roughness: ArrayLike,
    vectors: dict[str, Numbers],
    numbers: dict[str, Numbers],
    shadow: bool,
) -> Array:
    """Transmitted fraction, shape (..., C), for the Fresnel reflectance F that `at` computes.

    - `vectors`, `numbers`: Validated inputs; only `vectors` have channels. `ior` is in `numbers`.
    """
    directions = {"wo": checked_directions("wo", wo)}
    pairs = {"roughness": checked_roughness(roughness)}
    arguments.checked_switch("shadow", shadow)

    def total(
        wo: Array, roughness: Array, material: dict[str, Array], nodes: Nodes, axes: int
    ) -> Array:
        cosine, mu_i, length_i, weight = nodes
        new = (slice(None), *(np.newaxis,) * axes)
        spread = {k: v[new] if k in vectors else v for k, v in material.items()}
        passed = (1.0 - at(cosine, **spread)) * weight
        if shadow:
            # Multiply by G2 / G1(wo), which is finite for grazing wo and is 1 at alpha 0.
            mu_i, length = within(mu_i), ggx.stretched_length(wo, roughness)
            visibility = ggx.reciprocal(2.0 * (length * mu_i + length_i * wo[2]))
            passed = passed * (2.0 * mu_i * visibility * (wo[2] + length))
        return array_namespace(passed).sum(passed, axis=tuple(range(1, 1 + axes)))

    def value(wo: Array, roughness: Array, **material: Array) -> Array:
        wo, roughness = wo + 0.0 * roughness[:1], roughness + 0.0 * wo[:1]
        ior = material["ior"]
        T = total(wo, roughness, material, _visible(wo, roughness, ior), 1)
        if arrays.library(ior) or np.any(ior < 1.0):
            squared = within((1.0 - ior) * (1.0 + ior), 0.0, min(MOST_SQUARED, arrays.below_1(ior)))
            split = refracting_nodes(wo, roughness, squared)
            T = array_namespace(T).where(ior < 1.0, total(wo, roughness, material, split, 2), T)
        return T * material["tint"] if "tint" in material else T

    given = {**directions, **pairs, **vectors}
    return evaluate_material(value, given, numbers, channel_count(vectors), CAP_BLOCK)


def _visible(wo: Array, roughness: Array, ior: Array) -> Nodes:
    """Quadrature nodes over visible facets. Facets that transmit no light have weight 0."""
    height, turn, weight = (arrays.like(each, wo) for each in _nodes(wo.ndim))
    xp, view = array_namespace(wo), wo[:, np.newaxis]
    wh = visible_normal(view, height, turn, roughness[:, np.newaxis])
    wi = refracted(view, wh, ior)
    length_i, mu_i = ggx.stretched_length(wi, roughness[:, np.newaxis]), -wi[2]
    weight = weight * xp.where(mu_i > 0.0, 1.0, 0.0)
    return within(xp.sum(view * wh, axis=0)), mu_i, length_i, weight


@lru_cache(maxsize=2)
def _nodes(axes: int) -> tuple[Array, Array, Array]:
    """Nodes in the two random numbers that select a visible normal, and weights of the nodes."""
    x, w = np.polynomial.legendre.leggauss(CAP_NODES)
    around = (np.arange(CAP_NODES) + 0.5) / CAP_NODES
    height, turn = np.meshgrid(0.5 * (x + 1.0), around, indexing="ij")
    weight = np.repeat(0.5 * w / CAP_NODES, CAP_NODES)
    shape = (-1, *(1,) * (axes - 1))
    return height.reshape(shape), turn.reshape(shape), weight.reshape(shape)


PASSED_NODES = 40  # Chebyshev nodes in the cube root of mu (1 + scale) / (mu + scale)
# Lower limit of `scale`. If `scale` were near 0, all nodes would be near the horizon.
LEAST_SCALE = 0.05


def reversed_transmittance(
    mu: Array, alpha: float, ior: float, reflected: Callable[[Array], Array]
) -> Array:
    """Fraction of light transmitted from the denser side, (N, C), computed from reversed paths.

    P(wo) is the fraction that is transmitted from outside. Reversing a path exchanges wo and wi:

        n^2 mu_i T(wi, wo) = P(wo) p(wo, wi) mu_o
        p(wo, wi) = G1(wo) D |wo . wh| / mu_o |d wh / d wi|

    Hence T(wi, wo) = P(wo) G1(wo) / G1(wi) p(wi, wo), and the fraction transmitted from the denser
    side is the mean of P G1(wo) / G1(wi) over the facets visible from wi. The cosine-weighted
    average of this fraction, multiplied by n^2, is the average of P.

    - `mu` (N,): Cosines on the denser side.
    - `ior`: Index of refraction of the far side relative to the denser side, below 1.
    - `reflected`: Function from cosines outside, (M,), to the albedo 1 - P, (M, C).
    """
    s, scale = chebyshev_nodes(PASSED_NODES) ** 3, max(alpha, LEAST_SCALE)
    passed = 1.0 - reflected(s * scale / (1.0 + scale - s))
    wo, roughness = np.stack([np.sqrt(1.0 - mu * mu), 0.0 * mu, mu]), np.full((2, len(mu)), alpha)
    squared = np.full(len(mu), (1.0 - ior) * (1.0 + ior))
    _, mu_t, length, weight = refracting_nodes(wo, roughness, squared)
    x = np.cbrt(np.minimum(mu_t * (1.0 + scale) / (mu_t + scale), 1.0))
    stretched = ggx.stretched_length(wo, roughness)
    weight = weight * mu_t * (mu + stretched) / (mu * (mu_t + length))
    axes = tuple(range(weight.ndim - 1))
    rows = [chebyshev_sum(row, x) for row in chebyshev_coefficients(passed).T]
    return np.stack([np.sum(weight * row, axis=axes) for row in rows], axis=-1)


# MaterialX converts the reflectance along the normal to an index of refraction after a clamp to
# [DARKEST, BRIGHTEST].
DARKEST, BRIGHTEST = 0.01, 0.99


@dataclass(frozen=True)
class Reading:
    """A way to derive the index of refraction and F from the inputs of the Schlick node.

    - `index`: "average" for one index of refraction from the mean of color0's channels, or
      "channel" for one index of refraction per channel.
    """

    title: str
    curve: Callable[..., Array]  # F for transmission, as a function of the cosine outside the solid
    index: str = "average"
    least: float = DARKEST  # lower limit of the reflectance along the normal

    def at(self, cosine: Array, ior: Array, **inputs: Array) -> Array:
        """F for the cosine wo . wh, or 1 if light is totally reflected.

        If `ior` is below 1, wo is inside the solid, and F uses the cosine outside the solid.
        """
        xp = array_namespace(cosine, ior)
        squared = (
            1.0 - (1.0 - cosine) * (1.0 + cosine) / xp.maximum(ior, fresnel.least_ior(ior)) ** 2
        )
        inside = ior < 1.0
        F = self.curve(xp.where(inside, arrays.root(arrays.at_least_0(squared)), cosine), **inputs)
        return xp.where(inside & (squared <= 0.0), 1.0, F)


def _whole(cosine: Array, color0: Array, color82: Array, color90: Array, exponent: Array) -> Array:
    """The Fresnel curve F of the Schlick node, clamped to [0, 1]."""
    return within(fresnel.schlick(cosine, color0, color82, color90, exponent))


READINGS = {
    "text": Reading("1 - F of all inputs, kept in [0, 1]", _whole),
    "unclamped": Reading("1 - F of all inputs, as it is", fresnel.schlick),
    "channel": Reading("1 - F of all inputs; an index for each channel", _whole, "channel"),
    "closure": Reading(
        "1 - F without color82",
        lambda c, color82, **rest: _whole(c, color82=0.0 * color82 + 1.0, **rest),
        least=0.0,
    ),
    "grazing": Reading(
        "1 - F with color82 color90 at grazing",
        lambda c, color82, color90, **rest: _whole(
            c, color82=0.0 * color82 + 1.0, color90=color82 * color90, **rest
        ),
        "channel",
    ),
    "dielectric": Reading(
        "1 - F of the index of color0 alone",
        lambda c, color0, **others: fresnel.dielectric(c, index_of(_mean(color0, 0), DARKEST)),
    ),
}


@any_array
def schlick_ior(color0: ArrayLike, reading: str = "text") -> Array:
    """Index of refraction of the Schlick node from the reflectance along the normal.

        ior = (1 + sqrt(r)) / (1 - sqrt(r)),  r in [0.01, 0.99]

    Result (..., C) or (..., 1): one index of refraction per channel, or one for all channels,
    depending on the reading. The limits of r are from stock MaterialX, and keep the index of
    refraction in [1.22, 399], so light is refracted even if the reflectance is 0. [MaterialX2026],
    sections Generalized Schlick Equations and Thin-Film Iridescence.

        >>> schlick_ior([0.04, 0.25]).round(4), schlick_ior([0.04, 0.25], "channel").round(4)
        (array([2.2299]), array([1.5, 3. ]))
    """
    how = READINGS[arguments.checked_choice("reading", reading, READINGS)]
    r = arguments.checked_color("color0", color0)
    return index_of(_mean(r, -1) if how.index == "average" else r, how.least)


def index_of(reflectance: Array, least: float) -> Array:
    """Index of refraction for the reflectance along the normal after a clamp to [least, 0.99]."""
    amplitude = arrays.root(within(reflectance, least, BRIGHTEST))
    return (1.0 + amplitude) / (1.0 - amplitude)


def _mean(color: Array, axis: int) -> Array:
    return array_namespace(color).mean(color, axis=axis, keepdims=True)


@any_array
def generalized_schlick_btdf(
    wo: ArrayLike,
    wi: ArrayLike,
    color0: ArrayLike,
    color82: ArrayLike,
    color90: ArrayLike,
    roughness: ArrayLike,
    exponent: ArrayLike,
    reading: str = "text",
    inside: bool = False,
) -> Array:
    """Transmission of `generalized_schlick_bsdf`, scatter modes T and RT.

    As in renderers, F is evaluated at the angle outside the solid for light from either side. So
    the BTDF divided by the squared index of refraction is reciprocal. Taken literally, the
    specification evaluates F at the angle of the incident light, so F would depend on the direction
    in which light follows a path. [MaterialX2026], sections Microfacet BTDF and
    generalized_schlick_bsdf.

        >>> pair = [0.6, 0.0, 0.8], [-0.4, 0.0, -0.916515]
        >>> generalized_schlick_btdf(*pair, 0.04, 1.0, 1.0, [0.3, 0.3], 5.0).round(4)
        array([10.1048])
    """
    vectors = {"wo": checked_directions("wo", wo), "wi": arguments.checked_transmitted("wi", wi)}
    return _by_index(
        lambda at, ior, material, numbers: evaluate_btdf(
            at, wo, wi, roughness, ior, material, numbers
        ),
        vectors | {"roughness": checked_roughness(roughness)},
        {"color0": color0, "color82": color82, "color90": color90},
        exponent,
        reading,
        inside,
    )


@any_array
def generalized_schlick_transmittance_dir(
    wo: ArrayLike,
    color0: ArrayLike,
    color82: ArrayLike,
    color90: ArrayLike,
    roughness: ArrayLike,
    exponent: ArrayLike,
    reading: str = "text",
    inside: bool = False,
    shadow: bool = True,
) -> Array:
    """Fraction of the light from `wo` that is transmitted, by quadrature.

    Accuracy: the absolute error is below 2e-4 for a wo outside the solid and an exponent of at
    least 1, and below 1e-8 for a wo inside. [MaterialX2026], section Directional Albedo and Energy
    Conservation.

        >>> wo, alpha = [0.6, 0.0, 0.8], [0.3, 0.3]
        >>> generalized_schlick_transmittance_dir(wo, [0.04, 0.25], 1.0, 1.0, alpha, 5.0).round(3)
        array([0.945, 0.738])
    """
    vectors = {"wo": checked_directions("wo", wo), "roughness": checked_roughness(roughness)}
    return _by_index(
        lambda at, ior, material, numbers: evaluate_transmittance(
            at, wo, roughness, material, numbers | {"ior": ior}, shadow
        ),
        vectors,
        {"color0": color0, "color82": color82, "color90": color90},
        exponent,
        reading,
        inside,
    )


def _by_index(
    evaluate: Callable[..., Array],
    vectors: dict[str, Numbers],
    colors: Mapping[str, ArrayLike],
    exponent: ArrayLike,
    reading: str,
    inside: bool,
) -> Array:
    """Result of `evaluate(F, index, colors, numbers)`.

    If channels have different indices of refraction, `evaluate` is called for each channel.
    """
    how = READINGS[arguments.checked_choice("reading", reading, READINGS)]
    arguments.checked_switch("inside", inside)
    material = {name: arguments.checked_color(name, value) for name, value in colors.items()}
    count, numbers = channel_count(material), {"exponent": checked("exponent", exponent)}
    arguments.lead_shape(vectors | material, numbers)

    def index(color0: Array) -> Array:
        outside = index_of(color0, how.least)
        return 1.0 / outside if inside else outside

    if how.index == "average":
        return evaluate(how.at, index(_mean(material["color0"], -1)[..., 0]), material, numbers)
    xp, channels = array_namespace(*material.values()), []
    material = {k: xp.broadcast_to(v, (*v.shape[:-1], count)) for k, v in material.items()}
    for channel in range(count):
        single = {name: value[..., channel : channel + 1] for name, value in material.items()}
        channels.append(evaluate(how.at, index(single["color0"][..., 0]), single, numbers))
    return xp.concat(channels, axis=-1)
