# SPDX-License-Identifier: Apache-2.0
"""Thin films on the microfacet nodes of pbrlib: reflectances, lobes, albedos, and spectra to compare with.

Sections are those of [MaterialX2026], appendix Thin-Film Iridescence Model, after [Belcour2017]. A film of thickness
0 is the node's own Fresnel curve.

- `mu` (...): Cosine between direction and microfacet normal, in [0, 1].
- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, tangent +x, z >= 0.
- `category`, `inputs`: Category of the node, and its inputs by the names of its ports, colors with one or three
  channels; `thinfilm_thickness` (...) in nm, in [0, 1e9], and `thinfilm_ior` (...), in [1, 1e50].
- `form`: Choices that the text leaves open: the matrix to RGB, the number of orders, how an index per channel enters a sum
  over CIE XYZ, and the treatment of values outside [0, 1], which the text clamps at the very end.

Result (..., 3): linear RGB, in [0, 1].

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the shapes do
not broadcast.

The film is at least as dense as the vacuum above it, so that the amplitude r12 of its upper interface is real; that of
the lower one is r23 = sqrt(R23) e^(i phi_23). The text prints reflectances and phases, R12, R23 and
phi = phi_21 + phi_23, and sums

    I = C_0 + 2 sum of C_m S(m D, m phi),  C_0 = R12 + R_s,  R_s = T121^2 R23 / (1 - R12 R23),
    C_m = (R_s - T121) sqrt(R12 R23)^m,  T121 = 1 - R12

With z = r21 r23 = -r12 r23, whose length is sqrt(R12 R23) and whose angle is phi, the m-th term is the real part of
z^m. Roots and phases have no derivative where a reflectance is 0: for a film of index 1, at Brewster's angle, over a
substrate of its own index. z^m has.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.polynomial import legendre

from mxeon.models.core import arguments, arrays
from mxeon.models.core.arrays import NUMPY, Array, ArrayLike, any_array, array_namespace, like, root
from mxeon.models.core.chebyshev import chebyshev_coefficients, chebyshev_nodes, chebyshev_sum
from mxeon.models.core.colorimetry import XYZ_TO_REC709, XYZ_TO_REC709_E
from mxeon.models.core.evaluation import evaluate_material
from mxeon.models.microfacet import CATEGORIES, Curve, Lobe, evaluate_lobe, fresnel, lobe_albedo

Complex: TypeAlias = tuple[Array, Array]  # real and imaginary part

# Gaussians of the sensitivities, as the text has them: tristimulus, v in m, mu in 1/m, sigma^2 in 1/m^2. XYZ of films
# up to 2000 nm with indices up to 2.3 differ from sums over wavelengths by at most 0.012 over dielectrics, 0.017 over metals.
GAUSSIANS = (
    (0, 5.4856e-13, 1.6810e6, 4.3278e9),
    (0, 9.7470e-14, 2.2399e6, 4.5282e9),
    (1, 4.4201e-13, 1.7953e6, 9.3046e9),
    (2, 5.2481e-13, 2.2084e6, 6.6121e9),
)
NORMAL = 1.0685e-7
METERS = 1e-9  # 1 nm in m
# Centers, standard deviations, and weights in XYZ of the Gaussians, (3, 4).
CENTERS = np.array([mu for _, _, mu, _ in GAUSSIANS])
SPREADS = np.sqrt([variance for *_, variance in GAUSSIANS])
AREAS = [v * np.sqrt(2.0 * np.pi * variance) / NORMAL for _, v, _, variance in GAUSSIANS]
WEIGHTS = np.eye(3)[:, [row for row, *_ in GAUSSIANS]] * AREAS

# All orders are summed one by one where THIN_SPREAD <= 2 pi OPD sigma: the terms after DAMPED_ORDERS
# of them are below exp(-(30 * 0.2)^2) = 3e-16. Thinner films are integrated over wavenumbers, by the
# trapezoidal rule over 6.5 standard deviations, where a Gaussian falls to 2^-48, in steps of a fifth of one.
THIN_SPREAD, DAMPED_ORDERS = 0.2, 30
STEP, STEPS = 0.2, 32
SAME = 2.0**-20  # relative difference of indices that round the same number
# Weights of the trapezoidal rule's nodes from the center on, and of all nodes.
HEIGHTS = STEP * np.exp(-0.5 * (STEP * np.arange(STEPS + 1)) ** 2) / np.sqrt(2.0 * np.pi)
HEIGHT = 2.0 * float(HEIGHTS.sum()) - float(HEIGHTS[0])
FILM_BLOCK = 2**13  # elements per block


class Interface(NamedTuple):
    """Amplitudes r12 and -r23 of one polarization, seen from the film, and R23."""

    first: Array
    second: Complex
    reflectance: Array


def refracted(mu: Array, film_ior: Array) -> Array:
    """cos theta_t: Three-Layer Geometry."""
    xp = array_namespace(mu, film_ior)
    squared = xp.maximum(1.0 - (1.0 - mu) * (1.0 + mu) / film_ior**2, 0.0)
    # For a film of index 1 this is mu, with a derivative at grazing.
    return xp.sqrt(squared) if xp is NUMPY else xp.where(squared > 0.0, root(squared), mu)


def path_difference(mu: Array, thickness: Array, film_ior: Array) -> Array:
    """Optical path difference in m: Optical Path Difference."""
    return 2.0 * film_ior * refracted(mu, film_ior) * thickness * METERS


def over_index(
    mu: Array, film_ior: Array, ior: Array, extinction: Array
) -> tuple[Interface, Interface]:
    """Film over a dielectric or a conductor, for both polarizations, p before s.

    Printed, with c = film_ior cos theta_t, n = ior + i extinction and W = n cos theta_3 = sqrt(n^2 - sin^2 theta):

        r_s = (c - W) / (c + W),  r_p = (n^2 c - film_ior^2 W) / (n^2 c + film_ior^2 W)

    W^2 - c^2 = n^2 - film_ior^2, so that -r_s = (n^2 - film_ior^2) / (W + c)^2: no difference of roots. And
    n^2 = W^2 + sin^2, film_ior^2 = c^2 + sin^2 make n^2 c -+ film_ior^2 W = (W -+ c) (c W -+ sin^2), so that
    r_p = -r_s (c W - sin^2) / (c W + sin^2).
    """
    xp = array_namespace(mu, film_ior, ior, extinction)
    c, S2 = film_ior * refracted(mu, film_ior), (1.0 - mu) * (1.0 + mu)
    # W = U + iV; U V = ior extinction gives the smaller part without a cancellation.
    Q, A = ior * extinction, (ior - extinction) * (ior + extinction) - S2
    larger = root(0.5 * (fresnel.modulus(A, 2.0 * Q) + arrays.magnitude(A)))
    smaller = Q / xp.where(larger > 0.0, larger, 1.0)
    U, V = xp.where(A >= 0.0, larger, smaller), xp.where(A >= 0.0, smaller, larger)
    gap = (ior - film_ior) * (ior + film_ior) - extinction * extinction, 2.0 * Q
    s = _quotient(gap, ((U + c) ** 2 - V * V, 2.0 * (U + c) * V), 0.0)
    p = _product(s, _quotient((c * U - S2, c * V), (c * U + S2, c * V), 1.0))
    first_p, first_s = first_amplitudes(mu, film_ior)
    return Interface(first_p, p, _squared(p)), Interface(first_s, s, _squared(s))


def over_schlick(
    mu: Array, film_ior: Array, F: Array, color0: Array
) -> tuple[Interface, Interface]:
    """Film over a Schlick substrate whose curve is F at cos theta_t, for both polarizations.

    If a dip makes F negative there is no amplitude, and F counts as 0. The phase jumps where both
    indices are equal. Indices within SAME count as equal, because in float32 color0 = 0.04 is off
    by 2e-8 from the color of a film of index 1.5.
    """
    xp = array_namespace(mu, film_ior, F)
    F = arrays.at_least_0(F)
    second = xp.where(index_of(color0) < film_ior * (1.0 - SAME), -1.0, 1.0) * root(F)
    p, s = (Interface(r, (second, 0.0 * second), F) for r in first_amplitudes(mu, film_ior))
    return p, s


def index_of(color0: Array) -> Array:
    """Index of refraction whose reflectance along the normal is color0; unbounded at 1."""
    amplitude = root(color0)
    least = array_namespace(color0).maximum(1.0 - amplitude, fresnel.LEAST_IOR)
    return (1.0 + amplitude) / least


def first_amplitudes(mu: Array, film_ior: Array) -> tuple[Array, Array]:
    """r12 of both polarizations, by the forms of `over_index`; its sign is the phase phi_12, 0 or pi."""
    xp = array_namespace(mu, film_ior)
    c, S2 = film_ior * refracted(mu, film_ior), (1.0 - mu) * (1.0 + mu)
    total = xp.where(c + mu > 0.0, c + mu, 1.0)
    s = -(film_ior - 1.0) * (film_ior + 1.0) / (total * total)
    return s * (mu * c - S2) / (mu * c + S2), s


def tristimulus(interface: Interface, opd: Array, orders: int | None = None) -> Array:
    """Reflected intensity of one polarization in CIE XYZ, shape (3, ...): Airy Summation.

    `orders` is M; None sums all of them.
    """
    (first, (real, imaginary), R23), xp = interface, array_namespace(*interface[::2], opd)
    R12 = first * first
    passed, lost = 1.0 - R12, 1.0 - R12 * R23  # `lost` is 0 only if `passed` is
    dc = R12 + passed**2 * R23 / xp.where(lost > 0.0, lost, 1.0)
    values = first * real, first * imaginary, 2.0 * np.pi * opd
    shape = np.broadcast_shapes(*(tuple(each.shape) for each in values))
    x, y, phi = (xp.broadcast_to(each, shape) for each in values)
    if xp is NUMPY:
        sums = np.empty((len(GAUSSIANS), x.size))
        for start in range(0, x.size, FILM_BLOCK):
            rows = slice(start, start + FILM_BLOCK)
            _fill(sums[:, rows], x.ravel()[rows], y.ravel()[rows], phi.ravel()[rows], orders)
        sums = sums.reshape(len(GAUSSIANS), *shape)
    else:
        sums = _orders(x, y, phi, orders or DAMPED_ORDERS)
        if orders is None:
            thick = phi * float(SPREADS.min()) >= THIN_SPREAD
            sums = xp.where(thick, sums, _integrated(x, y, arrays.guarded(phi, ~thick, 0.0)))
    return dc + 2.0 * (dc - R12 - passed) * xp.tensordot(like(WEIGHTS, sums), sums, axes=1)


def _fill(sums: Array, x: Array, y: Array, phi: Array, orders: int | None) -> None:
    """Fill the sums of a block, for thick films and for thin ones."""
    thick = phi * SPREADS.min() >= THIN_SPREAD if orders is None else np.full(len(phi), True)
    if thick.all():
        sums[:] = _orders(x, y, phi, orders or DAMPED_ORDERS)
        return
    sums[:, thick] = _orders(x[thick], y[thick], phi[thick], DAMPED_ORDERS)
    sums[:, ~thick] = _integrated(x[~thick], y[~thick], phi[~thick])


def _column(values: Array, array: Array) -> Array:
    """Numbers of the Gaussians on a first axis before the array's axes, in its library."""
    return like(values.reshape(-1, *(1,) * array.ndim), array)


