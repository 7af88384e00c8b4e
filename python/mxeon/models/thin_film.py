# SPDX-License-Identifier: Apache-2.0
"""Thin films on the microfacet nodes of pbrlib: reflectances, lobes and albedos.

Section names refer to [MaterialX2026], appendix Thin-Film Iridescence Model, which is based on
[Belcour2017]. With thickness 0, the reflectance is the node's own Fresnel curve.

- `mu` (...): Cosine of the angle between a direction and a microfacet normal, in [0, 1].
- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, tangent
  +x, z >= 0.
- `category`, `inputs`: Category of the node, and a mapping from the names of the node's inputs to
  values. Colors have one or three channels. `thinfilm_thickness` (...) is in nm, in [0, 1e9], and
  `thinfilm_ior` (...) is in [1, 1e50].
- `form`: A `Form`, the choices that the specification leaves to implementations.

Result (..., 3): linear RGB, in [0, 1].

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.

The film is at least as dense as the vacuum above the film, so the amplitude r12 of the upper
interface is real. The amplitude of the lower interface is r23 = sqrt(R23) e^(i phi_23). In the
specification, the reflectances are R12 and R23, the phase is phi = phi_21 + phi_23, and the sum is

    I = C_0 + 2 sum of C_m S(m D, m phi),  C_0 = R12 + R_s,  R_s = T121^2 R23 / (1 - R12 R23),
    C_m = (R_s - T121) sqrt(R12 R23)^m,  T121 = 1 - R12

where D is the optical path difference. In this file, the term of order m is computed from the
complex power z^m of z = r21 r23 = -r12 r23. The absolute value of z is sqrt(R12 R23), and the angle
of z is phi. z^m has derivatives everywhere. Roots and phases have no derivatives where a
reflectance is 0. A reflectance is 0 for a film with index of refraction 1, at Brewster's angle, and
if film and substrate have the same index of refraction.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
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

# In the specification, each spectral sensitivity is a sum of Gaussians. A row holds the tristimulus
# value (0 for X, 1 for Y, 2 for Z), v in m, mu in 1/m and sigma^2 in 1/m^2. For films up to 2000 nm
# with indices of refraction up to 2.3, XYZ differs from a sum over wavelengths by at most 0.012 for
# dielectrics and 0.017 for metals.
GAUSSIANS = (
    (0, 5.4856e-13, 1.6810e6, 4.3278e9),
    (0, 9.7470e-14, 2.2399e6, 4.5282e9),
    (1, 4.4201e-13, 1.7953e6, 9.3046e9),
    (2, 5.2481e-13, 2.2084e6, 6.6121e9),
)
NORMAL = 1.0685e-7
METERS = 1e-9  # converts nm to m
# Centers, standard deviations and areas of the Gaussians. A row of WEIGHTS sums X, Y or Z.
CENTERS = np.array([mu for _, _, mu, _ in GAUSSIANS])
SPREADS = np.sqrt([variance for *_, variance in GAUSSIANS])
AREAS = [v * np.sqrt(2.0 * np.pi * variance) / NORMAL for _, v, _, variance in GAUSSIANS]
WEIGHTS = np.eye(3)[:, [row for row, *_ in GAUSSIANS]] * AREAS

# A film is thick if 2 pi sigma times the optical path difference is at least THIN_SPREAD. For thick
# films, DAMPED_ORDERS orders are summed, because later terms are below exp(-(30 * 0.2)^2) = 3e-16.
# For thin films, an integral over wavenumbers is computed by the trapezoidal rule. The step of this
# rule is 0.2 standard deviations of a Gaussian. The rule ends after 32 steps, at 6.4 standard
# deviations, where the Gaussian is exp(-6.4^2 / 2) = 1.3e-9 times its maximum.
THIN_SPREAD, DAMPED_ORDERS = 0.2, 30
STEP, STEPS = 0.2, 32
SAME = 2.0**-20  # indices of refraction with a smaller relative difference count as equal
# Weights of the symmetric trapezoidal rule from the center to one end, and the sum of all weights.
HEIGHTS = STEP * np.exp(-0.5 * (STEP * np.arange(STEPS + 1)) ** 2) / np.sqrt(2.0 * np.pi)
HEIGHT = 2.0 * float(HEIGHTS.sum()) - float(HEIGHTS[0])
FILM_BLOCK = 2**13  # elements per block


class Interface(NamedTuple):
    """Amplitudes r12 (`first`) and -r23 (`second`), and reflectance R23, for one polarization."""

    first: Array
    second: Complex
    reflectance: Array


def refracted(mu: Array, film_ior: Array) -> Array:
    """Cosine of the refracted angle theta_t in the film, from section Three-Layer Geometry."""
    xp = array_namespace(mu, film_ior)
    squared = xp.maximum(1.0 - (1.0 - mu) * (1.0 + mu) / film_ior**2, 0.0)
    # `squared` is 0 only where `mu` is 0. The derivative of `mu` is finite.
    return xp.sqrt(squared) if xp is NUMPY else xp.where(squared > 0.0, root(squared), mu)


def path_difference(mu: Array, thickness: Array, film_ior: Array) -> Array:
    """Optical path difference 2 film_ior cos(theta_t) thickness, in meters."""
    return 2.0 * film_ior * refracted(mu, film_ior) * thickness * METERS


def over_index(
    mu: Array, film_ior: Array, ior: Array, extinction: Array
) -> tuple[Interface, Interface]:
    """Interfaces of a film over a dielectric or a conductor, for the polarizations p and s.

    The published form, where c = film_ior cos theta_t, n = ior + i extinction and
    W = n cos theta_3 = sqrt(n^2 - sin^2 theta), is

        r_s = (c - W) / (c + W),  r_p = (n^2 c - film_ior^2 W) / (n^2 c + film_ior^2 W)

    Because W^2 - c^2 = n^2 - film_ior^2, -r_s is computed as (n^2 - film_ior^2) / (W + c)^2,
    without a difference of roots. n^2 = W^2 + sin^2 and film_ior^2 = c^2 + sin^2. Hence
    n^2 c - film_ior^2 W = (W - c) (c W - sin^2) and n^2 c + film_ior^2 W = (W + c) (c W + sin^2),
    so r_p = -r_s (c W - sin^2) / (c W + sin^2).
    """
    xp = array_namespace(mu, film_ior, ior, extinction)
    c, S2 = film_ior * refracted(mu, film_ior), (1.0 - mu) * (1.0 + mu)
    # W is U + iV. The smaller of U and V is computed from U V = ior extinction.
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
    """Interfaces of a film over a Schlick substrate, for the polarizations p and s.

    - `F`: Schlick curve of the substrate at cos theta_t.

    The dip of the Schlick curve can make F negative. A negative F has no amplitude and counts as 0.
    The phase jumps by pi where film and substrate have the same index of refraction. Indices of
    refraction with a relative difference below SAME count as equal, because colors may be rounded.
    For example, float32 changes 0.04, the color0 for index 1.5, by a relative error of 2e-8.
    """
    xp = array_namespace(mu, film_ior, F)
    F = arrays.at_least_0(F)
    second = xp.where(index_of(color0) < film_ior * (1.0 - SAME), -1.0, 1.0) * root(F)
    p, s = (Interface(r, (second, 0.0 * second), F) for r in first_amplitudes(mu, film_ior))
    return p, s


def index_of(color0: Array) -> Array:
    """Index of refraction for the reflectance color0 along the normal; 2e50 for reflectance 1."""
    amplitude = root(color0)
    least = array_namespace(color0).maximum(1.0 - amplitude, fresnel.LEAST_IOR)
    return (1.0 + amplitude) / least


def first_amplitudes(mu: Array, film_ior: Array) -> tuple[Array, Array]:
    """The amplitudes r12 for the polarizations p and s, computed as in `over_index`.

    The sign of r12 determines the phase phi_12, which is 0 or pi.
    """
    xp = array_namespace(mu, film_ior)
    c, S2 = film_ior * refracted(mu, film_ior), (1.0 - mu) * (1.0 + mu)
    total = xp.where(c + mu > 0.0, c + mu, 1.0)
    s = -(film_ior - 1.0) * (film_ior + 1.0) / (total * total)
    return s * (mu * c - S2) / (mu * c + S2), s


def tristimulus(interface: Interface, opd: Array, orders: int | None = None) -> Array:
    """CIE XYZ of one polarization, (3, ...), from section Airy Summation.

    - `orders`: Number M of orders; None sums all orders.
    """
    (first, (real, imaginary), R23), xp = interface, array_namespace(*interface[::2], opd)
    R12 = first * first
    passed, lost = 1.0 - R12, 1.0 - R12 * R23  # `lost` is 0 only if `passed` is 0
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
    """Fill `sums` for a block, by `_orders` for thick films and by `_integrated` for thin films."""
    thick = phi * SPREADS.min() >= THIN_SPREAD if orders is None else np.full(len(phi), True)
    if thick.all():
        sums[:] = _orders(x, y, phi, orders or DAMPED_ORDERS)
        return
    sums[:, thick] = _orders(x[thick], y[thick], phi[thick], DAMPED_ORDERS)
    sums[:, ~thick] = _integrated(x[~thick], y[~thick], phi[~thick])


def _column(values: Array, array: Array) -> Array:
    """One number per Gaussian, shape (4, 1, ...), which broadcasts with `array`."""
    return like(values.reshape(-1, *(1,) * array.ndim), array)


def _orders(x: Array, y: Array, phi: Array, orders: int) -> Array:
    """Real part of a sum over the orders of a film, for each Gaussian, (4, ...).

        sum over m from 1 to `orders` of z^m S(m phi),  S(phi) = exp(i mu phi - sigma^2 phi^2),
        z = x + i y

    With w = z exp(i mu phi), the recurrence Re(w^m) = 2 Re(w) Re(w^(m-1)) - |w|^2 Re(w^(m-2))
    computes the terms.
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
    """The sum of `_orders` for infinitely many orders, by an integral over wavenumbers.

    The damping exp(-sigma^2 m^2 phi^2) is the mean of exp(i m sqrt(2) sigma u phi) over a standard
    normal variable u. Hence

        sum of z^m S(m phi) = mean over u of the sum of w^m,
        w = z exp(i (mu + sqrt(2) sigma u) phi),  |w| = |z|

    The sum of w^m over m >= 1 is w / (1 - w), and the real part of w / (1 - w) is
    (Re(w) - |w|^2) / |1 - w|^2 = ((1 - |w|^2) / |1 - w|^2 - 1) / 2, since
    |1 - w|^2 = 1 - 2 Re(w) + |w|^2. The mean is computed by the trapezoidal rule with the weights
    HEIGHTS. From node to node, w rotates by the same angle, so the sine and cosine of this angle
    are computed only once.
    """
    xp, angle = array_namespace(phi), _column(CENTERS, phi) * phi
    step = _column(np.sqrt(2.0) * STEP * SPREADS, phi) * phi
    real = x * xp.cos(angle) - y * xp.sin(angle)
    imaginary = x * xp.sin(angle) + y * xp.cos(angle)
    turn_c, turn_s = xp.cos(step), xp.sin(step)
    kernel = float(HEIGHTS[0]) / _distance(real, imaginary)
    c, s = turn_c, turn_s
    for height in HEIGHTS[1:].tolist():
        # Each step adds the two nodes at equal distances from the center.
        a, b, d, e = real * c, imaginary * s, imaginary * c, real * s
        kernel += height / _distance(a - b, d + e)
        kernel += height / _distance(a + b, d - e)
        c, s = c * turn_c - s * turn_s, s * turn_c + c * turn_s
    return 0.5 * ((1.0 - x * x - y * y) * kernel - HEIGHT)


