# SPDX-License-Identifier: Apache-2.0
"""Nodes of pbrlib that compute inputs of lobes, by category."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

LARGEST_REFLECTIVITY = 0.99  # of artistic_ior in MaterialX: at 1 the index is infinite


def _alphas(roughness: Any, anisotropy: Any) -> Any:
    aspect = np.sqrt(1.0 - np.clip(anisotropy, 0.0, 0.98))
    square = np.clip(np.square(roughness), 1e-8, 1.0)
    x, y = np.broadcast_arrays(*np.atleast_1d(np.minimum(square / aspect, 1.0), square * aspect))
    return np.concatenate([x, y], axis=-1)


def _artistic(reflectivity: Any, edge_color: Any) -> dict[str, Any]:
    r = np.clip(reflectivity, 0.0, LARGEST_REFLECTIVITY)
    low, high = (1.0 - r) / (1.0 + r), (1.0 + np.sqrt(r)) / (1.0 - np.sqrt(r))
    n = high + (low - high) * edge_color
    square = (np.square(n + 1.0) * r - np.square(n - 1.0)) / (1.0 - r)
    return {"ior": n, "extinction": np.sqrt(np.maximum(square, 0.0))}


# Category -> its inputs, and the function of them; of several outputs, a value for each name.
UTILITIES: dict[str, tuple[tuple[str, ...], Callable[..., Any]]] = {
    "roughness_anisotropy": (("roughness", "anisotropy"), _alphas),
    "roughness_dual": (("roughness",), lambda roughness: np.square(roughness)),
    "artistic_ior": (("reflectivity", "edge_color"), _artistic),
}
