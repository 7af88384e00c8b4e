# SPDX-License-Identifier: Apache-2.0
"""The hair model of [MaterialX2026], section `chiang_hair_bsdf`, after [Chiang2016] and [dEon2011].

The fiber runs along +x, and the normal +z is on the viewer's side. Light comes from the whole
sphere. A direction has an inclination theta, with sin(theta) = x, and an azimuth about the fiber.
Absorption is per radius of the fiber, as in the specification's equation, although the
specification's table of inputs says diameter. Some functions compute roughnesses and absorption
from artist-friendly inputs.

- `wo` (..., 3): Direction to the viewer, unit vector to 1e-6, fiber +x, normal +z, z >= 0.
- `wi` (..., 3): Direction to the light, unit vector to 1e-6, on either side.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast. Functions that validate no arguments expect directions of shape (3, ...).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from mxeon.models.core import arguments, arrays
from mxeon.models.core.arguments import checked, lead_shape
from mxeon.models.core.arrays import Array, ArrayLike, any_array, array_namespace, guarded
from mxeon.models.core.evaluation import evaluate_material
from mxeon.models.core.quadrature import unit_rule
from mxeon.models.microfacet import fresnel as fresnel_formulas

LOBES = ("R", "TT", "TRT", "TRRT+")
SCALE = np.sqrt(np.pi / 8.0)  # factor of the scale s in section Azimuthal Scattering
LEAST_DIVISOR = 1e-300  # quotients by smaller divisors may overflow

# For x below 20, I_0 is a power series, and SERIES has the coefficients of (x / 20)^(2 k), which
# are all positive. For larger x, I_0 is an asymptotic series, whose smallest term is about
# exp(-2 x), and TAIL has the coefficients of (20 / x)^k. The last coefficients are below 2^-53.
BESSEL, ORDERS = 20.0, np.arange(1, 48)
SERIES = np.cumprod(np.append(1.0, (0.5 * BESSEL / ORDERS) ** 2)).tolist()
TAIL = np.cumprod(
    np.append(1.0, (2 * ORDERS[:38] - 1) ** 2 / (8.0 * ORDERS[:38] * BESSEL))
).tolist()


def bessel_scaled(x: Array) -> Array:
    """exp(-x) I_0(x) for x >= 0: [Olver2010], Eqs. 10.25.2 and 10.40.1."""
    xp = array_namespace(x)
    small, large = xp.minimum(x, BESSEL), xp.maximum(x, BESSEL)
    series, tail = _polynomial(SERIES, xp.square(small / BESSEL)), _polynomial(TAIL, BESSEL / large)
    return xp.where(x < BESSEL, xp.exp(-small) * series, tail / xp.sqrt(2.0 * np.pi * large))


def _polynomial(coefficients: list[float], x: Array) -> Array:
    """Polynomial in x by Horner's rule; the first coefficient is the constant term."""
    total = 0.0 * x
    for each in reversed(coefficients):
        total = total * x + each
    return total


def longitudinal(sin_i: Array, cos_i: Array, sin_o: Array, cos_o: Array, v: Array) -> Array:
    """M_p of section Longitudinal Scattering, in a form that neither overflows nor cancels.

    The published form is M = exp(-sin_i sin_o / v) I_0(x) / (2 v sinh(1 / v)), where
    x = cos_i cos_o / v. I_0 is even, so |cos_i| can replace cos_i, which is negative for
    inclinations tilted beyond [-pi/2, pi/2]. To avoid an overflow, exp(x) is factored out of I_0(x)
    and exp(1 / v) out of 2 sinh(1 / v):

        M = exp(-(1 + sin_i sin_o - |cos_i| cos_o) / v) (exp(-x) I_0(x)) / (v (1 - exp(-2 / v)))

    1 + sin_i sin_o - |cos_i| cos_o is computed as d^2 / 2, where d is the distance between the
    points (|cos_i|, sin_i) and (cos_o, -sin_o).
    """
    xp = array_namespace(sin_i, sin_o, v)
    cos_i = xp.abs(cos_i)
    d2 = xp.square(cos_i - cos_o) + xp.square(sin_i + sin_o)
    norm = -v * xp.expm1(-2.0 / v)
    return xp.exp(-0.5 * d2 / v) * bessel_scaled(cos_i * cos_o / v) / norm


