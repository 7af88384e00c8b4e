// SPDX-License-Identifier: Apache-2.0
// Directional albedo of a model by quadrature, at 256 cosines. Stands behind STAGE_VALUE.
//
// The integrand is smooth between the polar angle of wo, where the larger cosine changes, and the
// azimuth at which s changes its sign: four rectangles with Gauss-Legendre nodes in each.

uniform vec3 stage_rho;
uniform float stage_parameter;

out vec4 stage_albedo;

// Half of the 16 nodes and weights of [-1, 1]; the others are their mirror images.
const float NODES[8] = float[8](0.0950125098, 0.2816035508, 0.4580167777, 0.6178762444,
                                0.7554044084, 0.8656312024, 0.9445750231, 0.9894009350);
const float WEIGHTS[8] = float[8](0.1894506105, 0.1826034150, 0.1691565194, 0.1495959888,
                                  0.1246289713, 0.0951585117, 0.0622535239, 0.0271524594);

vec2 stage_node(int k)
{
    return k < 8 ? vec2(-NODES[k], WEIGHTS[k]) : vec2(NODES[k - 8], WEIGHTS[k - 8]);
}

// Integral over a rectangle of polar angle and azimuth, the first from `low` to `high`.
vec3 stage_rectangle(vec3 wo, float low, float high, float azimuth, vec3 rho, float r)
{
    vec3 sum = vec3(0.0);
    for (int k = 0; k < 16; ++k) {
        vec2 polar = stage_node(k);
        float theta = 0.5 * (low + high + (high - low) * polar.x);
        float S = sin(theta);
        for (int n = 0; n < 16; ++n) {
            vec2 around = stage_node(n);
            float phi = azimuth + 0.25 * EON_PI * (1.0 + around.x);
            vec3 wi = vec3(S * cos(phi), S * sin(phi), cos(theta));
            sum += polar.y * around.y * wi.z * S * STAGE_VALUE;
        }
    }
    return 0.5 * (high - low) * 0.25 * EON_PI * sum;
}

void main()
{
    float mu = (gl_FragCoord.x - 0.5) / 255.0;
    vec3 wo = vec3(sqrt((1.0 - mu) * (1.0 + mu)), 0.0, mu);
    float theta = 0.5 * EON_PI * oren_nayar_angle(wo.x, mu);
    vec3 sum = vec3(0.0);
    for (int quarter = 0; quarter < 2; ++quarter) {
        float azimuth = 0.5 * EON_PI * float(quarter);
        sum += stage_rectangle(wo, 0.0, theta, azimuth, stage_rho, stage_parameter);
        sum += stage_rectangle(wo, theta, 0.5 * EON_PI, azimuth, stage_rho, stage_parameter);
    }
    stage_albedo = vec4(2.0 * sum, 1.0);
}
