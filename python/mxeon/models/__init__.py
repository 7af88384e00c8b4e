# SPDX-License-Identifier: Apache-2.0
"""Diffuse reflection models in NumPy: values, albedos, inversion and sampling. Imports NumPy alone."""

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

__all__ = [
    "eon_brdf",
    "eon_brdf_approx",
    "fon_brdf",
    "lambert_brdf",
    "oren_nayar_brdf",
    "qon_brdf",
    "qon_footnote_brdf",
    "qon_fujii_brdf",
]