def _distance(real: Array, imaginary: Array) -> Array:
    """|1 - w|^2 as a divisor, or 1 where |1 - w|^2 is 0 because no light passes the film."""
    size = (1.0 - real) ** 2 + imaginary * imaginary
    return array_namespace(size).where(size > 0.0, size, 1.0)


def _product(a: Complex, b: Complex) -> Complex:
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def _squared(a: Complex) -> Array:
    return a[0] * a[0] + a[1] * a[1]


def _quotient(a: Complex, b: Complex, otherwise: float) -> Complex:
    """Complex quotient a / b, or the real number `otherwise` where b is 0."""
    squared = _squared(b)
    xp, valid = array_namespace(squared), squared > 0.0
    size = xp.where(valid, squared, 1.0)
    real, imaginary = _product(a, (b[0] / size, -b[1] / size))
    return xp.where(valid, real, otherwise), imaginary


# F is evaluated at POINTS Gauss-Legendre nodes in the cosine. The polynomial through these values
# is clamped and integrated at FINE nodes.
POINTS, FINE = 14, 200

Polarizations: TypeAlias = tuple[Interface, Interface]


@dataclass(frozen=True)
class Form:
    """Choices that the specification leaves to implementations.

    - `matrix`: Rows of the matrix from CIE XYZ to linear RGB.
    - `orders`: Number M of orders; None sums all orders.
    - `mixed`: If True, X, Y and Z are computed with the substrate's values for red, green and blue,
      respectively. If False, X, Y and Z are computed for each channel of the substrate, so that a
      film of thickness near 0 does not mix the channels.
    - `share`: Factor of the reflectance of a Schlick substrate; 1 in the specification.
    - `least`: Lower limit of color0 in the conversion to an index of refraction.
    - `clamped`: Whether values are clamped to [0, 1], as in the specification.
    """

    matrix: tuple[tuple[float, ...], ...] = tuple(map(tuple, XYZ_TO_REC709_E.tolist()))
    orders: int | None = None
    mixed: bool = False
    share: float = 1.0
    least: float = 0.0
    clamped: bool = True


