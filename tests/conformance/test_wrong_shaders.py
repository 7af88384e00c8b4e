# SPDX-License-Identifier: Apache-2.0
"""Each wrong line in a shader fails the intended check, and the diagnosis contains the cause."""

import pytest

from mxeon.models.nodes.node import COLORED
from tests.support.sharing import DRAWN
from tests.support.verdicts import DIFFERS, FAILED, has
from tests.support.wrong_libraries import wrong_library, wrong_stock

# Paths with a folder name files of eonlib. File names without a folder name MaterialX's files.
LOBE, FACETS = "genglsl/lib/oren_nayar_lobe.glsl", "genglsl/lib/microfacet_lobe.glsl"
CLEAR = "genglsl/lib/microfacet_transmission.glsl"
HAIR, FILM = "genglsl/chiang_hair_bsdf.glsl", "genglsl/lib/thin_film.glsl"
FILMED, HALF = "genglsl/lib/microfacet_film.glsl", "genglsl/lib/half_vector.glsl"

OPAQUE = "bsdf.throughput = vec3(1.0 - clamp(weight, 0.0, 1.0));"

# Mutations of shaders by node title. Each row holds the file, the original code, the new code, the
# check that detects the mutation, parts of one cause in the diagnosis, and the verdict unless the
# verdict is "failed". In the new code, OLD stands for the original code.
WRONG = {
    "oren_nayar_diffuse_bsdf, energy_compensation true": (
        (LOBE, "N = mx_forward_facing_normal(N, wo);", "roughness = max(roughness, 0.1);\n    OLD", "lambert",
         ("region",)),
        (LOBE, "mx_environment_irradiance(N) * weight", "0.99 * OLD", "furnace",
         ("fault", "scaled", 0.99)),
        (LOBE, "brdf * mu_i * weight * closureData.occlusion", "brdf * mu_i * closureData.occlusion", "value",
         ("fault", "weight_ignored_above_0")),
        (LOBE, "mx_environment_irradiance(N) * weight", "OLD * closureData.occlusion", "environment",
         ("fault", "occlusion_by_caller")),
        (LOBE, OPAQUE, "", "throughput",
         ("not_zero", "throughput", 1.0, "direct", "environment", "transmission", "emission")),
        (LOBE, "1.0 - clamp(weight, 0.0, 1.0)", "0.0", "throughput",
         ("not_zero", "throughput", 0.0, "weight_not_1", "direct", "environment", "transmission", "emission")),
        (LOBE, "N = mx_forward_facing_normal(N, wo);", "", "frame",
         ("normal_away",)),
        (LOBE, "bsdf.response = brdf", "if (mu_o == 1.0) brdf *= 2.0;\n        OLD", "value",
         ("viewer_along_normal",)),
        (LOBE, "min(dot(N, wo), 1.0)", "dot(N, wo)", "environment",
         ("not finite", "viewer_above_1")),
        (LOBE, "N = mx_forward_facing_normal(N, wo);", "color = color.bgr;\n    OLD", "value",
         ("fault", "channels_exchanged", "blue", "green", "red")),
        (LOBE, "N = mx_forward_facing_normal(N, wo);", "color = max(color, 0.0);\n    OLD", "negative", ("negative_color",)),
        (LOBE, "energy_compensation ? eon_brdf_mu", "!OLD", "value", ("model", 0.0)),
        (LOBE, "N = mx_forward_facing_normal(N, wo);", "if (fwidth(color.r) + fwidth(roughness) == 0.0) color *= 0.5;\n    OLD",
         "states", ("constant inputs",)),
        (LOBE, "N = mx_forward_facing_normal(N, wo);", "roughness += 0.5 * dFdx(roughness);\n    OLD", "value",
         ("beside_equal_pixels",)),
        # The next two shaders try to recognize a test by the renamed function `main`, or by the
        # number of lights.
        (LOBE, "bsdf.response = brdf", "#ifndef main\n        brdf *= 0.5;\n#endif\n        OLD", "value",
         ("fault", "scaled", 0.5)),
        (LOBE, "bsdf.response = brdf", "if (u_numActiveLightSources > 1) brdf *= 0.9;\n        OLD", "value",
         ("fault", "scaled", 0.9)),
    ),
    "eon_diffuse_bsdf": (
        (LOBE, "brdf * mu_i * weight * closureData.occlusion", "brdf * mu_i * weight", "value",
         ("fault", "occlusion_ignored")),
        (LOBE, "weight <= 0.0", "OLD1", "value", ("weight_within",)),
        (LOBE, "irradiance(N)", "irradiance(-N)", "surroundings",
         ("lookup_opposite",)),
        (LOBE, "N = mx_forward_facing_normal(N, wo);", "roughness = 0.3 + 1e-6 * roughness;\n    OLD", "inputs",
         ("inputs_without_effect", "roughness")),
        (LOBE, "N = mx_forward_facing_normal(N, wo);", "roughness *= roughness;\n    OLD", "environment",
         ("fault", "roughness_squared")),
    ),
    "oren_nayar_diffuse_bsdf, energy_compensation false": (
        (LOBE, "mx_forward_facing_normal(N, wo)", "mx_forward_facing_normal(closureData.N, wo)", "frame",
         ("normal_of_surface",)),
        (LOBE, "bsdf.response = brdf", "if (wo == wi) brdf *= 1.5;\n        OLD", "value",
         ("retro_reflection",)),
        (LOBE, "clamp(dot(N, wi), 0.0, 1.0)", "min(abs(dot(N, wi)), 1.0)", "value",
         ("light_below_horizon",)),
        (LOBE, "brdf * mu_i", "3.14159265 * OLD", "value", ("fault", "pi_missing")),
    ),
    "translucent_bsdf": (
        ("genglsl/translucent_bsdf.glsl", "mx_environment_irradiance(N)", "mx_environment_irradiance(-N)",
         "surroundings", ("lookup_other_side",)),
        ("mx_translucent_bsdf.glsl", "color * weight * NdotL", "color * NdotL", "value",
         ("fault", "weight_ignored_above_0")),
        ("genglsl/translucent_bsdf.glsl", "0.0, 1.0) * M_PI_INV", "OLD * closureData.occlusion", "value",
         ("fault", "occlusion_twice")),
        ("genglsl/translucent_bsdf.glsl", "clamp(dot(N, closureData.L), 0.0, 1.0)", "abs(dot(N, closureData.L))", "value",
         ("light_above_horizon",)),
        ("mx_translucent_bsdf.glsl", "N = -N;", "", "value", ("model", "a reflection instead")),
    ),
    "subsurface_bsdf": (
        ("genglsl/subsurface_bsdf.glsl", "fwidth(", "dFdx(", "states", ("a surface that bends",)),
        ("genglsl/subsurface_bsdf.glsl", "fwidth(closureData.N)", "fwidth(N)", "frame", ("direct", "beside_equal_pixels")),
        ("genglsl/subsurface_bsdf.glsl", "curvature * max(radius, vec3(0.0))",
         "curvature * vec3(0.5) * step(0.0, radius.x + 1.0)", "sphere",
         ("model", "the profile of a mean free path of 0.5, whatever the radius")),
        ("genglsl/subsurface_bsdf.glsl", "max(1.0 - anisotropy, 1e-3)", "max(1.0 - abs(anisotropy), 1e-3)", "sphere",
         ("model", "the profile, whatever the sign of the anisotropy")),
        ("genglsl/lib/subsurface_blur.glsl", "(1.0 + t * t)", "(2.0 * t + t * t)", "sphere",
         ("model", "a far exponential of 1.5 mean free paths instead of 3")),
    ),
    "conical_edf": (
        ("genglsl/conical_edf.glsl", "mu >= inner", "mu > inner", "radiance", ("region",)),
        ("genglsl/conical_edf.glsl", "max(inner - outer, 1e-8)", "max(inner - outer, 1e-4)", "radiance", ()),
        ("genglsl/conical_edf.glsl", "w / 42.0 * tail", "w / 42.0", "radiance", ("region",)),
        ("genglsl/conical_edf.glsl", "u = angle", "u = max(angle, 6.4)", "radiance", ("value", "inner_angle", 6.4)),
        ("genglsl/conical_edf.glsl", "u = angle", "u = min(2.0 * angle, 360.0)", "radiance",
         ("model", "a cone whose angles count from its axis")),
        ("genglsl/conical_edf.glsl", "float mu = max(", "color = min(color, 1.0);\n        OLD", "radiance",
         ("fault", "color_clamped")),
        ("genglsl/conical_edf.glsl", "else if (mu >= inner)", "else if (mu >= inner && outer_angle < inner_angle)", "radiance", ()),
        ("genglsl/conical_edf.glsl", "dot(N, ", "dot(closureData.N, ", "inputs", ("inputs_without_effect", "normal")),
    ),
    "dielectric_bsdf, scatter_mode R": (
        (FACETS, "F.visible * scale, 0.0)", "F.visible * scale * tint, 0.0)", "layering", ("model", COLORED), "differs"),
        ("mx_dielectric_bsdf.glsl", "(4.0 * NdotV)", "NdotV", "value",
         ("model", "no factor 4 in the denominator, and MaterialX's compensation")),
        ("mx_dielectric_bsdf.glsl", "mx_ggx_smith_G2(NdotL, NdotV, avgAlpha)",
         "mx_ggx_smith_G1(NdotL, avgAlpha) * mx_ggx_smith_G1(NdotV, avgAlpha)", "shape",
         ("model", "masking and shadowing uncorrelated, and MaterialX's compensation")),
        ("mx_dielectric_bsdf.glsl", "X = normalize(X - dot(X, N) * N);",
         "X = normalize(cross(vec3(0.0, 1.0, 0.0), N));", "frame", ("direct", "input_ignored", "tangent")),
        ("mx_dielectric_bsdf.glsl", "(ior, thinfilm_thickness, ", "(ior, 0.0, ", "inputs",
         ("inputs_without_effect", "thinfilm_thickness", "thinfilm_ior")),
        ("mx_dielectric_bsdf.glsl", "1.0 - dirAlbedo * weight;", "vec3(1.0);", "transmission",
         ("model", "all light passes")),
        ("genglsl/dielectric_bsdf.glsl", "eonlib_fresnel_dielectric_avg(ior)", "eonlib_fresnel_dielectric_avg(max(ior, 1.0))", "value",
         ("value", "ior", 0.99)),
        ("genglsl/dielectric_bsdf.glsl", "if (ior < 1.0)", "if (ior < 1.03 && ior != 1.0)", "domain",
         ("throughput_outside", "ior", 1.0015, 1.02)),
        ("genglsl/lib/fresnel_dielectric.glsl", "/ max((ior - 1.0) * (ior + 1.0), 1e-9)", "", "domain",
         ("throughput_outside", "ior", 1.0015, 1.02)),
        ("genglsl/dielectric_bsdf.glsl", "vec3(eonlib_fresnel_dielectric(lobe.mu_h, ior))",
         "vec3(ior == 0.0 && lobe.mu_h > 0.999 ? 0.0 : eonlib_fresnel_dielectric(lobe.mu_h, ior))", "domain",
         ("value_outside", "ior", 0.0)),
        ("genglsl/dielectric_bsdf.glsl", "vec3(1.0 - passing.x)",
         "vec3(eonlib_fresnel_dielectric(ggx_cosine_dielectric(lobe.mu_o, lobe.alpha, 1.0 / ior), ior))", "denser", ()),
        (FACETS, "F.outside * scale", "OLD * step(2e-6, lobe.alpha)", "environment", ("roughness_zero",)),
        (FACETS, "mirrored ? reflect(-closureData.V, N) :", "", "retroreflection", ()),
    ),
    "generalized_schlick_bsdf, scatter_mode R": (
        (FACETS, "reflect(-closureData.V, N)", "reflect(-closureData.V, closureData.N)", "frame",
         ("retroreflective_normal",)),
        ("genglsl/generalized_schlick_bsdf.glsl", "max(mx_fresnel_hoffman_schlick(lobe.mu_h, fd), 0.0)",
         "mx_fresnel_hoffman_schlick(lobe.mu_h, fd)", "dark", ("curve_below_0",), "differs"),
        ("mx_generalized_schlick_bsdf.glsl", "clamp(roughness, M_FLOAT_EPS, 1.0)",
         "clamp(roughness * roughness, M_FLOAT_EPS, 1.0)", "shape",
         ("model", "roughness squared once more, and MaterialX's compensation")),
        ("mx_generalized_schlick_bsdf.glsl", "mx_ggx_energy_compensation(NdotV, avgAlpha, F)", "vec3(1.0)",
         "lossless", ("model", "no energy compensation")),
        ("mx_generalized_schlick_bsdf.glsl", "X = normalize(X - dot(X, N) * N);",
         "X = normalize(cross(vec3(0.0, 1.0, 0.0), N));", "anisotropy", ("input_ignored", "tangent")),
        ("genglsl/generalized_schlick_bsdf.glsl", "eonlib_fresnel_schlick_avg(fd.F0, fd.F90,", "eonlib_fresnel_schlick_avg(fd.F0, vec3(1.0),",
         "value", ("cure", "color90", 1.0)),
        ("mx_generalized_schlick_bsdf.glsl", "dirAlbedo = mx_ggx_dir_albedo",
         "dirAlbedo = 1.0 + 0.0 * mx_ggx_dir_albedo", "layering", ()),
        (FACETS, "clamp(dot(lobe.N, lobe.wo), M_FLOAT_EPS, 1.0)", "dot(lobe.N, lobe.wo)", "finite",
         ("not finite", "both_on_horizon")),
        (HALF, "wi + wo + 1e-15 * N", "wi + wo", "finite",
         ("not finite", "opposite")),
    ),
    "conductor_bsdf": (
        (FACETS, "lobe.closure != CLOSURE_TYPE_TRANSMISSION", "lobe.closure == CLOSURE_TYPE_REFLECTION", "sky",
         ("retroreflective_environment",)),
        ("genglsl/conductor_bsdf.glsl", "MicrofacetLobe lobe = microfacet_lobe(", "ior.x = min(ior.x, 2.0);\n        OLD",
         "value", ("value", "ior", 2.0, "red")),
        (FACETS, "clamp(roughness, M_FLOAT_EPS, 1.0)",
         "clamp(abs(roughness.x - roughness.y) < 0.1 ? roughness.xx : roughness, M_FLOAT_EPS, 1.0)", "anisotropic_value",
         ("roughness", "difference")),
        (FACETS, "lobe.X = normalize(X - dot(X, lobe.N) * lobe.N);",
         "lobe.X = X - dot(X, lobe.N) * lobe.N;", "states",
         ("a tangent that leans and is not of length 1",)),
        ("genglsl/lib/ggx_albedo.glsl", "float ggx_missing(float mu, float alpha)\n{",
         "vec2 kept = vec2(-1.0);\nOLD\n    kept = kept.x == alpha ? kept : vec2(alpha, mu);\n    mu = kept.y;", "states",
         ("two lobes that differ in normal",)),
        (FACETS, "    return vec3(dot(w, lobe.X),", "    if (min(min(lobe.N.x, lobe.N.y), lobe.N.z) < -0.9999) lobe.X = lobe.N.yzx;\nOLD", "states",
         ("the normal on an axis",)),
        ("genglsl/conductor_bsdf.glsl", "MicrofacetLobe lobe = microfacet_lobe(",
         "if (closureData.closureType == CLOSURE_TYPE_INDIRECT) X = cross(N, X);\n        OLD", "sky",
         ("other_directions",)),
        ("genglsl/conductor_bsdf.glsl", "MicrofacetLobe lobe = microfacet_lobe(", "ior += 0.2 * step(0.1, ior) * step(ior, vec3(0.4));\n        OLD",
         "domain", ("value_outside", "ior", 0.18)),
        ("mx_conductor_bsdf.glsl", "V = retroreflective", "V = false", "retroreflection",
         ("input_ignored", "retroreflective")),
    ),
    "burley_diffuse_bsdf": (
        ("mx_burley_diffuse_bsdf.glsl", "LdotH, roughness)", "LdotH, 0.0)", "value",
         ("model", "Burley diffuse of roughness 0, without retro-reflection")),
        ("mx_burley_diffuse_bsdf.glsl", "mx_burley_diffuse(NdotV, NdotL", "mx_burley_diffuse(NdotV, NdotV",
         "reciprocity", ("no_model", "Burley diffuse")),
        ("mx_burley_diffuse_bsdf.glsl", "* M_PI_INV;", "* M_PI_INV + 0.001;", "black", ()),
        ("genglsl/burley_diffuse_bsdf.glsl", "N = mx_forward_facing_normal(N, wo);", "N = closureData.N;", "frame",
         ("direct", "input_ignored", "normal")),
        # The graphics drivers under test turn NaN into 0, even if the clamp is removed.
        ("genglsl/burley_diffuse_bsdf.glsl", "clamp(dot(wi, eonlib_half_vector(wo, wi, N)), 0.0, 1.0)",
         "dot(wi, normalize(wi + wo))", "finite", ("not finite", "opposite")),
        ("mx_burley_diffuse_bsdf.glsl", "(N, V);", "(vec3(0.0, 0.0, 1.0), V);", "frame",
         ("direct", "normal_of_surface")),
    ),
    "sheen_bsdf, mode conty_kulla": (
        ("genglsl/sheen_bsdf.glsl", "mode == 0 ? 1e-4 : 0.01", "0.01", "domain",
         ("albedo_outside", "roughness", 0.001, 0.0001)),
        ("mx_sheen_bsdf.glsl", "mode == 0", "mode != 0", "environment", ("model", "Zeltner sheen")),
    ),
    "sheen_bsdf, mode zeltner": (
        ("genglsl/sheen_bsdf.glsl", "abs(N.x) < 0.5 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0)", "vec3(1.0, 0.0, 0.0)",
         "states", ("the normal on an axis: the view along it",)),
        ("mx_sheen_bsdf.glsl", "roughness = clamp(roughness, 0.01, 1.0);", "", "finite",
         ("not finite", "roughness_zero")),
        ("mx_sheen_bsdf.glsl", "1.0 - dirAlbedo * weight", "0.0", "layer", ()),
        ("genglsl/sheen_bsdf.glsl", "vec3(max(1.0 - albedo * weight, 0.0))", "max(1.0 - albedo * color * weight, 0.0)",
         "layering", ("model", COLORED), "differs"),
    ),
    "chiang_hair_bsdf": (
        (HAIR, "M = chiang_hair_along(tilted, inclined_o, r.x)",
         "M = chiang_hair_along(chiang_hair_product(inclined_o, chiang_hair_product(tilted, inclined_i * vec2(1.0, -1.0)) / dot(inclined_i, inclined_i)), inclined_i, r.x)",
         "tilted_lobes", ("model", "the viewer's inclination tilted instead of the light's")),
        (HAIR, "M * 0.5 * M_PI_INV", "M * 0.5 * M_PI", "each_lobe",
         ("model", "N of TRRT+ pi/2 instead of 1/(2 pi)")),
        (HAIR, "max(r, vec2(1e-8, 1e-4))", "clamp(r, 0.001, 1.0)", "wide_lobes",
         ("model", "roughness clamped to [0.001, 1]")),
        (HAIR, "else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)", "else", "throughput",
         ("not_zero", "response", "transmission", "emission")),
        (HAIR, "total * closureData", "4.0 * OLD", "energy", ("fault", "scaled", 4.0)),
        (HAIR, "X = normalize(X - dot(X, N) * N);", "X = normalize(cross(vec3(0.0, 1.0, 0.0), N));", "frame",
         ("direct", "input_ignored", "curve_direction")),
        (HAIR, "max(1.0 - F * T, 1e-7)", "(1.0 - F * T)", "finite", ("not finite",)),
        (HAIR, "c > 0.0 ? vec2(wo.z, -wo.y) / c : vec2(1.0, 0.0)", "vec2(wo.z, -wo.y) / c", "finite",
         ("viewer_along_tangent",)),
        (HAIR, "back * mx_environment_irradiance(-N)", "back * mx_environment_irradiance(N)", "surroundings",
         ("lookup_viewer_side",)),
    ),
    "conductor_bsdf, thin film": (
        (FILMED, "F.outside = F.visible;", "F.outside = lobe.roughness.x == lobe.roughness.y ? F.visible : F.average;",
         "film_brushed", ()),
        ("genglsl/conductor_bsdf.glsl", "thinfilm_thickness,\n                                                   thinfilm_ior);",
         "retroreflective ? 0.0 : OLD", "retroreflection", ()),
        (FILMED, "F.average += node.w * F.value;", "F.average = thin_film_fresnel(2.0 / 3.0, 0.0, fd);",
         "film_average", ("average_at_two_thirds",)),
        (FACETS, "1.0 + F.average * ((1.0 - lobe.albedo) / lobe.albedo)", "vec3(1.0)", "film_average",
         ("model", "no energy compensation")),
        (FILM, "z_s.im *= r21_s;", "z_s.im *= -r21_s;", "value", ()),
        (FILM, "4.3278e9, 4.5282e9", "4.3728e9, 4.5282e9", "film_curve", ()),
        (FILM, "THIN_FILM_ORDER_RATIO 0.6", "THIN_FILM_ORDER_RATIO 0.006", "film_orders", ()),
        (FILM, "return clamp(mean +", "return 1.1 + clamp(mean +", "film_energy", ()),
        (FILMED, "F.visible += node", "F.visible += 0.5 * node", "environment", ()),
        (FILMED, "0.43737,", "0.33737,", "film_smooth", ()),
        (FILMED, "void microfacet_film(MicrofacetLobe lobe, FresnelData fd, inout MicrofacetFresnel F)\n{",
         "vec3 kept = vec3(-1.0);\nOLD\n    kept = kept.x < 0.0 ? fd.ior : kept;\n    fd.ior = kept;", "states",
         ("two lobes that differ in ior",)),
    ),
    "dielectric_bsdf, thin film": (
        ("genglsl/dielectric_bsdf.glsl", "(ior, thinfilm_thickness, thinfilm_ior)", "(ior, thinfilm_ior, thinfilm_thickness)",
         "value", ("fault", "inputs_exchanged", "thinfilm_thickness", "thinfilm_ior")),
        (FILMED, "float mu = lobe.visible.x;\n        float alpha = lobe.visible.y;",
         "float mu = lobe.mu_o;\n        float alpha = lobe.alpha;", "anisotropic_throughput", ()),
        (FILM, "M_PI * fd.tf_thickness", "M_PI * min(fd.tf_thickness, 2000.0)", "domain",
         ("value_outside", "thinfilm_thickness", 2500.0, 3000.0, 6000.0, 100000.0)),
        (FILM, "max(fd.tf_ior, 1.0)", "max(fd.tf_ior, 1.005)", "film_limit", ()),
        (FILM, "return clamp(mean +", "return mean / step(1.0, fd.tf_ior) + clamp(mean +", "finite", ()),
    ),
    "uniform_edf": (
        ("mx_uniform_edf.glsl", "result = color;", "result = color * 0.31830989;", "radiance",
         ("model", "the color as an exitance, over pi")),
        ("mx_uniform_edf.glsl", "result = color;",
         "result = (dot(closureData.N, closureData.V) < 0.0) ? vec3(0.0) : color;", "back",
         ("model", "emission from the front alone"), "differs"),
    ),
    "generalized_schlick_edf": (
        ("mx_generalized_schlick_edf.glsl", "result = base * f;", "result = base;", "radiance",
         ("model", "the base without its curve")),
        ("mx_generalized_schlick_edf.glsl", "closureData.V), M_FLOAT_EPS", "closureData.V) * 0.5, M_FLOAT_EPS",
         "back", ()),
    ),
    "mix, EDF": (
        ("mx_mix_edf.glsl", "mix(bg, fg, ", "mix(fg, bg, ", "radiance", ()),
    ),
    "absorption_vdf": (
        ("genglsl/absorption_vdf.glsl", "if (closureData.closureType == CLOSURE_TYPE_TRANSMISSION)", "", "above",
         ("medium_in_reflection",)),
        ("genglsl/layer_bsdf.glsl", "base.response * passed", "base.response", "between", ("medium_between",)),
    ),
    "anisotropic_vdf": (
        ("genglsl/anisotropic_vdf.glsl", "absorption + scattering", "absorption + min(scattering, 2.0)", "transmittance",
         ("value", "scattering", 2.0)),
    ),
    "mix, VDF": (
        ("genglsl/mix_vdf.glsl", "vec3(1.0 - share)", "vec3(share)", "transmittance", ()),
    ),
    "layer, under a colored sum": (
        ("genglsl/sheen_bsdf.glsl", "vec3(max(1.0 - albedo * weight, 0.0))", "max(1.0 - albedo * color * weight, 0.0)",
         "combination", ("model", COLORED), "differs"),
    ),
    "dielectric_bsdf, scatter_mode T": (
        ("genglsl/dielectric_bsdf.glsl", "ior < 1.0 && scatter_mode != 0", "false", "inside", ()),
        (CLEAR, "* (below ? vec3(1.0) : passed) * weight;", "OLD\n        bsdf.response *= weight;", "transmitted", ("weight_not_1",)),
        ("mx_dielectric_bsdf.glsl", "scatter_mode == 1)", "scatter_mode == 7)", "kept", ()),
        ("mx_dielectric_bsdf.glsl", "mx_surface_transmission(N, V, X, safeAlpha, distribution, fd, safeTint)",
         "mx_surface_transmission(N, V, X, safeAlpha, distribution, mx_init_fresnel_dielectric(1.0, thinfilm_thickness, thinfilm_ior), safeTint)",
         "critical", ()),
        ("genglsl/lib/fresnel_dielectric.glsl", "* max(mu, 1.0 / k)", "/ k", "critical", ()),
        ("mx_dielectric_bsdf.glsl", "mx_surface_transmission(N, V, X, safeAlpha, distribution, fd, safeTint)",
         "mx_surface_transmission(N, V, X, safeAlpha, distribution, mx_init_fresnel_dielectric(1.0 / ior, thinfilm_thickness, thinfilm_ior), safeTint)",
         "refraction", ()),
        ("genglsl/dielectric_bsdf.glsl", "max(tint, 0.0)", "abs(tint)", "negative", ("negative_color",)),
        (CLEAR, "lobe.X, lobe.roughness, distribution, fd", "lobe.X, lobe.roughness.yx, distribution, fd",
         "rough_refraction", ("other_refraction",)),
    ),
    "dielectric_bsdf, scatter_mode RT": (
        (CLEAR, "CLOSURE_TYPE_TRANSMISSION && scatter_mode != 0", "CLOSURE_TYPE_TRANSMISSION", "kept",
         ("mode_R_transmits",)),
        ("mx_dielectric_bsdf.glsl", "mx_surface_transmission(N, V, X, safeAlpha, distribution, fd, safeTint)",
         "mx_surface_transmission(N, V, X, safeAlpha, distribution, fd, vec3(1.0))", "transmitted_inputs", ()),
    ),
    "roughness_anisotropy": (
        ("mx_roughness_anisotropy.glsl", "sqrt(1.0 - clamp(anisotropy, 0.0, 0.98))", "sqrt(1.0 - 0.9 * anisotropy)",
         "output", ("model", "Burley's aspect of 2012"), "differs"),
        ("mx_roughness_anisotropy.glsl",
         "        result.x = min(roughness_sqr / aspect, 1.0);\n        result.y = roughness_sqr * aspect;",
         "        aspect = 1.0 - anisotropy;\n        result.x = roughness_sqr * sqrt(2.0 / (1.0 + aspect * aspect));\n        result.y = aspect * result.x;",
         "output", ("model", "OpenPBR's aspect"), "differs"),
    ),
    "roughness_dual": (
        ("mx_roughness_dual.glsl",
         "roughness.x * roughness.x, M_FLOAT_EPS, 1.0);\n    result.y = clamp(roughness.y * roughness.y",
         "roughness.x, M_FLOAT_EPS, 1.0);\n    result.y = clamp(roughness.y", "output",
         ("model", "a roughness that is not squared")),
    ),
    "artistic_ior, ior": (
        ("mx_artistic_ior.glsl", "mix(n_max, n_min, edge_color)", "mix(n_min, n_max, edge_color)", "output",
         ("model", "the ends of n exchanged")),
    ),
    "artistic_ior, extinction": (
        ("mx_artistic_ior.glsl", "(np1*np1 * r - nm1*nm1)", "(np1*np1 * r)", "output", ()),
    ),
    "chiang_hair_roughness, roughness_TRT": (
        ("mx_chiang_hair_bsdf.glsl", "v * scale_TRT * scale_TRT", "v * 4.0", "inputs",
         ("inputs_without_effect", "scale_TRT")),
        ("mx_chiang_hair_bsdf.glsl", "v = v * v;", "", "output", ("no_model",)),
    ),
    "deon_hair_absorption_from_melanin": (
        ("mx_chiang_hair_bsdf.glsl", "eumelanin * -log(eumelanin_color) + pheomelanin * -log(pheomelanin_color)",
         "pheomelanin * -log(eumelanin_color) + eumelanin * -log(pheomelanin_color)", "output",
         ("model", "the shares of both melanins exchanged")),
        ("genglsl/deon_hair_absorption_from_melanin.glsl", "melanin_concentration, melanin_redness,",
         "melanin_concentration, min(melanin_redness, 0.8),", "output", ("value", "melanin_redness", 0.8)),
    ),
    "chiang_hair_absorption_from_color": (
        ("mx_chiang_hair_bsdf.glsl", "min(max(color, 0.001), vec3(1.0))", "color", "output_finite",
         ("value", "color", 0.0)),
    ),
    "add": (
        ("genglsl/add_bsdf.glsl", "in1.response + in2.response", "in1.response", "combination", ()),
    ),
    "layer, under a mix of a sum": (
        ("genglsl/add_bsdf.glsl", "= in1.throughput + in2.throughput - 1.0",
         "= max(in1.throughput + in2.throughput - 1.0, 0.0)", "combination", ()),
        ("genglsl/layer_bsdf.glsl", "max(top.throughput, 0.0)", "top.throughput", "combination", ()),
    ),
    "layer": (
        ("genglsl/layer_bsdf.glsl", "base.response * passed", "base.response", "combination", ("a base that receives all light",)),
        ("genglsl/layer_bsdf.glsl", "passed * base.throughput", "passed", "combined_throughput", ()),
    ),
    "mix, of a layer under a sum": (
        ("genglsl/layer_bsdf.glsl", "min(top.throughput, 0.0) + ", "", "combined_throughput", (), DIFFERS),
    ),
    "multiply, in2 float": (
        ("genglsl/multiply_bsdfF.glsl", "clamp(in2, 0.0, 1.0)", "in2", "factor", ("factor_not_clamped",),
         "differs"),
    ),
    "open_pbr_surface, every lobe": (
        (FILM, "4.0e-9 * M_PI", "4.0e-10 * M_PI", "lobes_film", ()),
        (CLEAR, "max(1.0 - F.visible * mix(F.average, vec3(1.0), lobe.albedo), 0.0)", "vec3(1.0)", "glass", ()),
        (FACETS, "bsdf.throughput = max(1.0 - lobe.albedo", "bsdf.throughput = max(1.05 - lobe.albedo", "glass", ()),
    ),
    "standard_surface, every lobe": (
        (FACETS, "vec3(lobe.roughness, 1.0)", "vec3(lobe.alpha, lobe.alpha, 1.0)", "lobes", ()),
        ("genglsl/dielectric_bsdf.glsl", "                    bsdf);\n}\n\n",
         "                    bsdf);\n    bsdf.throughput = mix(bsdf.throughput, vec3(1.0), 0.3);\n}\n\n", "lobes",
         ("throughput_of_lobes", "dielectric_bsdf, scatter_mode R")),
    ),
    "UsdPreviewSurface, every lobe": (
        (FACETS, "bsdf.throughput = max(1.0 - lobe.albedo", "bsdf.throughput = max(1.002 - lobe.albedo", "lobes_mean",
         ()),
    ),
}  # fmt: skip
ASKED, PATH = "genglsl/path/interface.glsl", "genglsl/path/microfacets.glsl"
QUESTIONS, FIBER = "genglsl/path/lib/questions.glsl", "genglsl/path/hair.glsl"
RT, GLASS = "dielectric_bsdf, scatter_mode RT", "open_pbr_surface, every lobe"
STANDARD = "standard_surface, every lobe"
INSIDE, LOST = ("inside_is_not_outside",), ("light_from_inside",)
SCHLICK = "generalized_schlick_bsdf, scatter_mode RT"
INDEX = "path_inside && !path_thin ? 1.0 / max(ior, PATH_LEAST_BEND) : ior"
# Mutations of the shaders for path tracers. Each row starts with the node's title and continues
# like a row of WRONG.
PATHS = (
    (RT, ASKED, "pdf = path_root.y * path_out.a;", "pdf = 3.0 * path_root.y * path_out.a;", "sample",
     ("sampled_density", "inside")),
    (RT, ASKED, "weight = path_root", "weight = 1.0015 * path_root", "sample",
     ("drawn_weight", "outside")),
    (STANDARD, ASKED, "weight = path_root", "weight = 1.0015 * path_root", "sample", ("drawn_weight",)),
    (RT, PATH, INDEX, "ior", "path_inside", INSIDE),
    (GLASS, PATH, INDEX, "ior", "path_inside", INSIDE),
    (RT, PATH, "through *= path_reversed;", "through *= path_inside ? 3.0 : path_reversed;", "path_inside", INSIDE),
    (RT, PATH, "scatter_mode == 0 ? 0.0", "scatter_mode == 0 || path_inside ? 0.0", "path_inside", INSIDE),
    (RT, PATH, "through *= path_reversed;", "", "path_leaving", LOST),
    (SCHLICK, PATH, "lobe.mu_h = max(-dot(end, path_facet), 0.0);", "", "path_energy", LOST),
    (SCHLICK, PATH, "F.value += max(", "F.value += 0.5 * max(", "path_energy", LOST),
    (RT, PATH, "path_inside ? path_eta : ior", "ior", "path_inside", INSIDE),
    (SCHLICK, PATH, "scatter_mode == 0 ? 0.0 : 1.0", "scatter_mode == 0 ? 0.0 : path_inside ? 1.0 : 0.5", "path_energy", LOST),
    ("gltf_pbr, every lobe", PATH, "scatter_mode == 0 ? 0.0 : 1.0", "scatter_mode == 0 ? 0.0 : path_inside ? 1.0 : 0.5",
     "path_albedo", ("other_path_albedo",)),
    (RT, PATH, "path_u.xy, wo, lobe.roughness)", "path_u.xy, wo, lobe.roughness.xx)", "pdf", ("drawn_density",)),
    (RT, PATH, "lobe.wi = path_turned(lobe.wi, lobe.N)", "lobe.wi = path_turned(lobe.wi, closureData.N)", "pdf",
     ("drawn_density",)),
    ("standard_surface, every lobe", PATH, "path_thin ? path_mirrored(wi, lobe.N)", "path_thin ? wi", "pdf", ("drawn_density",)),
    ("burley_diffuse_bsdf", "genglsl/path/diffuse.glsl", "path_cosine(mx_forward_facing_normal(N, path_wo), bsdf);",
     "path_cosine(N, bsdf);", "sample", ("undrawn_light",)),
    ("burley_diffuse_bsdf", QUESTIONS, "closureData.occlusion = 1.0;", "closureData.occlusion = path_inside ? 0.5 : 1.0;",
     "path_value", ("other_path_value",)),
    (RT, PATH, "below && retroreflective", "false", "pdf", ("drawn_density", "outside")),
    (RT, PATH, "? 2.0 : 1.0;", "? 1.0 : 1.0;", "pdf", ("drawn_density", "inside")),
    ("chiang_hair_bsdf", FIBER, "abs(tilted.x) / (c", "max(tilted.x, 0.0) / (c", "sample", ("undrawn_light",)),
    ("conductor_bsdf", PATH, "wo.z = lobe.mu_o;", "wo = path_local(closureData.V, lobe.X, lobe.N);\n        OLD", "pdf", ()),
    ("conductor_bsdf", ASKED, "path_wi = ", "if (wi.z > 0.9) wi = p.normal;\n    OLD", "path_value", ("other_path_value",)),
    ("burley_diffuse_bsdf", QUESTIONS, "V = path_wo;", "V = vec3(path_wo.xy, abs(path_wo.z));", "path_value", ()),
    (STANDARD, ASKED, "return path_root * path_out.a;", "return path_root;", "path_value", ()),
    (STANDARD, ASKED, "return path_out.a;", "return 1.0 - path_out.a;", "path_value", ()),
    (STANDARD, ASKED, "return path_out.rgb;", "return path_out.rgb * path_out.a;", "path_value", ()),
    ("conical_edf", ASKED, "wo, wo, vec3(0.0));\n    return path_out.rgb;", "-wo, wo, vec3(0.0));\n    return path_out.rgb;",
     "path_emission", ("other_path_emission",)),
    ("eon_diffuse_bsdf", "genglsl/path/random.glsl", "vec4(v >> 8u)", "vec4(v >> 9u)", "path_random",
     ("other_random_numbers",)),
)  # fmt: skip
ROWS = [(title, *row) for title, rows in WRONG.items() for row in rows] + list(PATHS)


