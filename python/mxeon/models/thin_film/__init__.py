# SPDX-License-Identifier: Apache-2.0
"""Airy reflectances of the microfacet nodes of pbrlib under a thin film, in linear RGB.

A film of thickness 0 is the node's own Fresnel curve. `Form` says what the specification leaves open.

- `mu` (...): Cosine between direction and microfacet normal, in [0, 1].
- `thickness` (...): Of the film, in nm, in [0, 1e9].
- `film_ior` (...): Index of the film, in [1, 1e50].
- `ior` (...): Index of the dielectric, in [0, 1e50]; of a conductor see its function.
- `form`: Choices that the specification leaves open.

Result (..., 3): linear RGB, in [0, 1]. Raises `ValueError`, which names the first bad element, if
an argument leaves its range or the shapes do not broadcast. [MaterialX2026], Thin-Film Iridescence
Model; [Belcour2017].
"""

from __future__ import annotations

import numpy as np

from mxeon.models.core.arguments import checked, checked_rgb
from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.core.evaluation import evaluate_material
from mxeon.models.core.namespaces import any_array, like
from mxeon.models.core.shapes import lead_shape
from mxeon.models.thin_film.curve import CIE_RGB, MATERIALX, PRINTED, TEXT, Form, film_curve

__all__ = [
    "CIE_RGB",
    "MATERIALX",
    "PRINTED",
    "TEXT",
    "Form",
    "film_conductor",
    "film_dielectric",
    "film_schlick",
]

PORTS = {"thickness": "thinfilm_thickness", "film_ior": "thinfilm_ior"}  # of the nodes


@any_array
def film_dielectric(
    mu: ArrayLike,
    thickness: ArrayLike,
    film_ior: ArrayLike,
    ior: ArrayLike,
    form: Form = TEXT,
) -> Array:
    """Reflectance of a dielectric under a thin film for unpolarized light.

    Below index 1 the specification's phases of the first interface do not hold: the s polarization has
    its phase of pi from a film that is denser than the vacuum. Accuracy: the infinite sum is within
    1e-6, for cosines above 0.01.

        >>> film_dielectric(1.0, [0.0, 100.0, 300.0], 1.38, 1.5).round(4)
        array([[0.04  , 0.04  , 0.04  ],
               [0.015 , 0.014 , 0.0178],
               [0.0209, 0.0142, 0.0348]])
    """
    return _reflectance(
        "dielectric_bsdf",
        form,
        {},
        {"mu": mu, "ior": ior, "thickness": thickness, "film_ior": film_ior},
    )


@any_array
def film_conductor(
    mu: ArrayLike,
    thickness: ArrayLike,
    film_ior: ArrayLike,
    ior: ArrayLike,
    extinction: ArrayLike,
    form: Form = TEXT,
) -> Array:
    """Reflectance of a conductor under a thin film for unpolarized light.

    - `ior`, `extinction` (..., 3): Complex index of refraction per channel, in [0, 1e50].

    Accuracy: as that of `film_dielectric`; at grazing angles, where all orders count, within 1e-4.

        >>> gold = [0.183, 0.421, 1.373], [3.424, 2.346, 1.770]
        >>> film_conductor(1.0, [0.0, 200.0], 1.5, *gold).round(4)
        array([[0.9442, 0.7762, 0.3733],
               [0.9554, 0.7184, 0.1298]])
    """
    colors = {"ior": ior, "extinction": extinction}
    numbers = {"mu": mu, "thickness": thickness, "film_ior": film_ior}
    return _reflectance("conductor_bsdf", form, colors, numbers)


@any_array
def film_schlick(
    mu: ArrayLike,
    thickness: ArrayLike,
    film_ior: ArrayLike,
    color0: ArrayLike,
    color82: ArrayLike,
    color90: ArrayLike,
    exponent: ArrayLike,
    form: Form = TEXT,
) -> Array:
    """Reflectance of a generalized Schlick curve under a thin film.

    - `color0`, `color82`, `color90` (..., C): Reflectance r0 along the normal, multiplier at
      acos(1/7), and reflectance r90 at grazing, per channel, in [0, 1]; a number is one channel.
    - `exponent` (...): q, in [0, 1e50].

    Result (..., 3): linear RGB, in [0, 1] where the thickness is above 0. The curve stands for the
    film's lower interface at the refracted angle, so that the value jumps where the thickness
    leaves 0. A curve below 0 counts as 0, for it has no amplitude.

        >>> film_schlick(0.5, [0.0, 300.0], 1.5, [1.0, 0.8, 0.1], np.ones(3), np.ones(3), 5.0).round(4)
        array([[1.    , 0.8062, 0.1281],
               [1.    , 0.7633, 0.1166]])
    """
    colors = {"color0": color0, "color82": color82, "color90": color90}
    numbers = {"mu": mu, "exponent": exponent, "thickness": thickness, "film_ior": film_ior}
    return _reflectance("generalized_schlick_bsdf", form, colors, numbers)


def _reflectance(
    category: str, form: Form, colors: dict[str, ArrayLike], numbers: dict[str, ArrayLike]
) -> Array:
    """Curve of a node under a film over arguments that broadcast."""
    if not isinstance(form, Form):
        raise ValueError(f"form must be a Form; got {form!r}")
    curve = film_curve(category, form)

    def at(mu: Array, **material: Array) -> Array:
        if category == "dielectric_bsdf":
            material["tint"] = like(np.ones(1), mu)  # which the curve leaves alone
        return curve.at(mu, **material)

    vectors = {name: checked_rgb(name, value) for name, value in colors.items()}
    values = {name: checked(name, value) for name, value in numbers.items()}
    lead_shape(vectors, values)
    ports = {PORTS.get(name, name): value for name, value in values.items()}
    return evaluate_material(at, vectors, ports, 3)
