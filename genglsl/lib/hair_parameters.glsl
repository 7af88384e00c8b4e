// SPDX-License-Identifier: Apache-2.0
// Roughness and absorption of hair from artistic parameters.

// Roughness and albedo are at least this value, to avoid 1 / 0 and log(0).
#define HAIR_LEAST 1e-3

// Least value of 1 - concentration of melanin, so that its logarithm is finite.
#define HAIR_LEAST_SHARE 1e-4

// Least color of a pigment, so that its logarithm is finite.
#define HAIR_LEAST_COLOR 1e-30

// Longitudinal variance v: [MaterialX2026], Hair Roughness Conversion Equations.
float hair_variance(float longitudinal)
{
    float l = clamp(longitudinal, HAIR_LEAST, 1.0);
    float root = l * (0.726 + 0.812 * l) + 3.7 * pow(l, 20.0);
    return root * root;
}

// Azimuthal logistic scale s: [MaterialX2026], Hair Roughness Conversion Equations.
float hair_logistic(float azimuthal)
{
    float a = clamp(azimuthal, HAIR_LEAST, 1.0);
    return a * (0.265 + 1.194 * a) + 5.372 * pow(a, 22.0);
}

// Absorption of two melanins, whose total amount is -log(1 - concentration): [dEon2011].
vec3 hair_absorption_of_melanin(float concentration, float redness, vec3 eumelanin, vec3 pheomelanin)
{
    float melanin = -log(max(1.0 - max(concentration, 0.0), HAIR_LEAST_SHARE));
    float red = clamp(redness, 0.0, 1.0);
    vec3 brown = -log(clamp(eumelanin, vec3(HAIR_LEAST_COLOR), vec3(1.0)));
    vec3 blond = -log(clamp(pheomelanin, vec3(HAIR_LEAST_COLOR), vec3(1.0)));
    return melanin * ((1.0 - red) * brown + red * blond);
}

// Absorption of hair with a given apparent albedo, by the fit of [Chiang2016].
vec3 hair_absorption_of_albedo(vec3 scattering, float azimuthal)
{
    float b = clamp(azimuthal, 0.0, 1.0);
    float fit = 5.969 - b * (0.215 - b * (2.532 - b * (10.73 - b * (5.574 + b * 0.245))));
    vec3 root = log(clamp(scattering, vec3(HAIR_LEAST), vec3(1.0))) / fit;
    return root * root;
}
