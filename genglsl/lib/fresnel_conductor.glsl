// SPDX-License-Identifier: Apache-2.0
// F_ss of a metal, the average of its Fresnel reflectance over the hemisphere, weighted by the cosine.

#include "libraries/pbrlib/genglsl/lib/mx_microfacet_specular.glsl"

// 1 - F_ss of a metal from three cosines. Source: tools/fits/fresnel_average.py.
// Domain: index in [0.05, 5], extinction in [0.5, 10]. Largest absolute error: 4.6e-4.
#define FRESNEL_AVG_C0 0.22
#define FRESNEL_AVG_W0 0.13509272
#define FRESNEL_AVG_C1 0.58
#define FRESNEL_AVG_W1 0.43804992
#define FRESNEL_AVG_C2 0.9
#define FRESNEL_AVG_W2 0.42364277

vec3 eonlib_fresnel_conductor_avg(vec3 ior, vec3 extinction)
{
    return 1.0 - FRESNEL_AVG_W0 * (1.0 - mx_fresnel_conductor(FRESNEL_AVG_C0, ior, extinction))
           - FRESNEL_AVG_W1 * (1.0 - mx_fresnel_conductor(FRESNEL_AVG_C1, ior, extinction))
           - FRESNEL_AVG_W2 * (1.0 - mx_fresnel_conductor(FRESNEL_AVG_C2, ior, extinction));
}
