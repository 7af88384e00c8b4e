# SPDX-License-Identifier: Apache-2.0
"""Light through microfacets: refraction, the BTDF, the share that passes, and the readings of Schlick.

BTDFs are in 1/sr and without the cosine. Indices of refraction are those of the side of wi relative to those of wo: a
view from inside a solid has the inverse of the node's index. alpha 0 is a delta function, which has no value; it
counts as 0, and so does an index of 1, which bends nothing. Radiance is scaled by the square of the index as light
enters another medium, so values are divided by it; times ior^2 they integrate over wi to the transmitted share. Shares that
pass are the mean of (1 - F) G2 / G1(wo) over the normals as they are seen; the text has no compensation for what
transmission loses between facets.

- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, tangent +x; wo has
  z >= 0, wi has z <= 0.
- `tint` (..., C): Color per channel, in [0, 1]; a number is one channel.
- `roughness` (..., 2) or (): alpha along tangent and bitangent, in [0, 1]; a number is isotropic.
- `ior` (...): Index of refraction of the far side relative to that of wo, in [0, 1e50].
- `color0`, `color82`, `color90` (..., C): Reflectance along the normal, multiplier at acos(1/7), and reflectance at
  grazing, per channel, in [0, 1]; a number is one channel.
- `exponent` (...): Exponent of the Schlick curve, in [0, 1e50].
- `reading`: A key of READINGS: the replacement for the index that `generalized_schlick_bsdf` lacks, and
  of 1 - F of a curve that may leave [0, 1].
- `shadow`: Whether light is lost to other facets on the far side, as in the BTDF; otherwise the share is the mean of
  1 - F over the normals that wo sees.
- `inside`: Whether wo lies inside of the solid, where light is totally reflected beyond an angle.

Raises `ValueError`, which names the first bad element or lists the readings, if an argument leaves its range, the
shapes do not broadcast or the reading is unknown.
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

LEAST_IOR = 1e-50  # all light is reflected below this index; its square is a divisor


@any_array
def refraction_direction(wo: ArrayLike, normal: ArrayLike, ior: ArrayLike) -> Array:
    """Refracted direction on the far side for light along `wo`, and vice versa.

        cos_t = sqrt(1 - (1 - cos_o^2) / ior^2),  wi = -wo / ior + (cos_o / ior - cos_t) normal

    - `normal` (..., 3): Normal of the surface or microfacet, unit vector to 1e-6, z >= 0.

    Result (..., 3): (0, 0, 0) at total internal reflection, and where wo lies behind the normal. [MaterialX2026],
    Reflection and Transmission; [Walter2007], Eq. (40).

        >>> refraction_direction([0.6, 0.0, 0.8], [0.0, 0.0, 1.0], [1.5, 0.5]).round(6)
        array([[-0.4     , -0.      , -0.916515],
               [ 0.      ,  0.      ,  0.      ]])
    """
    vectors = {"wo": checked_directions("wo", wo), "normal": checked_directions("normal", normal)}
    return evaluate_material(refracted, vectors, {"ior": checked("ior", ior)}, 3)


def refracted(wo: Array, normal: Array, ior: Array) -> Array:
    """`refraction_direction` on float64 arrays, components first."""
    xp = array_namespace(wo, normal, ior)
    bends = ior > max(LEAST_IOR, arrays.least_normal(wo))
    inverse = 1.0 / arrays.guarded(xp.maximum(ior, LEAST_IOR), bends, 1.0)
    cosine = xp.sum(wo * normal, axis=0)
    squared = 1.0 - inverse * inverse * (1.0 - cosine) * (1.0 + cosine)
    passes = (squared > 0.0) & (cosine > 0.0) & bends
    scale = inverse * cosine - arrays.root(xp.maximum(squared, 0.0))
    wi = scale * normal - inverse * wo
    return xp.where(passes, wi, 0.0)


@dataclass(frozen=True)
class Facet:
    """The microfacet between directions on either side of it, on float64 arrays, components first."""

    normal: Array  # unit vector on the side of wo; 0 if no facet joins the directions
    cosine_o: Array  # |wo . wh|; 0 without a facet
    cosine_i: Array  # |wi . wh|; 0 without a facet
    jacobian: Array  # |d wh / d wi|, solid angle of normals per solid angle of wi

    @classmethod
    def of(cls, wo: Array, wi: Array, ior: Array) -> Facet:
        """The facet between wo and wi: |wo + n wi|^2 (d wh / d wi) = n^2 |wi . wh|, [Walter2007], Eq. (17)."""
        xp = array_namespace(wo, wi, ior)
        total = wo + ior * wi
        length = arrays.root(xp.sum(total * total, axis=0))
        side_o, side_i = xp.sum(wo * total, axis=0), xp.sum(wi * total, axis=0)
        real = (length > 0.0) & (side_o * side_i < 0.0) & (side_o * total[2] > 0.0)
        scale = xp.where(real, 1.0, 0.0) / xp.where(length > 0.0, length, 1.0)
        normal = total * (scale * xp.where(total[2] < 0.0, -1.0, 1.0))
        cosine_o, cosine_i = (
            arrays.trimmed(xp.abs(side) * scale, 1.0) for side in (side_o, side_i)
        )
        return cls(normal, cosine_o, cosine_i, (ior * scale) ** 2 * cosine_i)


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

    `ior` 0 disables the Fresnel curve: F is 1, and nothing passes. The specification does not say that the two
    directions lie on either side of the microfacet, [Walter2007] does; without that condition light passes between
    directions that no facet joins. [MaterialX2026], Microfacet BTDF; dielectric_bsdf; [Walter2007], Eq. (21).

        >>> wo = [0.6, 0.0, 0.8]
        >>> wi = refraction_direction(wo, [0.0, 0.0, 1.0], 1.5)
        >>> dielectric_btdf(wo, wi, 1.0, [0.3, 0.3], 1.5).round(6)
        array([10.066984])
    """
    vectors = {"tint": arguments.checked_vector("tint", tint)}
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
    """Values of a BTDF, shape (..., C); `vectors` and `numbers` are checked inputs of the curve.

    - `at`: `at(cosine, ior=ior, **material)`, shape (C, ...): F at the cosine on the side of wo.
    """
    directions = {"wo": checked_directions("wo", wo), "wi": arguments.checked_transmitted("wi", wi)}
    pairs = {"roughness": checked_roughness(roughness)}

    def value(wo: Array, wi: Array, roughness: Array, ior: Array, **material: Array) -> Array:
        facet = Facet.of(wo, wi, ior)
        F = at(facet.cosine_o, ior=ior, **material)
        above = array_namespace(wi).stack([wi[0], wi[1], -wi[2]])
        G2 = ggx.visibility_anisotropic(wo, above, roughness)
        bends = ior > max(LEAST_IOR, arrays.least_normal(wo))  # an index of 0 passes nothing
        index = arrays.guarded(array_namespace(ior).maximum(ior, LEAST_IOR), bends, 1.0)
        lobe = ggx.ndf(facet.normal, roughness) * G2 / index**2
        f = (1.0 - F) * (4.0 * lobe * facet.cosine_o * facet.jacobian)
        return f * material["tint"] if "tint" in material else f

    return evaluate_material(
        value,
        directions | pairs | vectors,
        {"ior": checked("ior", ior), **numbers},
        channel_count(vectors),
    )


