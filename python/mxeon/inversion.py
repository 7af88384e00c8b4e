# SPDX-License-Identifier: Apache-2.0
"""Reflectance from a wanted albedo: the public name of `mxeon.models.diffuse.inversion`."""

from mxeon.models.diffuse.inversion import (
    eon_rho_from_albedo_avg,
    eon_rho_from_albedo_avg_approx,
    eon_rho_from_albedo_avg_refit_approx,
    eon_rho_from_albedo_normal,
    eon_rho_from_albedo_normal_approx,
    eon_rho_from_albedo_normal_refit_approx,
)

__all__ = [
    "eon_rho_from_albedo_avg",
    "eon_rho_from_albedo_avg_approx",
    "eon_rho_from_albedo_avg_refit_approx",
    "eon_rho_from_albedo_normal",
    "eon_rho_from_albedo_normal_approx",
    "eon_rho_from_albedo_normal_refit_approx",
]
