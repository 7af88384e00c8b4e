# SPDX-License-Identifier: Apache-2.0
"""Reflectance from a wanted albedo: the public name of `mxeon.models.diffuse`."""

from mxeon.models.diffuse import eon_rho_from_albedo_avg as eon_rho_from_albedo_avg
from mxeon.models.diffuse import eon_rho_from_albedo_avg_approx as eon_rho_from_albedo_avg_approx
from mxeon.models.diffuse import (
    eon_rho_from_albedo_avg_refit_approx as eon_rho_from_albedo_avg_refit_approx,
)
from mxeon.models.diffuse import eon_rho_from_albedo_normal as eon_rho_from_albedo_normal
from mxeon.models.diffuse import (
    eon_rho_from_albedo_normal_approx as eon_rho_from_albedo_normal_approx,
)
from mxeon.models.diffuse import (
    eon_rho_from_albedo_normal_refit_approx as eon_rho_from_albedo_normal_refit_approx,
)
