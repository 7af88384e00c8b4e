// SPDX-License-Identifier: Apache-2.0
// Evaluates the Oren-Nayar closure of a kernel of Cycles: its header, with the few types that it needs.
// Reads lines of view, light, color and roughness; prints pi f cos(light) of each channel.

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <iomanip>
#include <iostream>

#define CCL_NAMESPACE_BEGIN
#define CCL_NAMESPACE_END
#define ccl_device inline
#define ccl_device_inline inline
#define ccl_private
#define SHADER_CLOSURE_BASE float3 weight; int type; float3 N

struct float2 { float x, y; };
struct float3 { float x, y, z; };
using Spectrum = float3;
struct ShaderClosure { float3 base[8]; };
struct ShaderData { float3 wi; };

constexpr float M_PI_F = 3.14159265358979f, M_PI_2_F = M_PI_F / 2, M_1_PI_F = 1 / M_PI_F, M_2PI_F = 2 * M_PI_F;
enum { CLOSURE_BSDF_OREN_NAYAR_ID, SD_BSDF = 1, SD_BSDF_HAS_EVAL = 2, LABEL_REFLECT = 4, LABEL_DIFFUSE = 8 };

inline float3 operator+(float3 a, float3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline float3 operator-(float3 a, float3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline float3 operator*(float3 a, float3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline float3 operator/(float3 a, float3 b) { return {a.x / b.x, a.y / b.y, a.z / b.z}; }
inline float3 operator*(float3 a, float b) { return {a.x * b, a.y * b, a.z * b}; }
inline float3 operator*(float a, float3 b) { return b * a; }
inline float dot(float3 a, float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline float sqr(float x) { return x * x; }
inline float3 sqr(float3 x) { return x * x; }
inline float max(float a, float b) { return std::max(a, b); }
inline float saturatef(float x) { return std::clamp(x, 0.0f, 1.0f); }
inline float3 saturate(float3 c) { return {saturatef(c.x), saturatef(c.y), saturatef(c.z)}; }
inline float3 make_spectrum(float x) { return {x, x, x}; }
inline float3 one_spectrum() { return make_spectrum(1); }
inline float3 zero_spectrum() { return make_spectrum(0); }
inline float sin_from_cos(float c) { return std::sqrt(max(1 - c * c, 0)); }
inline float safe_acosf(float x) { return std::acos(std::clamp(x, -1.0f, 1.0f)); }
inline void sample_cos_hemisphere(float3, float2, float3 *, float *) {}

#include "closure/bsdf_oren_nayar.h"

int main()
{
    float3 view, light, color;
    OrenNayarBsdf bsdf{};
    bsdf.N = {0, 0, 1};
    std::cout << std::setprecision(9);
    while (std::cin >> view.x >> view.y >> view.z >> light.x >> light.y >> light.z >> color.x >> color.y >> color.z >>
           bsdf.roughness) {
        ShaderData data{view};
        bsdf_oren_nayar_setup(&data, &bsdf, color);
        float pdf;
        float3 value = M_PI_F * color * bsdf_oren_nayar_eval((ShaderClosure *)&bsdf, view, light, &pdf);
        std::cout << value.x << ' ' << value.y << ' ' << value.z << '\n';
    }
}
