# SPDX-License-Identifier: Apache-2.0
"""Reflection models in NumPy: values, albedos, inversion and sampling.

The models only import NumPy. A call uses the caller's thread.
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
from mxeon.models.core.layering import Bsdf as Bsdf
from mxeon.models.core.layering import add as add
from mxeon.models.core.layering import layer as layer
from mxeon.models.core.layering import mix as mix
from mxeon.models.core.layering import multiply as multiply
from mxeon.models.core.layering import throughput as throughput
from mxeon.models.core.quadrature import albedo_dir_quadrature as albedo_dir_quadrature
from mxeon.models.diffuse import burley_albedo_dir as burley_albedo_dir
from mxeon.models.diffuse import burley_brdf as burley_brdf
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
from mxeon.models.diffuse import translucent_btdf as translucent_btdf
from mxeon.models.hair import chiang_hair_absorption_from_color as chiang_hair_absorption_from_color
from mxeon.models.hair import chiang_hair_attenuation as chiang_hair_attenuation
from mxeon.models.hair import chiang_hair_bcsdf as chiang_hair_bcsdf
from mxeon.models.hair import chiang_hair_roughness as chiang_hair_roughness
from mxeon.models.hair import deon_hair_absorption_from_melanin as deon_hair_absorption_from_melanin
from mxeon.models.media import blackbody as blackbody
from mxeon.models.media import blackbody_xyz as blackbody_xyz
from mxeon.models.media import conical_edf as conical_edf
from mxeon.models.media import conical_exitance as conical_exitance
from mxeon.models.media import diffusion_blur as diffusion_blur
from mxeon.models.media import generalized_schlick_edf as generalized_schlick_edf
from mxeon.models.media import generalized_schlick_exitance as generalized_schlick_exitance
from mxeon.models.media import hg_pdf as hg_pdf
from mxeon.models.media import hg_sample as hg_sample
from mxeon.models.media import surface_radiance as surface_radiance
from mxeon.models.media import transmittance as transmittance
from mxeon.models.media import uniform_edf as uniform_edf
from mxeon.models.media import uniform_exitance as uniform_exitance
from mxeon.models.microfacet import conductor_albedo_dir as conductor_albedo_dir
from mxeon.models.microfacet import conductor_brdf as conductor_brdf
from mxeon.models.microfacet import dielectric_albedo_dir as dielectric_albedo_dir
from mxeon.models.microfacet import dielectric_brdf as dielectric_brdf
from mxeon.models.microfacet import generalized_schlick_albedo_dir as generalized_schlick_albedo_dir
from mxeon.models.microfacet import generalized_schlick_brdf as generalized_schlick_brdf
from mxeon.models.microfacet import ggx_albedo_dir_anisotropic as ggx_albedo_dir_anisotropic
from mxeon.models.microfacet.fresnel import artistic_ior as artistic_ior
from mxeon.models.microfacet.fresnel import fresnel_conductor as fresnel_conductor
from mxeon.models.microfacet.fresnel import fresnel_conductor_avg as fresnel_conductor_avg
from mxeon.models.microfacet.fresnel import fresnel_dielectric as fresnel_dielectric
from mxeon.models.microfacet.fresnel import fresnel_dielectric_avg as fresnel_dielectric_avg
from mxeon.models.microfacet.fresnel import fresnel_schlick as fresnel_schlick
from mxeon.models.microfacet.fresnel import fresnel_schlick_avg as fresnel_schlick_avg
from mxeon.models.microfacet.ggx import ggx_albedo_dir as ggx_albedo_dir
from mxeon.models.microfacet.ggx import glossiness_anisotropy as glossiness_anisotropy
from mxeon.models.microfacet.ggx import roughness_anisotropy as roughness_anisotropy
from mxeon.models.microfacet.ggx import roughness_dual as roughness_dual
from mxeon.models.microfacet.ggx import smith_g1 as smith_g1
from mxeon.models.microfacet.ggx import smith_g2 as smith_g2
from mxeon.models.microfacet.ggx import smith_g2_anisotropic as smith_g2_anisotropic
from mxeon.models.nodes.node import Parameter as Parameter
from mxeon.models.sampling import *  # noqa: F403
from mxeon.models.shading_model import ShadingModel as ShadingModel
from mxeon.models.sheen import conty_kulla_albedo_dir as conty_kulla_albedo_dir
from mxeon.models.sheen import conty_kulla_brdf as conty_kulla_brdf
from mxeon.models.sheen import zeltner_albedo_dir as zeltner_albedo_dir
from mxeon.models.sheen import zeltner_brdf as zeltner_brdf
from mxeon.models.thin_film import Form as Form
from mxeon.models.thin_film import film_albedo_dir as film_albedo_dir
from mxeon.models.thin_film import film_brdf as film_brdf
from mxeon.models.thin_film import film_conductor as film_conductor
from mxeon.models.thin_film import film_dielectric as film_dielectric
from mxeon.models.thin_film import film_schlick as film_schlick
from mxeon.models.transmission import dielectric_btdf as dielectric_btdf
from mxeon.models.transmission import dielectric_transmittance_dir as dielectric_transmittance_dir
from mxeon.models.transmission import generalized_schlick_btdf as generalized_schlick_btdf
from mxeon.models.transmission import (
    generalized_schlick_transmittance_dir as generalized_schlick_transmittance_dir,
)
from mxeon.models.transmission import refraction_direction as refraction_direction
from mxeon.models.transmission import schlick_ior as schlick_ior

__all__ = [
    name for name, value in globals().items() if callable(value) and not name.startswith("_")
]