def parameters(row):
    """Turn a row of ROWS into a test parameter, marked `whole` if shaders compile slowly."""
    title, check = row[0], row[4]
    is_long = check in DRAWN or any(each in title for each in ("thin film", "every lobe"))
    marks = pytest.mark.whole if is_long else ()
    return pytest.param(row, id=f"{check}, {title}", marks=marks)


@pytest.mark.parametrize("row", [parameters(row) for row in ROWS])
def test_a_wrong_line_fails_the_check_meant_for_it_and_is_named(judged, tmp_path, row):
    title, file, old, new, check, cause, *verdict = row
    library = wrong_library(tmp_path, file, old, new.replace("OLD", old))
    result = judged(check, title, library=library)
    assert result.verdict == (verdict or [FAILED])[0] and result.control.caught
    assert has(result, *cause)


def test_an_emission_that_a_surface_shader_drops_is_named(judged, tmp_path):
    change = ('interfacename="emission_color"', 'value="1.0, 1.0, 1.0"')
    library = wrong_stock(tmp_path, "bxdf/open_pbr_surface.mtlx", change)
    result = judged("reach", "open_pbr_surface, every lobe", library=library)
    assert result.verdict == FAILED and has(result, "changes_nothing", "emission_color")


@pytest.mark.parametrize("host", ["gl", "webgl", "vulkan", "slang", "osl"])
def test_a_color_that_is_not_decoded_from_srgb_is_named(judged, tmp_path, host):
    curve = {"2.4": "1.0", "1.055": "1.0", "0.055": "0.0", "12.92": "1.0"}
    changes = ((f'value="{old}"', f'value="{new}"') for old, new in curve.items())
    library = wrong_stock(tmp_path, "cmlib/cmlib_ng.mtlx", *changes)
    result = judged("color_space", "burley_diffuse_bsdf", host, library)
    assert result.verdict == FAILED and result.control.caught
    assert has(result, "model", "the color, not decoded from sRGB")


