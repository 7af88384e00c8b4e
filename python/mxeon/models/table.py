# SPDX-License-Identifier: Apache-2.0
"""Tables of rough diffuse models and of models with a known error. Each row is a model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from mxeon.models import diffuse
from mxeon.models.core.arguments import RANGES, checked, checked_choice, checked_colors
from mxeon.models.core.arrays import Array, ArrayLike, Numbers, any_array, cosine
from mxeon.models.core.quadrature import albedo_dir_quadrature
from mxeon.models.nodes.node import Inputs, PbrNode
from mxeon.models.nodes.node import parameter as node_parameter


@dataclass(frozen=True, kw_only=True)
class Model(PbrNode):
    """A rough diffuse node, with the closed forms of the model that the node uses.

    - `brdf`: `brdf(wo, wi, rho, *parameter)` in 1/sr, shape (..., C); Lambert has no parameter.
    - `albedo_dir`: `albedo_dir(mu, rho, *parameter)`, shape (..., C), if a closed form is known.
    - `albedo_avg`: `albedo_avg(rho, *parameter)`, shape (..., C), if a closed form is known.
    - `brdf_of`: Name of the model from which `brdf` is taken; `name` if `brdf` is not taken from
      another model.
    """

    brdf: Callable[..., Array]
    # "sigma" (in radians), "roughness", or None if the model has no parameter.
    parameter: str | None
    albedo_dir: Callable[..., Array] | None = None
    albedo_avg: Callable[..., Array] | None = None
    brdf_of: str

    @property
    def largest(self) -> float:
        """Largest value of the parameter; 1 if the model has no parameter."""
        return RANGES[self.parameter][1] if self.parameter else 1.0


def row(
    name: str,
    title: str,
    brdf: Callable[..., Array],
    parameter: str | None,
    albedo_dir: Callable[..., Array] | None = None,
    albedo_avg: Callable[..., Array] | None = None,
    brdf_of: str = "",
) -> Model:
    category = "burley_diffuse_bsdf" if name.startswith("burley") else "oren_nayar_diffuse_bsdf"
    parameters = [node_parameter(category, "color", "rho")]
    if parameter:
        parameters.append(node_parameter(category, "roughness", parameter))
    closed = albedo_dir or partial(albedo_dir_quadrature, brdf)

    def arguments(inputs: Inputs) -> list[Array]:
        return [inputs[each.name] for each in parameters]

    return Model(
        name,
        title,
        category,
        ("color", "roughness"),
        lambda wo, wi, inputs: brdf(wo, wi, *arguments(inputs)),
        lambda wo, inputs: closed(cosine(wo[:, 2]), *arguments(inputs)),
        parameters=tuple(parameters),
        average=albedo_avg and (lambda inputs: albedo_avg(*arguments(inputs))),
        brdf=brdf,
        parameter=parameter,
        albedo_dir=albedo_dir,
        albedo_avg=albedo_avg,
        brdf_of=brdf_of or name,
    )


def diffuse_model(name: str) -> Model:
    """The row with the given name in any of the tables.

    >>> diffuse_model("eon").parameter
    'roughness'
    """
    rows = {each.name: each for each in DIFFUSE_MODELS + KNOWN_DEFECTS + OTHERS + PARAMETRIZATIONS}
    return rows[checked_choice("model", name, rows, listing="mxeon.models.table.DIFFUSE_MODELS")]


@any_array
def _lambert_albedo_dir(mu: ArrayLike, rho: ArrayLike) -> Array:
    (color,), (cosine,) = checked_colors({"rho": rho}, mu=mu)
    return color + 0.0 * cosine


@any_array
def _lambert_albedo_avg(rho: ArrayLike) -> Array:
    return checked_colors({"rho": rho})[0][0]


def _tinted(white: Callable[..., Array]) -> Callable[..., Array]:
    """Add an argument rho, placed before the parameter, to an albedo function for rho = 1."""

    @any_array
    def tinted(*arguments: ArrayLike) -> Array:
        *mu, rho, parameter = arguments
        albedo: Array = white(*mu, parameter)[..., np.newaxis]
        return albedo * checked("rho", rho)

    return tinted


def _named(name: str, title: str, parameter: str, at_white: bool = False) -> Model:
    """The row of a model whose functions in `mxeon.models.diffuse` begin with `name`.

    - `at_white`: True if the albedo functions are for unit reflectance.
    """
    functions = (f"{name}_{each}" for each in ("brdf", "albedo_dir", "albedo_avg"))
    brdf, albedo_dir, albedo_avg = (getattr(diffuse, each, None) for each in functions)
    brdf = brdf or diffuse.checked_brdf(getattr(diffuse, f"{name}_brdf_mu"), parameter)
    if at_white:
        albedo_dir, albedo_avg = map(_tinted, filter(None, (albedo_dir, albedo_avg)))
    return row(name, title, brdf, parameter, albedo_dir, albedo_avg)


DIFFUSE_MODELS = (
    row("lambert", "Lambert", diffuse.lambert_brdf, None, _lambert_albedo_dir, _lambert_albedo_avg),
    _named("oren_nayar", "full Oren-Nayar", "sigma"),
    _named("qon", "qualitative Oren-Nayar (QON)", "sigma", at_white=True),
    _named("qon_footnote", "QON with the footnote's constant", "sigma"),
    _named("qon_fujii", "QON with Fujii's coefficients", "sigma"),
    _named("fon", "Fujii Oren-Nayar (FON)", "roughness", at_white=True),
    _named("eon", "energy-preserving Oren-Nayar (EON)", "roughness"),
    row("eon_approx", "EON with the paper's quartic", diffuse.eon_brdf_approx, "roughness"),
)

KNOWN_DEFECTS = (
    _named("eon_clamped", "EON with clamped dot(wo, wi)", "roughness"),
    _named("eon_rho_cubed", "EON with rho^3", "roughness"),
    _named("fon_white_lobe", "FON + white lobe", "roughness"),
    row(
        "qon_fitted",
        "QON with MaterialX's fit of its albedo",
        diffuse.qon_brdf,
        "sigma",
        diffuse.qon_fitted_albedo_dir,
        brdf_of="qon",
    ),
    _named("qon_tinted_twice", "QON tinted twice", "sigma"),
)

# Models of renderers' own nodes. Shaders generated by MaterialX never use these nodes.
OTHERS = (
    row(
        "eon_fitted",
        "EON with the paper's quartic",
        diffuse.eon_brdf_approx,
        "roughness",
        diffuse.eon_albedo_dir_approx,
        brdf_of="eon_approx",
    ),
    _named("eon_floor", "EON with a reflectance of at least 0.1", "roughness"),
    _named("burley", "Burley's diffuse model", "roughness"),
    row(
        "burley_lambert",
        "Burley's diffuse model with Lambert in surroundings",
        diffuse.burley_brdf,
        "roughness",
        lambda mu, rho, roughness: _lambert_albedo_dir(mu, rho),
        brdf_of="burley",
    ),
    _named(
        "burley_schlick",
        "Burley with Schlick's weight for the cosine of retro-reflection",
        "roughness",
    ),
)


def _reparametrized(
    name: str, title: str, base: str, parameter: Callable[[Numbers], Numbers]
) -> Model:
    """The model `base` with a roughness in [0, 1] as the parameter.

    - `parameter`: Function that converts this roughness to the parameter of `base`.
    """
    model = next(each for each in DIFFUSE_MODELS if each.name == base)

    def converted(function: Callable[..., Array]) -> Callable[..., Array]:
        return any_array(
            lambda *args: function(*args[:-1], parameter(checked("roughness", args[-1])))
        )

    albedo_dir = converted(model.albedo_dir) if model.albedo_dir else None
    return row(name, title, converted(model.brdf), "roughness", albedo_dir)


def _square(roughness: Numbers) -> Numbers:
    return roughness**2


# Models whose roughness, in [0, 1], renderers convert to sigma or r in different ways.
PARAMETRIZATIONS = (
    *(
        _reparametrized(f"{base}_{word}", f"{short} with {meaning}", base, parameter)
        for base, short in (("qon", "QON"), ("oren_nayar", "full Oren-Nayar"))
        for word, meaning, parameter in (
            ("half_pi", "sigma = roughness pi/2", lambda r: 0.5 * np.pi * r),
            ("slope", "sigma = roughness / sqrt(2)", lambda r: float(np.sqrt(0.5)) * r),
            ("squared", "sigma = roughness^2", _square),
        )
    ),
    _reparametrized("fon_squared", "FON with squared roughness", "fon", _square),
    _reparametrized("eon_squared", "EON with squared roughness", "eon", _square),
)
