// SPDX-License-Identifier: Apache-2.0

#include "libraries/pbrlib/genglsl/lib/mx_microfacet_specular.glsl"

// Cosine-weighted average F_ss of a metal's Fresnel reflectance F, from F at three cosines. Source:
// tools/fits/fresnel_average.py. Domain: ior in [0.05, 5], extinction in [0.5, 10]. Largest
// absolute error: 4.6e-4.
vec3 eonlib_fresnel_conductor_avg(vec3 ior, vec3 extinction)
{
    return 1.0 - 0.13509272 * (1.0 - mx_fresnel_conductor(0.22, ior, extinction))
           - 0.43804992 * (1.0 - mx_fresnel_conductor(0.58, ior, extinction))
           - 0.42364277 * (1.0 - mx_fresnel_conductor(0.9, ior, extinction));
}