SWAPPED = "uv = uv.yx;\n    result = "


@pytest.mark.parametrize(
    "host, old, new",
    [
        ("gl", ").rgb", ").bgr"),
        ("gl", "result = ", "uv = vec2(0.5);\n    result = "),
        ("gl", ").rgb", ").rgb;\n    result = pow(max(result, vec3(0.0)), vec3(2.2))"),
        *((host, "result = ", SWAPPED) for host in ("gl", "webgl", "vulkan", "wgsl")),
    ],
)
def test_a_color_that_an_image_node_reads_wrongly_is_wrong_in_inputs_from_an_image(
    judged, tmp_path, host, old, new
):
    library = wrong_stock(tmp_path, "stdlib/genglsl/mx_image_color3.glsl", (old, new))
    result = judged("states", "burley_diffuse_bsdf", host, library)
    assert result.verdict == FAILED and result.control.caught
    assert has(result, "state", "inputs from an image")


@pytest.mark.whole
def test_every_check_of_a_node_has_a_shader_that_it_fails(stock, run):
    """Each check detects an error in a row of ROWS, in stock MaterialX, or in another test."""
    failing = {row[4] for row in ROWS}
    failing |= {each.check for each in stock.results if each.verdict == FAILED}
    checks = {each.check for each in (*stock.results, *run.results) if each.host == "gl"}
    # Checks that are covered by `test_wrong_libraries.py`, or by the tests of a color space and of
    # a dropped input above.
    elsewhere = {"client", "color_space", "reach", "release"}
    elsewhere |= {"densities", "loss", "parts", "samples", "twins"}
    assert {*checks, *DRAWN} - failing == elsewhere


@pytest.mark.parametrize("host", ["webgl", "vulkan", "wgsl", "slang"])
@pytest.mark.parametrize(
    "old, check, cause",
    [
        ("N = mx_forward_facing_normal(N, wo);", "frame", ("region", "normal_away")),
        (OPAQUE, "throughput", ("not_zero", "throughput", 1.0, "direct")),
    ],
)
def test_the_other_hosts_see_what_is_around_the_model(judged, tmp_path, host, old, check, cause):
    result = judged(check, next(iter(WRONG)), host, wrong_library(tmp_path, LOBE, old, ""))
    assert result.verdict == FAILED and has(result, *cause)