def _orders(x: Array, y: Array, phi: Array, orders: int) -> Array:
    """Real part of the sum of z^m S(m phi) for m from 1 to `orders`, z = x + i y, of each Gaussian, (4, ...).

        S(phi) = exp(i mu phi - sigma^2 phi^2)

    With w = z exp(i mu phi), the real part of w^m is 2 Re(w) times that of w^(m-1), minus |w|^2
    times that of w^(m-2).
    """
    xp, angle = array_namespace(phi), _column(CENTERS, phi) * phi
    damping = xp.exp(-((_column(SPREADS, phi) * phi) ** 2))
    twice = damping * damping
    growth = damping * twice
    power, size = x * xp.cos(angle) - y * xp.sin(angle), x * x + y * y
    before, double, total = 0.0 * size + 1.0, 2.0 * power, damping * power
    for _ in range(1, orders):
        before, power = power, double * power - size * before
        damping = damping * growth
        growth = growth * twice
        total += damping * power
    return total


def _integrated(x: Array, y: Array, phi: Array) -> Array:
    """`_orders` of all orders by an integral over wavenumbers.

    The damping exp(-sigma^2 m^2 phi^2) is the mean of exp(i m sqrt(2) sigma u phi) over a standard normal u. So

        sum of z^m S(m phi) = mean over u of the sum of w^m,  w = z exp(i (mu + sqrt(2) sigma u) phi),  |w| = |z|

    The sum over m >= 1 is w / (1 - w), with the real part (Re(w) - |w|^2) / |1 - w|^2, which is
    ((1 - |w|^2) / |1 - w|^2 - 1) / 2, since |1 - w|^2 = 1 - 2 Re(w) + |w|^2. The mean is the trapezoidal rule of
    HEIGHTS; each node turns w by a multiple of one step, so that nodes need no individual sines.
    """
    xp, angle = array_namespace(phi), _column(CENTERS, phi) * phi
    step = _column(np.sqrt(2.0) * STEP * SPREADS, phi) * phi
    real = x * xp.cos(angle) - y * xp.sin(angle)
    imaginary = x * xp.sin(angle) + y * xp.cos(angle)
    turn_c, turn_s = xp.cos(step), xp.sin(step)
    kernel = float(HEIGHTS[0]) / _distance(real, imaginary)
    c, s = turn_c, turn_s
    for height in HEIGHTS[1:].tolist():
        # Sum the nodes on both sides of the center, then rotate to the next ones.
        a, b, d, e = real * c, imaginary * s, imaginary * c, real * s
        kernel += height / _distance(a - b, d + e)
        kernel += height / _distance(a + b, d - e)
        c, s = c * turn_c - s * turn_s, s * turn_c + c * turn_s
    return 0.5 * ((1.0 - x * x - y * y) * kernel - HEIGHT)


