# SPDX-License-Identifier: Apache-2.0
"""Wrong variants of the microfacet nodes that renderers implement, to recognize them by."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from mxeon.models import ggx_formulas as ggx
from mxeon.models.arguments import checked
from mxeon.models.arrays import Array, ArrayLike
from mxeon.models.microfacet_lobe import (
    CONDUCTOR,
    DIELECTRIC,
    SCHLICK,
    Curve,
    Lobe,
    Pair,
    evaluate_lobe,
    missing,
    uncompensated,
)

# Fresnel curve of each node, its inputs with channels, and those without.
NODES: dict[str, tuple[Curve, tuple[str, ...], tuple[str, ...]]] = {
    "dielectric_bsdf": (DIELECTRIC, ("tint",), ("ior",)),
    "conductor_bsdf": (CONDUCTOR, ("ior", "extinction"), ()),
    "generalized_schlick_bsdf": (SCHLICK, ("color0", "color82", "color90"), ("exponent",)),
}


@dataclass(frozen=True)
class MicrofacetDefect:
    """A known wrong variant of the three microfacet nodes.

    Attributes
    ----------
    name, title : str
        One word, and the name in print.
    lobe : Lobe
        Its terms.
    """

    name: str
    title: str
    lobe: Lobe

    def value(
        self,
        node: str,
        wo: ArrayLike,
        wi: ArrayLike,
        inputs: Mapping[str, ArrayLike],
        retroreflective: bool = False,
    ) -> Array:
        """Values of the variant of a node.

        Parameters
        ----------
        node : str
            A key of NODES.
        wo, wi : array_like, shape (..., 3)
            Directions that leave the surface, unit vectors to 1e-6, normal +z, tangent +x, z >= 0.
        inputs : mapping of str to array_like
            Inputs of the node by the names of its ports; others than the BRDF's are ignored.
        retroreflective : bool
            Whether light returns towards where it comes from.

        Returns
        -------
        ndarray, shape (..., C), float64
            1/sr.

        Raises
        ------
        ValueError
            If an argument leaves its range or the shapes do not broadcast.

        Examples
        --------
        >>> inputs = {"tint": 1.0, "ior": 1.5, "roughness": [0.3, 0.3]}
        >>> no_compensation = MICROFACET_DEFECTS[0]
        >>> w = [0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]
        >>> no_compensation.value("dielectric_bsdf", *w, inputs).round(6)
        array([0.059164])
        """
        curve, colors, numbers = NODES[node]
        return evaluate_lobe(
            self.lobe,
            curve,
            wo,
            wi,
            inputs["roughness"],
            {name: np.atleast_1d(checked(name, inputs[name])) for name in colors},
            {name: checked(name, inputs[name]) for name in numbers},
            retroreflective,
        )


def averaged_channels(albedo: Array) -> Array:
    """Albedo whose channels all have their mean, as the throughput of a colored node may have."""
    mean = np.mean(albedo, axis=-1, keepdims=True)
    return np.broadcast_to(mean, albedo.shape).copy()


def _compensated_by(cosine: Callable[[Pair], Array]) -> Callable[[Pair], Array]:
    """Compensation with F at a cosine in place of its average F_ss."""

    def factor(pair: Pair) -> Array:
        F = pair.curve.at(cosine(pair), **pair.material)
        return 1.0 + F * missing(pair.wo[2], pair.roughness)

    return factor


def _separable(pair: Pair) -> Array:
    """G1(wo) G1(wi) / (4 mu_o mu_i) at sqrt(alpha_x alpha_y)."""
    alpha = ggx.mean_alpha(pair.roughness)
    mu_o, mu_i = pair.wo[2], pair.wi[2]
    length_o, length_i = (mu + ggx.smith_lambda(mu, alpha) for mu in (mu_o, mu_i))
    return ggx.reciprocal(length_o * length_i)


def _anisotropic(pair: Pair) -> Array:
    """G2 / (4 mu_o mu_i) that belongs to the anisotropic distribution."""
    return ggx.visibility_anisotropic(pair.wo, pair.wi, pair.roughness)


MICROFACET_DEFECTS = (
    MicrofacetDefect("no_compensation", "no energy compensation", Lobe(uncompensated)),
    MicrofacetDefect(
        "compensation_half",
        "compensation with F at the half vector",
        Lobe(_compensated_by(lambda pair: pair.cosine)),
    ),
    MicrofacetDefect(
        "compensation_f0",
        "compensation with F along the normal",
        Lobe(_compensated_by(lambda pair: np.ones_like(pair.cosine))),
    ),
    MicrofacetDefect(
        "compensation_view",
        "compensation with F at the view direction",
        Lobe(_compensated_by(lambda pair: np.minimum(pair.wo[2], 1.0))),
    ),
    MicrofacetDefect(
        "smith_separable", "masking and shadowing uncorrelated", Lobe(visibility=_separable)
    ),
    MicrofacetDefect(
        "smith_anisotropic",
        "masking of the anisotropic distribution (Heitz 2014)",
        Lobe(visibility=_anisotropic),
    ),
    MicrofacetDefect("alpha_squared", "roughness squared once more", Lobe(alpha=np.square)),
    MicrofacetDefect("alpha_root", "square root of the roughness as alpha", Lobe(alpha=np.sqrt)),
    MicrofacetDefect("no_factor_4", "no factor 4 in the denominator", Lobe(scale=4.0)),
)
