# SPDX-License-Identifier: Apache-2.0
"""Objects that hold a model's functions and inputs.

Each call validates the inputs, and arranges values in rows, one row per pair of directions.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np

from mxeon.models.core import arguments, arrays
from mxeon.models.core.arrays import Array, ArrayLike, any_array, array_namespace, library
from mxeon.models.nodes.node import Inputs, Parameter, PbrNode

UP, ALONG = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)  # MaterialX's default normal and tangent


@dataclass(frozen=True)
class Rows:
    """Vectors and inputs of a call, one row per pair of directions.

    - `inputs`: Arrays (N,), (N, 2) or (N, C) by the name of the parameter. An array has one row if
      all pairs of directions share the value.
    """

    lead: tuple[int, ...]  # shape of the array of pairs of directions
    vectors: list[Array]  # directions or random numbers
    inputs: dict[str, Array]
    colored: bool  # whether at least one color was passed with an axis of channels

    def shaped(self, values: Array, last: tuple[int, ...] = ()) -> Array:
        """Values of all rows, (N, *last) or (1, *last), reshaped to (*lead, *last)."""
        xp, count = array_namespace(values), int(np.prod(self.lead))
        return xp.reshape(xp.broadcast_to(values, (count, *last)), (*self.lead, *last))[()]

    def colors(self, values: Array) -> Array:
        """Values of all rows, (N, C), reshaped to (*lead, C), or to lead if `colored` is False."""
        values = self.shaped(values, tuple(values.shape[-1:]))
        return values if self.colored or values.shape[-1] != 1 else values[..., 0]


@any_array
def rows(parameters: Sequence[Parameter], vectors: Collection[str], /, **values: ArrayLike) -> Rows:
    """`Rows` of the vectors and the parameters in `values`."""
    directions = {name: _floats(arguments.checked_real(name, values[name])) for name in vectors}
    for name, w in directions.items():
        count = 2 if name == "u" else 3
        if w.shape[-1:] != (count,):
            raise ValueError(f"{name} must have shape (..., {count}); got shape {tuple(w.shape)}")
    lead = arguments.lead_shape(directions, {})
    inputs, colored = dict[str, Array](), False
    for each in parameters:
        array = _floats(arguments.checked(each.name, values[each.name], each.quantity))
        if each.channels == 3:
            arguments.refuse_ambiguous(each.name, array, lead)
            colored = colored or array.ndim > 0
            array = array if array.ndim else array[np.newaxis]
        inputs[each.name] = arguments.spread_pair(each.name, array) if each.channels == 2 else array
    wide = {each.name: inputs[each.name] for each in parameters if each.channels}
    numbers = {name: array for name, array in inputs.items() if name not in wide}
    lead = arguments.lead_shape(directions | wide, numbers)
    flat = {name: _flattened(array, lead, name in wide) for name, array in inputs.items()}
    pairs = [_flattened(v, lead, True, whole=True) for v in directions.values()]
    return Rows(lead, pairs, flat, colored)


@any_array
def views(mu: ArrayLike, azimuth: ArrayLike) -> Array:
    """Directions from cosines of the polar angle and from azimuths, shape (..., 3)."""
    cosine, phi = _floats(arguments.checked("mu", mu)), _floats(arguments.checked("phi", azimuth))
    values = arrays.host_values(cosine)
    if values is not None and values.size and values.shape[-1:] == (3,):
        length = np.sum(np.square(values, dtype=np.float64), axis=-1)
        if np.all(np.abs(length - 1.0) <= arguments.UNIT_TOLERANCE):
            raise ValueError(
                f"mu must be cosines; got shape {values.shape} of unit length, a direction: pass its z, "
                "or mu[..., np.newaxis] for cosines"
            )
    xp = array_namespace(cosine, phi)
    sine = arrays.root((1.0 - cosine) * (1.0 + cosine))
    x, y = sine * xp.cos(phi), sine * xp.sin(phi)
    return xp.stack([x, y, xp.broadcast_to(cosine, x.shape)], axis=-1)


def _floats(value: ArrayLike) -> Array:
    """Numbers as a float64 array; an array of a library other than NumPy is returned unchanged."""
    return cast(Array, value) if library(value) else np.asarray(value, np.float64)


def _flattened(array: Array, lead: tuple[int, ...], last: bool, whole: bool = False) -> Array:
    """Array reshaped to N rows, or to one row if there is only one value.

    - `lead`: Shape of the array of pairs of directions; N is the number of pairs.
    - `last`: Whether the last axis holds components; rows are then arrays of components.
    - `whole`: Whether to return N equal rows if there is only one value.
    """
    xp = array_namespace(array)
    tail = tuple(array.shape[-1:]) if last else ()
    if not whole and int(np.prod(array.shape[:-1] if last else array.shape)) == 1:
        return xp.reshape(array, (1, *tail))
    return xp.reshape(xp.broadcast_to(array, (*lead, *tail)), (-1, *tail))


# End of the error message for a function that a model lacks, by name of the function.
LACKS = {
    **dict.fromkeys(("bsdf", "albedo_dir"), ""),
    **dict.fromkeys(("sample", "pdf"), ": no density of refracted light is implemented"),
    "brdf": ": light passes through it, so call bsdf",
    "albedo_avg": ": no closed form is known",
}
SIDES = {"front": 1.0, "back": -1.0}


@dataclass(frozen=True)
class ModelSampler:
    """Two functions: `sample` returns (wi, pdf), and `pdf` returns the density at wi.

    - `side`: 1 if all samples are above the horizon, -1 if all are below the horizon, else None.
    """

    sample: Callable[[Array, Array, Inputs], tuple[Array, Array]]
    pdf: Callable[[Array, Array, Inputs], Array]
    side: float | None = 1.0


@dataclass(frozen=True, repr=False)
class ShadingModel:
    """A model whose functions take MaterialX's inputs.

    The arguments of a function are directions, followed by the inputs in the order of `parameters`;
    inputs may also be passed by name. Omitted inputs have MaterialX's default. Shapes broadcast,
    except for the last axes of directions, colors and pairs. A color is a number or has channels on
    the last axis; three channels are red, green and blue. If all colors are numbers, results have
    no axis of channels, except with a film, where results are RGB. A pair, such as the `roughness`
    of microfacets, may be one number for tangent and bitangent.

    wo must be on or above the horizon. wi may have any z; the value is 0 if the model scatters no
    light from wi. `pdf` is the density of `sample` and integrates to 1 over the whole sphere. If a
    model only reflects, samples below the horizon are wasted, because their value is 0 although
    their density is positive. Models without their own sampler sample a cosine-weighted hemisphere;
    the hair model samples the sphere uniformly.

    The functions raise ValueError if an input leaves its range, if a shape is invalid or ambiguous,
    or if the model lacks the function. TypeError is raised if an input is unknown or passed twice.
    """

    row: PbrNode
    parameters: tuple[Parameter, ...]  # inputs: name, default, interval, unit
    sampler: ModelSampler | None = None
    lights: str = "front"  # side from which the model scatters light: "front", "back", "all sides"

    @property
    def name(self) -> str:
        return self.row.name

    @property
    def title(self) -> str:
        return self.row.title

    @property
    def node(self) -> str:
        """Category of the node that defines the model's inputs."""
        return self.row.category

    def __repr__(self) -> str:
        lines = [repr(each) for each in self.parameters]
        if self.node == "chiang_hair_bsdf":
            lines.append("albedo_dir integrates the value without a cosine")
        return "\n  ".join([f"{self.name}: {self.title}; {', '.join(self.functions)}", *lines])

    def __dir__(self) -> Iterable[str]:
        return [name for name in super().__dir__() if name in self.functions or name not in LACKS]

    def _need(self, function: str) -> None:
        if function not in self.functions:
            raise ValueError(
                f"{self.name} has no {function}{LACKS[function]}; it has {', '.join(self.functions)}"
            )

    def _bound(
        self,
        vectors: dict[str, ArrayLike],
        inputs: tuple[ArrayLike, ...],
        named: dict[str, ArrayLike],
    ) -> Rows:
        """Vectors and inputs of a call as `Rows`, with default values for omitted inputs."""
        names = [each.name for each in self.parameters]
        aliases = {each.quantity: each.name for each in self.parameters}
        if len(inputs) > len(names):
            raise TypeError(f"inputs are {', '.join(names)}; got {len(inputs)} inputs")
        values = dict(zip(names, inputs, strict=False))
        for word, value in named.items():
            name = aliases.get(word, word)
            if name not in names or name in values:
                twice = " twice" if name in names else ""
                raise TypeError(f"inputs are {', '.join(names)}; got {word!r}{twice}")
            values[name] = value
        values = {each.name: values.get(each.name, each.default) for each in self.parameters}
        return rows(self.parameters, tuple(vectors), **vectors, **values)

    @property
    def functions(self) -> tuple[str, ...]:
        """Names of the functions that the model supports."""
        value = ("brdf", "bsdf") if self.lights == "front" else ("bsdf",)
        average = ("albedo_avg",) if self.row.average else ()
        samples = ("sample", "pdf") if self.sampler else ()
        return (*value, "albedo_dir", *average, *samples)

    def brdf(self, wo: ArrayLike, wi: ArrayLike, *inputs: ArrayLike, **named: ArrayLike) -> Array:
        """Value of a model that only reflects, in 1/sr, without the cosine.

        - `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z,
          tangent +x. wo must have z >= 0; the value is 0 for wi with z < 0.
        - `*inputs`, `**named`: Values of the inputs in `parameters`, by position or by name.

        The shape of the result is (..., C), or (...) if all colors are numbers.
        """
        self._need("brdf")
        return self.bsdf(wo, wi, *inputs, **named)

    def bsdf(self, wo: ArrayLike, wi: ArrayLike, *inputs: ArrayLike, **named: ArrayLike) -> Array:
        """Value of any model, with the arguments of `brdf`.

        The value is 0 if the model scatters no light from wi.
        """
        call = self._bound({"wo": wo, "wi": wi}, inputs, named)
        return call.colors(_on_side(SIDES.get(self.lights), self.row.value, call))

    def albedo_dir(
        self, mu: ArrayLike, *inputs: ArrayLike, azimuth: ArrayLike = 0.0, **named: ArrayLike
    ) -> Array:
        """Directional albedo, the integral of value times cosine. For hair, the cosine is omitted.

        - `mu` (...): Cosine of the viewer's polar angle, in [0, 1].
        - `azimuth` (...): Angle between the viewer's azimuth and the tangent, in radians. Only
          anisotropic models use this angle.
        """
        call = self._bound({"view": views(mu, azimuth)}, inputs, named)
        integral = self.row.integral or self.row.albedo
        return call.colors(integral(call.vectors[0], call.inputs))

    def albedo_avg(self, *inputs: ArrayLike, **named: ArrayLike) -> Array:
        """Average albedo under uniform illumination, for models whose average has a closed form."""
        self._need("albedo_avg")
        assert self.row.average is not None
        call = self._bound({}, inputs, named)
        return call.colors(self.row.average(call.inputs))

    def sample(
        self, wo: ArrayLike, u: ArrayLike, *inputs: ArrayLike, **named: ArrayLike
    ) -> tuple[Array, Array]:
        """Directions (..., 3) and densities (...), in 1/sr, of samples of the model.

        `u`, shape (..., 2), holds uniform random numbers in [0, 1). For EON, the samples are exact
        for the mean of the color's channels. For a mirror, which has roughness 0, value and density
        are 0. The weight of a sample is then the albedo `albedo_dir(wo[2])` instead of 0 / 0.
        """
        self._need("sample")
        assert self.sampler is not None
        call = self._bound({"wo": wo, "u": u}, inputs, named)
        wi, pdf = self.sampler.sample(call.vectors[0], call.vectors[1], call.inputs)
        return call.shaped(wi, (3,)), call.shaped(pdf)

    def pdf(self, wo: ArrayLike, wi: ArrayLike, *inputs: ArrayLike, **named: ArrayLike) -> Array:
        """Density of `sample` at any wi, in 1/sr, shape (...), with the arguments of `brdf`."""
        self._need("pdf")
        assert self.sampler is not None
        call = self._bound({"wo": wo, "wi": wi}, inputs, named)
        return call.shaped(_on_side(self.sampler.side, self.sampler.pdf, call))


def _on_side(
    side: float | None, function: Callable[[Array, Array, Inputs], Array], call: Rows
) -> Array:
    """Values of a function, but 0 on one side of the horizon.

    - `side`: 1 if values below the horizon are 0, -1 if values above the horizon are 0, else None.
    """
    wo, wi = call.vectors
    if side is None:
        return function(wo, wi, call.inputs)
    xp, z = array_namespace(wi), side * wi[:, 2]
    outside = z < -arguments.ROUNDING
    # If no value has to be 0, a call without mirroring is up to three times as fast.
    if xp is arrays.NUMPY and not outside.any():
        return function(wo, wi, call.inputs)
    mirrored = xp.stack([wi[:, 0], wi[:, 1], side * xp.where(outside, -z, z)], axis=-1)
    values = function(wo, mirrored, call.inputs)
    return xp.where(outside[:, np.newaxis] if values.ndim > 1 else outside, 0.0, values)