def _distance(real: Array, imaginary: Array) -> Array:
    """|1 - w|^2, or 1 where it is 0: nothing passes and no order counts there."""
    size = (1.0 - real) ** 2 + imaginary * imaginary
    return array_namespace(size).where(size > 0.0, size, 1.0)


def _product(a: Complex, b: Complex) -> Complex:
    """a b."""
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def _squared(a: Complex) -> Array:
    """|a|^2."""
    return a[0] * a[0] + a[1] * a[1]


def _quotient(a: Complex, b: Complex, otherwise: float) -> Complex:
    """a / b, or a real number where b is 0."""
    squared = _squared(b)
    xp, valid = array_namespace(squared), squared > 0.0
    size = xp.where(valid, squared, 1.0)
    real, imaginary = _product(a, (b[0] / size, -b[1] / size))
    return xp.where(valid, real, otherwise), imaginary


# Gauss-Legendre nodes in the cosine: of the curve, and of the polynomial through it, which is clamped.
POINTS, FINE = 14, 200

Polarizations: TypeAlias = tuple[Interface, Interface]


@dataclass(frozen=True)
class Form:
    """Choices that the specification leaves to implementations, and one defect.

    - `matrix`: From CIE XYZ to linear RGB, by rows.
    - `orders`: M; None sums all orders.
    - `mixed`: Whether the index of RGB channel k enters XYZ value k. If not, each RGB channel has
      its index in all of XYZ, so that a vanishing film does not change the channels.
    - `share`: Factor of the Schlick substrate's reflectance in each polarization; 1 in the text.
    - `least`: Smallest color0 that is converted to the index of a Schlick substrate.
    - `clamped`: Whether values outside [0, 1] are clamped, as the text does.
    """

    matrix: tuple[tuple[float, ...], ...] = tuple(map(tuple, XYZ_TO_REC709_E.tolist()))
    orders: int | None = None
    mixed: bool = False
    share: float = 1.0
    least: float = 0.0
    clamped: bool = True


