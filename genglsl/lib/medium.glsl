// SPDX-License-Identifier: Apache-2.0
// The type of media, which MaterialX has since 1.39.5; before, it gives them that of BSDFs.

#include "libraries/pbrlib/genglsl/lib/mx_closure_type.glsl"

// Only what MaterialX generates since 1.39.5 has this macro.
#ifndef AIRY_FRESNEL_ITERATIONS
#define VDF BSDF
#endif