# Matrix from CIE XYZ to CIE RGB with equal-energy white, as in MaterialX 1.39.5.
CIE_RGB = (
    (2.3706743, -0.9000405, -0.4706338),
    (-0.5138850, 1.4253036, 0.0885814),
    (0.0052982, -0.0146949, 1.0093968),
)
TEXT = Form()
PRINTED = Form(tuple(map(tuple, XYZ_TO_REC709.tolist())), 2, True)
MATERIALX = Form(CIE_RGB, 2, True, 0.5, 0.01)


def film_curve(category: str, form: Form = TEXT) -> Curve:
    """Fresnel curve of a node with a thin film; for thickness 0, the node's own Fresnel curve."""
    bare = CATEGORIES[category][0]

    def at(
        mu: Array, *, thinfilm_thickness: Array, thinfilm_ior: Array, **material: Array
    ) -> Array:
        coated = partial(_airy, category, form, mu, thinfilm_thickness, thinfilm_ior, material)
        return _where_coated(thinfilm_thickness, coated, bare.at(mu, **material))

    def average(*, thinfilm_thickness: Array, thinfilm_ior: Array, **material: Array) -> Array:
        film = thinfilm_thickness, thinfilm_ior
        coated = partial(_film_average, category, form, film, material)
        return _where_coated(thinfilm_thickness, coated, bare.average(**material))

    return Curve(at, average)


