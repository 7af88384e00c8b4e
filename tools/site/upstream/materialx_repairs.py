# SPDX-License-Identifier: Apache-2.0
"""The smallest repairs of MaterialX's data, and a copy of its package that has them."""

import os
import shutil
from collections.abc import Sequence
from pathlib import Path
from textwrap import indent

import MaterialX as mx

from tools.site.upstream.hair_repairs import HAIR_REPAIRS, UNIFORM_LOBE
from tools.site.upstream.repairs import MATERIALX, Repair, glsl, library, repair

SHEEN, LOBES = "mx_sheen_bsdf.glsl", "lib/mx_microfacet_sheen.glsl"
COSINES, FLOATS = "NdotL, NdotV, ", "float NdotL, float NdotV, "
SPECULAR = "lib/mx_microfacet_specular.glsl"
DIFFUSE = "lib/mx_microfacet_diffuse.glsl"
OPENPBR = "bxdf/open_pbr_surface.mtlx"
INPUT = '      <input name="{}" type="{}" {} />\n'
THIN_WALLED = (
    "    </oren_nayar_diffuse_bsdf>\n"
    '    <subtract name="one_minus_subsurface_scatter_anisotropy" type="float">\n'
)
# The color of the lobe, once more, on either side: words of the names of its nodes.
FACTOR = (
    '    <multiply name="subsurface_thin_walled_{}_factor" type="color3">\n'
    + INPUT.format("in1", "color3", 'interfacename="subsurface_color"')
    + INPUT.format("in2", "float", 'nodename="one_{}_subsurface_scatter_anisotropy"')
    + "    </multiply>\n"
)
SIDES = (("brdf", "minus"), ("btdf", "plus"))
MATRIX = """\
/// XYZ to Rec.709 RGB colorspace conversion
const mat3 XYZ_to_RGB = mat3( 3.2406, -0.9689, 0.0557,
                             -1.5372, 1.8758, -0.2040,
                             -0.4986, 0.0415, 1.0570);
"""

