# SPDX-License-Identifier: Apache-2.0
"""A model as one object: value, albedos, samples, density, inputs, and a plot."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np

from mxeon.models import lobe_plot
from mxeon.models.core.arguments import ROUNDING, checked_switch
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.namespaces import array_namespace
from mxeon.models.nodes.frames import ALONG, UP, into_frame, out_of_frame
from mxeon.models.nodes.inputs import Rows, bound_inputs, rows, views
from mxeon.models.nodes.node import Inputs
from mxeon.models.nodes.parameters import WEIGHT, Parameter

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Functions of models, and why a model may lack them.
LACKS = {
    **dict.fromkeys(
        ("bsdf", "albedo_dir", "plot", "edf", "exitance", "transmittance", "phase"), ""
    ),
    **dict.fromkeys(("sample", "pdf"), ": no density of refracted light is implemented"),
    "brdf": ": light passes through it, so call bsdf",
    "albedo_avg": ": no closed form is known",
}
SIDES = {"front": 1.0, "back": -1.0}


@dataclass(frozen=True)
class ModelSampler:
    """Samples (wi, pdf) of a model and their density, and the side on which it draws.

    The side is 1 above the horizon, -1 below it, and None for any wi.
    """

    sample: Callable[[Array, Array, Inputs], tuple[Array, Array]]
    pdf: Callable[[Array, Array, Inputs], Array]
    side: float | None = 1.0


@dataclass(frozen=True, repr=False)
class NodeModel(ABC):
    """What the models of all nodes have: a name, inputs, and a list of functions."""

    name: str
    title: str  # the name in print
    node: str  # category of the node whose inputs it has
    parameters: tuple[Parameter, ...]  # its inputs: name, default, interval, unit

    @property
    @abstractmethod
    def functions(self) -> tuple[str, ...]:
        """Names of the functions that it has."""

    def __repr__(self) -> str:
        inputs = "".join(f"\n  {each!r}" for each in self.parameters)
        return f"{self.name}: {self.title}; {', '.join(self.functions)}{inputs}"

    def __dir__(self) -> Iterable[str]:
        """Names of what it has."""
        return [name for name in super().__dir__() if name in self.functions or name not in LACKS]

    if not TYPE_CHECKING:  # where it would make every name an attribute

        def __getattr__(self, name: str) -> None:
            """Say what it has instead of a function of other models."""
            if name in LACKS:
                raise AttributeError(
                    f"{self.name}, {self.title}, has no {name}; it has {', '.join(self.functions)}"
                )
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def _need(self, function: str) -> None:
        """Raise ValueError unless the model has this function: why not, and which it has."""
        if function not in self.functions:
            raise ValueError(
                f"{self.name} has no {function}{LACKS[function]}; it has {', '.join(self.functions)}"
            )

    def _bound(
        self,
        vectors: dict[str, ArrayLike],
        inputs: tuple[ArrayLike, ...],
        named: dict[str, ArrayLike],
        *others: Parameter,
    ) -> Rows:
        """Vectors and inputs of a call in rows; `others` are parameters that go by name alone."""
        own = {each.name: named.pop(each.name) for each in others}
        values = bound_inputs(self.parameters, inputs, named) | own
        return rows((*self.parameters, *others), tuple(vectors), **vectors, **values)


@dataclass(frozen=True, repr=False)
class ShadingModel(NodeModel):
    """A model by its name: functions of MaterialX's inputs.

    Each function takes the inputs after its directions, in the order of `parameters` or by name; one
    that is left out has MaterialX's default. Shapes broadcast, last axes of directions, colors and pairs
    apart. A color has its channels on the last axis, or is a number; where all colors are numbers,
    results have no channels. A pair, such as the `roughness` of microfacets, may be a number, which
    counts for both directions. Three numbers for a color are red, green and blue.

    What is in `by_name` has to be named in a call. `weight` scales values and albedos. With `normal`, and
    `tangent` or `curve_direction`, directions are those of a frame in which the node's normal is this
    unit vector, such as that of the scene; a tangent that is left out is +x. `retroreflective` mirrors
    the viewer.

    wo lies on or above the horizon, and wi anywhere: the value of a wi from which the model scatters no
    light is 0. `pdf` is the density of `sample` on the whole sphere, over which it integrates to 1. What
    `sample` draws below the horizon for a model that reflects is wasted: its value is 0, its density
    counts. Without a sampling of its own a model has that of the cosine, hair that of the sphere.

    Arrays of PyTorch and JAX give results of their library wherever the functions of the model take
    them; others refuse them by name.

    Each function raises ValueError if an input leaves its range, a shape fits nothing or two things, or
    the model does not have the function; TypeError if an input is unknown or is there twice.
    """

    value: Callable[[Array, Array, Inputs], Array]  # (N, C)
    albedo: Callable[[Array, Inputs], Array]  # (N, C)
    average: Callable[[Inputs], Array] | None = None
    sampler: ModelSampler | None = None
    lights: str = "front"  # from where it scatters light: "front", "back" or "all sides"
    by_name: tuple[str, ...] = ("weight", "normal")  # the other inputs of the node

    @property
    def functions(self) -> tuple[str, ...]:
        """Names of the functions that it has."""
        value = ("brdf", "bsdf") if self.lights == "front" else ("bsdf",)
        average = ("albedo_avg",) if self.average else ()
        samples = ("sample", "pdf") if self.sampler else ()
        return (*value, "albedo_dir", *average, *samples, "plot")

    def brdf(self, wo: ArrayLike, wi: ArrayLike, *inputs: ArrayLike, **named: ArrayLike) -> Array:
        """Value of a model that reflects, in 1/sr and without the cosine.

        - `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z,
          tangent +x. That to the viewer has z >= 0; the value is 0 where that to the light has z < 0.
        - `*inputs`, `**named`: Those of `parameters`.

        Result (..., C) or (...).
        """
        self._need("brdf")
        return self.bsdf(wo, wi, *inputs, **named)

    def bsdf(self, wo: ArrayLike, wi: ArrayLike, *inputs: ArrayLike, **named: ArrayLike) -> Array:
        """Value of any model, as `brdf`; 0 where wi is not where its light comes from."""
        call = self._rows({"wo": wo, "wi": wi}, inputs, named)
        return call.colors(_on_side(SIDES.get(self.lights), self.value, call))

    def albedo_dir(
        self, mu: ArrayLike, *inputs: ArrayLike, azimuth: ArrayLike = 0.0, **named: ArrayLike
    ) -> Array:
        """Directional albedo: the integral of value times cosine.

        - `mu` (...): Cosine of the viewer's polar angle, in [0, 1].
        - `azimuth` (...): The viewer's angle from the tangent, in radian; it counts where the model is
          anisotropic.
        """
        call = self._rows({"view": views(mu, azimuth)}, inputs, named)
        return call.colors(self.albedo(call.vectors[0], call.inputs))

    def albedo_avg(self, *inputs: ArrayLike, **named: ArrayLike) -> Array:
        """Average albedo, of light from all sides alike, where a closed form is known."""
        self._need("albedo_avg")
        assert self.average is not None
        call = self._rows({}, inputs, named)
        return call.colors(self.average(call.inputs))

    def sample(
        self, wo: ArrayLike, u: ArrayLike, *inputs: ArrayLike, **named: ArrayLike
    ) -> tuple[Array, Array]:
        """Directions drawn for the model, shape (..., 3), and their density in 1/sr, shape (...).

        `u`, shape (..., 2), are uniform random numbers in [0, 1). EON is sampled exactly for the mean of
        the channels.
        """
        self._need("sample")
        assert self.sampler is not None
        call = self._rows({"wo": wo, "u": u}, inputs, named)
        wi, pdf = self.sampler.sample(call.vectors[0], call.vectors[1], call.inputs)
        wi = call.shaped(wi, (3,))
        frame = _frame(named)
        return out_of_frame(wi, *frame) if frame else wi, call.shaped(pdf)

    def pdf(self, wo: ArrayLike, wi: ArrayLike, *inputs: ArrayLike, **named: ArrayLike) -> Array:
        """Density of `sample` at any wi, in 1/sr, shape (...); inputs as those of `brdf`."""
        self._need("pdf")
        assert self.sampler is not None
        call = self._rows({"wo": wo, "wi": wi}, inputs, named)
        return call.shaped(_on_side(self.sampler.side, self.sampler.pdf, call))

    def plot(self, path: str | None = None, **named: ArrayLike) -> Figure:
        """Polar lobe, albedo over the viewer's angle, and density of samples, of one material.

        It is written to `path`, a .png, .svg or .pdf. Raises ImportError if matplotlib is missing.
        """
        return lobe_plot.draw(self, named, path)

    def _rows(
        self,
        vectors: dict[str, ArrayLike],
        inputs: tuple[ArrayLike, ...],
        named: dict[str, ArrayLike],
    ) -> Rows:
        """Vectors and inputs of a call, in the frame of the node."""
        own = {name: named[name] for name in self.by_name if name in named}
        rest = {name: value for name, value in named.items() if name not in own or name == "weight"}
        if frame := _frame(own):
            if not {"wo", "wi"} & set(vectors):
                raise TypeError("normal and tangent turn directions; an albedo has none to turn")
            turned = {n: into_frame(v, *frame) for n, v in vectors.items() if n in ("wo", "wi")}
            vectors = vectors | turned
        if checked_switch("retroreflective", cast(bool, own.get("retroreflective", False))):
            back = tuple(-x for x in ALONG)  # half a turn about the normal
            vectors |= {n: out_of_frame(v, UP, back) for n, v in vectors.items() if n == "wo"}
        return self._bound(vectors, inputs, rest, *([WEIGHT] if "weight" in own else []))


def _frame(named: Mapping[str, ArrayLike]) -> tuple[ArrayLike, ArrayLike] | None:
    """Normal and tangent of a call, of which one was named."""
    if not {"normal", "tangent", "curve_direction"} & set(named):
        return None
    return named.get("normal", UP), named.get("tangent", named.get("curve_direction", ALONG))


def _on_side(
    side: float | None, function: Callable[[Array, Array, Inputs], Array], call: Rows
) -> Array:
    """Values for wi on a side of the horizon, 1 above and -1 below it; 0 for the others."""
    wo, wi = call.vectors
    if side is None:
        return function(wo, wi, call.inputs)
    xp, z = array_namespace(wi), side * wi[:, 2]
    other = z < -ROUNDING
    mirrored = xp.stack([wi[:, 0], wi[:, 1], side * xp.where(other, -z, z)], axis=-1)
    values = function(wo, mirrored, call.inputs)
    return xp.where(other[:, np.newaxis] if values.ndim > 1 else other, 0.0, values)