def azimuthal(phi: Array, s: Array) -> Array:
    """N_p of section Azimuthal Scattering at x = phi - Phi_p, wrapped into [-pi, pi].

    The published form is l(x, s) / (L(pi, s) - L(-pi, s)), where l is the logistic density,
    L = 1 / (1 + e^(-x/s)) is its integral, and s is scaled by sqrt(pi / 8). Because l is even, l is
    computed as f / (s (1 + f)^2) with f = e^(-|x|/s), which never overflows. The divisor is
    L(pi) - L(-pi) = (1 - e^(-pi/s)) / (1 + e^(-pi/s)) = tanh(pi / (2 s)).
    """
    xp, scale = array_namespace(phi, s), SCALE * s
    wrapped = xp.remainder(phi + np.pi, 2.0 * np.pi) - np.pi
    fall = xp.exp(-xp.abs(wrapped) / scale)
    value: Array = fall / (scale * xp.square(1.0 + fall)) / xp.tanh(0.5 * np.pi / scale)
    return value


@dataclass(frozen=True)
class HairForm:
    """A form of the hair model. The default is the form in the specification. Shaders use other
    forms.

    - `tilts_light`: True to tilt the light's inclination by the cuticle angle, False to tilt the
      viewer's inclination.
    - `effective`: True to compute F at gamma_o with the effective index of refraction, False to
      compute F at the actual angle of incidence with `ior`.
    """

    longitudinal: Callable[[Array, Array, Array, Array, Array], Array] = longitudinal  # M_p
    uniform: float = 0.5 / np.pi  # constant N_p of the lobe TRRT+
    limits: tuple[float, float] = (0.0, np.inf)  # range to which all roughnesses are clamped
    tilts_light: bool = True
    effective: bool = False
    factor: float = 1.0 / np.pi  # factor that multiplies the sum of the lobes


TEXT = HairForm()


@dataclass(frozen=True)
class Section:
    """Angles of the viewing direction and of the refracted ray in the fiber's cross-section."""

    sin_o: Array  # sine of the viewer's inclination
    cos_o: Array  # cosine of the viewer's inclination
    gamma_o: Array  # angle between the normal and the viewing direction
    gamma_t: Array  # angle between the normal and the refracted ray
    cos_gamma: Array  # cosine of gamma_o


def section(wo: Array, ior: Array) -> tuple[Section, Array]:
    """Returns the angles of section Hair Fiber Geometry and the effective index of refraction.

    The specification lets the renderer choose the offset h = sin(gamma_o). As in MaterialX's
    shaders, h is the offset of the point with normal +z. If wo is along the fiber, h is 0. If `ior`
    is below 1 and no light enters the fiber, F is 1 and gamma_t has no effect.
    """
    xp, least = array_namespace(wo, ior), max(LEAST_DIVISOR, arrays.least_normal(wo))
    sin_o, cos_o = wo[0], arrays.hypot(wo[1], wo[2])
    inside = arrays.root(xp.maximum(xp.square(ior) - xp.square(sin_o), 0.0))
    across = xp.maximum(guarded(cos_o, cos_o > least, 1.0), LEAST_DIVISOR)
    # The cosine of gamma_o, rounded to float32, may be negative, because float32's pi / 2 is larger.
    cos_gamma = xp.where(cos_o > least, wo[2] / across, 1.0)
    gamma_o = arrays.angle(-wo[1], xp.where(cos_o > 0.0, wo[2], 1.0))
    sin_t = -wo[1] / xp.maximum(guarded(inside, inside > least, 1.0), LEAST_DIVISOR)
    return Section(sin_o, cos_o, gamma_o, arrays.arcsine(sin_t), cos_gamma), inside / across


