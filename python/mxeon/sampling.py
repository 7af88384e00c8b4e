# SPDX-License-Identifier: Apache-2.0
"""Importance sampling: the public name of `mxeon.models.sampling`."""

from mxeon.models.sampling import (
    SAMPLERS,
    Sampler,
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
    zeltner_pdf,
    zeltner_sample,
)

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
    "ltc0_pdf",
    "ltc0_sample",
    "ltc_pdf",
    "ltc_sample",
    "uniform_pdf",
    "uniform_sample",
    "zeltner_pdf",
    "zeltner_sample",
]
