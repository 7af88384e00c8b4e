// SPDX-License-Identifier: Apache-2.0
// The type of media, which MaterialX has since 1.39.5; before, it gives them that of BSDFs.

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"

// MaterialX states no version in its text; this macro of its films came with the type.
#ifdef AIRY_FRESNEL_ITERATIONS
#define EONLIB_VDF VDF
#else
#define EONLIB_VDF BSDF
#endif
