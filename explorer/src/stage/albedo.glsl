// SPDX-License-Identifier: Apache-2.0
// Directional albedo of a model by quadrature, at 256 cosines. STAGE_VALUE evaluates the model.
//
// The integrand is smooth except at the polar angle of wo, where the larger cosine switches, and at
// the azimuth where s changes sign. Each smooth rectangle has 16 by 16 Gauss-Legendre nodes. Angles
// are tangents of half angles, so that cosines and sines are quotients, which are more precise than
// drivers' trigonometric functions.

uniform vec3 stage_rho;
uniform float stage_parameter;

out vec4 stage_albedo;

// Half of the 16 nodes and weights on [-1, 1]. The other half are mirror images.
const float NODES[8] = float[8](0.0950125098, 0.2816035508, 0.4580167777, 0.6178762444,
                                0.7554044084, 0.8656312024, 0.9445750231, 0.9894009350);
const float WEIGHTS[8] = float[8](0.1894506105, 0.1826034150, 0.1691565194, 0.1495959888,
                                  0.1246289713, 0.0951585117, 0.0622535239, 0.0271524594);

// A node in [low, high], and the weight of the node.
vec2 stage_node(int k, float low, float high)
{
    float node = k < 8 ? -NODES[k] : NODES[k - 8];
    return 0.5 * vec2(low + high + (high - low) * node, (high - low) * WEIGHTS[k & 7]);
}

// Cosine and sine of the angle whose half has the tangent t, and the angle's derivative by t.
vec3 stage_angle(float t)
{
    return vec3(1.0 - t * t, 2.0 * t, 2.0) / (1.0 + t * t);
}

// Integral over half of the hemisphere, y > 0. Tangents of half polar angles are in [low, high].
vec3 stage_zone(vec3 wo, float low, float high, vec3 rho, float r)
{
    vec3 sum = vec3(0.0);
    for (int k = 0; k < 16; ++k) {
        vec2 polar = stage_node(k, low, high);
        vec3 theta = stage_angle(polar.x);
        for (int n = 0; n < 32; ++n) {
            vec2 azimuth = stage_node(n & 15, 0.0, 1.0);
            vec3 phi = stage_angle(azimuth.x);
            float ahead = n < 16 ? phi.x : -phi.x;
            vec3 wi = vec3(theta.y * ahead, theta.y * phi.y, theta.x);
            sum += polar.y * theta.z * theta.x * theta.y * azimuth.y * phi.z * STAGE_VALUE;
        }
    }
    return sum;
}

void main()
{
    float mu = (gl_FragCoord.x - 0.5) / 255.0;
    float S = sqrt((1.0 - mu) * (1.0 + mu));
    vec3 wo = vec3(S, 0.0, mu);
    float tangent = S / (1.0 + mu);
    vec3 sum = vec3(0.0);
    // The loop makes compilers inline the model only once.
    for (int zone = 0; zone < 2; ++zone) {
        float low = zone == 0 ? 0.0 : tangent;
        sum += stage_zone(wo, low, zone == 0 ? tangent : 1.0, stage_rho, stage_parameter);
    }
    stage_albedo = vec4(2.0 * sum, 1.0);
}