def attenuations(
    view: Section, effective: Array, ior: Array, absorption: Array, form: HairForm
) -> Array:
    """A_p of the four lobes, (4, C, ...), by section Attenuation Factors.

    - `absorption` (C, ...): Absorption per radius of the fiber.
    """
    xp = array_namespace(view.sin_o, ior, absorption)
    least = max(LEAST_DIVISOR, arrays.least_normal(ior))
    if form.effective:
        F = fresnel_formulas.dielectric(view.cos_gamma, xp.minimum(effective, 1e50))
    else:
        F = fresnel_formulas.dielectric(view.cos_o * view.cos_gamma, ior)
    bends = ior > least
    index = xp.maximum(guarded(ior, bends, least), LEAST_DIVISOR)
    sin_t = arrays.at_most(xp.abs(view.sin_o) / index, 1.0)
    cos_t = arrays.root((1.0 - sin_t) * (1.0 + sin_t))
    passes, path = cos_t > least, 2.0 * xp.cos(view.gamma_t)
    path = xp.where(
        passes, path / xp.maximum(guarded(cos_t, passes, 1.0), LEAST_DIVISOR), path / least
    )
    T = xp.exp(-absorption * path)
    pass_through = xp.square(1.0 - F)
    rest = 1.0 - F * T
    # If F and T are 1, the quotient A_TRRT+ is 0 / 0, and the limit is 0.
    A_TRRT = pass_through * F**2 * T**3 / xp.where(rest > 0.0, rest, 1.0)
    return xp.stack([F + 0.0 * T, pass_through * T, pass_through * F * T**2, A_TRRT])


def distribution(
    view: Section,
    wo: Array,
    wi: Array,
    roughness: Array,
    alpha: Array,
    lobe: int,
    form: HairForm,
) -> Array:
    """M_p N_p of a lobe, by the sections Cuticle Tilt, Longitudinal and Azimuthal Scattering.

    - `roughness` (2, ...): Longitudinal variance v and azimuthal scale s.
    """
    xp, (low, high) = array_namespace(wo, wi, alpha), form.limits
    v, s = (xp.minimum(xp.maximum(each, low), high) for each in roughness)
    sin_i, cos_i, sin_o, cos_o = wi[0], arrays.hypot(wi[1], wi[2]), view.sin_o, view.cos_o
    if lobe < 3:
        cosine, sine = xp.cos((2.0 - 3.0 * lobe) * alpha), xp.sin((2.0 - 3.0 * lobe) * alpha)
        if form.tilts_light:
            sin_i, cos_i = sin_i * cosine + cos_i * sine, cos_i * cosine - sin_i * sine
        else:
            sin_o, cos_o = sin_o * cosine + cos_o * sine, cos_o * cosine - sin_o * sine
    M = form.longitudinal(sin_i, cos_i, sin_o, xp.abs(cos_o), v)
    if lobe == 3:
        return M * form.uniform
    exit_angle = 2.0 * lobe * view.gamma_t - 2.0 * view.gamma_o + lobe * np.pi
    phi = arrays.angle(wi[2] * wo[1] - wo[2] * wi[1], wi[1] * wo[1] + wi[2] * wo[2])
    return M * azimuthal(phi - exit_angle, s)


# Gauss-Legendre nodes in each of the five intervals of `tilted_share`. The error is at most 1e-12
# for variances from 1e-6 to 50.
TILT_NODES = 48
PEAK = 12.0  # half width of M's peak in standard deviations, where M has fallen by about e^-72


def tilted_share(view: Section, v: Array, tilt: Array) -> Array:
    """Integral of M_p N_p over all wi for the light's inclination tilted by `tilt`; 1 if untilted.

    With s the tilted inclination, mirrored into [-pi/2, pi/2] because M depends on |cos(s)|, this is
    the integral of M times max(cos(s - tilt), 0) + max(-cos(s + tilt), 0), by Gauss-Legendre
    between the zeros of these cosines and the ends of the peak of M.
    """
    xp, right = array_namespace(view.sin_o, v, tilt), 0.5 * np.pi
    kink = xp.remainder(tilt, np.pi) - right
    center, width = -arrays.angle(view.sin_o, view.cos_o), PEAK * xp.sqrt(v)
    zero = 0.0 * (kink + center + width)
    breaks = (zero - right, kink, -kink, center - width, center + width, zero + right)
    inside = [arrays.within(each + zero, -right, right) for each in breaks]
    ends = xp.sort(xp.stack(inside), axis=0)
    total = zero
    for x, weight in zip(*unit_rule(TILT_NODES), strict=True):
        span = ends[1:] - ends[:-1]
        s = ends[:-1] + float(x) * span
        M = longitudinal(xp.sin(s), xp.cos(s), view.sin_o, view.cos_o, v)
        ahead = arrays.at_least_0(xp.cos(s - tilt)) + arrays.at_least_0(-xp.cos(s + tilt))
        total = total + float(weight) * xp.sum(span * M * ahead, axis=0)
    return total


