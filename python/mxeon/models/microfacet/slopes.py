# SPDX-License-Identifier: Apache-2.0
"""Quadratures over the slopes of the microfacets that are visible from one direction.

If the half vector is parallel to (alpha_x r cos(phi), alpha_y r sin(phi), 1), an albedo is

    integral of F G2 (wo . wh) / (h_z mu_o) r / (pi (1 + r^2)^2) dr dphi,

where r ends at the value for which wi reaches the horizon. For any alpha, the integrand has no
sharp peak, and its only kink is at the critical angle, where F has a kink.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mxeon.models.core import arrays
from mxeon.models.core.arrays import Array, array_namespace, at_least_0, at_most, hypot, like, root
from mxeon.models.core.quadrature import unit_rule
from mxeon.models.microfacet.ggx import mean_alpha, smith_lambda

# Quadratures have SLOPE_NODES nodes per panel of r, and QUADRANT nodes per quadrant of phi.
SLOPE_NODES, PANELS, QUADRANT = 20, 3, 20
# Nodes per panel of r and nodes per azimuth interval, used if there is a critical angle.
SPLIT_NODES, SPLIT_PART = 28, 32

# Smallest cosine of wo and largest r. Facets with a larger r reflect less than 1e-12 of the light.
LEAST_MU, LARGEST_R = 1e-12, 1e8
# Lower limit of `scale`. Facets with a smaller r reflect less than 1e-7 of the light.
LEAST_SCALE = 3e-4
# Largest r of refracting facets. Facets with a larger r refract at most 1e-12 of the light.
FARTHEST_R = 1e12


@dataclass(frozen=True)
class Slopes:
    """Slopes visible from a direction, in polar coordinates r and omega.

    At omega = 0, the cosine between the direction and the slope's normal grows fastest with r.

    - `mu_o`: Cosine of the direction's polar angle.
    - `stretched`: (alpha_x x, alpha_y y), where x and y are components of the direction.
    """

    mu_o: Array
    stretched: tuple[Array, Array]
    steepness: Array  # the factor A in wo . h / h_z = mu_o + r A cos(omega)
    axis: tuple[Array, Array]  # cosine and sine of phi at omega 0
    roughness: Array

    @classmethod
    def seen(cls, wo: Array, roughness: Array) -> Slopes:
        """The slopes visible from `wo` (3, ...)."""
        (x, y, _), (alpha_x, alpha_y) = wo, roughness
        xp, A = array_namespace(wo, roughness), hypot(x * alpha_x, y * alpha_y)
        tilted, length = A > 0.0, xp.where(A > 0.0, A, 1.0)
        axis = (
            xp.where(tilted, x * alpha_x, 1.0) / length,
            xp.where(tilted, y * alpha_y, 0.0) / length,
        )
        mu_o = at_most(xp.maximum(wo[2], LEAST_MU), 1.0)
        return cls(mu_o, (x * alpha_x, y * alpha_y), A, axis, roughness)

    @property
    def scale(self) -> Array:
        """Width of the integrand's steepest part, in r and, near right angles, in omega."""
        maximum = array_namespace(self.mu_o, self.steepness).maximum
        return self.mu_o / maximum(self.steepness, self.mu_o)

    @property
    def isotropic(self) -> bool:
        """Whether all surfaces are known to be isotropic."""
        known = array_namespace(self.roughness) is arrays.NUMPY
        return known and bool(np.all(self.roughness[0] == self.roughness[1]))

    def rays(self, omega: Array) -> tuple[Array, Array, tuple[Array, Array]]:
        """Returns B, the largest r and the slope (alpha_x cos(phi), alpha_y sin(phi)) at r = 1.

        The azimuth of the slope is phi = omega + phi_0, where tan(phi_0) = alpha_y y / (alpha_x x).
        Then

            wo . h / h_z = mu_o + r (alpha_x x cos(phi) + alpha_y y sin(phi)) = mu_o + B r
            B = A cos(omega)
            |h / h_z|^2 = 1 + g r^2,  g = (alpha_x cos(phi))^2 + (alpha_y sin(phi))^2

        The cosine of the reflected direction, mu_i = 2 (wo . h) h_z / |h|^2 - mu_o
        = 2 (mu_o + B r) / (1 + g r^2) - mu_o, is at least 0 if mu_o g r^2 <= 2 B r + mu_o. So the
        largest r is (B + q) / (mu_o g) = mu_o / (q - B), where q = sqrt(B^2 + mu_o^2 g). The first
        form does not cancel for B >= 0, and the second form does not cancel for B < 0.
        """
        (cos_0, sin_0), (alpha_x, alpha_y) = self.axis, self.roughness
        xp = array_namespace(omega)
        cosine, sine = xp.cos(omega), xp.sin(omega)
        slope = (
            alpha_x * (cos_0 * cosine - sin_0 * sine),
            alpha_y * (sin_0 * cosine + cos_0 * sine),
        )
        g = _squared(slope)
        B = self.steepness * cosine
        ahead = xp.abs(B) + root(B * B + self.mu_o * self.mu_o * g)
        ahead = xp.maximum(ahead, self.mu_o / LARGEST_R)
        beyond = ahead / xp.maximum(self.mu_o * g, ahead / LARGEST_R)
        return B, xp.where(B < 0.0, self.mu_o / ahead, beyond), slope

    def facets(
        self, r: Array, B: Array, slope: tuple[Array, Array], alpha: Array | None = None
    ) -> tuple[Array, Array]:
        """Cosine wo . h and the integrand without F.

        - `alpha`: An isotropic alpha that replaces the roughness in G_2 / G_1, or None.
        """
        xp = array_namespace(r, B)
        lean = at_least_0(B * r + self.mu_o)
        stretch = 1.0 + _squared(slope) * r * r
        double = 2.0 * lean / stretch
        mu_i = at_most(at_least_0(double - self.mu_o), 1.0)
        cosine = at_most(lean / xp.sqrt(stretch), 1.0)
        if alpha is not None:
            length_o, length_i = smith_lambda(self.mu_o, alpha), smith_lambda(mu_i, alpha)
            masking = mu_i * (self.mu_o + length_o) / (length_o * mu_i + length_i * self.mu_o)
            seen = 2.0 * lean / (self.mu_o + hypot(self.mu_o, self.steepness))
            return cosine, _density(r) * seen * masking
        # Tangent and bitangent components of wi = 2 (wo . h) h - wo, times alpha_x and alpha_y,
        # respectively.
        along, across = (
            alpha * double * r * each - of_wo
            for alpha, each, of_wo in zip(self.roughness, slope, self.stretched, strict=True)
        )
        length_i = root(along * along + across * across + mu_i * mu_i)
        smith = hypot(self.mu_o, self.steepness) * mu_i + length_i * self.mu_o
        return cosine, _density(r) * 2.0 * mu_i * lean / smith


