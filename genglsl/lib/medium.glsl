// SPDX-License-Identifier: Apache-2.0

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"

// Media have the type VDF since MaterialX 1.39.5, and BSDF before.

// MaterialX's GLSL has no version macro. AIRY_FRESNEL_ITERATIONS came with the type VDF.
#ifdef AIRY_FRESNEL_ITERATIONS
#define EONLIB_VDF VDF
#else
#define EONLIB_VDF BSDF
#endif
