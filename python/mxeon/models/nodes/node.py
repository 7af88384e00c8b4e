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
    """Another function that a shader may have in place of a node's own.

    Attributes
    ----------
    title : str
    value : callable or None
        As the node's; None where its values are the node's.
    albedo : callable (wo, inputs) -> ndarray, shape (N, 3), or None
    permitted : bool
        Whether the specification leaves it open.
    """

    title: str
    value: Function | None = None
    albedo: Callable[[Array, Inputs], Array] | None = None
    permitted: bool = False


@dataclass(frozen=True)
class Node(Generic[Function]):
    """A node, or a mode of one, by [MaterialX2026].

    Attributes
    ----------
    name, title : str
        One word, and the name in print.
    category : str
        Category of the node.
    inputs : tuple of str
        Names or paths of the inputs that the functions read.
    value : callable
        Its values from these inputs.
    variants : tuple of Variant
    """

    name: str
    title: str
    category: str
    inputs: tuple[str, ...]
    value: Function
    variants: tuple[Variant[Function], ...] = field(default=(), kw_only=True)


@dataclass(frozen=True)
class PbrNode(Node[Scattering]):
    """A mode of a BSDF node.

    Attributes
    ----------
    value : callable (wo, wi, inputs) -> ndarray, shape (N, 3)
        BSDF in 1/sr without the cosine, for weight 1.
    albedo : callable (wo, inputs) -> ndarray, shape (N, 3)
        Directional albedo E for weight 1, with all tints; 1 where its integral exceeds 1. Of
        anisotropic microfacets it is that at the geometric mean of both alphas, as G2 is.
    integral : callable (wo, inputs) -> ndarray, shape (N, 3), or None
        The integral of its values, where that is another number for some inputs.
    fixed : mapping of str to str
        Inputs that select the mode.
    layerable : bool
        Whether it lets 1 - E through to what lies below; another node lets nothing through.
    transmits : bool
        Whether it scatters light from below the horizon in place of light from above.
    fitted : bool
        Whether a shader needs a fit for its albedo.
    reciprocal : bool
        Whether exchanging the directions does not change the value.
    mirror : mapping of str to value
        Inputs with which it reflects all light; none if there are none.
    """

    albedo: Callable[[Array, Inputs], Array]
    integral: Callable[[Array, Inputs], Array] | None = None
    fixed: Mapping[str, str] = field(default_factory=dict, hash=False)
    layerable: bool = False
    transmits: bool = False
    fitted: bool = False
    reciprocal: bool = True
    mirror: Mapping[str, ArrayLike] = field(default_factory=dict, hash=False)
