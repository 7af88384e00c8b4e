# SPDX-License-Identifier: Apache-2.0
"""Values and albedos of the microfacet nodes of pbrlib under a thin film, by the names of their ports.

- `category`: Category of the node.
- `wo`, `wi` (..., 3): Directions that leave the surface, unit vectors to 1e-6, normal +z, tangent
  +x, z >= 0.
- `inputs`: The node's inputs by the names of its ports, colors with three channels;
  `thinfilm_thickness` in nm, 0 for no film, and `thinfilm_ior`, at least 1.
- `form`: Choices that the specification leaves open.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mxeon.models.core.arguments import checked, checked_choice, checked_directions, checked_rgb
from mxeon.models.core.arrays import Array, ArrayLike, Numbers
from mxeon.models.core.chebyshev import chebyshev_coefficients, chebyshev_nodes, chebyshev_sum
from mxeon.models.core.edges import within
from mxeon.models.core.namespaces import NUMPY, any_array, array_namespace, like
from mxeon.models.microfacet.albedo import lobe_albedo
from mxeon.models.microfacet.lobe import Curve, Lobe, evaluate_lobe
from mxeon.models.thin_film.curve import CURVES, TEXT, Form, film_curve, without_clamp

FILM = ("thinfilm_thickness", "thinfilm_ior")
# Inputs of each node with channels, and those without.
INPUTS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "dielectric_bsdf": (("tint",), ("ior",)),
    "conductor_bsdf": (("ior", "extinction"), ()),
    "generalized_schlick_bsdf": (("color0", "color82", "color90"), ("exponent",)),
}
DEGREE = 48  # of a film's curve in the cosine where an albedo is integrated


@any_array
def film_brdf(
    category: str,
    wo: ArrayLike,
    wi: ArrayLike,
    inputs: Mapping[str, ArrayLike],
    form: Form = TEXT,
    lobe: Lobe | None = None,
) -> Array:
    """BRDF of a microfacet node under a thin film, scatter mode R.

    - `lobe`: Other terms than the specification's.

    Result (..., 3): BRDF in 1/sr. [MaterialX2026], Thin-Film Iridescence; Energy Compensation.

        >>> inputs = {"tint": np.ones(3), "ior": 1.5, "roughness": [0.3, 0.3]}
        >>> soap = {"thinfilm_thickness": 400.0, "thinfilm_ior": 1.33}
        >>> w = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]
        >>> film_brdf("dielectric_bsdf", *w, inputs | soap).round(4)
        array([0.    , 0.0394, 0.0542])
    """
    vectors, numbers = _material(category, inputs, wo)
    curve = film_curve(category, form)
    return evaluate_lobe(lobe or Lobe(), curve, wo, wi, inputs["roughness"], vectors, numbers)


@any_array
def film_albedo_dir(
    category: str,
    wo: ArrayLike,
    inputs: Mapping[str, ArrayLike],
    form: Form = TEXT,
    compensate: bool = True,
) -> Array:
    """Directional albedo of `film_brdf`, by quadrature.

    - `compensate`: Whether the energy compensation enters.

    Result (..., 3). The film's curve is a polynomial of degree 48 in the cosine, within 1e-4 of the
    curve for films up to 2000 nm of index up to 2. [MaterialX2026], Directional Albedo and Energy
    Conservation.

        >>> inputs = {"tint": np.ones(3), "ior": 1.5, "roughness": [0.3, 0.3]}
        >>> soap = {"thinfilm_thickness": 400.0, "thinfilm_ior": 1.33}
        >>> film_albedo_dir("dielectric_bsdf", [0.6, 0.0, 0.8], inputs | soap).round(4)
        array([0.0046, 0.0263, 0.0328])
    """
    vectors, numbers = _material(category, inputs, wo)
    curve = Curve(PolynomialCurve(category, form), film_curve(category, form).average)
    return lobe_albedo(curve, wo, inputs["roughness"], vectors, numbers, compensate)


def _material(
    category: str, inputs: Mapping[str, ArrayLike], wo: ArrayLike
) -> tuple[dict[str, Numbers], dict[str, Numbers]]:
    """Checked inputs with channels and without."""
    colors, numbers = INPUTS[checked_choice("category", category, INPUTS)]
    if not isinstance(inputs, Mapping):
        raise ValueError(f"inputs must be a mapping of names to values; got {inputs!r}")
    if missing := {"roughness", *colors, *numbers, *FILM} - set(inputs):
        raise ValueError(f"inputs must have {', '.join(sorted(missing))}")
    wo = checked_directions("wo", wo)
    return (
        {name: _short(checked_rgb(name, inputs[name]), 1, wo) for name in colors},
        {name: _short(checked(name, inputs[name]), 0, wo) for name in (*numbers, *FILM)},
    )


def _short(values: Numbers, channels: int, wo: ArrayLike) -> Numbers:
    """Values as one row if there is one for each of many `wo`, and all are the same.

    F_ss of a film is an integral, which would be taken for each point of a picture.
    """
    if array_namespace(values) is not NUMPY:
        return values
    many = np.ndim(wo) == 2 and values.ndim == channels + 1 and len(values) == len(np.asarray(wo))
    return values[:1] if many and bool((values == values[:1]).all()) else values


class PolynomialCurve:
    """Curve of a film, by a polynomial in the cosine for each material."""

    def __init__(self, category: str, form: Form) -> None:
        self._bare = CURVES[category].at
        self._curve = film_curve(category, without_clamp(form)).at

    def __call__(self, mu: Array, **material: Array) -> Array:
        """F at cosines of shape (nodes, nodes, ...), shape (3, nodes, nodes, ...)."""
        bare = {k: v for k, v in material.items() if k not in FILM}
        film, xp = material["thinfilm_thickness"] > 0.0, array_namespace(mu)
        if xp is NUMPY and not film.any():
            return self._bare(mu, **bare)
        cosines = chebyshev_nodes(DEGREE + 1).reshape(-1, 1, *(1,) * (mu.ndim - 2))
        sampled = self._curve(like(cosines, mu), **material)
        matrix = like(chebyshev_coefficients(np.eye(DEGREE + 1)), mu)
        series = xp.tensordot(matrix, sampled, axes=((1,), (1,)))
        F = within(chebyshev_sum(series[:, :, np.newaxis, ...], mu))
        if xp is NUMPY and film.all():
            return F
        return xp.where(film, F, self._bare(mu, **bare))
