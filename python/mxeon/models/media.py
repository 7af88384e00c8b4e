# SPDX-License-Identifier: Apache-2.0
"""Emission, media, subsurface scattering, `surface` and black bodies of [MaterialX2026].

Radiances are per channel, in any unit. Directions point away from the surface, whose normal is +z.
In media, directions point away from the point of scattering, so undeflected light has wi = -wo. A
viewer below the horizon sees the back of the surface. There is no function for `measured_edf`,
because the values of this node come from a file.

- `wo`, `wi` (..., 3): Unit vectors to 1e-6; z may be negative.
- `radiance` (..., C): Radiance c per channel, in [0, 1e50]; a cone's radiance is c inside the cone.
- `inner_angle`, `outer_angle` (...): Full angles of the cones at which the falloff starts and ends,
  in degrees, in [0, 360].
- `color0`, `color90` (..., C): Factors along the normal and at grazing angles, in [0, 1].
- `exponent` (...): Exponent q, in [0, 1e50]. With exponent 0, the factor is always `color90`.
- `absorption`, `scattering`: Coefficients per channel in 1/m, in [0, 1e50].
- `g`: Mean cosine of the deflection, in (-1, 1). For -1 and 1, the phase function would be a delta
  function.
- `temperature` (...): In kelvin, in [1, 1e9].

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mxeon.models.core import arguments, arrays
from mxeon.models.core.arguments import checked, checked_colors, checked_numbers, lead_shape
from mxeon.models.core.arrays import Array, ArrayLike, any_array, array_namespace, at_least_0, like
from mxeon.models.core.colorimetry import CIE_1931, WAVELENGTHS, XYZ_TO_REC709
from mxeon.models.core.quadrature import unit_rule

HALF_TURN = np.pi / 360.0  # converts a cone's full angle in degrees to its half angle in radians


@any_array
def uniform_edf(wo: ArrayLike, radiance: ArrayLike) -> Array:
    """Radiance L_e = c of a surface that emits equally in all directions.

    The specification's equation does not distinguish the sides of the surface, so both sides emit.
    [MaterialX2026], section `uniform_edf`, Uniform Emission Equation.

        >>> uniform_edf([0.6, 0.0, 0.8], [0.5, 2.0])
        array([0.5, 2. ])
    """
    mu, (c,), _ = _checked(wo, {"radiance": radiance})
    return c + 0.0 * mu[..., np.newaxis]


@any_array
def conical_edf(
    wo: ArrayLike, radiance: ArrayLike, inner_angle: ArrayLike, outer_angle: ArrayLike
) -> Array:
    """Radiance of a surface that emits inside a cone.

        L_e = c smoothstep(c_out, c_in, cos)    if outer_angle > inner_angle
        L_e = c if cos >= c_in, else 0          otherwise

    c_in and c_out are the cosines of half the inner and outer angles. If wo is below the horizon,
    cos counts as 0. [MaterialX2026], section `conical_edf`, Conical Falloff Equations.

        >>> conical_edf([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8]], [2.0], 60.0, 90.0).round(6)
        array([[2.      ],
               [1.251183]])
    """
    angles = {"inner_angle": inner_angle, "outer_angle": outer_angle}
    mu, (c,), (inner, outer) = _checked(wo, {"radiance": radiance}, **angles)
    xp, mu, soft = array_namespace(mu, inner, outer), at_least_0(mu)[..., np.newaxis], outer > inner
    width = xp.where(soft, cone_width(inner, outer), 1.0)
    t = arrays.at_most(at_least_0((mu - cone_cosine(outer)) / width), 1.0)
    hard = xp.where(mu >= cone_cosine(inner), 1.0, 0.0)
    return c * xp.where(soft, t * t * (3.0 - 2.0 * t), hard)


@any_array
def generalized_schlick_edf(
    wo: ArrayLike, base: ArrayLike, color0: ArrayLike, color90: ArrayLike, exponent: ArrayLike
) -> Array:
    """Radiance of an emission `base`, (..., C) in [0, 1e50], scaled by a Schlick curve.

        L_e = (r_0 + (r_90 - r_0) (1 - cos)^q) L_base

    If cos is negative, |cos| is used, because the published factor would not lie between r_0 and
    r_90. [MaterialX2026], section `generalized_schlick_edf`, Generalized Schlick Emission
    Equations.

        >>> generalized_schlick_edf([0.6, 0.0, 0.8], [2.0], [1.0], [0.0], 1.0).round(6)
        array([1.6])
    """
    colors = {"base": base, "color0": color0, "color90": color90}
    mu, (c, r0, r90), (q,) = _checked(wo, colors, exponent=exponent)
    mu = mu[..., np.newaxis]
    height = array_namespace(mu).where(mu < 0.0, -mu, mu)
    return c * (r0 + (r90 - r0) * arrays.power(at_least_0(1.0 - height), q))


def cone_cosine(angle: Array) -> Array:
    """Cosine of half an angle in degrees. The result for 180 degrees is exactly 0."""
    return array_namespace(angle).sin(HALF_TURN * (180.0 - angle))


def cone_width(inner: Array, outer: Array) -> Array:
    """Difference c_in - c_out of the cosines of half angles, as a product to avoid cancellation."""
    half = 0.5 * HALF_TURN
    sin = array_namespace(inner, outer).sin
    return 2.0 * sin(half * (outer + inner)) * sin(half * (outer - inner))


def _checked(
    wo: ArrayLike, colors: Mapping[str, ArrayLike], **numbers: ArrayLike
) -> tuple[Array, list[Array], list[Array]]:
    """Returns the cosine of wo's polar angle, in [-1, 1], and validated colors and numbers."""
    directions = arguments.checked_sphere("wo", wo)
    vectors, values = checked_colors(colors, **numbers)
    parts = dict(zip(colors, vectors, strict=True))
    plain = {name: value[..., 0] for name, value in zip(numbers, values, strict=True)}
    lead_shape({"wo": directions} | parts, plain)
    return -arrays.at_most(-arrays.at_most(directions[..., 2], 1.0), 1.0), vectors, values


