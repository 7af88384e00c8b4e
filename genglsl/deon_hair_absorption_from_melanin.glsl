// SPDX-License-Identifier: Apache-2.0

#include "lib/hair_parameters.glsl"

void deon_hair_absorption_from_melanin(float melanin_concentration, float melanin_redness,
                                       vec3 eumelanin_color, vec3 pheomelanin_color,
                                       out vec3 absorption)
{
    absorption = hair_absorption_of_melanin(melanin_concentration, melanin_redness, eumelanin_color,
                                            pheomelanin_color);
}