def _squared(slope: tuple[Array, Array]) -> Array:
    return slope[0] ** 2 + slope[1] ** 2


def _density(r: Array) -> Array:
    """Probability density of a slope with the polar coordinates r and omega."""
    return r / (np.pi * (1.0 + r * r) ** 2)


def slope_nodes(
    wo: Array, roughness: Array, isotropic: bool = False, summed: bool = False
) -> tuple[Array, Array]:
    """Cosine wo . h and weight of every node, shape (nodes of r, nodes of phi, ...).

    - `isotropic`: True if all surfaces are isotropic; symmetry then halves the number of nodes.
    - `summed`: True to sum as MaterialX sums an environment over visible normals, with G_2 / G_1 at
      the geometric mean of both alphas.
    """
    slopes = Slopes.seen(wo, roughness)
    scale = array_namespace(slopes.scale).maximum(slopes.scale, LEAST_SCALE)
    omega, weight_omega = _quadrants(scale, isotropic or slopes.isotropic)
    B, limit, slope = slopes.rays(omega)
    r, weight = _graded(scale, limit)
    cosine, values = slopes.facets(r, B, slope, mean_alpha(roughness) if summed else None)
    return cosine, weight * weight_omega * values


def transmitting_nodes(wo: Array, roughness: Array, squared: Array) -> tuple[Array, Array]:
    """Cosine wo . h and weight of nodes whose cosine is larger than the critical cosine.

    Near the critical cosine, 1 - F behaves like a square root. Nodes are therefore denser at both
    ends of the range of r, and at the azimuths where this range becomes empty.

    - `squared` (...): Square of the cosine of the critical angle, at least 0.
    """
    slopes = Slopes.seen(wo, roughness)
    # Azimuth, relative to wo, of the facet at the critical angle that reflects wo to the horizon.
    mu_o, xp = slopes.mu_o, array_namespace(slopes.mu_o, squared)
    steep = root(at_least_0(4.0 * squared / mu_o**2 - 1.0))
    length = root((1.0 - mu_o) * (1.0 + mu_o)) * steep
    cosine = (2.0 * squared / mu_o - mu_o) / xp.where(length > 0.0, length, 1.0)
    meeting = arrays.arccosine(xp.where(length > 0.0, cosine, 0.0))
    omega, weight_omega = _split_azimuths(slopes, wo, squared, meeting)
    B, limit, slope = slopes.rays(omega)
    low, high = _transmitting(mu_o, B, _squared(slope), squared)
    high = xp.minimum(high, limit)
    r, weight = _between(slopes.scale, xp.minimum(low, high), high)
    cosine, values = slopes.facets(r, B, slope)
    return cosine, weight * weight_omega * values


