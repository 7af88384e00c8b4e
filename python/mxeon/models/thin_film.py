# SPDX-License-Identifier: Apache-2.0
"""Thin films on the microfacet nodes of pbrlib: reflectances, lobes and albedos.

Section names refer to [MaterialX2026], appendix Thin-Film Iridescence Model, after [Belcour2017]. With thickness 0,
the node's own Fresnel curve is used.

- `mu` (...): Cosine between direction and microfacet normal, in [0, 1].
- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, tangent +x, z >= 0.
- `category`, `inputs`: Category of the node, and its inputs by port name. Colors have one or three channels;
  `thinfilm_thickness` (...) is in nm, in [0, 1e9], and `thinfilm_ior` (...) in [1, 1e50].
- `form`: Choices that the specification leaves open: the matrix to RGB, the number of orders, how an index per channel
  enters a sum over CIE XYZ, and whether values are clamped to [0, 1], which the specification does at the very end.

Result (..., 3): linear RGB, in [0, 1].

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the shapes do
not broadcast.

The film is at least as dense as the vacuum above it, so the amplitude r12 of its upper interface is real; the
amplitude of the lower interface is r23 = sqrt(R23) e^(i phi_23). The printed form has reflectances R12, R23 and
phases, phi = phi_21 + phi_23, and sums

    I = C_0 + 2 sum of C_m S(m D, m phi),  C_0 = R12 + R_s,  R_s = T121^2 R23 / (1 - R12 R23),
    C_m = (R_s - T121) sqrt(R12 R23)^m,  T121 = 1 - R12

Here the m-th term is the real part of z^m, z = r21 r23 = -r12 r23, which has length sqrt(R12 R23) and angle phi. z^m
has derivatives everywhere; roots and phases have none where a reflectance is 0: for a film of index 1, at Brewster's
angle, and over a substrate of the film's own index.
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

# Gaussians of the sensitivities in the specification: tristimulus, v in m, mu in 1/m, sigma^2 in 1/m^2. For films up
# to 2000 nm with index up to 2.3, XYZ is within 0.012 (dielectrics) or 0.017 (metals) of sums over wavelengths.
GAUSSIANS = (
    (0, 5.4856e-13, 1.6810e6, 4.3278e9),
    (0, 9.7470e-14, 2.2399e6, 4.5282e9),
    (1, 4.4201e-13, 1.7953e6, 9.3046e9),
    (2, 5.2481e-13, 2.2084e6, 6.6121e9),
)
NORMAL = 1.0685e-7
METERS = 1e-9  # converts nm to m
# Centers and standard deviations of the Gaussians, and their weights in XYZ, (3, 4).
CENTERS = np.array([mu for _, _, mu, _ in GAUSSIANS])
SPREADS = np.sqrt([variance for *_, variance in GAUSSIANS])
AREAS = [v * np.sqrt(2.0 * np.pi * variance) / NORMAL for _, v, _, variance in GAUSSIANS]
WEIGHTS = np.eye(3)[:, [row for row, *_ in GAUSSIANS]] * AREAS

# If 2 pi OPD sigma is at least THIN_SPREAD, orders are summed one by one: terms after DAMPED_ORDERS
# are below exp(-(30 * 0.2)^2) = 3e-16. Thinner films are integrated over wavenumbers by the trapezoidal rule, in
# steps of a fifth of a standard deviation, up to 6.5 standard deviations, where a Gaussian falls to 2^-48.
THIN_SPREAD, DAMPED_ORDERS = 0.2, 30
STEP, STEPS = 0.2, 32
SAME = 2.0**-20  # indices with a smaller relative difference count as equal
# Weights of the trapezoidal rule's nodes from the center outward; sum of the weights of all nodes.
HEIGHTS = STEP * np.exp(-0.5 * (STEP * np.arange(STEPS + 1)) ** 2) / np.sqrt(2.0 * np.pi)
HEIGHT = 2.0 * float(HEIGHTS.sum()) - float(HEIGHTS[0])
FILM_BLOCK = 2**13  # elements per block


class Interface(NamedTuple):
    """Amplitudes r12 (`first`) and -r23 (`second`) for one polarization, and R23."""

    first: Array
    second: Complex
    reflectance: Array


def refracted(mu: Array, film_ior: Array) -> Array:
    """cos theta_t in the film: section Three-Layer Geometry."""
    xp = array_namespace(mu, film_ior)
    squared = xp.maximum(1.0 - (1.0 - mu) * (1.0 + mu) / film_ior**2, 0.0)
    # For a film of index 1 this is mu, with a derivative at grazing.
    return xp.sqrt(squared) if xp is NUMPY else xp.where(squared > 0.0, root(squared), mu)


def path_difference(mu: Array, thickness: Array, film_ior: Array) -> Array:
    """Optical path difference in m: section Optical Path Difference."""
    return 2.0 * film_ior * refracted(mu, film_ior) * thickness * METERS


def over_index(
    mu: Array, film_ior: Array, ior: Array, extinction: Array
) -> tuple[Interface, Interface]:
    """Film over a dielectric or a conductor: interfaces for the polarizations p and s.

    Printed form, with c = film_ior cos theta_t, n = ior + i extinction, W = n cos theta_3 = sqrt(n^2 - sin^2 theta):

        r_s = (c - W) / (c + W),  r_p = (n^2 c - film_ior^2 W) / (n^2 c + film_ior^2 W)

    As W^2 - c^2 = n^2 - film_ior^2, -r_s = (n^2 - film_ior^2) / (W + c)^2 has no difference of roots. As
    n^2 = W^2 + sin^2 and film_ior^2 = c^2 + sin^2, n^2 c -+ film_ior^2 W is (W -+ c) (c W -+ sin^2), so
    r_p = -r_s (c W - sin^2) / (c W + sin^2).
    """
    xp = array_namespace(mu, film_ior, ior, extinction)
    c, S2 = film_ior * refracted(mu, film_ior), (1.0 - mu) * (1.0 + mu)
    # W = U + iV. The smaller part follows from U V = ior extinction without a cancellation.
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
    """Film over a Schlick substrate with curve F at cos theta_t: interfaces for p and s.

    A negative F, caused by the dip, has no amplitude and counts as 0. The phase jumps where both
    indices are equal. Indices within SAME count as equal: in float32, color0 = 0.04 differs by 2e-8
    from the color of a film with index 1.5.
    """
    xp = array_namespace(mu, film_ior, F)
    F = arrays.at_least_0(F)
    second = xp.where(index_of(color0) < film_ior * (1.0 - SAME), -1.0, 1.0) * root(F)
    p, s = (Interface(r, (second, 0.0 * second), F) for r in first_amplitudes(mu, film_ior))
    return p, s


def index_of(color0: Array) -> Array:
    """Index of refraction with reflectance color0 along the normal; unbounded at 1."""
    amplitude = root(color0)
    least = array_namespace(color0).maximum(1.0 - amplitude, fresnel.LEAST_IOR)
    return (1.0 + amplitude) / least


def first_amplitudes(mu: Array, film_ior: Array) -> tuple[Array, Array]:
    """r12 for p and s, rearranged as in `over_index`; its sign gives the phase phi_12, 0 or pi."""
    xp = array_namespace(mu, film_ior)
    c, S2 = film_ior * refracted(mu, film_ior), (1.0 - mu) * (1.0 + mu)
    total = xp.where(c + mu > 0.0, c + mu, 1.0)
    s = -(film_ior - 1.0) * (film_ior + 1.0) / (total * total)
    return s * (mu * c - S2) / (mu * c + S2), s


def tristimulus(interface: Interface, opd: Array, orders: int | None = None) -> Array:
    """CIE XYZ of one polarization, (3, ...), from M `orders` or all: section Airy Summation."""
    (first, (real, imaginary), R23), xp = interface, array_namespace(*interface[::2], opd)
    R12 = first * first
    passed, lost = 1.0 - R12, 1.0 - R12 * R23  # if `lost` is 0, `passed` is 0 too
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
    """Fill the sums of a block: thick films by orders, thin films by integrals."""
    thick = phi * SPREADS.min() >= THIN_SPREAD if orders is None else np.full(len(phi), True)
    if thick.all():
        sums[:] = _orders(x, y, phi, orders or DAMPED_ORDERS)
        return
    sums[:, thick] = _orders(x[thick], y[thick], phi[thick], DAMPED_ORDERS)
    sums[:, ~thick] = _integrated(x[~thick], y[~thick], phi[~thick])


def _column(values: Array, array: Array) -> Array:
    """One number per Gaussian, on a new first axis before the array's axes, in its library."""
    return like(values.reshape(-1, *(1,) * array.ndim), array)


