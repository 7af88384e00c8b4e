// SPDX-License-Identifier: Apache-2.0
// The type of media: MaterialX has its own since 1.39.5, and used the type of BSDFs before.

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"

// MaterialX's text has no version, but this macro for films came with the type.
#ifdef AIRY_FRESNEL_ITERATIONS
#define EONLIB_VDF VDF
#else
#define EONLIB_VDF BSDF
#endif
