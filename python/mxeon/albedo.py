# SPDX-License-Identifier: Apache-2.0
"""Directional and average albedos: their public names."""

from mxeon.models.core.quadrature import albedo_dir_quadrature
from mxeon.models.diffuse.albedo import (
    eon_albedo_avg,
    eon_albedo_dir,
    eon_albedo_dir_approx,
    fon_albedo_avg,
    fon_albedo_dir,
    fon_albedo_dir_approx,
    fon_loss,
)
from mxeon.models.diffuse.qon_albedo import qon_albedo_avg, qon_albedo_dir
from mxeon.models.microfacet.albedo import (
    conductor_albedo_dir,
    dielectric_albedo_dir,
    generalized_schlick_albedo_dir,
    ggx_albedo_dir_anisotropic,
)
from mxeon.models.microfacet.ggx_albedo import ggx_albedo_dir

__all__ = [
    "albedo_dir_quadrature",
    "conductor_albedo_dir",
    "dielectric_albedo_dir",
    "eon_albedo_avg",
    "eon_albedo_dir",
    "eon_albedo_dir_approx",
    "fon_albedo_avg",
    "fon_albedo_dir",
    "fon_albedo_dir_approx",
    "fon_loss",
    "generalized_schlick_albedo_dir",
    "ggx_albedo_dir",
    "ggx_albedo_dir_anisotropic",
    "qon_albedo_avg",
    "qon_albedo_dir",
]
