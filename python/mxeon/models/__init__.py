# SPDX-License-Identifier: Apache-2.0
"""Diffuse reflection models in NumPy: values, albedos, inversion and sampling.

The models import NumPy alone. A call uses the caller's thread alone, unless `threads` asks for more.
"""

from mxeon.models.brdf import (
    eon_brdf,
    eon_brdf_approx,
    fon_brdf,
    lambert_brdf,
    oren_nayar_brdf,
    qon_brdf,
    qon_footnote_brdf,
    qon_fujii_brdf,
)
from mxeon.models.evaluation import threads

__all__ = [
    "eon_brdf",
    "eon_brdf_approx",
    "fon_brdf",
    "lambert_brdf",
    "oren_nayar_brdf",
    "qon_brdf",
    "qon_footnote_brdf",
    "qon_fujii_brdf",
    "threads",
]
