// SPDX-License-Identifier: Apache-2.0

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"
#include "libraries/pbrlib/genglsl/lib/mx_microfacet.glsl"

// Node chiang_hair_bsdf: [MaterialX2026], Chiang Hair Model. The lobe p is A_p M_p N_p.
//
// Roughness is at least 1e-8 rad^2 along and 1e-4 rad around the fiber, to suit float32. In the
// local frame, x is the fiber and z is the normal.

// Scaled Bessel function exp(-x) I_0(x) for x >= 0: [AbramowitzStegun1964], 9.8.1 and 9.8.2.
// Relative error: 5e-7.
float chiang_hair_bessel(float x)
{
    float t = x / 3.75;
    if (t < 1.0)
    {
        t *= t;
        return exp(-x) * (1.0 + t * (3.5156229 + t * (3.0899424 + t * (1.2067492
             + t * (0.2659732 + t * (0.0360768 + t * 0.0045813))))));
    }
    t = 1.0 / t;
    return (0.39894228 + t * (0.01328592 + t * (0.00225319 + t * (-0.00157565
          + t * (0.00916281 + t * (-0.02057706 + t * (0.02635537
          + t * (-0.01647633 + t * 0.00392377)))))))) / sqrt(x);
}

// Norm 2 v sinh(1 / v) exp(-1 / v) of M_p for variance v. If v >= 1, sinh is a series. Relative
// error: 3e-8.
float chiang_hair_norm(float v)
{
    float u = 1.0 / v;
    float u2 = u * u;
    return v < 1.0 ? v * (1.0 - exp(-2.0 * u))
                   : 2.0 * exp(-u)
                     * (1.0 + u2 / 6.0 * (1.0 + u2 / 20.0 * (1.0 + u2 / 42.0 * (1.0 + u2 / 72.0))));
}

// Longitudinal lobe M_p for variance v. Inclinations are (cosine, sine). For the
// form without cancellation, see `longitudinal` in python/mxeon/models/hair.py.
float chiang_hair_along(vec2 inclined_i, vec2 inclined_o, float v)
{
    float c = abs(inclined_i.x);
    vec2 d = vec2(c - inclined_o.x, inclined_i.y + inclined_o.y);
    return exp(-0.5 * dot(d, d) / v) * chiang_hair_bessel(c * inclined_o.x / v)
           / chiang_hair_norm(v);
}

// Angle in [0, pi] between a vector and the x axis, by a polynomial (tools/fits/arc_tangent.py).
// Built-in arc tangents are off by 1e-6 or more.
float chiang_hair_angle(vec2 w)
{
    vec2 a = abs(w);
    float r = min(a.x, a.y) / max(max(a.x, a.y), 1e-30);
    float t = r / (1.0 + sqrt(1.0 + r * r));
    float z = t * t;
    float series = 0.99999998
                   + z * (-0.33332786 + z * (0.19974082 + z * (-0.13848490 + z * 0.07976292)));
    float angle = 2.0 * t * series;
    angle = a.y > a.x ? 0.5 * M_PI - angle : angle;
    return w.x < 0.0 ? M_PI - angle : angle;
}

// Azimuthal lobe N_p with scale s. `exit` has the angle between the light and the lobe's center.
float chiang_hair_around(vec2 exit, float s)
{
    float scale = sqrt(M_PI / 8.0) * s;
    float fall = exp(-chiang_hair_angle(exit) / scale);
    float rest = exp(-M_PI / scale);
    return fall * (1.0 + rest) / (scale * (1.0 + fall) * (1.0 + fall) * (1.0 - rest));
}

// Fresnel reflectance: [MaterialX2026], Dielectric Fresnel Equations, without cancellation.
float chiang_hair_fresnel(float mu, float ior)
{
    float gap = (ior - 1.0) * (ior + 1.0);
    float g2 = gap + mu * mu;
    if (g2 <= 0.0)
    {
        return gap < 0.0 ? 1.0 : 0.0;
    }
    float product = mu * sqrt(g2);
    float S2 = 1.0 - mu * mu;
    float amplitude = gap / ((sqrt(g2) + mu) * (sqrt(g2) + mu));
    float ratio = (product - S2) / (product + S2);
    return min(0.5 * amplitude * amplitude * (1.0 + ratio * ratio), 1.0);
}

