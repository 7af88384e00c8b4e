# SPDX-License-Identifier: Apache-2.0
"""The smallest repairs of hair in MaterialX's GLSL."""

from tools.site.upstream.repairs import Repair, glsl

HAIR = "mx_chiang_hair_bsdf.glsl"
HAIR_REPAIRS: tuple[Repair, ...] = (
    glsl(
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
    glsl(
        "genglsl_hair_longitudinal",
        HAIR,
        "x + 0.5 * (-log(2.0 * M_PI) + log(1.0 / x) + 1.0 / (8.0 * x));",
        "x - 0.5 * log(2.0 * M_PI * x) + log(1.0 + (1.0 + (4.5 + 37.5 / (8.0 * x)) / (8.0 * x)) / (8.0 * x));",
    ),
    glsl(
        "genglsl_hair_longitudinal",
        HAIR,
        "    float inv_v = 1.0 / v;\n",
        "    float inv_v = 1.0 / v;\n    cosThetaI = abs(cosThetaI);\n"
        "    vec2 d = vec2(cosThetaI - cosThetaO, sinThetaI + sinThetaO);\n",
    ),
    glsl(
        "genglsl_hair_longitudinal",
        HAIR,
        "exp(mx_hair_log_I0(a) - b - inv_v + 0.6931 + log(0.5 * inv_v));",
        "exp(mx_hair_log_I0(a) - a - 0.5 * dot(d, d) * inv_v) * inv_v;",
    ),
    glsl(
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
    glsl(
        "genglsl_hair_azimuth",
        HAIR,
        "asin(sinGammaT);",
        "mx_atan(sinGammaT, cosGammaT);",
    ),
    glsl(
        "genglsl_hair_grazing",
        HAIR,
        "(vec3(1.0) - T * f);",
        "max(vec3(1.0) - T * f, 1e-7);",
    ),
    glsl(
        "genglsl_hair_grazing",
        HAIR,
        "vec3 k1_p = normalize(V - X * dot(V, X));",
        "vec3 k1_p = cosThetaO > 0.0 ? normalize(V - X * dot(V, X)) : N;",
    ),
    glsl(
        "genglsl_hair_grazing",
        HAIR,
        "float cosThetaT = mx_hair_transform_sin_cos(sinThetaT);",
        "float cosThetaT = max(mx_hair_transform_sin_cos(sinThetaT), M_FLOAT_EPS);",
    ),
    *(
        glsl(
            "genglsl_hair_roughness",
            HAIR,
            f"clamp(roughness_{lobe}, 0.001, 1.0);",
            f"max(roughness_{lobe}, vec2(1e-8, 1e-4));",
        )
        for lobe in ("R", "TT", "TRT")
    ),
    glsl(
        "genglsl_black_pigment",
        HAIR,
        "-log(eumelanin_color) + pheomelanin * -log(pheomelanin_color), ",
        "-log(max(eumelanin_color, 1e-30)) + pheomelanin * -log(max(pheomelanin_color, 1e-30)),",
    ),
)
# Pull request 2961, which follows 1.39.5, repairs it as well.
UNIFORM_LOBE = glsl("genglsl_hair_uniform_lobe", HAIR, "(1.0 / 2.0 * M_PI)", "(1.0 / (2.0 * M_PI))")
