# SPDX-License-Identifier: Apache-2.0
"""Reflection models in NumPy, with functions for values, albedos, inversion and sampling.

The models import no package but NumPy. A call runs in the caller's thread.
"""

from mxeon.models.catalog import model as model
from mxeon.models.catalog import model_names as model_names
from mxeon.models.coat import dielectric_over_eon_albedo_avg as dielectric_over_eon_albedo_avg
from mxeon.models.coat import dielectric_over_eon_albedo_dir as dielectric_over_eon_albedo_dir
from mxeon.models.coat import dielectric_over_eon_brdf as dielectric_over_eon_brdf
from mxeon.models.coat import dielectric_over_eon_pdf as dielectric_over_eon_pdf
from mxeon.models.coat import dielectric_over_eon_sample as dielectric_over_eon_sample
from mxeon.models.coat import varnished_albedo_avg as varnished_albedo_avg
from mxeon.models.coat import varnished_albedo_dir as varnished_albedo_dir
from mxeon.models.coat import varnished_brdf as varnished_brdf
from mxeon.models.coat import varnished_pdf as varnished_pdf
from mxeon.models.coat import varnished_sample as varnished_sample
from mxeon.models.core.quadrature import albedo_dir_quadrature as albedo_dir_quadrature
from mxeon.models.diffuse import eon_albedo_avg as eon_albedo_avg
from mxeon.models.diffuse import eon_albedo_dir as eon_albedo_dir
from mxeon.models.diffuse import eon_albedo_dir_approx as eon_albedo_dir_approx
from mxeon.models.diffuse import eon_brdf as eon_brdf
from mxeon.models.diffuse import eon_brdf_approx as eon_brdf_approx
from mxeon.models.diffuse import eon_rho_from_albedo_avg as eon_rho_from_albedo_avg
from mxeon.models.diffuse import eon_rho_from_albedo_normal as eon_rho_from_albedo_normal
from mxeon.models.diffuse import fon_albedo_avg as fon_albedo_avg
from mxeon.models.diffuse import fon_albedo_dir as fon_albedo_dir
from mxeon.models.diffuse import fon_albedo_dir_approx as fon_albedo_dir_approx
from mxeon.models.diffuse import fon_brdf as fon_brdf
from mxeon.models.diffuse import fon_loss as fon_loss
from mxeon.models.diffuse import lambert_brdf as lambert_brdf
from mxeon.models.diffuse import oren_nayar_brdf as oren_nayar_brdf
from mxeon.models.diffuse import qon_albedo_avg as qon_albedo_avg
from mxeon.models.diffuse import qon_albedo_dir as qon_albedo_dir
from mxeon.models.diffuse import qon_brdf as qon_brdf
from mxeon.models.diffuse import qon_footnote_brdf as qon_footnote_brdf
from mxeon.models.diffuse import qon_fujii_brdf as qon_fujii_brdf
from mxeon.models.microfacet import conductor_albedo_dir as conductor_albedo_dir
from mxeon.models.microfacet import conductor_brdf as conductor_brdf
from mxeon.models.microfacet import dielectric_albedo_dir as dielectric_albedo_dir
from mxeon.models.microfacet import dielectric_brdf as dielectric_brdf
from mxeon.models.microfacet import generalized_schlick_albedo_dir as generalized_schlick_albedo_dir
from mxeon.models.microfacet import generalized_schlick_brdf as generalized_schlick_brdf
from mxeon.models.microfacet import ggx_albedo_dir_anisotropic as ggx_albedo_dir_anisotropic
from mxeon.models.microfacet.fresnel import fresnel_conductor as fresnel_conductor
from mxeon.models.microfacet.fresnel import fresnel_conductor_avg as fresnel_conductor_avg
from mxeon.models.microfacet.fresnel import fresnel_dielectric as fresnel_dielectric
from mxeon.models.microfacet.fresnel import fresnel_dielectric_avg as fresnel_dielectric_avg
from mxeon.models.microfacet.fresnel import fresnel_schlick as fresnel_schlick
from mxeon.models.microfacet.fresnel import fresnel_schlick_avg as fresnel_schlick_avg
from mxeon.models.microfacet.ggx import ggx_albedo_dir as ggx_albedo_dir
from mxeon.models.microfacet.ggx import smith_g1 as smith_g1
from mxeon.models.microfacet.ggx import smith_g2 as smith_g2
from mxeon.models.microfacet.ggx import smith_g2_anisotropic as smith_g2_anisotropic

__all__ = [
    name for name, value in globals().items() if callable(value) and not name.startswith("_")
]