def _where_coated(thickness: Array, coated: Callable[[], Array], plain: Array) -> Array:
    """`coated()` where the thickness is not 0, else `plain`.

    If no thickness is positive, `coated` is not called.
    """
    xp = array_namespace(thickness, plain)
    if xp is not NUMPY or (thickness > 0.0).any():
        return xp.where(thickness > 0.0, coated(), plain)
    return np.broadcast_to(plain, np.broadcast_shapes(thickness.shape, plain.shape))


def _film_average(
    category: str, form: Form, film: tuple[Array, Array], material: dict[str, Array]
) -> Array:
    """F_ss, (3, ...), from a polynomial in the cosine that is clamped and then integrated.

    The polynomial interpolates unclamped values of F, because clamped values would have kinks.
    """
    mu, between, weights = (like(each, film[1]) for each in _rule())
    channels = {k for k, v in material.items() if k in CATEGORIES[category][1]}
    axes = max((v.ndim - 1 for k, v in material.items() if k in channels), default=film[0].ndim)
    spread = {k: v[:, np.newaxis] if k in channels else v for k, v in material.items()}
    nodes = array_namespace(mu).reshape(mu, (-1, *(1,) * max(axes, film[0].ndim, film[1].ndim)))
    curve = _airy(category, replace(form, clamped=False), nodes, *film, spread)
    fine = array_namespace(curve).tensordot(between, curve, axes=((1,), (1,)))
    fine = arrays.within(fine) if form.clamped else fine
    return array_namespace(fine).tensordot(weights, fine, axes=1)


