# SPDX-License-Identifier: Apache-2.0
"""Types of the rows of pbrlib's nodes, and of other functions that shaders have in their place.

Inputs come as a mapping by the names of the node's ports, each (N,) or (N, components). The node's
`weight` is left to the caller, since every node has it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Generic, TypeAlias, TypeVar

from numpy.typing import ArrayLike

from mxeon.models.core.arrays import Array

Inputs: TypeAlias = Mapping[str, Array]
Scattering: TypeAlias = Callable[[Array, Array, Inputs], Array]  # of wo, wi and inputs
Function = TypeVar("Function", covariant=True)  # of a node: what its value is computed from


@dataclass(frozen=True)
class Variant(Generic[Function]):
    """Another function that a shader may have instead of a node's own."""

    title: str
    value: Function | None = None  # as the node's; None where its values are the node's
    albedo: Callable[[Array, Inputs], Array] | None = None
    permitted: bool = False  # whether the specification leaves it open


@dataclass(frozen=True)
class Node(Generic[Function]):
    """A node, or a mode of one, by [MaterialX2026]."""

    name: str
    title: str
    category: str
    inputs: tuple[str, ...]  # names or paths of the inputs that the functions read
    value: Function  # its values from these inputs
    variants: tuple[Variant[Function], ...] = field(default=(), kw_only=True)


@dataclass(frozen=True)
class PbrNode(Node[Scattering]):
    """A mode of a BSDF node.

    - `value`: BSDF in 1/sr without the cosine, for weight 1.
    - `albedo`: Directional albedo E for weight 1, with all tints; 1 where its integral exceeds 1.
      Of anisotropic microfacets it is that at the geometric mean of both alphas, as G2 is.
    - `integral`: The integral of its values, where that is another number for some inputs.
    - `fixed`: Inputs that select the mode.
    - `layerable`: Whether it lets 1 - E through to what lies below; another node lets nothing
      through.
    - `transmits`: Whether it scatters light from below the horizon instead of light from above.
    - `mirror`: Inputs with which it reflects all light; none if there are none.
    """

    albedo: Callable[[Array, Inputs], Array]
    integral: Callable[[Array, Inputs], Array] | None = None
    fixed: Mapping[str, str] = field(default_factory=dict, hash=False)
    layerable: bool = False
    transmits: bool = False
    fitted: bool = False  # whether a shader needs a fit for its albedo
    reciprocal: bool = True  # whether exchanging the directions does not change the value
    mirror: Mapping[str, ArrayLike] = field(default_factory=dict, hash=False)