HAIR_BLOCK = 4096  # elements per block; few, because each element needs much memory
TINTS, ROUGHNESSES = (
    tuple(f"{prefix}_{lobe}" for lobe in ("R", "TT", "TRT")) for prefix in ("tint", "roughness")
)


@any_array
def chiang_hair_bcsdf(wo: ArrayLike, wi: ArrayLike, **inputs: Any) -> Array:
    """Curve-scattering distribution function of a hair fiber.

        f = 1/pi (t_R A_R M_R N_R + t_TT A_TT M_TT N_TT + t_TRT (A_TRT M_TRT N_TRT + A_TRRT+ M_TRT / 2pi))

    Every keyword argument may be omitted and then has the node's default:

    - `tint_R`, `tint_TT`, `tint_TRT` (..., C): Tints of the lobes, in [0, 1].
    - `ior` (...): Index of refraction of the fiber, in [0, 1e50].
    - `roughness_R`, `roughness_TT`, `roughness_TRT` (..., 2): Longitudinal variance in square
      radians and azimuthal scale in radians, in [1e-12, 1e12].
    - `cuticle_angle` (...): In [0, 1]; 0.5 is no tilt.
    - `absorption_coefficient` (..., C): Absorption per radius of the fiber, in [0, 1e50].
    - `form`: A `HairForm`.

    Result (..., C): in 1/sr, without a cosine of the light, as in the specification. The integral
    of the result over all wi is 1/pi if nothing is absorbed and the cuticle has no tilt. Roughness
    (0, 0) would be a mirror, a delta function, and is rejected. F uses `ior`, as in [Chiang2016],
    although the specification can also be understood to mean the effective index of refraction.
    Accuracy: the relative error is below 1e-13 / min(sqrt(v), s), or the absolute error is below
    1e-300. [MaterialX2026].

        >>> chiang_hair_bcsdf([0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]).round(6)
        array([0.137704, 0.137704, 0.137704])
    """
    form: HairForm = inputs.pop("form", TEXT)
    wo, wi = arguments.checked_directions("wo", wo), arguments.checked_sphere("wi", wi)
    vectors = _checked(inputs, wo)
    numbers = {name: vectors.pop(name) for name in ("ior", "cuticle_angle")}
    colors = {name: vectors[name] for name in (*TINTS, "absorption_coefficient")}

    # The lobe TRRT+ has the tint and the roughness of the lobe TRT.
    def formula(wo: Array, wi: Array, **inputs: Array) -> Array:
        ior, alpha = inputs["ior"], np.pi * (inputs["cuticle_angle"] - 0.5)
        view, effective = section(wo, ior)
        factors = attenuations(view, effective, ior, inputs["absorption_coefficient"], form)
        names = zip((*TINTS, TINTS[-1]), (*ROUGHNESSES, ROUGHNESSES[-1]), strict=True)
        lobes: list[Array] = [
            inputs[tint] * (A * distribution(view, wo, wi, inputs[rough], alpha, p, form))
            for p, (A, (tint, rough)) in enumerate(zip(factors, names, strict=True))
        ]
        return form.factor * sum(lobes[1:], lobes[0])

    return evaluate_material(
        formula,
        {"wo": wo, "wi": wi, **vectors},
        numbers,
        arguments.channel_count(colors),
        HAIR_BLOCK,
    )


