# SPDX-License-Identifier: Apache-2.0
"""Light that surfaces emit towards the viewer, by category of the node."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mxeon.conformance.reference.points import Points
from mxeon.models.fresnel import fresnel_schlick


def _uniform(points: Points, color: Any) -> Any:
    return color


def _schlick(points: Points, color0: Any, color90: Any, exponent: Any, base: Any) -> Any:
    """Emission below a layer that lets a Schlick curve of it through."""
    mu = np.minimum(points.facing[:, 0], 1.0)
    each = (len(mu), 3)
    f0, f82, f90 = (np.broadcast_to(color, each) for color in (color0, np.ones(3), color90))
    power = np.broadcast_to(np.ravel(exponent), len(mu))
    return base * fresnel_schlick(mu, f0, f82, f90, power)


# Category -> its inputs, and the function of the points and them.
EMISSIONS: dict[str, tuple[tuple[str, ...], Callable[..., Any]]] = {
    "uniform_edf": (("color",), _uniform),
    "generalized_schlick_edf": (("color0", "color90", "exponent", "base"), _schlick),
}
