# SPDX-License-Identifier: Apache-2.0
"""The smallest repairs of MaterialX's GLSL, and a copy of its package that has them."""

import os
import shutil
from pathlib import Path

import MaterialX as mx

from docs.upstream.repairs import Repair, repair

PACKAGE = "MaterialX"
SHEEN, LOBES = "mx_sheen_bsdf.glsl", "lib/mx_microfacet_sheen.glsl"
SPECULAR = "lib/mx_microfacet_specular.glsl"


def _glsl(page: str, file: str, old: str, new: str) -> Repair:
    """A change of a file of pbrlib's GLSL."""
    return Repair(page, PACKAGE, f"libraries/pbrlib/genglsl/{file}", old, new)


HAIR = "mx_chiang_hair_bsdf.glsl"
HAIR_REPAIRS = (
    _glsl("genglsl_hair_uniform_lobe", HAIR, "(1.0 / 2.0 * M_PI)", "(1.0 / (2.0 * M_PI))"),
    _glsl(
        "genglsl_hair_longitudinal",
        HAIR,
        """    float n = 1.0;
    float d = 1.0;
    float f = 1.0;
    float x2 = x * x;
    for (int i = 0; i < 9 ; ++i)
    {
        d *= 4.0 * (f * f);
        n *= x2;
        v += n / d;
        f += 1.0;
    }
""",
        """    float term = 1.0;
    for (int i = 1; i < 32; ++i)
    {
        term *= x * x / (4.0 * float(i * i));
        v += term;
    }
""",
    ),
    _glsl(
        "genglsl_hair_longitudinal",
        HAIR,
        "x + 0.5 * (-log(2.0 * M_PI) + log(1.0 / x) + 1.0 / (8.0 * x));",
        "x - 0.5 * log(2.0 * M_PI * x) + log(1.0 + (1.0 + (4.5 + 37.5 / (8.0 * x)) / (8.0 * x)) / (8.0 * x));",
    ),
    _glsl(
        "genglsl_hair_longitudinal",
        HAIR,
        "    float inv_v = 1.0 / v;\n",
        "    float inv_v = 1.0 / v;\n    cosThetaI = abs(cosThetaI);\n"
        "    vec2 d = vec2(cosThetaI - cosThetaO, sinThetaI + sinThetaO);\n",
    ),
    _glsl(
        "genglsl_hair_longitudinal",
        HAIR,
        "exp(mx_hair_log_I0(a) - b - inv_v + 0.6931 + log(0.5 * inv_v));",
        "exp(mx_hair_log_I0(a) - a - 0.5 * dot(d, d) * inv_v) * inv_v;",
    ),
    *(
        _glsl(
            "genglsl_hair_roughness",
            HAIR,
            f"clamp(roughness_{lobe}, 0.001, 1.0);",
            f"max(roughness_{lobe}, vec2(1e-8, 1e-4));",
        )
        for lobe in ("R", "TT", "TRT")
    ),
    _glsl(
        "genglsl_hair_azimuth",
        HAIR,
        """        float sinGammaO = mx_hair_transform_sin_cos(cosGammaO);
        if (dot(k1_p, Y) > 0.0)
            sinGammaO = -sinGammaO;
        float gammaO = asin(sinGammaO);
""",
        """        float sinGammaO = -dot(k1_p, Y);
        float gammaO = mx_atan(sinGammaO, cosGammaO);
""",
    ),
    _glsl(
        "genglsl_hair_azimuth",
        HAIR,
        "asin(sinGammaT);",
        "mx_atan(sinGammaT, cosGammaT);",
    ),
    _glsl(
        "genglsl_hair_grazing",
        HAIR,
        "(vec3(1.0) - T * f);",
        "max(vec3(1.0) - T * f, 1e-7);",
    ),
    _glsl(
        "genglsl_hair_grazing",
        HAIR,
        "vec3 k1_p = normalize(V - X * dot(V, X));",
        "vec3 k1_p = cosThetaO > 0.0 ? normalize(V - X * dot(V, X)) : N;",
    ),
    _glsl(
        "genglsl_hair_grazing",
        HAIR,
        "float cosThetaT = mx_hair_transform_sin_cos(sinThetaT);",
        "float cosThetaT = max(mx_hair_transform_sin_cos(sinThetaT), M_FLOAT_EPS);",
    ),
)