@any_array
def chiang_hair_attenuation(
    wo: ArrayLike, ior: ArrayLike, absorption_coefficient: ArrayLike
) -> Array:
    """Attenuation factors A_R, A_TT, A_TRT and A_TRRT+ for a viewing direction.

    - `ior` (...): Index of refraction of the fiber, in [0, 1e50].
    - `absorption_coefficient` (..., C): Absorption per radius of the fiber, in [0, 1e50].

    Result (..., C, 4): in [0, 1]. The sum of the four factors is 1 without absorption, and less
    than 1 with absorption. [MaterialX2026], Chiang Hair Model, section Attenuation Factors.

        >>> chiang_hair_attenuation([0.0, 0.0, 1.0], 1.55, 0.0).round(6)
        array([[0.046521, 0.909123, 0.042293, 0.002063]])
    """
    absorption = arguments.checked_color("absorption_coefficient", absorption_coefficient)
    vectors = {"wo": arguments.checked_directions("wo", wo), "absorption_coefficient": absorption}
    channels = absorption.shape[-1]

    def formula(wo: Array, absorption_coefficient: Array, ior: Array) -> Array:
        view, effective = section(wo, ior)
        factors = attenuations(view, effective, ior, absorption_coefficient, TEXT)
        rows = [factors[lobe, c] for c in range(channels) for lobe in range(len(LOBES))]
        return array_namespace(factors).stack(rows)

    values = evaluate_material(
        formula, vectors, {"ior": checked("ior", ior)}, 4 * channels, HAIR_BLOCK
    )
    return array_namespace(values).reshape(values, (*values.shape[:-1], channels, 4))


DEFAULTS: dict[str, float | tuple[float, ...]] = {
    **dict.fromkeys(TINTS, (1.0, 1.0, 1.0)),
    "ior": 1.55,
    "roughness_R": (0.1, 0.1),
    "roughness_TT": (0.05, 0.05),
    "roughness_TRT": (0.2, 0.2),
    "cuticle_angle": 0.5,
    "absorption_coefficient": (0.0, 0.0, 0.0),
}


def _checked(inputs: dict[str, ArrayLike], wo: arrays.Numbers) -> dict[str, Array]:
    """Validated inputs of the node, as arrays of wo's library. Colors have shape (..., C)."""
    if unknown := sorted(set(inputs) - set(DEFAULTS)):
        raise TypeError(f"inputs must be among {', '.join(DEFAULTS)}; got {', '.join(unknown)}")
    values = {}
    for name, value in {**DEFAULTS, **inputs}.items():
        check = arguments.checked_pairs if name in ROUGHNESSES else checked
        array = check(name, value)
        values[name] = array if arrays.library(array) else arrays.like(array, wo)
    for name in (*TINTS, "absorption_coefficient"):
        values[name] = arguments.with_axis(values[name])
    return values


# Absorption of each pigment in red, green and blue, per radius of the fiber.
EUMELANIN = (0.419, 0.697, 1.37)
PHEOMELANIN = (0.187, 0.4, 1.05)


@any_array
def chiang_hair_roughness(
    longitudinal: ArrayLike,
    azimuthal: ArrayLike,
    scale_tt: ArrayLike = 0.5,
    scale_trt: ArrayLike = 2.0,
) -> tuple[Array, Array, Array]:
    """Longitudinal variance v and azimuthal scale s of the lobes R, TT and TRT.

        v = (0.726 l + 0.812 l^2 + 3.7 l^20)^2,  s = 0.265 a + 1.194 a^2 + 5.372 a^22;
        R (v, s), TT (scale_tt^2 v, s), TRT (scale_trt^2 v, s)

    - `longitudinal`, `azimuthal` (...): Roughnesses l and a, in [0, 1].
    - `scale_tt`, `scale_trt` (...): Factors of the roughness of TT and TRT, in [0, 1e50].

    s does not include the factor sqrt(pi / 8). [MaterialX2026], section Hair Roughness Conversion
    Equations; [Chiang2016], fits of both roughnesses.

        >>> r, tt, trt = chiang_hair_roughness(0.1, 0.2)
        >>> r.round(6), tt.round(6), trt.round(6)
        (array([0.006516, 0.10076 ]), array([0.001629, 0.10076 ]), array([0.026063, 0.10076 ]))
    """
    scales = {"scale_tt": scale_tt, "scale_trt": scale_trt}
    numbers = arguments.checked_all({"longitudinal": longitudinal, "azimuthal": azimuthal} | scales)
    shape, xp = lead_shape({}, numbers), array_namespace(*numbers.values())
    long, azim, *factors = (xp.broadcast_to(value, shape) for value in numbers.values())
    v = xp.square(0.726 * long + 0.812 * long**2 + 3.7 * long**20)
    s = 0.265 * azim + 1.194 * azim**2 + 5.372 * azim**22
    tt, trt = (xp.stack([factor * factor * v, s], axis=-1) for factor in factors)
    return xp.stack([v, s], axis=-1), tt, trt


