# SPDX-License-Identifier: Apache-2.0
"""Reflection models in NumPy: values, albedos, inversion and sampling.

The models import NumPy alone. A call uses the caller's thread, unless `threads` asks for more.
"""

import sys
from importlib import import_module

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

__all__ = [
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