# XYZ to CIE RGB with white E, from MaterialX 1.39.5.
CIE_RGB = (
    (2.3706743, -0.9000405, -0.4706338),
    (-0.5138850, 1.4253036, 0.0885814),
    (0.0052982, -0.0146949, 1.0093968),
)
TEXT = Form()
PRINTED = Form(tuple(map(tuple, XYZ_TO_REC709.tolist())), 2, True)
MATERIALX = Form(CIE_RGB, 2, True, 0.5, 0.01)


def film_curve(category: str, form: Form = TEXT) -> Curve:
    """Curve of a microfacet node with the additional inputs `thinfilm_thickness` and `thinfilm_ior`.

    For thickness 0 it is the node's own curve.
    """
    bare = CATEGORIES[category][0]

    def at(
        mu: Array, *, thinfilm_thickness: Array, thinfilm_ior: Array, **material: Array
    ) -> Array:
        def coated() -> Array:
            return _airy(category, form, mu, thinfilm_thickness, thinfilm_ior, material)

        return _where_coated(thinfilm_thickness, coated, bare.at(mu, **material))

    # Interpolate the curve by a polynomial before it is clamped, since the clamp has kinks.
    def average(*, thinfilm_thickness: Array, thinfilm_ior: Array, **material: Array) -> Array:
        def coated() -> Array:
            film = thinfilm_thickness, thinfilm_ior
            curve = _fine(category, replace(form, clamped=False), film, material)
            # Clamp at the fine nodes, and sum.
            kept = arrays.within(curve) if form.clamped else curve
            return array_namespace(curve).tensordot(like(_rule()[2], curve), kept, axes=1)

        return _where_coated(thinfilm_thickness, coated, bare.average(**material))

    return Curve(at, average)