// Product of complex numbers.
vec2 chiang_hair_product(vec2 a, vec2 b)
{
    return vec2(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}

// Cosine and sine of alpha in [-pi/2, pi/2], by series for alpha / 2. Error: 2e-9. SwiftShader's
// built-in functions are off by 1.9e-4.
vec2 chiang_hair_tilt(float alpha)
{
    float x = 0.5 * alpha;
    float z = x * x;
    float S = x * (1.0 - z / 6.0 * (1.0 - z / 20.0 * (1.0 - z / 42.0 * (1.0 - z / 72.0))));
    float C = 1.0
              - z / 2.0 * (1.0 - z / 12.0 * (1.0 - z / 30.0 * (1.0 - z / 56.0 * (1.0 - z / 90.0))));
    return chiang_hair_product(vec2(C, S), vec2(C, S));
}

// Terms that depend only on the view. The columns of A are the attenuations of R, TT and TRT;
// A_rest is the attenuation of TRRT+. In the cross-section, gamma_o and gamma_t are the angles of
// the view and of the refracted ray, as (cosine, sine).
struct ChiangHairSection
{
    mat3 A;
    vec3 A_rest;
    vec2 gamma_o;
    vec2 gamma_t;
};

ChiangHairSection chiang_hair_section(vec3 wo, float ior, vec3 absorption)
{
    ChiangHairSection section;
    float c = length(wo.yz);
    section.gamma_o = c > 0.0 ? vec2(wo.z, -wo.y) / c : vec2(1.0, 0.0);
    float inside = sqrt(max((ior - wo.x) * (ior + wo.x), 1e-12));
    float sine = clamp(-wo.y / inside, -1.0, 1.0);
    section.gamma_t = vec2(sqrt((1.0 - sine) * (1.0 + sine)), sine);

    float F = chiang_hair_fresnel(clamp(wo.z, 0.0, 1.0), ior);
    vec3 T = exp(-absorption * (2.0 * section.gamma_t.x * max(ior, 1e-6) / inside));
    vec3 TT = (1.0 - F) * (1.0 - F) * T;
    vec3 TRT = TT * F * T;
    section.A = mat3(vec3(F), TT, TRT);
    section.A_rest = TRT * F * T / max(1.0 - F * T, 1e-7);  // avoids 0 / 0 if F T = 1
    return section;
}

// Sum of the lobes: pi times the response. The columns of `tint` are for R, TT and TRT.
vec3 chiang_hair_sum(vec3 wo, vec3 wi, mat3 tint, vec2 roughness_R, vec2 roughness_TT, vec2 roughness_TRT, float ior,
                     float cuticle_angle, vec3 absorption)
{
    ChiangHairSection section = chiang_hair_section(wo, ior, absorption);

    // Inclination and azimuth of the light, relative to the lobe R.
    vec2 inclined_o = vec2(length(wo.yz), wo.x);
    vec2 inclined_i = vec2(length(wi.yz), wi.x);
    vec2 alpha = chiang_hair_tilt(M_PI * (cuticle_angle - 0.5));
    vec2 back = alpha * vec2(1.0, -1.0);  // rotation by -alpha
    vec2 tilted = chiang_hair_product(inclined_i, chiang_hair_product(alpha, alpha));
    vec2 exit = vec2(dot(wi.yz, wo.yz), wi.z * wo.y - wo.z * wi.y);
    exit = chiang_hair_product(exit, chiang_hair_product(section.gamma_o, section.gamma_o));
    // Rotation by pi - 2 gamma_t, from one lobe's center to the next.
    vec2 inside = -chiang_hair_product(section.gamma_t, section.gamma_t) * vec2(1.0, -1.0);

    vec3 total = vec3(0.0);
    for (int p = 0; p < 3; ++p)
    {
        vec2 r = p == 0 ? roughness_R : (p == 1 ? roughness_TT : roughness_TRT);
        r = max(r, vec2(1e-8, 1e-4));
        float M = chiang_hair_along(tilted, inclined_o, r.x);
        total += tint[p] * section.A[p] * M * chiang_hair_around(exit, r.y);
        exit = chiang_hair_product(exit, inside);
        tilted = chiang_hair_product(chiang_hair_product(tilted, back), chiang_hair_product(back, back));
    }

    // Add TRRT+, which is uniform in azimuth.
    float v = max(roughness_TRT.x, 1e-8);
    float M = chiang_hair_along(inclined_i, inclined_o, v);
    return total + tint[2] * section.A_rest * M * 0.5 * M_PI_INV;
}

void chiang_hair_bsdf(ClosureData closureData, vec3 tint_R, vec3 tint_TT, vec3 tint_TRT, float ior,
                      vec2 roughness_R, vec2 roughness_TT, vec2 roughness_TRT, float cuticle_angle,
                      vec3 absorption_coefficient, vec3 N, vec3 X, inout BSDF bsdf)
{
    bsdf.throughput = vec3(0.0);

    vec3 V = closureData.V;
    vec3 L = closureData.L;
    N = mx_forward_facing_normal(N, V);
    X = normalize(X - dot(X, N) * N);
    vec3 Y = cross(N, X);

    vec3 wo = vec3(dot(V, X), dot(V, Y), dot(V, N));
    mat3 tint = mat3(max(tint_R, vec3(0.0)), max(tint_TT, vec3(0.0)), max(tint_TRT, vec3(0.0)));

    if (closureData.closureType == CLOSURE_TYPE_REFLECTION)
    {
        vec3 wi = vec3(dot(L, X), dot(L, Y), dot(L, N));
        vec3 total = chiang_hair_sum(wo, wi, tint, roughness_R, roughness_TT, roughness_TRT, ior, cuticle_angle,
                                     absorption_coefficient);
        bsdf.response = total * closureData.occlusion * M_PI_INV;
    }
    else if (closureData.closureType == CLOSURE_TYPE_INDIRECT)
    {
        // R and TRT use irradiance from the viewer's side, TT from the far side, TRRT+ the mean.
        // The response is exact for an untilted cuticle in a uniform environment.
        ChiangHairSection section = chiang_hair_section(wo, ior, absorption_coefficient);
        vec3 both = 0.5 * tint[2] * section.A_rest;
        vec3 front = tint[0] * section.A[0] + tint[2] * section.A[2] + both;
        vec3 back = tint[1] * section.A[1] + both;
        vec3 light = front * mx_environment_irradiance(N) + back * mx_environment_irradiance(-N);
        bsdf.response = light * M_PI_INV;
    }
}
