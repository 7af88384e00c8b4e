# SPDX-License-Identifier: Apache-2.0
"""The BSDF nodes of pbrlib, one row for each mode, as functions of the values of their inputs.

Inputs come as a mapping by the names of the node's ports, each (N,) or (N, components). The node's
`weight` is left to the caller, since every node has it.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from mxeon.models.arrays import Array
from mxeon.models.burley import burley_albedo_dir, burley_brdf
from mxeon.models.sheen import (
    conty_kulla_albedo_dir,
    conty_kulla_brdf,
    zeltner_albedo_dir,
    zeltner_brdf,
)
from mxeon.models.translucent import translucent_btdf

Inputs: TypeAlias = Mapping[str, Array]


@dataclass(frozen=True)
class Variant:
    """Another function that a shader may have in place of a node's own.

    Attributes
    ----------
    title : str
    value : callable (wo, wi, inputs) -> ndarray, shape (N, 3), or None
        As in PbrNode; None where its values are the node's.
    albedo : callable (wo, inputs) -> ndarray, shape (N, 3), or None
    """

    title: str
    value: Callable[[Array, Array, Inputs], Array] | None = None
    albedo: Callable[[Array, Inputs], Array] | None = None


@dataclass(frozen=True)
class PbrNode:
    """A mode of a BSDF node, by [MaterialXPBR2026].

    Attributes
    ----------
    name, title : str
        One word, and the name in print.
    category : str
        Category of the node.
    inputs : tuple of str
        Names of the inputs that the functions read.
    value : callable (wo, wi, inputs) -> ndarray, shape (N, 3)
        BSDF in 1/sr without the cosine, for weight 1.
    albedo : callable (wo, inputs) -> ndarray, shape (N, 3)
        Directional albedo E for weight 1, with all tints; 1 where its integral exceeds 1.
    integral : callable (wo, inputs) -> ndarray, shape (N, 3), or None
        The integral of its values, where that exceeds 1 for some inputs; None for the albedo.
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
    variants : tuple of Variant
    """

    name: str
    title: str
    category: str
    inputs: tuple[str, ...]
    value: Callable[[Array, Array, Inputs], Array]
    albedo: Callable[[Array, Inputs], Array]
    integral: Callable[[Array, Inputs], Array] | None = None
    fixed: Mapping[str, str] = field(default_factory=dict)
    layerable: bool = False
    transmits: bool = False
    fitted: bool = False
    reciprocal: bool = True
    variants: tuple[Variant, ...] = ()


def node(name: str) -> PbrNode:
    """The row of NODES with this name.

    Raises
    ------
    ValueError
        If there is none; lists the names.

    Examples
    --------
    >>> node("zeltner").category
    'sheen_bsdf'
    """
    rows = {row.name: row for row in NODES}
    if name not in rows:
        raise ValueError(f"node must be one of {', '.join(rows)}; got {name!r}")
    return rows[name]


def _bounded(albedo: Callable[[Array, Array], Array]) -> Callable[[Array, Array], Array]:
    """An albedo that counts as 1 where it exceeds 1; the text is silent on it."""
    return lambda mu, roughness: np.minimum(albedo(mu, roughness), 1.0)


def _tinted(
    albedo: Callable[[Array, Array], Array],
) -> Callable[[Array, Inputs], Array]:
    """Albedo of a lobe of one roughness times its color."""

    def tinted(wo: Array, inputs: Inputs) -> Array:
        white = albedo(np.minimum(wo[:, 2], 1.0), inputs["roughness"])
        return np.asarray(white[..., np.newaxis] * inputs["color"])

    return tinted


def _untinted(
    albedo: Callable[[Array, Array], Array],
) -> Callable[[Array, Inputs], Array]:
    """Albedo of a lobe of one roughness without its color."""

    def untinted(wo: Array, inputs: Inputs) -> Array:
        white = albedo(np.minimum(wo[:, 2], 1.0), inputs["roughness"])
        return np.repeat(white[..., np.newaxis], 3, axis=-1)

    return untinted


def _sheen(
    brdf: Callable[..., Array],
) -> Callable[[Array, Array, Inputs], Array]:
    """Values of a lobe of a color and a roughness."""
    return lambda wo, wi, inputs: brdf(wo, wi, inputs["color"], inputs["roughness"])


def _fitted_conty_kulla(wo: Array, inputs: Inputs) -> Array:
    """MaterialX's rational fit of the Conty-Kulla albedo, without the color."""
    x, y = np.minimum(wo[:, 2], 1.0), inputs["roughness"]
    above = 13.673 - 68.78018 * x + 799.08825 * y - 905.00061 * x * y
    above += 60.28956 * x * x + 1086.96473 * y * y
    below = 1.0 + 61.57746 * x + 442.78211 * y + 2597.49308 * x * y
    below += 121.81241 * x * x + 3045.55075 * y * y
    return np.repeat(np.clip(above / below, 0.0, 1.0)[:, np.newaxis], 3, axis=-1)


