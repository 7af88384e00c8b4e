# SPDX-License-Identifier: Apache-2.0
"""Directional and average albedos: the public name of `mxeon.models.albedo`."""

from mxeon.models.albedo import (
    eon_albedo_avg,
    eon_albedo_dir,
    eon_albedo_dir_approx,
    fon_albedo_avg,
    fon_albedo_dir,
    fon_albedo_dir_approx,
    fon_loss,
    qon_albedo_avg,
    qon_albedo_dir,
)
from mxeon.models.quadrature import albedo_dir_quadrature

__all__ = [
    "albedo_dir_quadrature",
    "eon_albedo_avg",
    "eon_albedo_dir",
    "eon_albedo_dir_approx",
    "fon_albedo_avg",
    "fon_albedo_dir",
    "fon_albedo_dir_approx",
    "fon_loss",
    "qon_albedo_avg",
    "qon_albedo_dir",
]
