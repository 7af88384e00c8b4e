# SPDX-License-Identifier: Apache-2.0
"""Importance sampling: a sampler is a pair, x_sample(...) -> wi, pdf and x_pdf(...).

Argument order `wo`, `wi`, `u`, `roughness`, without those that a sampler does not depend on; `rho`,
which only the exact sampler of EON takes, is a keyword. Random numbers `u` have shape (..., 2) and
lie in [0, 1). Densities are in solid angle, 1/sr.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from mxeon.models.core.arrays import Array
from mxeon.models.sampling.cltc import cltc_pdf, cltc_sample, eon_cltc_pdf, eon_cltc_sample
from mxeon.models.sampling.eon import eon_pdf, eon_sample
from mxeon.models.sampling.hemisphere import cosine_pdf, cosine_sample, uniform_pdf, uniform_sample
from mxeon.models.sampling.ltc import ltc0_pdf, ltc0_sample, ltc_pdf, ltc_sample
from mxeon.models.sampling.visible_normals import ggx_pdf, ggx_sample
from mxeon.models.sampling.zeltner import zeltner_pdf, zeltner_sample

__all__ = [
    "SAMPLERS",
    "Sampler",
    "cltc_pdf",
    "cltc_sample",
    "cosine_pdf",
    "cosine_sample",
    "eon_cltc_pdf",
    "eon_cltc_sample",
    "eon_pdf",
    "eon_sample",
    "ggx_pdf",
    "ggx_sample",
    "ltc0_pdf",
    "ltc0_sample",
    "ltc_pdf",
    "ltc_sample",
    "uniform_pdf",
    "uniform_sample",
    "zeltner_pdf",
    "zeltner_sample",
]


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