def _fitted_burley(wo: Array, inputs: Inputs) -> Array:
    """MaterialX's fit of Burley's albedo."""
    x, r = np.minimum(wo[:, 2], 1.0), inputs["roughness"]
    smooth = 0.97619 - 0.488095 * (1.0 - x) ** 5
    rough = 1.55754 + (-2.02221 + (2.56283 - 1.06244 * x) * x) * x
    return np.asarray(((1.0 - r) * smooth + r * rough)[:, np.newaxis] * inputs["color"])


def _colored(albedo: Callable[[Array, Inputs], Array]) -> Callable[[Array, Inputs], Array]:
    """An albedo times the color."""
    return lambda wo, inputs: np.asarray(albedo(wo, inputs) * inputs["color"])


COLOR_ROUGHNESS = ("color", "roughness")
NODES = (
    PbrNode(
        "burley",
        "Burley diffuse",
        "burley_diffuse_bsdf",
        COLOR_ROUGHNESS,
        _sheen(burley_brdf),
        lambda wo, inputs: burley_albedo_dir(
            np.minimum(wo[:, 2], 1.0), inputs["color"], inputs["roughness"]
        ),
        variants=(Variant("MaterialX's fit of its albedo", albedo=_fitted_burley),),
    ),
    PbrNode(
        "translucent",
        "Lambert transmission",
        "translucent_bsdf",
        ("color",),
        lambda wo, wi, inputs: translucent_btdf(wo, wi, inputs["color"]),
        lambda wo, inputs: np.broadcast_to(inputs["color"], wo.shape),
        transmits=True,
    ),
    PbrNode(
        "conty_kulla",
        "Conty-Kulla sheen",
        "sheen_bsdf",
        COLOR_ROUGHNESS,
        _sheen(conty_kulla_brdf),
        _tinted(_bounded(conty_kulla_albedo_dir)),
        _tinted(conty_kulla_albedo_dir),
        fixed={"mode": "conty_kulla"},
        layerable=True,
        fitted=True,
        variants=(
            Variant(
                "its albedo without the color", albedo=_untinted(_bounded(conty_kulla_albedo_dir))
            ),
            Variant("MaterialX's fit of its albedo", albedo=_colored(_fitted_conty_kulla)),
            Variant("MaterialX's fit of its albedo without the color", albedo=_fitted_conty_kulla),
        ),
    ),
    PbrNode(
        "zeltner",
        "Zeltner sheen",
        "sheen_bsdf",
        COLOR_ROUGHNESS,
        _sheen(zeltner_brdf),
        _tinted(zeltner_albedo_dir),
        fixed={"mode": "zeltner"},
        layerable=True,
        reciprocal=False,
        variants=(Variant("its albedo without the color", albedo=_untinted(zeltner_albedo_dir)),),
    ),
)
