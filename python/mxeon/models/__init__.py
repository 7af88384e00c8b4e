# SPDX-License-Identifier: Apache-2.0
"""Reflection models in NumPy: values, albedos, inversion and sampling.

The models import NumPy alone. A call uses the caller's thread, unless `threads` asks for more.
"""

import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

from mxeon.models.core.evaluation import threads
from mxeon.models.core.namespaces import unchecked
from mxeon.models.diffuse.brdf import (
    eon_brdf,
    eon_brdf_approx,
    fon_brdf,
    lambert_brdf,
    oren_nayar_brdf,
    qon_brdf,
    qon_footnote_brdf,
    qon_fujii_brdf,
)
from mxeon.models.microfacet import conductor_brdf, dielectric_brdf, generalized_schlick_brdf
from mxeon.models.microfacet.fresnel import (
    fresnel_conductor,
    fresnel_conductor_avg,
    fresnel_dielectric,
    fresnel_dielectric_avg,
    fresnel_schlick,
    fresnel_schlick_avg,
)
from mxeon.models.microfacet.ggx import ggx_ndf, smith_g1, smith_g2, smith_g2_anisotropic

if TYPE_CHECKING:
    from mxeon.models.catalog import model as model
    from mxeon.models.catalog import model_names as model_names
    from mxeon.models.coat import dielectric_over_eon_albedo_avg as dielectric_over_eon_albedo_avg
    from mxeon.models.coat import dielectric_over_eon_albedo_dir as dielectric_over_eon_albedo_dir
    from mxeon.models.coat import dielectric_over_eon_brdf as dielectric_over_eon_brdf
    from mxeon.models.coat.openpbr import openpbr_base_albedo_dir as openpbr_base_albedo_dir
    from mxeon.models.coat.openpbr import openpbr_base_brdf as openpbr_base_brdf
    from mxeon.models.coat.sampling import dielectric_over_eon_pdf as dielectric_over_eon_pdf
    from mxeon.models.coat.sampling import dielectric_over_eon_sample as dielectric_over_eon_sample
    from mxeon.models.media_model import EmissionModel as EmissionModel
    from mxeon.models.media_model import MediumModel as MediumModel
    from mxeon.models.shading_model import ShadingModel as ShadingModel

# Names that are loaded when they are used, by the module that defines them.
_LATER = {
    "catalog": "model model_names",
    "coat": (
        "dielectric_over_eon_albedo_avg dielectric_over_eon_albedo_dir dielectric_over_eon_brdf"
    ),
    "coat.openpbr": "openpbr_base_albedo_dir openpbr_base_brdf",
    "coat.sampling": "dielectric_over_eon_pdf dielectric_over_eon_sample",
    "core.layering": "Bsdf add layer mix multiply throughput",
    "core.quadrature": "albedo_dir_quadrature",
    "diffuse.albedo": (
        "eon_albedo_avg eon_albedo_dir eon_albedo_dir_approx fon_albedo_avg fon_albedo_dir "
        "fon_albedo_dir_approx fon_loss"
    ),
    "diffuse.qon_albedo": "qon_albedo_avg qon_albedo_dir",
    "diffuse.burley": "burley_albedo_dir burley_brdf",
    "diffuse.inversion": (
        "eon_rho_from_albedo_avg eon_rho_from_albedo_avg_approx "
        "eon_rho_from_albedo_avg_refit_approx eon_rho_from_albedo_normal "
        "eon_rho_from_albedo_normal_approx eon_rho_from_albedo_normal_refit_approx"
    ),
    "diffuse.translucent": "translucent_btdf",
    "hair": "chiang_hair_attenuation chiang_hair_bcsdf hair_azimuthal hair_longitudinal",
    "hair.parameters": (
        "chiang_hair_absorption_from_color chiang_hair_roughness deon_hair_absorption_from_melanin"
    ),
    "media.blackbody": "blackbody blackbody_xyz planck_radiance",
    "media.emission": (
        "conical_edf conical_exitance generalized_schlick_edf generalized_schlick_exitance "
        "uniform_edf uniform_exitance"
    ),
    "media.shading": "light_radiance surface_radiance volume_radiance",
    "media.subsurface": (
        "diffusion_blur diffusion_cdf diffusion_profile diffusion_sample subsurface_albedo "
        "subsurface_coefficients subsurface_reflectance"
    ),
    "media.volume": "extinction hg_pdf hg_phase hg_sample single_scattering_albedo transmittance",
    "media_model": "EmissionModel MediumModel",
    "microfacet.albedo": (
        "conductor_albedo_dir dielectric_albedo_dir generalized_schlick_albedo_dir "
        "ggx_albedo_dir_anisotropic"
    ),
    "microfacet.artistic_ior": "artistic_ior artistic_parameters",
    "microfacet.ggx_albedo": "ggx_albedo_dir",
    "microfacet.roughness": "glossiness_anisotropy roughness_anisotropy roughness_dual",
    "nodes.parameters": "Parameter",
    "sampling": "SAMPLERS Sampler",
    "sampling.cltc": "cltc_pdf cltc_sample eon_cltc_pdf eon_cltc_sample",
    "sampling.eon": "eon_pdf eon_sample",
    "sampling.hemisphere": "cosine_pdf cosine_sample uniform_pdf uniform_sample",
    "sampling.ltc": "ltc0_pdf ltc0_sample ltc_pdf ltc_sample",
    "sampling.visible_normals": "ggx_pdf ggx_sample",
    "sampling.zeltner": "zeltner_pdf zeltner_sample",
    "shading_model": "ShadingModel",
    "sheen": "conty_kulla_brdf zeltner_albedo_dir zeltner_brdf",
    "sheen.conty_kulla": "conty_kulla_albedo_dir",
    "thin_film": "film_conductor film_dielectric film_schlick",
    "thin_film.curve": "Form",
    "thin_film.lobe": "film_albedo_dir film_brdf",
    "thin_film.spectrum": "film_spectrum film_spectrum_xyz",
    "transmission.btdf": "dielectric_btdf",
    "transmission.refraction": "refraction_direction transmission_half_vector",
    "transmission.schlick": (
        "generalized_schlick_btdf generalized_schlick_transmittance_dir schlick_ior"
    ),
    "transmission.transmittance": "dielectric_transmittance_dir",
}
_HOMES = {name: place for place, names in _LATER.items() for name in names.split()}

__all__ = [
    *_HOMES,
    "conductor_brdf",
    "dielectric_brdf",
    "eon_brdf",
    "eon_brdf_approx",
    "fon_brdf",
    "fresnel_conductor",
    "fresnel_conductor_avg",
    "fresnel_dielectric",
    "fresnel_dielectric_avg",
    "fresnel_schlick",
    "fresnel_schlick_avg",
    "generalized_schlick_brdf",
    "ggx_ndf",
    "lambert_brdf",
    "oren_nayar_brdf",
    "qon_brdf",
    "qon_footnote_brdf",
    "qon_fujii_brdf",
    "smith_g1",
    "smith_g2",
    "smith_g2_anisotropic",
    "threads",
    "unchecked",
]

# Modules that are public by a shorter name than that of their place.
_SHORT = (
    "core.layering",
    "diffuse.burley",
    "diffuse.translucent",
    "media.blackbody",
    "media.emission",
    "media.shading",
    "media.subsurface",
    "media.volume",
    "microfacet.artistic_ior",
    "microfacet.roughness",
)
for _place in _SHORT:
    _name = f"{__name__}.{_place.rpartition('.')[2]}"
    sys.modules[_name] = import_module(f"{__name__}.{_place}")


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