REPAIRS = (
    *HAIR_REPAIRS,
    *(
        _glsl("genglsl_film_half", SPECULAR, f"R23{pol} = 0.5 * f;", f"R23{pol} = f;")
        for pol in "ps"
    ),
    *(
        _glsl(
            "genglsl_multiply_throughput",
            f"mx_multiply_bsdf_{kind}.glsl",
            "result.throughput = in1.throughput;",
            f"result.throughput = 1.0 - {factor} * (1.0 - in1.throughput);",
        )
        for kind, factor in (("float", "weight"), ("color3", "tint"))
    ),
    _glsl(
        "genglsl_add_throughput",
        "mx_add_bsdf.glsl",
        "max(in1.throughput + in2.throughput - 1.0, 0.0);",
        "in1.throughput + in2.throughput - 1.0;",
    ),
    _glsl(
        "genglsl_add_throughput",
        "mx_layer_bsdf.glsl",
        "base.response * top.throughput;",
        "base.response * max(top.throughput, 0.0);",
    ),
    _glsl(
        "genglsl_add_throughput",
        "mx_layer_bsdf.glsl",
        "top.throughput * base.throughput;",
        "min(top.throughput, 0.0) + max(top.throughput, 0.0) * base.throughput;",
    ),
    _glsl(
        "genglsl_medium_scattering",
        "mx_anisotropic_vdf.glsl",
        "exp(-absorption)",
        "exp(-(absorption + scattering))",
    ),
    _glsl(
        "genglsl_zeltner_normal",
        LOBES,
        "    vec3 X = V - N*NdotV;\n",
        "    vec3 X = V - N*NdotV;\n    X -= N*dot(N, X);\n",
    ),
    _glsl(
        "genglsl_sheen_throughput",
        SHEEN,
        "vec3(1.0 - dirAlbedo * weight)",
        "1.0 - dirAlbedo * color * weight",
    ),
    _glsl(
        "genglsl_sheen_throughput",
        SHEEN,
        "else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)",
        "else",
    ),
    _glsl(
        "genglsl_sheen_throughput",
        SHEEN,
        "vec3 Li = mx_environment_irradiance(N);",
        "vec3 Li = (closureData.closureType == CLOSURE_TYPE_INDIRECT) ?"
        " mx_environment_irradiance(N) : vec3(0.0);",
    ),
    _glsl("genglsl_conty_kulla_fit", LOBES, "NDF(float NdotH,", "NDF(float sin2,"),
    _glsl(
        "genglsl_conty_kulla_fit",
        LOBES,
        "    float cos2 = NdotH * NdotH;\n    float sin2 = 1.0 - cos2;\n",
        "",
    ),
    _glsl(
        "genglsl_conty_kulla_fit",
        LOBES,
        "float NdotH = clamp(H.z, M_FLOAT_EPS, 1.0);",
        "float NdotH = dot(H.xy, H.xy);",
    ),
    _glsl(
        "genglsl_conty_kulla_fit",
        SHEEN,
        "float NdotH = clamp(dot(N, H), M_FLOAT_EPS, 1.0);",
        "vec3 T = cross(N, H);\n            float NdotH = min(dot(T, T), 1.0);",
    ),
    _glsl(
        "genglsl_translucent_side",
        "mx_translucent_bsdf.glsl",
        '#include "lib/mx_closure_type.glsl"\n',
        '#include "lib/mx_closure_type.glsl"\n#include "lib/mx_microfacet.glsl"\n',
    ),
    _glsl(
        "genglsl_translucent_side",
        "mx_translucent_bsdf.glsl",
        "    N = -N;\n",
        "    N = -mx_forward_facing_normal(N, V);\n",
    ),
    _glsl("genglsl_ior_zero", SPECULAR, "    if (g2 < 0.0)", "    if (g2 <= 0.0)"),
    _glsl(
        "genglsl_ior_zero",
        SPECULAR,
        "    vec3 t3 = cosTheta2 * a2plusb2 + vec3(sinTheta2 * sinTheta2);\n",
        "    vec3 t3 = max(cosTheta2 * a2plusb2 + vec3(sinTheta2 * sinTheta2), 1e-20);\n",
    ),
    _glsl(
        "genglsl_transmission_masking",
        "lib/mx_environment_fis.glsl",
        "    radiance /= G1V * float(envRadianceSamples);\n",
        "    radiance /= (fd.refraction ? 1.0 : G1V) * float(envRadianceSamples);\n",
    ),
    _glsl(
        "genglsl_refraction_nan",
        SPECULAR,
        "    R = refract(R, N, 1.0 / ior);\n",
        "    float cosine = -dot(R, N);\n    R = refract(R, N, 1.0 / ior);\n",
    ),
    _glsl(
        "genglsl_refraction_nan",
        SPECULAR,
        "    return refract(R, N1, ior);\n",
        "    return ior * R - (ior * dot(R, N1) + cosine) * N1;\n",
    ),
)


def installed() -> Path:
    """Folder of the MaterialX that is installed."""
    return Path(mx.__file__).parent


def repaired(folder: Path) -> Path:
    """A folder for the path of Python, in which MaterialX is a tree of links with all repairs."""
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(installed(), folder / PACKAGE, copy_function=os.symlink, ignore=ignored)
    for change in REPAIRS:
        repair(folder, change)
    return folder