def _where_coated(thickness: Array, coated: Callable[[], Array], plain: Array) -> Array:
    """Values with films where the thickness is not 0, else plain ones; without any film the slow part is skipped."""
    xp = array_namespace(thickness, plain)
    if xp is not NUMPY or (thickness > 0.0).any():
        return xp.where(thickness > 0.0, coated(), plain)
    return np.broadcast_to(plain, np.broadcast_shapes(thickness.shape, plain.shape))


def _fine(
    category: str, form: Form, film: tuple[Array, Array], material: dict[str, Array]
) -> Array:
    """The curve at the cosines of a fine rule, interpolated from the nodes, shape (FINE, 3, ...)."""
    mu, between, _ = (like(each, film[1]) for each in _rule())
    channels = {k for k, v in material.items() if k in CATEGORIES[category][1]}
    axes = max((v.ndim - 1 for k, v in material.items() if k in channels), default=film[0].ndim)
    spread = {k: v[:, np.newaxis] if k in channels else v for k, v in material.items()}
    nodes = array_namespace(mu).reshape(mu, (-1, *(1,) * max(axes, film[0].ndim, film[1].ndim)))
    curve = _airy(category, form, nodes, *film, spread)
    return array_namespace(curve).tensordot(between, curve, axes=((1,), (1,)))


@cache
def _rule() -> tuple[Array, Array, Array]:
    """Cosines of the nodes, the matrix from values there to a fine rule, and the fine rule's weights."""
    x, w = legendre.leggauss(POINTS)
    fine, weight = legendre.leggauss(FINE)
    degree = np.arange(POINTS)
    moments = (degree + 0.5)[:, np.newaxis] * legendre.legvander(x, POINTS - 1).T * w
    between = legendre.legvander(fine, POINTS - 1) @ moments
    return 0.5 * (1.0 + x), between, 0.5 * weight * (1.0 + fine)


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
    opd = path_difference(mu, thickness, film_ior)
    p, s = SUBSTRATES[category](mu, film_ior, form, **inputs)
    xyz = tristimulus(p, opd, form.orders) + tristimulus(s, opd, form.orders)
    rgb = to_rgb(0.5 * xyz, form)
    return arrays.within(rgb) if form.clamped else rgb


