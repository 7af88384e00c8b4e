// SPDX-License-Identifier: Apache-2.0

#include "lib/questions.glsl"
#include "../chiang_hair_bsdf.glsl"

// Hair for path tracers. Inclinations are drawn from the distribution M_p of a lobe p as in
// [dEon2013]. Azimuths are drawn by inversion of N_p, a logistic distribution cut at +-pi. Both
// distributions describe light tilted by the cuticle, so draws are tilted back.

// The lobes R, TT, TRT and TRRT+ for one view. Attenuations `weight` are averaged over colors. The
// cuticle tilts light by `tilt`. `exit` is the azimuth of a lobe's center. Angles are unit complex
// numbers.
struct PathHair
{
    vec4 weight;
    vec2 roughness[4];
    vec2 tilt[4];
    vec2 exit[4];
};

// The azimuth of a direction (x, y, z) is the angle of z + i y.
PathHair path_hair(vec3 wo, vec3 tint_R, vec3 tint_TT, vec3 tint_TRT, float ior, vec2 roughness_R, vec2 roughness_TT,
                   vec2 roughness_TRT, float cuticle_angle, vec3 absorption)
{
    ChiangHairSection section = chiang_hair_section(wo, ior, absorption);
    PathHair hair;
    hair.weight = vec4(path_mean(tint_R * section.A[0]), path_mean(tint_TT * section.A[1]),
                       path_mean(tint_TRT * section.A[2]), path_mean(tint_TRT * section.A_rest));
    vec2 least = vec2(1e-8, 1e-4);
    hair.roughness[0] = max(roughness_R, least);
    hair.roughness[1] = max(roughness_TT, least);
    hair.roughness[2] = max(roughness_TRT, least);
    hair.roughness[3] = hair.roughness[2];
    float c = length(wo.yz);
    vec2 inside = -chiang_hair_product(section.gamma_t, section.gamma_t) * vec2(1.0, -1.0);
    vec2 turned = chiang_hair_product(section.gamma_o, section.gamma_o);
    hair.exit[0] = chiang_hair_product(c > 0.0 ? wo.zy / c : vec2(1.0, 0.0), turned);
    vec2 alpha = chiang_hair_tilt(M_PI * (cuticle_angle - 0.5));
    vec2 back = chiang_hair_product(alpha, chiang_hair_product(alpha, alpha)) * vec2(1.0, -1.0);
    hair.tilt[0] = chiang_hair_product(alpha, alpha);
    for (int p = 1; p < 3; ++p)
    {
        hair.exit[p] = chiang_hair_product(hair.exit[p - 1], inside);
        hair.tilt[p] = chiang_hair_product(hair.tilt[p - 1], back);
    }
    hair.exit[3] = vec2(1.0, 0.0);
    hair.tilt[3] = vec2(1.0, 0.0);
    return hair;
}

vec2 path_hair_untilted(vec2 tilted, vec2 tilt)
{
    return chiang_hair_product(tilted, tilt * vec2(1.0, -1.0));
}

// Density of wi in 1/sr. The model mirrors inclinations tilted past the end of the fiber, so two
// directions wi may have the same tilted direction. Sampling chooses wi by cosine.
// If no wi has the tilted direction, the sample tilts past the end of the fiber.
float path_hair_pdf(PathHair hair, vec3 wo, vec3 wi)
{
    vec2 inclined_o = vec2(length(wo.yz), wo.x);
    float c = max(length(wi.yz), 1e-6);
    float sum = 0.0;
    for (int p = 0; p < 4; ++p)
    {
        for (float side = 1.0; side > -2.0; side -= 2.0)
        {
            vec2 tilted = chiang_hair_product(vec2(side * c, wi.x), hair.tilt[p]);
            vec2 from_exit = chiang_hair_product(side / c * wi.zy * vec2(1.0, -1.0), hair.exit[p]);
            float N = p < 3 ? chiang_hair_around(from_exit, hair.roughness[p].y) : 0.5 * M_PI_INV;
            float M = chiang_hair_along(tilted, inclined_o, hair.roughness[p].x);
            float other = path_hair_untilted(tilted * vec2(-1.0, 1.0), hair.tilt[p]).x;
            float passed = other > 0.0 ? 0.0 : max(tilted.x, 0.0) / c;
            sum += hair.weight[p] * M * N * (side > 0.0 ? abs(tilted.x) / (c + max(other, 0.0)) : passed);
        }
    }
    return sum / dot(hair.weight, vec4(1.0));
}