@any_array
def transmittance(absorption: ArrayLike, scattering: ArrayLike, distance: ArrayLike) -> Array:
    """Fraction T = exp(-sigma_t t) of the radiance that crosses a homogeneous medium unscattered.

    - `distance`: Distance t in m, in [0, 1e50].

    For the node `absorption_vdf`, `scattering` is 0. [MaterialX2026], sections `absorption_vdf`,
    Beer-Lambert Absorption, and `anisotropic_vdf`, Extinction.

        >>> round(float(transmittance(0.5, 0.5, 2.0)), 6)
        0.135335
    """
    sigma_a, sigma_s, t = checked_numbers(
        absorption=absorption, scattering=scattering, distance=distance
    )
    xp = array_namespace(sigma_a, sigma_s, t)
    return xp.exp(-(sigma_a + sigma_s) * t)[()]


@any_array
def hg_pdf(wo: ArrayLike, wi: ArrayLike, g: ArrayLike) -> Array:
    """Phase function of Henyey and Greenstein: the density of `wi`, in 1/sr.

        f_p = (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2)),  cos = -dot(wo, wi)

    To avoid cancellation near g = 1 and g = -1, 1 + g^2 - 2 g cos is computed as (1 - |g|)^2 + 2
    |g| (1 - cos), where cos is negated for g < 0. 1 - g^2 is computed as a product.
    [MaterialX2026], section `anisotropic_vdf`, Henyey-Greenstein Phase Function.

        >>> round(float(hg_pdf([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], 0.5)), 6)
        0.477465
    """
    views, lights = arguments.checked_sphere("wo", wo), arguments.checked_sphere("wi", wi)
    mean = checked("g", g)
    lead_shape({"wo": views, "wi": lights}, {"g": mean})
    xp = array_namespace(views, lights, mean)
    side = xp.where(mean < 0.0, -1.0, 1.0)[..., np.newaxis]
    difference = 1.0 * views + side * lights
    return _phase(0.5 * xp.sum(difference**2, axis=-1), mean)[()]