def _orders(x: Array, y: Array, phi: Array, orders: int) -> Array:
    """Re of the sum of z^m S(m phi), m from 1 to `orders`, z = x + i y, for each Gaussian, (4, ...).

        S(phi) = exp(i mu phi - sigma^2 phi^2)

    With w = z exp(i mu phi), Re(w^m) = 2 Re(w) Re(w^(m-1)) - |w|^2 Re(w^(m-2)).
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
    """`_orders` for infinitely many orders, by an integral over wavenumbers.

    The damping exp(-sigma^2 m^2 phi^2) is the mean of exp(i m sqrt(2) sigma u phi) over a standard normal u. Thus

        sum of z^m S(m phi) = mean over u of the sum of w^m,  w = z exp(i (mu + sqrt(2) sigma u) phi),  |w| = |z|

    The sum over m >= 1 is w / (1 - w). Its real part is (Re(w) - |w|^2) / |1 - w|^2, which is
    ((1 - |w|^2) / |1 - w|^2 - 1) / 2, since |1 - w|^2 = 1 - 2 Re(w) + |w|^2. The mean is computed by the trapezoidal
    rule with weights HEIGHTS. Each node rotates w by a multiple of one step, so nodes need no sines of their own.
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
    """|1 - w|^2 as a divisor; 0 is replaced by 1, because no light passes there."""
    size = (1.0 - real) ** 2 + imaginary * imaginary
    return array_namespace(size).where(size > 0.0, size, 1.0)


