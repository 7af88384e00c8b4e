# SPDX-License-Identifier: Apache-2.0
"""Samplers of EON, and the moments of sample weights."""

from collections.abc import Callable
from typing import NamedTuple

from mxeon.models import sampling
from mxeon.models.core.arrays import Array
from mxeon.models.core.quadrature import hemisphere_nodes
from mxeon.models.diffuse import eon_brdf


class Sampler(NamedTuple):
    """A sampler and the probability density of the samples."""

    name: str  # prefix of function names, such as `ltc` in `ltc_sample`
    sample: Callable[..., tuple[Array, Array]]  # sample(wo, u, roughness) -> wi, pdf
    pdf: Callable[..., Array]  # pdf(wo, wi, roughness)
    title: str  # name in plots and tables


SAMPLERS = (
    Sampler(
        "uniform",
        lambda wo, u, roughness: sampling.uniform_sample(u),
        lambda wo, wi, roughness: sampling.uniform_pdf(wi),
        "uniform",
    ),
    Sampler(
        "cosine",
        lambda wo, u, roughness: sampling.cosine_sample(u),
        lambda wo, wi, roughness: sampling.cosine_pdf(wi),
        "cosine",
    ),
    Sampler("ltc", sampling.ltc_sample, sampling.ltc_pdf, "LTC"),
    Sampler("cltc", sampling.cltc_sample, sampling.cltc_pdf, "CLTC"),
    Sampler("eon_cltc", sampling.eon_cltc_sample, sampling.eon_cltc_pdf, "CLTC + uniform"),
    Sampler("eon", sampling.eon_sample, sampling.eon_pdf, "exact"),
)
BY_NAME = {sampler.name: sampler for sampler in SAMPLERS}
# EON's exact sampler has a positive variance, because fits change the density by up to 1.3e-5.
EXACT_VARIANCE = 1.7e-10


def moments(
    name: str,
    mu: float,
    roughness: float,
    light: Callable[[Array], Array] | None = None,
    nodes: int = 96,
) -> tuple[float, float, float]:
    """Mean, variance and maximum of a sample's weight times a radiance, by quadrature.

    The weight is f cos(theta_i) / p for EON at unit reflectance, and 0 below the horizon.
    """
    wo, wi, projected = hemisphere_nodes(mu, nodes)
    value, pdf = eon_brdf(wo, wi, 1.0, roughness)[:, 0], BY_NAME[name].pdf(wo, wi, roughness)
    value = value if light is None else value * light(wi)
    sampled, cosine = pdf > 0.0, wi[:, 2]
    weight = value[sampled] * cosine[sampled] / pdf[sampled]
    probability = projected[sampled] * pdf[sampled] / cosine[sampled]
    mean = float(weight @ probability)
    return mean, float((weight - mean) ** 2 @ probability), float(weight.max())