def refracting_nodes(
    wo: Array, roughness: Array, squared: Array
) -> tuple[Array, Array, Array, Array]:
    """Returns wo . h, the cosine of wi, the stretched length of wi, and the weight of each node.

    With n^2 = 1 - squared and L = |wo + n wi|, the refracted wi = (L h - wo) / n points below the
    horizon if r exceeds the smaller root of mu_o^2 g r^2 - 2 mu_o B r + squared = mu_o^2.
    """
    slopes = Slopes.seen(wo, roughness)
    mu_o = slopes.mu_o
    # Azimuth intervals end where a facet at the critical angle is vertical.
    omega, weight_omega = _split_azimuths(slopes, wo, squared, _cone_azimuth(mu_o, squared))
    B, _, slope = slopes.rays(omega)
    g = _squared(slope)
    # At the smallest r, facets refract wo to the horizon. Total reflection begins at the largest r.
    low, high = _transmitting(mu_o, B, g, squared)
    xp = array_namespace(mu_o, high)
    high = xp.minimum(high, FARTHEST_R)
    beyond = squared - mu_o * mu_o
    ahead = mu_o * (B + root(at_least_0(B * B - g * beyond)))
    horizon = beyond / xp.where(ahead > 0.0, ahead, 1.0)
    low = xp.where((beyond > 0.0) & (B > 0.0), xp.maximum(low, horizon), low)
    r, weight = _between(slopes.scale, xp.minimum(low, high), high)
    lean, stretch = at_least_0(B * r + mu_o), 1.0 + g * r * r
    cosine = at_most(lean / xp.sqrt(stretch), 1.0)
    total = cosine + root(at_least_0(cosine * cosine - squared))
    length = squared / arrays.guarded(total, total > 0.0, 1.0)
    inverse = 1.0 / xp.sqrt(1.0 - squared)
    vertical = length / xp.sqrt(stretch)
    mu_i = arrays.within((mu_o - vertical) * inverse)
    along, across = (
        (alpha * vertical * r * each - of_wo) * inverse
        for alpha, each, of_wo in zip(roughness, slope, slopes.stretched, strict=True)
    )
    length_i = root(along * along + across * across + mu_i * mu_i)
    seen = 2.0 * lean / (mu_o + hypot(mu_o, slopes.steepness))
    return cosine, mu_i, length_i, weight * weight_omega * _density(r) * seen


