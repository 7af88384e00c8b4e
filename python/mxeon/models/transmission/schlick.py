# SPDX-License-Identifier: Apache-2.0
"""Transmission of `generalized_schlick_bsdf`, in the readings that the specification leaves open.

Its BTDF needs an index of refraction, which the node does not have, and 1 - F of a curve that may leave
[0, 1]. A Reading says what takes their place.

- `reading`: A key of READINGS.
- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, tangent
  +x; wo has z >= 0, wi has z <= 0.
- `roughness` (..., 2) or (): alpha along tangent and bitangent, in [0, 1]; a number is isotropic.
- `color0`, `color82`, `color90` (..., C): Reflectance along the normal, multiplier at acos(1/7),
  and reflectance at grazing, per channel, in [0, 1]; a number is one channel.
- `exponent` (...): Exponent of the Schlick curve, in [0, 1e50].
- `inside`: Whether wo lies inside of the solid, where light is totally reflected beyond an angle.

Raises `ValueError`, which names the first bad element or lists the readings, if an argument leaves
its range, the shapes do not broadcast or the reading is unknown.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from mxeon.models.core.arguments import (
    checked,
    checked_choice,
    checked_color,
    checked_directions,
    checked_roughness,
    checked_switch,
    checked_transmitted,
)
from mxeon.models.core.arrays import Array, ArrayLike, Numbers
from mxeon.models.core.edges import at_least_0, root, within
from mxeon.models.core.namespaces import any_array, array_namespace
from mxeon.models.core.shapes import channel_count, lead_shape
from mxeon.models.microfacet import fresnel_formulas as fresnel
from mxeon.models.transmission.btdf import evaluate_btdf
from mxeon.models.transmission.transmittance import evaluate_transmittance

LEAST, MOST = 0.01, 0.99  # reflectances along the normal that MaterialX's inversion takes


@dataclass(frozen=True)
class Reading:
    """What transmission takes of the node's inputs.

    - `index`: "average": one index, of the mean of color0 over the channels; "channel": one of
      each.
    """

    title: str
    curve: Callable[..., Array]  # F of transmission, at the angle outside of the solid
    index: str = "average"
    least: float = LEAST  # least reflectance of which an index is taken

    def at(self, cosine: Array, ior: Array, **inputs: Array) -> Array:
        """F for light at this cosine, from inside if the index is below 1: 1 at total reflection."""
        xp = array_namespace(cosine, ior)
        squared = 1.0 - (1.0 - cosine) * (1.0 + cosine) / xp.maximum(ior, 1e-50) ** 2
        inside = ior < 1.0
        F = self.curve(xp.where(inside, root(at_least_0(squared)), cosine), **inputs)
        return xp.where(inside & (squared <= 0.0), 1.0, F)


def _whole(cosine: Array, color0: Array, color82: Array, color90: Array, exponent: Array) -> Array:
    """F of the node, kept in [0, 1]."""
    return within(fresnel.schlick(cosine, color0, color82, color90, exponent))


def _no_dip(cosine: Array, color0: Array, color82: Array, color90: Array, exponent: Array) -> Array:
    """F without the dip at 82 degrees."""
    return _whole(cosine, color0, 0.0 * color82 + 1.0, color90, exponent)


def _darker(cosine: Array, color0: Array, color82: Array, color90: Array, exponent: Array) -> Array:
    """F with color82 as a factor of color90."""
    return _whole(cosine, color0, 0.0 * color82 + 1.0, color82 * color90, exponent)


def _of_index(cosine: Array, color0: Array, **others: Array) -> Array:
    """F of a dielectric of the index, which no input but color0 enters."""
    return fresnel.dielectric(cosine, index_of(_mean(color0, 0), LEAST))


READINGS = {
    "text": Reading("1 - F of all inputs, kept in [0, 1]", _whole),
    "unclamped": Reading("1 - F of all inputs, as it is", fresnel.schlick),
    "channel": Reading("1 - F of all inputs; an index for each channel", _whole, "channel"),
    "closure": Reading("1 - F without color82", _no_dip, least=0.0),
    "grazing": Reading("1 - F with color82 color90 at grazing", _darker, "channel"),
    "dielectric": Reading("1 - F of the index of color0 alone", _of_index),
}


@any_array
def schlick_ior(color0: ArrayLike, reading: str = "text") -> Array:
    """Index of refraction of a reflectance along the normal.

        ior = (1 + sqrt(r)) / (1 - sqrt(r)),  r in [0.01, 0.99]

    - `color0` (..., C): Reflectance along the normal, in [0, 1]; a number is one channel.

    Result (..., C) or (..., 1): One index for each channel, or one for all. The bounds are those of
    stock MaterialX: the index lies in [1.22, 399], so that a reflectance of 0 still refracts.
    [MaterialX2026], Generalized Schlick Equations, Thin-Film Iridescence.

        >>> schlick_ior([0.04, 0.25]).round(4), schlick_ior([0.04, 0.25], "channel").round(4)
        (array([2.2299]), array([1.5, 3. ]))
    """
    how = _reading(reading)
    r = checked_color("color0", color0)
    return index_of(_mean(r, -1) if how.index == "average" else r, how.least)


def index_of(reflectance: Array, least: float) -> Array:
    """Index of a reflectance along the normal, kept in [least, 0.99]."""
    amplitude = root(within(reflectance, least, MOST))
    return (1.0 + amplitude) / (1.0 - amplitude)


def _mean(color: Array, axis: int) -> Array:
    """Mean over the channels, which are one then."""
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
    radiance: bool = True,
) -> Array:
    """Transmission of `generalized_schlick_bsdf`, scatter modes T and RT.

    - `radiance`: Whether the value is of radiance from wi to wo, as the specification has it; else
      it is times ior^2, the form that is integrated over wi to the transmitted share of the light
      from wo.

    Result (..., C): BTDF in 1/sr, unbounded at grazing and as alpha vanishes. F is taken at the
    angle on the outside, whichever side the light comes from, as renderers take it. Then the value
    over the squared index is reciprocal. The letter of the specification, the angle of the incident
    light, would have another F for each direction of one path. [MaterialX2026],
    Microfacet BTDF; generalized_schlick_bsdf.

        >>> pair = [0.6, 0.0, 0.8], [-0.4, 0.0, -0.916515]
        >>> generalized_schlick_btdf(*pair, 0.04, 1.0, 1.0, [0.3, 0.3], 5.0).round(4)
        array([10.1048])
    """
    how = _reading(reading)
    checked_switch("inside", inside)
    parts = _parts(how, color0, color82, color90)
    numbers = {"exponent": checked("exponent", exponent)}
    directions = {"wo": checked_directions("wo", wo), "wi": checked_transmitted("wi", wi)}
    pairs = {"roughness": checked_roughness(roughness)}
    lead_shape(directions | pairs | parts[0][1], numbers)
    channels = [
        evaluate_btdf(
            how.at,
            wo,
            wi,
            roughness,
            1.0 / index if inside else index,
            colors,
            numbers,
            radiance=radiance,
        )
        for index, colors in parts
    ]
    return array_namespace(*channels).concat(channels, axis=-1)


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

    - `shadow`: Whether light is lost to other facets on the far side, as in the BTDF; without, it
      is the mean of 1 - F over the normals that wo sees.

    Result (..., C). Accuracy: absolute error below 2e-4 from outside for exponents >= 1, and below
    1e-8 from inside. [MaterialX2026], Directional Albedo and Energy Conservation.

        >>> wo, alpha = [0.6, 0.0, 0.8], [0.3, 0.3]
        >>> generalized_schlick_transmittance_dir(wo, [0.04, 0.25], 1.0, 1.0, alpha, 5.0).round(3)
        array([0.945, 0.738])
    """
    how = _reading(reading)
    checked_switch("inside", inside)
    parts = _parts(how, color0, color82, color90)
    numbers = {"exponent": checked("exponent", exponent)}
    directions = {"wo": checked_directions("wo", wo)}
    pairs = {"roughness": checked_roughness(roughness)}
    lead_shape(directions | pairs | parts[0][1], numbers)
    channels = [
        evaluate_transmittance(
            how.at,
            wo,
            roughness,
            colors,
            numbers | {"ior": 1.0 / index if inside else index},
            shadow,
        )
        for index, colors in parts
    ]
    return array_namespace(*channels).concat(channels, axis=-1)


def _parts(
    how: Reading, color0: ArrayLike, color82: ArrayLike, color90: ArrayLike
) -> list[tuple[Array, dict[str, Numbers]]]:
    """Index and colors of each evaluation: of all channels, or of one after another."""
    given = {"color0": color0, "color82": color82, "color90": color90}
    colors = {name: checked_color(name, value) for name, value in given.items()}
    count = channel_count(colors)
    if how.index == "average":
        return [(index_of(_mean(colors["color0"], -1)[..., 0], how.least), colors)]
    xp = array_namespace(*colors.values())
    spread = {
        name: xp.broadcast_to(value, (*value.shape[:-1], count)) for name, value in colors.items()
    }
    return [
        (
            index_of(spread["color0"][..., channel], how.least),
            {name: value[..., channel : channel + 1] for name, value in spread.items()},
        )
        for channel in range(count)
    ]


def _reading(name: str) -> Reading:
    """A row of READINGS."""
    return READINGS[checked_choice("reading", name, READINGS)]