def _phase(less: Array, g: Array) -> Array:
    """Henyey-Greenstein phase function; `less` is 1 - cos for g >= 0, and 1 + cos for g < 0."""
    xp = array_namespace(less, g)
    size = xp.abs(g)
    square = (1.0 - size) ** 2 + 2.0 * size * less
    return (1.0 - size) * (1.0 + size) / (4.0 * np.pi * square * xp.sqrt(square))


@any_array
def surface_radiance(emission: ArrayLike, scattered: ArrayLike, opacity: ArrayLike) -> Array:
    """Radiance O (L_e + L_s) of a surface, without the fraction 1 - O of the light from behind.

    - `emission`, `scattered` (..., C): L_e, the emission of the surface, and L_s, the light that
      the surface scatters, per channel, in [0, 1e50].
    - `opacity` (...): O, the fraction of the surface that the material covers, in [0, 1].

    [MaterialX2026], section `surface`, Surface Shading Equation.

        >>> surface_radiance([1.0], [0.5], 0.5)
        array([0.75])
    """
    colors = {"emission": emission, "scattered": scattered}
    (emitted, light), (covered,) = checked_colors(colors, opacity=opacity)
    return covered * (emitted + light)


# Nodes per panel, and number of panels. PANELS is large because the integrand has a kink.
BLUR_NODES, PANELS = 50, 40
FAR = 3.0  # the profile's second decay length divided by the first decay length


@any_array
def diffusion_blur(mu: ArrayLike, reach: ArrayLike) -> Array:
    """Cosine of a distant light, blurred over a unit sphere by the normalized diffusion profile.

        R(r) = (exp(-r / l) + exp(-r / (3 l))) / (8 pi l r)
        W(mu) = int C'(r) c(mu, r) dr / C(2),  c = mean of max(cos(theta), 0) at the distance r

    - `mu`: Cosine of the angle between the light and the normal, in [-1, 1].
    - `reach`: Mean free path divided by the sphere's radius, in [1e-150, 1e150]. For a vanishing
      mean free path, W is max(mu, 0).

    The mean of W over the sphere is 1/4, the mean of max(mu, 0). As in the specification, distances
    are chords through the sphere. With C'(r) = 2 pi r R(r), the divisor C(2) normalizes the
    profile over chords up to the diameter. Accuracy: the absolute error is below 1e-6.
    [MaterialX2026], section Normalized Diffusion Profile; [Christensen2015].

        >>> diffusion_blur([-0.5, 0.0, 1.0], 0.1).round(4)
        array([0.0097, 0.074 , 0.9344])
    """
    numbers = {"mu": checked("mu", mu, "cos_theta"), "reach": checked("reach", reach)}
    cosine, length = arguments.broadcastable({}, numbers)
    return blur_to(cosine, length, FAR)


def blur_to(mu: Array, reach: Array, far: float) -> Array:
    """`diffusion_blur` for valid arrays. The specification's profile has `far` = FAR."""
    reach = reach[..., np.newaxis]
    (first, share_1), (second, share_2) = (_exponential(mu, each) for each in (reach, far * reach))
    total = 0.25 * share_1 + 0.75 * share_2
    return (0.25 * share_1 * first + 0.75 * share_2 * second) / total


def _exponential(mu: Array, reach: Array) -> tuple[Array, Array]:
    """Returns the cosine blurred over chords r <= 2 of density exp(-r / reach), and P(r <= 2)."""
    xp, rule = array_namespace(mu, reach), unit_rule(BLUR_NODES, PANELS)
    u, weights = (like(each, reach) for each in rule)
    share = -xp.expm1(-2.0 / reach)
    distance = xp.minimum(-reach * xp.log1p(-u * share), 2.0)
    # `circle` is the mean of max(cos(theta), 0) over all points at a given distance.
    mu, squared = mu[..., np.newaxis], distance * distance
    along = mu * (1.0 - 0.5 * squared)
    across = arrays.root(at_least_0((1.0 - mu * mu) * squared * (1.0 - 0.25 * squared)))
    lit = arrays.arccosine(-along / xp.maximum(across, 1e-300))
    circle = (along * lit + arrays.root(at_least_0(across**2 - along**2))) / np.pi
    return xp.sum(weights * circle, axis=-1), share[..., 0]