@any_array
def deon_hair_absorption_from_melanin(
    melanin_concentration: ArrayLike,
    melanin_redness: ArrayLike,
    eumelanin_color: ArrayLike,
    pheomelanin_color: ArrayLike,
) -> Array:
    """Absorption coefficient of a mix of eumelanin and pheomelanin.

        sigma_a = m ((1 - redness) (-log eumelanin) + redness (-log pheomelanin)),
        m = -log(1 - concentration)

    - `melanin_concentration`, `melanin_redness` (...): In [0, 1) and in [0, 1].
    - `eumelanin_color`, `pheomelanin_color` (..., 3): Transmittance of the pigment along one fiber
      radius, in (0, 1].

    [dEon2011] adds the absorptions of both pigments. The specification does not say how
    concentration and redness determine the amount of each pigment. The equation for the amounts is
    from MaterialX's implementations. [MaterialX2026], section deon_hair_absorption_from_melanin.

        >>> colors = np.exp(-np.array(EUMELANIN)), np.exp(-np.array(PHEOMELANIN))
        >>> deon_hair_absorption_from_melanin(0.25, 0.5, *colors).round(6)
        array([0.087168, 0.157794, 0.348095])
    """
    colors = {"eumelanin_color": eumelanin_color, "pheomelanin_color": pheomelanin_color}
    mixed = {"melanin_concentration": melanin_concentration, "melanin_redness": melanin_redness}
    numbers = arguments.checked_all(mixed)
    vectors = {
        name: arguments.checked_triples(name, checked(name, value))
        for name, value in colors.items()
    }
    lead_shape(vectors, numbers)
    concentration, redness = (value[..., np.newaxis] for value in numbers.values())
    xp = array_namespace(concentration, redness)
    eumelanin, pheomelanin = (-xp.log(value) for value in vectors.values())
    mix = (1.0 - redness) * eumelanin + redness * pheomelanin
    return -xp.log1p(-concentration) * mix


@any_array
def chiang_hair_absorption_from_color(
    hair_color: ArrayLike, azimuthal_roughness: ArrayLike
) -> Array:
    """Absorption coefficient of hair whose color after multiple scattering is `hair_color`.

        sigma_a = (log(color) / (5.969 - 0.215 b + 2.532 b^2 - 10.73 b^3 + 5.574 b^4 + 0.245 b^5))^2

    - `hair_color` (..., 3): Scattering color, in (0, 1].
    - `azimuthal_roughness` (...): Azimuthal roughness b, in [0, 1].

    [Chiang2016], fit of the absorption; [MaterialX2026], section chiang_hair_absorption_from_color.

        >>> chiang_hair_absorption_from_color([0.5, 0.2, 0.1], 0.2).round(6)
        array([0.013569, 0.073156, 0.149739])
    """
    color = arguments.checked_triples("hair_color", checked("hair_color", hair_color))
    roughness = checked("azimuthal_roughness", azimuthal_roughness)
    lead_shape({"hair_color": color}, {"azimuthal_roughness": roughness})
    xp, b = array_namespace(color), roughness[..., np.newaxis]
    fit = 5.969 - b * (0.215 - b * (2.532 - b * (10.73 - b * (5.574 + b * 0.245))))
    return xp.square(xp.log(color) / fit)