def to_rgb(xyz: Array, form: Form) -> Array:
    """RGB, shape (3, ...), from the XYZ of each channel's substrate, shape (3, channels, ...)."""
    xp, matrix = array_namespace(xyz), np.array(form.matrix)
    xyz = xp.broadcast_to(xyz, (3, 3, *xyz.shape[2:]))
    if form.mixed:
        diagonal = xp.stack([xyz[k, k, ...] for k in range(3)])
        return xp.tensordot(like(matrix, xyz), diagonal, axes=1)
    return xp.sum(like(matrix.T.reshape(3, 3, *(1,) * (xyz.ndim - 2)), xyz) * xyz, axis=0)


def _schlick(
    mu: Array,
    film_ior: Array,
    form: Form,
    color0: Array,
    color82: Array,
    color90: Array,
    exponent: Array,
) -> Polarizations:
    mu_t = refracted(mu, film_ior)
    F = form.share * fresnel.schlick(mu_t, color0, color82, color90, exponent)
    base = array_namespace(color0).maximum(color0, form.least)
    return over_schlick(mu[np.newaxis], film_ior[np.newaxis], F, base)


SUBSTRATES: dict[str, Callable[..., Polarizations]] = {
    "dielectric_bsdf": lambda mu, film_ior, _, ior: over_index(
        mu[np.newaxis], film_ior[np.newaxis], ior[np.newaxis], like(np.zeros(1), ior)
    ),
    "conductor_bsdf": lambda mu, film_ior, _, ior, extinction: over_index(
        mu[np.newaxis], film_ior[np.newaxis], ior, extinction
    ),
    "generalized_schlick_bsdf": _schlick,
}


FILM = ("thinfilm_thickness", "thinfilm_ior")
DEGREE = 48  # degree of the film's curve in the cosine, for albedos


@any_array
def film_reflectance(
    category: str, mu: ArrayLike, inputs: Mapping[str, ArrayLike], form: Form = TEXT
) -> Array:
    """Reflectance of a node's curve under a thin film for unpolarized light; `tint` and `roughness` have no effect.

    Accuracy: over a dielectric the infinite sum is within 1e-6 for cosines above 0.01, over a conductor within 1e-4 at
    grazing angles, where all orders count. Below index 1 the specification's phases of the first interface do not
    hold: the s polarization has its phase of pi from a film that is denser than the vacuum. The Schlick curve replaces
    the film's lower interface at the refracted angle, so the value jumps as soon as the thickness is not 0; a negative
    curve counts as 0, because it has no amplitude.

        >>> glass = {"ior": 1.5, "thinfilm_thickness": [0.0, 100.0, 300.0], "thinfilm_ior": 1.38}
        >>> film_reflectance("dielectric_bsdf", 1.0, glass).round(4)
        array([[0.04  , 0.04  , 0.04  ],
               [0.015 , 0.014 , 0.0178],
               [0.0209, 0.0142, 0.0348]])
    """
    if not isinstance(form, Form):
        raise ValueError(f"form must be a Form; got {form!r}")
    given = {"tint": 1.0, "roughness": 0.0, **inputs} if isinstance(inputs, Mapping) else inputs
    vectors, numbers = _material(category, given)
    numbers["mu"] = arguments.checked("mu", mu)
    arguments.lead_shape(vectors, numbers)
    return evaluate_material(film_curve(category, form).at, vectors, numbers, 3)


@any_array
def film_brdf(
    category: str,
    wo: ArrayLike,
    wi: ArrayLike,
    inputs: Mapping[str, ArrayLike],
    form: Form = TEXT,
    lobe: Lobe | None = None,
) -> Array:
    """BRDF of a microfacet node under a thin film, scatter mode R, in 1/sr; `lobe` may replace the text's terms.

    [MaterialX2026], Thin-Film Iridescence; Energy Compensation.

        >>> inputs = {"tint": np.ones(3), "ior": 1.5, "roughness": [0.3, 0.3]}
        >>> soap = {"thinfilm_thickness": 400.0, "thinfilm_ior": 1.33}
        >>> w = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]
        >>> film_brdf("dielectric_bsdf", *w, inputs | soap).round(4)
        array([0.    , 0.0394, 0.0542])
    """
    vectors, numbers = _material(category, inputs, wo)
    curve = film_curve(category, form)
    return evaluate_lobe(lobe or Lobe(), curve, wo, wi, inputs["roughness"], vectors, numbers)


