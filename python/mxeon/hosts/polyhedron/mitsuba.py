# SPDX-License-Identifier: Apache-2.0
"""Mitsuba's own BSDFs, in its scalar variant."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from mxeon.hosts.polyhedron import PolyhedronHost


class Host(PolyhedronHost):
    """Mitsuba with its own BSDFs, which it evaluates for any pair of directions.

    Raises
    ------
    NotRun
        If the interpreter that is to have it is missing.
    """

    name = "mitsuba"
    samples = 64
    device = "CPU, scalar_rgb"
    # Without specular reflection nothing but the diffuse lobe is left of the principled BSDF.
    nodes: ClassVar[dict[str, dict[str, Any]]] = {
        "diffuse": {"type": "diffuse", "reflectance": "{color}"},
        "principled": {
            "type": "principled",
            "base_color": "{color}",
            "roughness": "{roughness}",
            "specular": 0.0,
        },
    }

    def pairs(
        self,
        title: str,
        wo: NDArray[Any],
        wi: NDArray[Any],
        color: NDArray[Any],
        roughness: NDArray[Any],
    ) -> NDArray[Any]:
        """f cos(theta_i) of a BSDF by its own function; see `RendererHost`."""
        path = self._folder / "pairs.npz"
        np.savez(path, wo=wo, wi=wi, color=color, roughness=roughness)
        material = self._material(title, "{color}", "{roughness}")
        return self._ask(material=material, pairs=str(path))
