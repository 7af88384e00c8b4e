# SPDX-License-Identifier: Apache-2.0
"""The samplers of EON that the paper compares, under one signature."""

from collections.abc import Callable
from dataclasses import dataclass

from mxeon.models import sampling
from mxeon.models.core.arrays import Array


@dataclass(frozen=True)
class Sampler:
    """A sampler and its density, under one signature.

    - `name`: The x of x_sample and x_pdf.
    - `sample`: sample(wo, u, roughness) -> wi, pdf.
    - `pdf`: pdf(wo, wi, roughness).
    - `title`: For plots and tables.
    """

    name: str
    sample: Callable[..., tuple[Array, Array]]
    pdf: Callable[..., Array]
    title: str


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
    Sampler("ltc0", sampling.ltc0_sample, sampling.ltc0_pdf, "LTC, d = 0"),
    Sampler("ltc", sampling.ltc_sample, sampling.ltc_pdf, "LTC"),
    Sampler("cltc", sampling.cltc_sample, sampling.cltc_pdf, "CLTC"),
    Sampler("eon_cltc", sampling.eon_cltc_sample, sampling.eon_cltc_pdf, "CLTC + uniform"),
    Sampler("eon", sampling.eon_sample, sampling.eon_pdf, "exact"),
)
