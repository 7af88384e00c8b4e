// SPDX-License-Identifier: Apache-2.0

#include "microfacet_film.glsl"

// Light through a microfacet surface, and lobes that may transmit.

// Light through a surface that transmits the fraction `share`. MaterialX refracts the view twice,
// as in a solid sphere. If MaterialX renders transmission as opacity, the result is the tint.
//
// MaterialX's squared cosine at the exit is 1 - n^2 (1 - q^2), where q is the cosine inside. If
// the square rounds to a negative number, the result is NaN. So wo is multiplied by 1 + d, which
// adds 8 d q^2 / n^2 to the square: at grazing 8e-6 n^2, three times the rounding of seven
// operations. Near n = 1 and above 4, d would be too large, so n is clamped to [1.001, 4]. Smooth
// surfaces keep n above 4 but enlarge the cosine of wo.
//
// The Schlick curve is F0 except at grazing. F0 and F90 set MaterialX's transmission to `share`.
//   sampled: (1 - F0) / G_1(mu)     prefiltered, with fits A and B: 1 - (A F0 + B F90)
vec3 microfacet_transmitted(MicrofacetLobe lobe, int distribution, FresnelData fd, vec3 share, vec3 tint)
{
    float n = max(fd.ior.x, MICROFACET_LEAST_INDEX);
    vec3 wo = lobe.wo;
    if (n > 4.0 && lobe.alpha <= M_FLOAT_EPS)
    {
        wo = normalize(wo + max(0.005 + 2e-3 * n - lobe.mu_o, 0.0) * lobe.N);
    }
    else if (n >= 1.0)
    {
        n = clamp(n, 1.001, 4.0);
        float n2 = n * n;
        wo *= 1.0 + 1e-6 * n2 * n2 * n2 / (n2 - 1.0);
    }
    float mu = clamp(dot(lobe.N, wo), M_FLOAT_EPS, 1.0);
    fd.model = FRESNEL_MODEL_SCHLICK;
    fd.airy = false;
    fd.ior = vec3(n);
#ifdef MX_REFRACTION_UNMASKED // patch 0009, genglsl/environment
    fd.F0 = 1.0 - share;
#else
    fd.F0 = 1.0 - mx_ggx_smith_G1(mu, lobe.alpha) * share;
#endif
    fd.F82 = vec3(1.0);
    vec3 AB = mx_ggx_dir_albedo(mu, lobe.alpha, vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0));
    fd.F90 = (1.0 - share - AB.x * fd.F0) / max(AB.y, 1e-6);
    fd.exponent = 1e9;
    return mx_surface_transmission(lobe.N, wo, lobe.X, lobe.roughness, distribution, fd, tint);
}

void microfacet_bsdf(ClosureData closureData, MicrofacetLobe lobe, FresnelData fd, MicrofacetFresnel F, vec3 tint,
                     float weight, int distribution, int scatter_mode, inout BSDF bsdf)
{
    microfacet_bsdf(closureData, lobe, fd, F, tint, weight, distribution, bsdf);
    if (lobe.closure == CLOSURE_TYPE_TRANSMISSION && scatter_mode != 0)
    {
        // In mode T, opacity ignores F, because the layer above subtracts reflected light.
        vec3 passed = max(1.0 - F.visible * mix(F.average, vec3(1.0), lobe.albedo), 0.0);
        bool below = scatter_mode == 1;
        bsdf.response = microfacet_transmitted(lobe, distribution, fd, below ? passed : vec3(1.0), tint)
                        * (below ? vec3(1.0) : passed) * weight;
    }
}