@any_array
def film_albedo_dir(
    category: str,
    wo: ArrayLike,
    inputs: Mapping[str, ArrayLike],
    form: Form = TEXT,
    compensate: bool = True,
) -> Array:
    """Directional albedo of `film_brdf`, by quadrature, with or without the energy compensation.

    The film's curve is a polynomial of degree 48 in the cosine, within 1e-4 of the curve for films up to 2000 nm of
    index up to 2. [MaterialX2026], Directional Albedo and Energy Conservation.

        >>> inputs = {"tint": np.ones(3), "ior": 1.5, "roughness": [0.3, 0.3]}
        >>> soap = {"thinfilm_thickness": 400.0, "thinfilm_ior": 1.33}
        >>> film_albedo_dir("dielectric_bsdf", [0.6, 0.0, 0.8], inputs | soap).round(4)
        array([0.0046, 0.0263, 0.0328])
    """
    vectors, numbers = _material(category, inputs, wo)
    curve = Curve(polynomial_curve(category, form), film_curve(category, form).average)
    return lobe_albedo(curve, wo, inputs["roughness"], vectors, numbers, compensate)


def _material(
    category: str, inputs: Mapping[str, ArrayLike], wo: ArrayLike = (0.0, 0.0, 1.0)
) -> tuple[dict[str, arrays.Numbers], dict[str, arrays.Numbers]]:
    """Checked inputs with channels and without."""
    _, colors, numbers = CATEGORIES[arguments.checked_choice("category", category, CATEGORIES)]
    if not isinstance(inputs, Mapping):
        raise ValueError(f"inputs must be a mapping of names to values; got {inputs!r}")
    if missing := {"roughness", *colors, *numbers, *FILM} - set(inputs):
        raise ValueError(f"inputs must have {', '.join(sorted(missing))}")
    wo = arguments.checked_directions("wo", wo)
    return (
        {name: _short(arguments.checked_rgb(name, inputs[name]), 1, wo) for name in colors},
        {name: _short(arguments.checked(name, inputs[name]), 0, wo) for name in (*numbers, *FILM)},
    )


def _short(values: arrays.Numbers, channels: int, wo: ArrayLike) -> arrays.Numbers:
    """Values as one row if they have a row for each `wo` but all rows are equal.

    Otherwise the integral F_ss of the film would be computed for every point of a picture.
    """
    if array_namespace(values) is not NUMPY:
        return values
    many = np.ndim(wo) == 2 and values.ndim == channels + 1 and len(values) == len(np.asarray(wo))
    return values[:1] if many and bool((values == values[:1]).all()) else values


def polynomial_curve(category: str, form: Form) -> Callable[..., Array]:
    """F of a film as a polynomial in the cosine for each material.

    Cosines have the shape (nodes, nodes, ...), F (3, nodes, nodes, ...).
    """
    bare_at = CATEGORIES[category][0].at
    curve = film_curve(category, replace(form, clamped=False))

    def at(mu: Array, **material: Array) -> Array:
        bare = {k: v for k, v in material.items() if k not in FILM}
        film, xp = material["thinfilm_thickness"] > 0.0, array_namespace(mu)
        if xp is NUMPY and not film.any():
            return bare_at(mu, **bare)
        cosines = chebyshev_nodes(DEGREE + 1).reshape(-1, 1, *(1,) * (mu.ndim - 2))
        sampled = curve.at(like(cosines, mu), **material)
        matrix = like(chebyshev_coefficients(np.eye(DEGREE + 1)), mu)
        series = xp.tensordot(matrix, sampled, axes=((1,), (1,)))
        F = arrays.within(chebyshev_sum(series[:, :, np.newaxis, ...], mu))
        if xp is NUMPY and film.all():
            return F
        return xp.where(film, F, bare_at(mu, **bare))

    return at