CAP_NODES, CAP_BLOCK = (
    48,
    2**4,
)  # nodes in height and in azimuth of the cap of normals; views per block
MOST_SQUARED = 1.0 - 1e-15  # largest squared sine; almost nothing passes below an index of 3e-8

# Cosines wo . h and of wi, length of wi stretched by the roughness, and weights.
Nodes: TypeAlias = tuple[Array, Array, Array, Array]


@any_array
def dielectric_transmittance_dir(
    wo: ArrayLike,
    tint: ArrayLike,
    roughness: ArrayLike,
    ior: ArrayLike,
    shadow: bool = True,
) -> Array:
    """Transmitted share of the light from `wo`, by quadrature.

        T(wo) = ior^2 integral of dielectric_btdf |mu_i| over the hemisphere of wi

    Result (..., C): in [0, 1] where alpha_x and alpha_y are equal. Accuracy: absolute error below
    2e-4 for `ior` >= 1, and below 1e-8 for smaller indices, since the quadrature is split at the
    critical angle, where F has an infinite slope. At alpha 0 it is that of a plane, tint (1 -
    F(mu_o)). The albedo of the radiance, over all lights of one view, is this divided by ior^2.
    [MaterialX2026], Directional Albedo and Energy Conservation; [Walter2007], Eq. (21).

        >>> dielectric_transmittance_dir([0.6, 0.0, 0.8], 1.0, [0.3, 0.3], [1.5, 0.75]).round(3)
        array([[0.939],
               [0.732]])
    """
    vectors = {"tint": arguments.checked_vector("tint", tint)}
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
    """Transmittance, shape (..., C), for checked inputs; `numbers` includes the index."""
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
            # G2 / G1(wo), whose limits at grazing are finite; 1 at alpha 0.
            mu_i, length = within(mu_i), ggx.stretched_length(wo, roughness)
            visibility = ggx.reciprocal(2.0 * (length * mu_i + length_i * wo[2]))
            passed = passed * (2.0 * mu_i * visibility * (wo[2] + length))
        T: Array = array_namespace(passed).sum(passed, axis=tuple(range(1, 1 + axes)))
        return T

    def value(wo: Array, roughness: Array, **material: Array) -> Array:
        wo, roughness = wo + 0.0 * roughness[:1], roughness + 0.0 * wo[:1]
        ior = material["ior"]
        T = total(wo, roughness, material, _visible(wo, roughness, ior), 1)
        if arrays.library(ior) or np.any(ior < 1.0):
            squared = within((1.0 - ior) * (1.0 + ior), 0.0, MOST_SQUARED)
            split = refracting_nodes(wo, roughness, squared)
            T = array_namespace(T).where(ior < 1.0, total(wo, roughness, material, split, 2), T)
        return T * material["tint"] if "tint" in material else T

    given = {**directions, **pairs, **vectors}
    return evaluate_material(value, given, numbers, channel_count(vectors), CAP_BLOCK)