# Second radiation constant h c / k_B in m K, exact in the SI of 2019.
SECOND = 6.62607015e-34 * 299792458.0 / 1.380649e-23
NANOMETER = 1e-9  # m
LUMINANCE = np.linalg.inv(XYZ_TO_REC709)[1]  # weights of the linear Rec. 709 channels in Y

# Cubic polynomials for the chromaticity of a black body from 1667 K to 25000 K; the highest power
# comes first. The coordinate x is a polynomial in 1000 K / T; the rows of KANG_X are for
# temperatures below and above 4000 K. The coordinate y is a polynomial in x; the rows of KANG_Y are
# for temperatures below 2222 K, from 2222 K to 4000 K, and above 4000 K.
KANG_X = (
    (-0.2661239, -0.2343589, 0.8776956, 0.179910),
    (-3.0258469, 2.1070379, 0.2226347, 0.240390),
)
KANG_Y = (
    (-1.1063814, -1.34811020, 2.18555832, -0.20219683),
    (-0.9549476, -1.37418593, 2.09137015, -0.16748867),
    (3.0817580, -5.87338670, 3.75112997, -0.37001483),
)


@any_array
def blackbody_xyz(temperature: ArrayLike) -> Array:
    """CIE 1931 XYZ of a black body, with Y = 1.

    Result (..., 3): Sums over the observer's table in steps of 5 nm, which differ by less than 5e-5
    from sums in steps of 1 nm. Each spectrum is scaled by the spectrum's largest exponential, so a
    cold body has the right color although its radiance would underflow in float64. [Planck1901];
    ISO/CIE 11664-1.

        >>> blackbody_xyz(6504.0).round(4)
        array([0.9688, 1.    , 1.1218])
    """
    kelvin = checked_numbers(temperature=temperature)[0][..., np.newaxis]
    xp = array_namespace(kelvin)
    exponent = SECOND / (like(NANOMETER * WAVELENGTHS, kelvin) * kelvin)
    least = exponent[..., -1:]  # the longest wavelength has the smallest exponent
    # `growth` is (exp(exponent) - 1) / exp(least). The clamp to 700 affects only negligible terms.
    growth = xp.exp(xp.minimum(exponent - least, 700.0)) * -xp.expm1(-exponent)
    xyz = xp.tensordot(like(WAVELENGTHS**-5.0, kelvin) / growth, like(CIE_1931, kelvin), axes=1)
    return xyz / xyz[..., 1:2]


@any_array
def blackbody(temperature: ArrayLike) -> Array:
    """Color of a black body in linear Rec. 709, with luminance 1.

    Result (..., 3): Colors outside the gamut of Rec. 709 have negative channels; blue is negative
    below 1900 K, and green below 964 K. The specification calls the output "radiant emittance" and
    has no equation. Radiant emittance is proportional to the fourth power of the temperature, but
    implementations return a color of luminance 1, like this function. [MaterialX2026], section
    blackbody; [Planck1901]; ISO/CIE 11664-1.

        >>> blackbody([2000.0, 6504.0]).round(3)
        array([[2.52 , 0.647, 0.02 ],
               [1.043, 0.984, 1.036]])
    """
    xyz = blackbody_xyz(temperature)
    return array_namespace(xyz).tensordot(xyz, like(XYZ_TO_REC709.T, xyz), axes=1)


def kang_xyz(temperature: ArrayLike) -> Array:
    """CIE 1931 XYZ of a black body with Y = 1, approximated by cubic polynomials.

    From 1667 K to 25000 K, the errors of x and y are below 6e-4. MaterialX's GLSL also uses the
    polynomials below 1667 K, where the polynomials are wrong: the color is paler at 800 K than at
    1667 K. [Kang2002].
    """
    (kelvin,) = checked_numbers(temperature=temperature)
    warm, hot = (np.polyval(fit, 1000.0 / kelvin) for fit in KANG_X)
    x = np.where(kelvin < 4000.0, warm, hot)
    cold, warm, hot = (np.polyval(fit, x) for fit in KANG_Y)
    y = np.where(kelvin < 2222.0, cold, np.where(kelvin < 4000.0, warm, hot))
    return np.asarray(np.stack([x / y, np.ones_like(x), (1.0 - x - y) / y], axis=-1))