// Draws wi. path_u.z selects the lobe. The first 12 bits of path_u.x and path_u.y select the
// inclination, and the next 12 bits select the azimuth.
vec3 path_hair_draw(PathHair hair, vec3 wo)
{
    float left = path_u.z * dot(hair.weight, vec4(1.0));
    int p = 0;
    while (p < 3 && left >= hair.weight[p])
    {
        left -= hair.weight[p];
        ++p;
    }
    path_u.z = clamp(left / hair.weight[p], 0.0, 1.0 - 1.0 / 16777216.0);
    vec2 u = (floor(4096.0 * path_u.xy) + 0.5) / 4096.0;
    vec2 low = floor(4096.0 * fract(4096.0 * path_u.xy));
    float u_azimuth = (low.x + (low.y + 0.5) / 4096.0) / 4096.0;

    float v = hair.roughness[p].x;
    float z = clamp(1.0 + v * log(u.x + (1.0 - u.x) * exp(-2.0 / v)), -1.0, 1.0);
    float across = sqrt((1.0 - z) * (1.0 + z)) * mx_cos(2.0 * M_PI * u.y);
    float S = clamp(across * length(wo.yz) - z * wo.x, -1.0, 1.0);
    vec2 tilted = vec2(sqrt((1.0 - S) * (1.0 + S)), S);
    vec2 inclined = path_hair_untilted(tilted, hair.tilt[p]);
    vec2 folded = path_hair_untilted(tilted * vec2(-1.0, 1.0), hair.tilt[p]);
    float folds = max(folded.x, 0.0) / (max(inclined.x, 0.0) + max(folded.x, 1e-30));  // 0 if no cosine > 0
    bool folding = path_u.z < folds;
    inclined = folding ? folded : inclined;
    path_u.z = folding ? path_u.z / folds : (path_u.z - folds) / (1.0 - folds);

    float scale = sqrt(M_PI / 8.0) * hair.roughness[p].y;
    float rest = exp(-M_PI / scale);
    float share = rest / (1.0 + rest) + u_azimuth * (1.0 - rest) / (1.0 + rest);
    float angle = p < 3 ? -scale * log(1.0 / share - 1.0) : 2.0 * M_PI * u_azimuth;
    vec2 zy = inclined.x * chiang_hair_product(vec2(mx_cos(angle), mx_sin(angle)), hair.exit[p]);
    return vec3(inclined.y, zy.y, zy.x);
}

void path_chiang_hair_bsdf(ClosureData closureData, vec3 tint_R, vec3 tint_TT, vec3 tint_TRT, float ior,
                           vec2 roughness_R, vec2 roughness_TT, vec2 roughness_TRT, float cuticle_angle,
                           vec3 absorption_coefficient, vec3 N, vec3 X, inout BSDF bsdf)
{
    if (!path_is_asked(closureData))
    {
        return;
    }
    chiang_hair_bsdf(path_question(closureData), tint_R, tint_TT, tint_TRT, ior, roughness_R, roughness_TT,
                     roughness_TRT, cuticle_angle, absorption_coefficient, N, X, bsdf);
    if (path_asked != PATH_VALUE)
    {
        N = mx_forward_facing_normal(N, path_wo);
        X = normalize(X - dot(X, N) * N);
        vec3 wo = path_local(path_wo, X, N);
        PathHair hair = path_hair(wo, tint_R, tint_TT, tint_TRT, ior, roughness_R, roughness_TT, roughness_TRT,
                                  cuticle_angle, absorption_coefficient);
        vec3 drawn = path_asked == PATH_DRAW ? path_hair_draw(hair, wo) : wo;
        bsdf.response = path_answer(path_mean(bsdf.response), path_packed(path_world(drawn, X, N)),
                                    path_hair_pdf(hair, wo, path_local(path_wi, X, N)));
    }
    path_end(bsdf);
}