def _product(a: Complex, b: Complex) -> Complex:
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def _squared(a: Complex) -> Array:
    return a[0] * a[0] + a[1] * a[1]


def _quotient(a: Complex, b: Complex, otherwise: float) -> Complex:
    """Complex quotient a / b; the real number `otherwise` where b is 0."""
    squared = _squared(b)
    xp, valid = array_namespace(squared), squared > 0.0
    size = xp.where(valid, squared, 1.0)
    real, imaginary = _product(a, (b[0] / size, -b[1] / size))
    return xp.where(valid, real, otherwise), imaginary


# Gauss-Legendre nodes in the cosine: for the curve, and for the clamped polynomial through it.
POINTS, FINE = 14, 200

Polarizations: TypeAlias = tuple[Interface, Interface]


@dataclass(frozen=True)
class Form:
    """Choices that the specification leaves to implementations, and one defect.

    - `matrix`: Rows of the matrix from CIE XYZ to linear RGB.
    - `orders`: Number M of orders; None sums all orders.
    - `mixed`: If true, the index of RGB channel k is used for XYZ value k. Otherwise XYZ is computed
      for each channel's index, so a vanishing film does not change the channels.
    - `share`: Factor on the Schlick substrate's reflectance; 1 in the specification.
    - `least`: Smallest color0 that is converted to the index of a Schlick substrate.
    - `clamped`: Whether values are clamped to [0, 1], as in the specification.
    """

    matrix: tuple[tuple[float, ...], ...] = tuple(map(tuple, XYZ_TO_REC709_E.tolist()))
    orders: int | None = None
    mixed: bool = False
    share: float = 1.0
    least: float = 0.0
    clamped: bool = True


# Matrix of MaterialX 1.39.5 from XYZ to CIE RGB with white E.
CIE_RGB = (
    (2.3706743, -0.9000405, -0.4706338),
    (-0.5138850, 1.4253036, 0.0885814),
    (0.0052982, -0.0146949, 1.0093968),
)
TEXT = Form()
PRINTED = Form(tuple(map(tuple, XYZ_TO_REC709.tolist())), 2, True)
MATERIALX = Form(CIE_RGB, 2, True, 0.5, 0.01)


def film_curve(category: str, form: Form = TEXT) -> Curve:
    """Fresnel curve of a node with the inputs of a film; with thickness 0, the node's own curve."""
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
    """Coated values where the thickness is not 0, else plain values; skips `coated` without films."""
    xp = array_namespace(thickness, plain)
    if xp is not NUMPY or (thickness > 0.0).any():
        return xp.where(thickness > 0.0, coated(), plain)
    return np.broadcast_to(plain, np.broadcast_shapes(thickness.shape, plain.shape))


def _film_average(
    category: str, form: Form, film: tuple[Array, Array], material: dict[str, Array]
) -> Array:
    """F_ss, (3, ...): the integral of a polynomial through the film's curve, which is then clamped.

    The curve itself is not clamped, since the clamp has kinks.
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
    """Cosines of POINTS nodes, the matrix that interpolates to a fine rule, and that rule's weights."""
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
DEGREE = 48  # degree of the polynomial in the cosine that replaces a film's curve in albedos


@any_array
def film_reflectance(
    category: str, mu: ArrayLike, inputs: Mapping[str, ArrayLike], form: Form = TEXT
) -> Array:
    """Reflectance of a node under a thin film for unpolarized light; `tint` and `roughness` have no effect.

    Accuracy of the infinite sum: 1e-6 over a dielectric for cosines above 0.01; 1e-4 over a conductor at grazing
    angles, where all orders count. A film index below 1 is rejected: the specification's phases of the first interface,
    pi for the s polarization, require a film denser than the vacuum. The Schlick curve describes the film's lower
    interface at the refracted angle, so the value jumps as soon as the thickness is not 0. A negative curve counts as
    0, because it has no amplitude.

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
    """BRDF of a microfacet node under a thin film, scatter mode R, in 1/sr; `lobe` may replace its terms.

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

    The film's curve is approximated by a polynomial of degree 48 in the cosine; the error is below 1e-4 for films up
    to 2000 nm with index up to 2. [MaterialX2026], Directional Albedo and Energy Conservation.

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
    """Checked inputs: those with channels, and those without."""
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
    """Values reduced to one row if all rows are equal: a film's F_ss is then computed once."""
    if array_namespace(values) is not NUMPY:
        return values
    many = np.ndim(wo) == 2 and values.ndim == channels + 1 and len(values) == len(np.asarray(wo))
    return values[:1] if many and bool((values == values[:1]).all()) else values


def polynomial_curve(category: str, form: Form) -> Callable[..., Array]:
    """F of a film as a polynomial in the cosine: (3, n, n, ...) for cosines (n, n, ...)."""
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