def _transmitting(mu_o: Array, B: Array, g: Array, squared: Array) -> tuple[Array, Array]:
    """Range of r in which (mu_o + B r)^2 > squared (1 + g r^2), or (0, 0) if there is no such r."""
    a, b, d = B * B - squared * g, mu_o * B, mu_o * mu_o - squared
    xp, size = array_namespace(a, b, d), root(at_least_0(b * b - a * d))
    ahead, inside = b > 0.0, d > 0.0
    none = ~inside & (~ahead | (b * b < a * d))
    low = xp.where(inside, 0.0, -d / xp.where(ahead, b + size, 1.0))
    falling = xp.where(a < 0.0, (b + size) / xp.where(a < 0.0, -a, 1.0), np.inf)
    # The divisor `size - b` is 0 only if alpha is 0.
    behind = xp.where(size > b, d / xp.where(size > b, size - b, 1.0), np.inf)
    high = xp.where(ahead, falling, behind)
    return xp.where(none, 0.0, low), xp.where(none, 0.0, high)


def _split_azimuths(
    slopes: Slopes, wo: Array, squared: Array, meeting: Array
) -> tuple[Array, Array]:
    """Nodes and weights in omega, in intervals that end at two azimuths on either side of wo.

    The azimuths are `meeting` and the largest azimuth of facets that transmit light.
    """
    xp = array_namespace(slopes.mu_o, wo, squared, meeting)
    last = _cone_azimuth(slopes.mu_o, squared - slopes.mu_o**2)
    inside, right = slopes.mu_o * slopes.mu_o >= squared, 0.5 * np.pi
    nodes = []
    # As r increases, wo . h increases for |omega| < pi / 2, and decreases for |omega| > pi / 2.
    for center in (0.0, np.pi):
        low, high = (
            xp.where(
                inside,
                sign * right,
                _omega(slopes, wo, sign * last) if center == 0.0 else 0.0 * last,
            )
            for sign in (-1.0, 1.0)
        )
        splits = [_omega(slopes, wo, sign * meeting) - sign * center for sign in (-1.0, 1.0)]
        shape = np.broadcast_shapes(*(tuple(each.shape) for each in (low, *splits, high)))
        ends = low, *splits, 0.0 * low, high
        points = xp.stack([xp.broadcast_to(each, shape) for each in ends])
        points = xp.maximum(points, xp.maximum(low, -right + 0.0 * low))
        points = xp.sort(xp.minimum(points, xp.minimum(high, right + 0.0 * high)), axis=0)
        half = points[2:] if slopes.isotropic else points
        for first, end in pairwise(half):
            omega, weight = _piece(slopes.scale, first, end)
            nodes.append((center + omega, weight * (2.0 if slopes.isotropic else 1.0)))
    omega, weight = (xp.concat(each) for each in zip(*nodes, strict=True))
    return omega[np.newaxis], weight[np.newaxis]


def _cone_azimuth(mu_o: Array, squared: Array) -> Array:
    """Azimuth relative to wo whose cosine is sqrt(squared) / sin(theta_o)."""
    xp, sine = array_namespace(mu_o, squared), root((1.0 - mu_o) * (1.0 + mu_o))
    return arrays.arccosine(root(at_least_0(squared)) / xp.where(sine > 0.0, sine, 1.0))