# In the order of the patches: those first that are no choice of the specification.
REPAIRS = (
    glsl(
        "genglsl_clamped_dot",
        "mx_oren_nayar_diffuse_bsdf.glsl",
        "float LdotV = clamp(dot(L, V), M_FLOAT_EPS, 1.0);",
        "float LdotV = dot(L, V);",
    ),
    glsl(
        "genglsl_albedo_acos",
        DIFFUSE,
        "(mx_acos(clamp(cosTheta, -1.0, 1.0)) - Si * cosTheta)",
        "(mx_atan(Si, cosTheta) - Si * cosTheta)",
    ),
    glsl(
        "genglsl_albedo_acos",
        DIFFUSE,
        "2.0 * ((Si / cosTheta) * (1.0 - Si * Si * Si) - Si) / 3.0;",
        "2.0 * Si * (cosTheta * (1.0 + Si + Si * Si) / (1.0 + Si) - 1.0) / 3.0;",
    ),
    *(
        glsl("genglsl_film_half", SPECULAR, f"R23{pol} = 0.5 * f;", f"R23{pol} = f;")
        for pol in "ps"
    ),
    library(
        "openpbr_thin_walled",
        OPENPBR,
        THIN_WALLED,
        INPUT.format("energy_compensation", "boolean", 'value="true"') + THIN_WALLED,
    ),
    *(
        library(
            "openpbr_thin_walled_tint",
            OPENPBR,
            FACTOR.format(side, sign),
            "",
        )
        for side, sign in SIDES
    ),
    *(
        library(
            "openpbr_thin_walled_tint",
            OPENPBR,
            INPUT.format("in2", "color3", f'nodename="subsurface_thin_walled_{side}_factor"'),
            INPUT.format("in2", "float", f'nodename="one_{sign}_subsurface_scatter_anisotropy"'),
        )
        for side, sign in SIDES
    ),
    library(
        "genosl_dropped_flag",
        "pbrlib/genosl/pbrlib_genosl_impl.mtlx",
        "oren_nayar_diffuse_bsdf({{normal}}, {{color}}, {{roughness}})",
        "oren_nayar_diffuse_bsdf({{normal}}, {{color}}, {{roughness}}, "
        "&quot;energy_compensation&quot;, {{energy_compensation}})",
    ),
    glsl(
        "genglsl_refraction_nan",
        SPECULAR,
        "    R = refract(R, N, 1.0 / ior);\n",
        "    float cosine = -dot(R, N);\n    R = refract(R, N, 1.0 / ior);\n",
    ),
    glsl(
        "genglsl_refraction_nan",
        SPECULAR,
        "    return refract(R, N1, ior);\n",
        "    return ior * R - (ior * dot(R, N1) + cosine) * N1;\n",
    ),
    glsl("genglsl_ior_zero", SPECULAR, "    if (g2 < 0.0)", "    if (g2 <= 0.0)"),
    glsl(
        "genglsl_ior_zero",
        SPECULAR,
        "    vec3 t3 = cosTheta2 * a2plusb2 + vec3(sinTheta2 * sinTheta2);\n",
        "    vec3 t3 = max(cosTheta2 * a2plusb2 + vec3(sinTheta2 * sinTheta2), 1e-20);\n",
    ),
    glsl(
        "genglsl_transmission_masking",
        "lib/mx_environment_fis.glsl",
        "    radiance /= G1V * float(envRadianceSamples);\n",
        "    radiance /= (fd.refraction ? 1.0 : G1V) * float(envRadianceSamples);\n",
    ),
    glsl(
        "genglsl_translucent_side",
        "mx_translucent_bsdf.glsl",
        '#include "lib/mx_closure_type.glsl"\n',
        '#include "lib/mx_closure_type.glsl"\n#include "lib/mx_microfacet.glsl"\n',
    ),
    glsl(
        "genglsl_translucent_side",
        "mx_translucent_bsdf.glsl",
        "    N = -N;\n",
        "    N = -mx_forward_facing_normal(N, V);\n",
    ),
    glsl(
        "genglsl_zeltner_normal",
        LOBES,
        "    vec3 X = V - N*NdotV;\n",
        "    vec3 X = V - N*NdotV;\n    X -= N*dot(N, X);\n",
    ),
    glsl("genslang_blackbody_constant", "mx_blackbody.glsl", MATRIX + "\n", ""),
    glsl(
        "genslang_blackbody_constant",
        "mx_blackbody.glsl",
        "    colorValue = mx_matrix_mul(XYZ_to_RGB, XYZ);\n",
        f"{indent(MATRIX, 4 * ' ')}    colorValue = mx_matrix_mul(XYZ_to_RGB, XYZ);\n",
    ),
    glsl("genglsl_conty_kulla_fit", LOBES, "NDF(float NdotH,", "NDF(float sin2,"),
    glsl(
        "genglsl_conty_kulla_fit",
        LOBES,
        "    float cos2 = NdotH * NdotH;\n    float sin2 = 1.0 - cos2;\n",
        "",
    ),
    glsl("genglsl_conty_kulla_fit", LOBES, "NDF(NdotH, roughness)", "NDF(sin2, roughness)"),
    *(
        glsl("genglsl_conty_kulla_fit", file, f"sheen_brdf({old}", f"sheen_brdf({new}")
        for file, old, new in (
            (LOBES, f"{FLOATS}float NdotH", f"{FLOATS}float sin2"),
            (LOBES, f"{COSINES}NdotH", f"{COSINES}sin2"),
            (SHEEN, f"{COSINES}NdotH", f"{COSINES}sin2"),
        )
    ),
    glsl(
        "genglsl_conty_kulla_fit",
        LOBES,
        "float NdotH = clamp(H.z, M_FLOAT_EPS, 1.0);",
        "float sin2 = dot(H.xy, H.xy);",
    ),
    glsl(
        "genglsl_conty_kulla_fit",
        SHEEN,
        "float NdotH = clamp(dot(N, H), M_FLOAT_EPS, 1.0);",
        "vec3 NxH = cross(N, H);\n            float sin2 = min(dot(NxH, NxH), 1.0);",
    ),
    *HAIR_REPAIRS,
    glsl(
        "genglsl_sheen_throughput",
        SHEEN,
        "vec3(1.0 - dirAlbedo * weight)",
        "1.0 - dirAlbedo * color * weight",
    ),
    glsl(
        "genglsl_sheen_throughput",
        SHEEN,
        "else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)",
        "else",
    ),
    glsl(
        "genglsl_sheen_throughput",
        SHEEN,
        "vec3 Li = mx_environment_irradiance(N);",
        "vec3 Li = (closureData.closureType == CLOSURE_TYPE_INDIRECT) ?"
        " mx_environment_irradiance(N) : vec3(0.0);",
    ),
    glsl(
        "genglsl_add_throughput",
        "mx_add_bsdf.glsl",
        "max(in1.throughput + in2.throughput - 1.0, 0.0);",
        "in1.throughput + in2.throughput - 1.0;",
    ),
    glsl(
        "genglsl_add_throughput",
        "mx_layer_bsdf.glsl",
        "base.response * top.throughput;",
        "base.response * max(top.throughput, 0.0);",
    ),
    glsl(
        "genglsl_add_throughput",
        "mx_layer_bsdf.glsl",
        "top.throughput * base.throughput;",
        "min(top.throughput, 0.0) + max(top.throughput, 0.0) * base.throughput;",
    ),
    *(
        glsl(
            "genglsl_multiply_throughput",
            f"mx_multiply_bsdf_{kind}.glsl",
            "result.throughput = in1.throughput;",
            f"result.throughput = 1.0 - {factor} * (1.0 - in1.throughput);",
        )
        for kind, factor in (("float", "weight"), ("color3", "tint"))
    ),
    glsl(
        "genglsl_medium_scattering",
        "mx_anisotropic_vdf.glsl",
        "support for scattering and anisotropy.",
        "support for in-scattering and anisotropy.",
    ),
    glsl(
        "genglsl_medium_scattering",
        "mx_anisotropic_vdf.glsl",
        "exp(-absorption)",
        "exp(-(absorption + scattering))",
    ),
    UNIFORM_LOBE,
)


def installed() -> Path:
    """Folder of the MaterialX that is installed."""
    return Path(mx.__file__).parent


def linked(folder: Path, package: Path | None = None) -> Path:
    """A tree of links to a package of MaterialX, in a folder for the path of Python."""
    ignored = shutil.ignore_patterns("__pycache__")
    target = folder / MATERIALX
    shutil.copytree(package or installed(), target, copy_function=os.symlink, ignore=ignored)
    return target


def repaired(
    folder: Path, package: Path | None = None, changes: Sequence[Repair] = REPAIRS
) -> Path:
    """A folder for the path of Python, in which MaterialX is a tree of links with repairs."""
    linked(folder, package)
    for change in changes:
        repair(folder, change)
    return folder