@cache
def _rule() -> tuple[Array, Array, Array]:
    """Returns cosines of POINTS nodes, the matrix to FINE nodes, and weights of the FINE nodes."""
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
    inputs = {k: v for k, v in material.items() if k != "tint"}
    opd = path_difference(mu, thickness, film_ior)
    p, s = SUBSTRATES[category](mu, film_ior, form, **inputs)
    xyz = tristimulus(p, opd, form.orders) + tristimulus(s, opd, form.orders)
    rgb = to_rgb(0.5 * xyz, form)
    return arrays.within(rgb) if form.clamped else rgb


def to_rgb(xyz: Array, form: Form) -> Array:
    """Convert the XYZ of each channel of a substrate, (3, channels, ...), to RGB, (3, ...)."""
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
DEGREE = 48  # degree of the polynomial in the cosine that replaces F of a film in albedos


@any_array
def film_reflectance(
    category: str, mu: ArrayLike, inputs: Mapping[str, ArrayLike], form: Form = TEXT
) -> Array:
    """Fresnel reflectance of a node under a thin film for unpolarized light, without the tint.

    Accuracy: on dielectrics, the error of the infinite sum is below 1e-6 for cosines above 0.01. On
    conductors at grazing angles, where many orders contribute, the error is below 1e-4. A film with
    an index of refraction below 1 is rejected. For the s polarization, the specification sets the
    phase of the upper interface to pi, which requires a film that is denser than the vacuum. The
    Schlick curve describes the lower interface of the film at the refracted angle, so the result
    jumps between thickness 0 and any positive thickness. A negative value of the Schlick curve has
    no amplitude and counts as 0.

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
    """BRDF of a microfacet node under a thin film, scatter mode R, in 1/sr.

    - `lobe`: Terms of the microfacet BRDF; None for the terms of the specification.

    [MaterialX2026], sections Thin-Film Iridescence and Energy Compensation.

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

    F of the film is approximated by a polynomial of degree 48 in the cosine. The error is below
    1e-4 for films up to 2000 nm with an index of refraction up to 2. [MaterialX2026], section
    Directional Albedo and Energy Conservation.

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
    """Validated inputs with channels, and validated inputs without channels."""
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
    """Values reduced to one row if all rows are equal, so that F_ss is computed only once."""
    if array_namespace(values) is not NUMPY:
        return values
    many = np.ndim(wo) == 2 and values.ndim == channels + 1 and len(values) == len(np.asarray(wo))
    return values[:1] if many and bool((values == values[:1]).all()) else values


def polynomial_curve(category: str, form: Form) -> Callable[..., Array]:
    """F of a film as a polynomial in the cosine; F is (3, n, n, ...) for cosines (n, n, ...)."""
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
