# SPDX-License-Identifier: Apache-2.0
"""Rows of pbrlib's VDF nodes below a surface, over one meter of the medium."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from mxeon.models.arrays import Array
from mxeon.models.pbrlib.node import Inputs
from mxeon.models.volume import transmittance

METER = 1.0  # a shader of a surface knows no thickness


@dataclass(frozen=True)
class Medium:
    """A VDF node, by its transmittance.

    Attributes
    ----------
    name, title : str
        One word, and the name in print.
    category : str
        Category of the node.
    inputs : tuple of str
        Names of the inputs that the transmittance depends on. The anisotropy enters the light that is
        scattered into a ray alone.
    value : callable (inputs) -> ndarray, shape (N, 3)
        Transmittance of METER.
    variants : tuple of (str, callable)
        Title and function of others that a shader may have in its place.
    """

    name: str
    title: str
    category: str
    inputs: tuple[str, ...]
    value: Callable[[Inputs], Array]
    variants: tuple[tuple[str, Callable[[Inputs], Array]], ...] = field(default=())


def _absorbed(inputs: Inputs) -> Array:
    return transmittance(inputs["absorption"], 0.0, METER)


def _extinguished(inputs: Inputs) -> Array:
    return transmittance(inputs["absorption"], inputs["scattering"], METER)


CLEAR = ("no medium at all", lambda inputs: np.ones_like(inputs["absorption"]))
MEDIA = (
    Medium("absorption", "Beer's law", "absorption_vdf", ("absorption",), _absorbed, (CLEAR,)),
    Medium(
        "anisotropic",
        "extinction",
        "anisotropic_vdf",
        ("absorption", "scattering"),
        _extinguished,
        (
            ("absorption alone", _absorbed),
            (
                "scattering alone",
                lambda inputs: transmittance(0.0, inputs["scattering"], METER),
            ),
            CLEAR,
        ),
    ),
)
