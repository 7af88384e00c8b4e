# SPDX-License-Identifier: Apache-2.0
"""Types for tables of pbrlib's nodes: functions, and inputs with defaults, ranges and units.

Inputs are a mapping from port names, in MaterialX's order, to values of shape (N,) or (N,
components). Every node has an input `weight`, which the caller applies.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from typing import Generic, TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from mxeon.models.core.arguments import RANGES
from mxeon.models.core.arrays import Array
from mxeon.models.hair import DEFAULTS as HAIR
from mxeon.models.microfacet import CATEGORIES

Value = float | tuple[float, ...]
WHITE, GRAY, BLACK = (1.0,) * 3, (0.18,) * 3, (0.0,) * 3
FACETS: dict[str, Value] = {
    "roughness": (0.05, 0.05),
    "thinfilm_thickness": 0.0,
    "thinfilm_ior": 1.5,
}
# Defaults of each node's inputs in the order of MaterialX's definition. The modes, the weight, the
# normal and the tangent are left out. A test compares the defaults with MaterialX's definitions.
DEFAULTS: dict[str, dict[str, Value]] = {
    "oren_nayar_diffuse_bsdf": {"color": GRAY, "roughness": 0.0},
    "burley_diffuse_bsdf": {"color": GRAY, "roughness": 0.0},
    "translucent_bsdf": {"color": WHITE},
    "subsurface_bsdf": {"color": GRAY, "radius": WHITE},
    "sheen_bsdf": {"color": WHITE, "roughness": 0.3},
    **{name: {**colors, **numbers, **FACETS} for name, (_, colors, numbers) in CATEGORIES.items()},
    "chiang_hair_bsdf": HAIR,
}
UNITS = {
    "sigma": "rad",
    "thinfilm_thickness": "nm",
    "absorption_coefficient": "1/radius",
    **dict.fromkeys(("roughness_R", "roughness_TT", "roughness_TRT"), "rad^2, rad"),
}


@dataclass(frozen=True, repr=False)
class Parameter:
    """An input of a model.

    - `name`: MaterialX's name.
    - `default`: MaterialX's default, with three numbers for a color and two numbers for a pair.
    - `quantity`: Name of the input in the functions of `mxeon.models`, accepted in addition to
      `name`.
    """

    name: str
    default: Value
    quantity: str

    @property
    def channels(self) -> int:
        """Number of components: 3 for a color, 2 for a pair, 0 for a number."""
        return len(self.default) if isinstance(self.default, tuple) else 0

    @property
    def interval(self) -> tuple[float, float]:
        """Smallest and largest valid value."""
        low, high, _ = RANGES[self.quantity]
        return low, high

    def __repr__(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.name} = {self.default}, in {RANGES[self.quantity][2]}{unit}"

    @property
    def unit(self) -> str:
        """Unit of the input, or "1" for a dimensionless input."""
        return UNITS.get(self.quantity, "1")


def parameter(category: str, name: str, quantity: str = "") -> Parameter:
    return Parameter(name, DEFAULTS[category][name], quantity or name)


Inputs: TypeAlias = Mapping[str, Array]
Scattering: TypeAlias = Callable[[Array, Array, Inputs], Array]  # (wo, wi, inputs)
Function = TypeVar("Function", covariant=True)  # type of a node's function


@dataclass(frozen=True)
class Variant(Generic[Function]):
    """Alternative functions that a shader may use instead of a node's own functions."""

    title: str
    value: Function | None = None  # None for the node's own function
    albedo: Callable[[Array, Inputs], Array] | None = None
    permitted: bool = False  # whether the specification permits the variant
    anisotropic: bool = False  # whether only lobes with two different alphas reveal the variant
    above: bool = False  # whether `albedo` only determines how much the node darkens a lower layer


@dataclass(frozen=True)
class Node(Generic[Function]):
    """A node of [MaterialX2026], or a mode of a node."""

    name: str
    title: str
    category: str
    inputs: Collection[str]  # names or paths of the inputs that the functions read
    value: Function  # computes the node's values from `inputs`
    variants: tuple[Variant[Function], ...] = field(default=(), kw_only=True)


@dataclass(frozen=True)
class PbrNode(Node[Scattering]):
    """A mode of a BSDF node.

    - `value`: BSDF in 1/sr without the cosine, for weight 1.
    - `albedo`: Directional albedo E for weight 1, tints included, clamped to 1.
    - `integral`: Integral of `value`, if this integral differs from `albedo` for some inputs.
    - `fixed`: Inputs that select the mode.
    - `layerable`: Whether the fraction 1 - E of the light passes to the layer below, where E is the
      albedo at `white` inputs. An opaque node of weight 1 passes no light.
    - `taken`: The E of `layerable`, if E is not `albedo` at `white` inputs.
    - `transmits`: Whether the node scatters light from below the horizon instead of from above.
    - `mirror`: Inputs for which the node reflects all light, or empty if there are no such inputs.
    - `parameters`: Inputs of the mode, if names or quantities differ from the category's inputs.
    - `average`: Average albedo, if a closed form is known.
    """

    albedo: Callable[[Array, Inputs], Array]
    integral: Callable[[Array, Inputs], Array] | None = None
    fixed: Mapping[str, str] = field(default_factory=dict, hash=False)
    layerable: bool = False
    taken: Callable[[Array, Inputs], Array] | None = None
    transmits: bool = False
    fitted: bool = False  # whether shaders need a fit for the albedo
    reciprocal: bool = True  # whether the value stays the same if wo and wi are exchanged
    mirror: Mapping[str, ArrayLike] = field(default_factory=dict, hash=False)
    parameters: tuple[Parameter, ...] = ()
    average: Callable[[Inputs], Array] | None = None


# Inputs whose colors absorb light in a layer, by "Vertical-Layering Transmittance" in
# [MaterialX2026] of August 2026. In earlier specifications, the light that these colors remove
# reaches the base.
ABSORBING = ("color", "tint")
COLORED = "the color in the light that passes, as in texts before August 2026"


def white(inputs: Inputs) -> dict[str, Array]:
    """Copy of the inputs in which `color` and `tint`, the colors that absorb light, are white."""
    return {**inputs, **{name: np.ones((1, 3)) for name in ABSORBING if name in inputs}}


def column(inputs: Inputs, name: str) -> Array:
    """The input `name` as a matrix with a number or a color in each row, (N, 1 or 3)."""
    return np.reshape(inputs[name], (len(inputs[name]), -1))


Combined: TypeAlias = tuple[str, str, str, tuple[str, ...], Callable[[Inputs], Array]]


def linear_nodes(
    kind: str, one: str, several: str, total: str, paths: tuple[str, str, str, str]
) -> tuple[Combined, ...]:
    """Names, titles, categories, inputs and functions of nodes that mix, add or scale colors.

    - `paths`: Paths of four inputs: the first color, the second color, the first color's weight,
      and the first color's factor.
    """
    first, second, share, factor = paths

    def mixed(i: Inputs) -> Array:
        return np.asarray(column(i, share) * i[first] + (1.0 - column(i, share)) * i[second])

    def scaled(i: Inputs) -> Array:
        return np.asarray(i[first] * column(i, factor))

    return (
        (f"{kind}_mix", f"a mix of {several}", "mix", (first, second, share), mixed),
        (f"{kind}_add", total, "add", (first, second), lambda i: np.asarray(i[first] + i[second])),
        (f"{kind}_multiply_float", f"a scaled {kind}", "multiply", (first, factor), scaled),
        (
            f"{kind}_multiply_color3",
            f"{one} scaled by a color",
            "multiply",
            (first, factor),
            scaled,
        ),
    )
