// SPDX-License-Identifier: Apache-2.0
// Node blackbody: color in linear Rec. 709 with luminance 1.

// Fits of X and Z of a black body with Y = 1 at temperature T: quotients N / D of polynomials in
// t = 1000 K / T. Source: tools/fits/blackbody.py. Domain: [800, 25000] K. Largest
// absolute errors: 2.6e-5 of X, 6.7e-5 of Z.
#define BLACKBODY_X_N0 1.0227899
#define BLACKBODY_X_N1 2.9880568
#define BLACKBODY_X_N2 15.714266
#define BLACKBODY_X_N3 26.662602
#define BLACKBODY_X_N4 22.522789
#define BLACKBODY_X_D1 3.3497442
#define BLACKBODY_X_D2 21.050569
#define BLACKBODY_X_D3 2.4803443
#define BLACKBODY_X_D4 8.483762
#define BLACKBODY_Z_N0 2.2417205
#define BLACKBODY_Z_N1 -4.9255056
#define BLACKBODY_Z_N2 5.9266146
#define BLACKBODY_Z_N3 -4.031977
#define BLACKBODY_Z_N4 1.130666
#define BLACKBODY_Z_D1 0.47280048
#define BLACKBODY_Z_D2 17.785216
#define BLACKBODY_Z_D3 -22.91965
#define BLACKBODY_Z_D4 46.083796

float blackbody_X(float t)
{
    float N = BLACKBODY_X_N0
              + t * (BLACKBODY_X_N1
                     + t * (BLACKBODY_X_N2 + t * (BLACKBODY_X_N3 + t * BLACKBODY_X_N4)));
    float D = 1.0
              + t * (BLACKBODY_X_D1
                     + t * (BLACKBODY_X_D2 + t * (BLACKBODY_X_D3 + t * BLACKBODY_X_D4)));
    return N / D;
}

float blackbody_Z(float t)
{
    float N = BLACKBODY_Z_N0
              + t * (BLACKBODY_Z_N1
                     + t * (BLACKBODY_Z_N2 + t * (BLACKBODY_Z_N3 + t * BLACKBODY_Z_N4)));
    float D = 1.0
              + t * (BLACKBODY_Z_D1
                     + t * (BLACKBODY_Z_D2 + t * (BLACKBODY_Z_D3 + t * BLACKBODY_Z_D4)));
    return N / D;
}

// Converts XYZ to linear Rec. 709 by IEC 61966-2-1. Negative blue (below 1900 K) and green (below
// 964 K) are clamped to 0.
void blackbody_rec709(float temperature, out vec3 result)
{
    float t = 1000.0 / clamp(temperature, 800.0, 25000.0);
    float X = blackbody_X(t);
    float Z = blackbody_Z(t);
    vec3 rec709 = vec3(3.2404542 * X - 1.5371385 - 0.4985314 * Z,
                       -0.9692660 * X + 1.8760108 + 0.0415560 * Z,
                       0.0556434 * X - 0.2040259 + 1.0572252 * Z);
    rec709 = max(rec709, vec3(0.0));
    result = rec709 / dot(rec709, vec3(0.2126729, 0.7151522, 0.0721750));
}