def _omega(slopes: Slopes, wo: Array, azimuth: Array) -> Array:
    """Coordinate omega, in [-pi, pi], of slopes whose `azimuth` is relative to wo."""
    xp, upright = array_namespace(wo, azimuth), hypot(wo[0], wo[1]) == 0.0
    x, y = xp.where(upright, 1.0, wo[0]), wo[1]
    cosine, sine = xp.cos(azimuth), xp.sin(azimuth)
    across = (x * cosine - y * sine) * slopes.roughness[1]
    along = (y * cosine + x * sine) * slopes.roughness[0]
    cos_0, sin_0 = slopes.axis
    omega = arrays.angle(cos_0 * along - sin_0 * across, cos_0 * across + sin_0 * along)
    return xp.where(hypot(across, along) > 0.0, omega, azimuth)


def _piece(scale: Array, low: Array, high: Array) -> tuple[Array, Array]:
    """Nodes and weights in omega for [low, high], an interval on one side of 0.

    The nodes are denser towards both ends, and towards right angles.
    """
    xp, (t, weight) = array_namespace(scale, low, high), _crowded(1, SPLIT_PART, low)
    side = xp.where(low + high < 0.0, -1.0, 1.0)
    near, far = xp.minimum(side * low, side * high), xp.maximum(side * low, side * high)
    first, last = (xp.asinh((0.5 * np.pi - each) / scale) for each in (far, near))
    x = first + (last - first) * t
    return side * (0.5 * np.pi - scale * xp.sinh(x)), weight * (last - first) * scale * xp.cosh(x)


def _between(scale: Array, low: Array, high: Array) -> tuple[Array, Array]:
    """Nodes and weights in r for [low, high].

    The spacing is sqrt(r^2 + scale^2) times a factor that decreases towards both ends.
    """
    xp, (t, weight) = array_namespace(scale, low, high), _crowded(PANELS, SPLIT_NODES, low[0])
    first, last = xp.asinh(low / scale), xp.asinh(high / scale)
    x = first + (last - first) * t
    return scale * xp.sinh(x), weight * (last - first) * scale * xp.cosh(x)


def _crowded(panels: int, nodes: int, array: Array) -> tuple[Array, Array]:
    """Nodes and weights for [0, 1] on a new first axis, quadratically denser towards both ends."""
    (u, weight), shape = unit_rule(nodes, panels), (-1, *(1,) * array.ndim)
    x, weight = u * u * (3.0 - 2.0 * u), 6.0 * u * (1.0 - u) * weight
    return like(x.reshape(shape), array), like(weight.reshape(shape), array)


def _quadrants(scale: Array, isotropic: bool) -> tuple[Array, Array]:
    """Nodes and weights in omega, shape (1, n, ...). The nodes are denser towards right angles.

    Isotropic surfaces need only half the nodes.
    """
    xp = array_namespace(scale)
    x, weight = (like(v.reshape(-1, *(1,) * scale.ndim), scale) for v in unit_rule(QUADRANT))
    extent = xp.asinh(0.5 * np.pi / scale)
    omega = 0.5 * np.pi - scale * xp.sinh(extent * x)
    weight = weight * extent * scale * xp.cosh(extent * x)
    if isotropic:
        omega, weight = xp.concat([omega, np.pi - omega]), xp.concat([2.0 * weight] * 2)
    else:
        omega = xp.concat([omega, np.pi - omega, -omega, np.pi + omega])
        weight = xp.concat([weight] * 4)
    return omega[np.newaxis], weight[np.newaxis]


def _graded(scale: Array, length: Array) -> tuple[Array, Array]:
    """Nodes and weights for [0, length] on the first axis.

    The spacing at x is proportional to sqrt(x^2 + scale^2).
    """
    xp, shape = array_namespace(length), (-1, *(1,) * (length.ndim - 1))
    x, weight = (like(each.reshape(shape), length) for each in unit_rule(SLOPE_NODES, PANELS))
    extent = xp.asinh(length / scale)
    rise = xp.exp(extent * x)
    fall = 1.0 / rise
    half = 0.5 * scale
    # One exponential takes a third of the time of sinh and cosh.
    return half * (rise - fall), weight * extent * half * (rise + fall)
