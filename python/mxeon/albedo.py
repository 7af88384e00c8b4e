# SPDX-License-Identifier: Apache-2.0
"""Directional and average albedos: their public names."""

from mxeon.models.core.quadrature import albedo_dir_quadrature as albedo_dir_quadrature
from mxeon.models.diffuse import eon_albedo_avg as eon_albedo_avg
from mxeon.models.diffuse import eon_albedo_dir as eon_albedo_dir
from mxeon.models.diffuse import eon_albedo_dir_approx as eon_albedo_dir_approx
from mxeon.models.diffuse import fon_albedo_avg as fon_albedo_avg
from mxeon.models.diffuse import fon_albedo_dir as fon_albedo_dir
from mxeon.models.diffuse import fon_albedo_dir_approx as fon_albedo_dir_approx
from mxeon.models.diffuse import fon_loss as fon_loss
from mxeon.models.diffuse import qon_albedo_avg as qon_albedo_avg
from mxeon.models.diffuse import qon_albedo_dir as qon_albedo_dir
from mxeon.models.microfacet import conductor_albedo_dir as conductor_albedo_dir
from mxeon.models.microfacet import dielectric_albedo_dir as dielectric_albedo_dir
from mxeon.models.microfacet import generalized_schlick_albedo_dir as generalized_schlick_albedo_dir
from mxeon.models.microfacet import ggx_albedo_dir_anisotropic as ggx_albedo_dir_anisotropic
from mxeon.models.microfacet.ggx import ggx_albedo_dir as ggx_albedo_dir