def _visible(wo: Array, roughness: Array, ior: Array) -> Nodes:
    """Quadrature nodes over visible facets; weight 0 if their light does not reach the far side."""
    xp, (height, turn, weight) = (
        array_namespace(wo),
        (arrays.like(each, wo) for each in _nodes(wo.ndim)),
    )
    view = wo[:, np.newaxis]
    wh = visible_normal(view, height, turn, roughness[:, np.newaxis])
    wi = refracted(view, wh, ior)
    length_i, mu_i = ggx.stretched_length(wi, roughness[:, np.newaxis]), -wi[2]
    weight = weight * xp.where(mu_i > 0.0, 1.0, 0.0)
    return within(xp.sum(view * wh, axis=0)), mu_i, length_i, weight


@lru_cache(maxsize=2)
def _nodes(axes: int) -> tuple[Array, Array, Array]:
    """Random numbers for the visible normals, and weights, on an axis before the view axes."""
    x, w = np.polynomial.legendre.leggauss(CAP_NODES)
    around = (np.arange(CAP_NODES) + 0.5) / CAP_NODES
    height, turn = np.meshgrid(0.5 * (x + 1.0), around, indexing="ij")
    weight = np.repeat(0.5 * w / CAP_NODES, CAP_NODES)
    shape = (-1, *(1,) * (axes - 1))
    return height.reshape(shape), turn.reshape(shape), weight.reshape(shape)


PASSED_NODES = 40  # nodes of the share passed from outside, in the cube root of mu / (mu + scale)
LEAST_SCALE = 0.05  # smallest scale, otherwise alpha; near 0 all nodes would be at grazing


def reversed_transmittance(
    mu: Array, alpha: float, ior: float, reflected: Callable[[Array], Array]
) -> Array:
    """Share of the light that passes from the denser side, (N, C), from the paths from outside reversed.

        n^2 mu_i T(wi, wo) = P(wo) p(wo, wi) mu_o,  p(wo, wi) = G1(wo) D |wo . wh| / mu_o |d wh / d wi|

    Then T(wi, wo) = P(wo) G1(wo) / G1(wi) p(wi, wo), and the share is the mean of P G1(wo) / G1(wi) over the facets
    that wi sees. Its cosine-weighted average over wi times n^2 is that of P.

    - `mu` (N,): Cosines on the denser side.
    - `ior`: Index of the far side relative to that of the view, below 1.
    - `reflected`: Albedo from outside, 1 - P, of cosines (M,), (M, C).
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


DARKEST, BRIGHTEST = 0.01, 0.99  # range of normal reflectances that MaterialX inverts to an index


@dataclass(frozen=True)
class Reading:
    """How transmission derives its index and curve from the node's inputs.

    - `index`: "average": one index, of the mean of color0 over the channels; "channel": one of
      each.
    """

    title: str
    curve: Callable[..., Array]  # F of transmission, at the angle outside the solid
    index: str = "average"
    least: float = DARKEST  # smallest reflectance that is converted to an index

    def at(self, cosine: Array, ior: Array, **inputs: Array) -> Array:
        """F for light at this cosine, from inside if the index is below 1: 1 at total reflection."""
        xp = array_namespace(cosine, ior)
        squared = 1.0 - (1.0 - cosine) * (1.0 + cosine) / xp.maximum(ior, 1e-50) ** 2
        inside = ior < 1.0
        F = self.curve(xp.where(inside, arrays.root(arrays.at_least_0(squared)), cosine), **inputs)
        return xp.where(inside & (squared <= 0.0), 1.0, F)


def _whole(cosine: Array, color0: Array, color82: Array, color90: Array, exponent: Array) -> Array:
    """The node's F, clamped to [0, 1]."""
    return within(fresnel.schlick(cosine, color0, color82, color90, exponent))


