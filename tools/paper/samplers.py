# SPDX-License-Identifier: Apache-2.0
"""The samplers of EON that the paper compares, under one signature."""

from collections.abc import Callable
from dataclasses import dataclass

from mxeon.models.core.arrays import Array
from mxeon.models.sampling import (
    cltc_pdf,
    cltc_sample,
    cosine_pdf,
    cosine_sample,
    eon_cltc_pdf,
    eon_cltc_sample,
    eon_pdf,
    eon_sample,
    ltc0_pdf,
    ltc0_sample,
    ltc_pdf,
    ltc_sample,
    uniform_pdf,
    uniform_sample,
)


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
        lambda wo, u, roughness: uniform_sample(u),
        lambda wo, wi, roughness: uniform_pdf(wi),
        "uniform",
    ),
    Sampler(
        "cosine",
        lambda wo, u, roughness: cosine_sample(u),
        lambda wo, wi, roughness: cosine_pdf(wi),
        "cosine",
    ),
    Sampler("ltc0", ltc0_sample, ltc0_pdf, "LTC, d = 0"),
    Sampler("ltc", ltc_sample, ltc_pdf, "LTC"),
    Sampler("cltc", cltc_sample, cltc_pdf, "CLTC"),
    Sampler("eon_cltc", eon_cltc_sample, eon_cltc_pdf, "CLTC + uniform"),
    Sampler("eon", eon_sample, eon_pdf, "exact"),
)