READINGS = {
    "text": Reading("1 - F of all inputs, kept in [0, 1]", _whole),
    "unclamped": Reading("1 - F of all inputs, as it is", fresnel.schlick),
    "channel": Reading("1 - F of all inputs; an index for each channel", _whole, "channel"),
    "closure": Reading(
        "1 - F without color82",
        lambda c, color0, color82, color90, exponent: _whole(
            c, color0, 0.0 * color82 + 1.0, color90, exponent
        ),
        least=0.0,
    ),
    "grazing": Reading(
        "1 - F with color82 color90 at grazing",
        lambda c, color0, color82, color90, exponent: _whole(
            c, color0, 0.0 * color82 + 1.0, color82 * color90, exponent
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
    """Index of refraction of a reflectance along the normal: one for each channel (..., C), or one for all (..., 1).

        ior = (1 + sqrt(r)) / (1 - sqrt(r)),  r in [0.01, 0.99]

    The bounds are stock MaterialX's: the index lies in [1.22, 399], so that a reflectance of 0 still refracts.
    [MaterialX2026], Generalized Schlick Equations, Thin-Film Iridescence.

        >>> schlick_ior([0.04, 0.25]).round(4), schlick_ior([0.04, 0.25], "channel").round(4)
        (array([2.2299]), array([1.5, 3. ]))
    """
    how = _reading(reading)
    r = arguments.checked_color("color0", color0)
    return index_of(_mean(r, -1) if how.index == "average" else r, how.least)


def index_of(reflectance: Array, least: float) -> Array:
    """Index for a reflectance along the normal, which is clamped to [least, 0.99]."""
    amplitude = arrays.root(within(reflectance, least, BRIGHTEST))
    return (1.0 + amplitude) / (1.0 - amplitude)


def _mean(color: Array, axis: int) -> Array:
    """Mean over the channels, as a single channel."""
    mean: Array = array_namespace(color).mean(color, axis=axis, keepdims=True)
    return mean


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

    F is taken at the angle on the outside, whichever side the light comes from, as in renderers.
    This makes the value over the squared index reciprocal. Taken literally, the specification uses
    the angle of the incident light, which gives a different F for each direction of a path.
    [MaterialX2026], Microfacet BTDF; generalized_schlick_bsdf.

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
    """Transmitted share of the light from `wo`, by quadrature.

    Accuracy: absolute error below 2e-4 from outside for exponents >= 1, and below 1e-8 from inside. [MaterialX2026],
    Directional Albedo and Energy Conservation.

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
    given: Mapping[str, ArrayLike],
    exponent: ArrayLike,
    reading: str,
    inside: bool,
) -> Array:
    """evaluate(F, index, colors, numbers) for all channels at once, or channel by channel with its own index."""
    how = _reading(reading)
    arguments.checked_switch("inside", inside)
    colors = {name: arguments.checked_color(name, value) for name, value in given.items()}
    count, numbers = channel_count(colors), {"exponent": checked("exponent", exponent)}
    arguments.lead_shape(vectors | colors, numbers)

    def index(color0: Array) -> Array:
        outside = index_of(color0, how.least)
        return 1.0 / outside if inside else outside

    if how.index == "average":
        return evaluate(how.at, index(_mean(colors["color0"], -1)[..., 0]), colors, numbers)
    xp, channels = array_namespace(*colors.values()), []
    colors = {k: xp.broadcast_to(v, (*v.shape[:-1], count)) for k, v in colors.items()}
    for channel in range(count):
        own = {name: value[..., channel : channel + 1] for name, value in colors.items()}
        channels.append(evaluate(how.at, index(own["color0"][..., 0]), own, numbers))
    return xp.concat(channels, axis=-1)


def _reading(name: str) -> Reading:
    return READINGS[arguments.checked_choice("reading", name, READINGS)]
