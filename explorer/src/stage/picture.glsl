// SPDX-License-Identifier: Apache-2.0
// Combines the pictures of both materials in linear light, premultiplied by opacity, and averages
// all frames.

uniform highp sampler2D stage_left;
uniform highp sampler2D stage_right;
uniform highp sampler2D stage_before;
uniform highp sampler2D stage_surface;
uniform highp sampler2D stage_place;
uniform highp sampler2D stage_detail;
uniform highp sampler2D stage_lit;
uniform highp sampler2D stage_environment;
uniform highp sampler2D stage_irradiance;
uniform vec3 stage_light_view;
uniform float stage_intensity;
uniform float stage_share; // Weight of this frame in the average.
uniform float stage_gain; // Scale factor of the exposure.
uniform float stage_shift; // Offset of each side in pixels if shown side by side, otherwise 0.
// Position of the wipe in pixels from the left. The left material is to the left of the wipe.
uniform float stage_edge;
uniform float stage_scale; // Difference shown in the last color; 0 for a picture.
uniform vec3 stage_colors[9]; // Colors of differences from -scale to +scale, linear.
uniform bool stage_traced; // Whether the sides' pictures include the floor.
uniform bool stage_backdrop; // Whether the surroundings are visible.

out vec4 stage_picture;

// The gray Lambertian floor.
vec3 stage_floor(vec3 normal, float ambient, float lit)
{
    vec3 light = vec3(stage_intensity * lit * max(dot(normal, stage_light_view), 0.0));
    vec3 incoming = texture(stage_irradiance, stage_latlong(stage_camera * normal)).xyz;
    return STAGE_FLOOR_RHO * (light + ambient * incoming);
}

// Color of the signed difference in the channel that differs most.
vec3 stage_difference(vec3 difference)
{
    vec3 size = abs(difference);
    float most = size.x > size.y ? difference.x : difference.y;
    most = size.z > abs(most) ? difference.z : most;
    float at = clamp(most / stage_scale, -1.0, 1.0) * 4.0 + 4.0;
    int low = min(int(at), 7);
    return mix(stage_colors[low], stage_colors[low + 1], at - float(low));
}


void main()
{
    bool left = gl_FragCoord.x + stage_jitter.x < stage_edge;
    float shift = left ? stage_shift : -stage_shift;
    ivec2 at = ivec2(gl_FragCoord.xy + vec2(shift, 0.0));
    vec4 surface = texelFetch(stage_surface, at, 0);
    float opacity = texelFetch(stage_detail, at, 0).z;
    bool floor_seen = surface.w == 2.0;
    vec3 color = vec3(0.0);
    if (stage_scale > 0.0) {
        if (surface.w == 1.0)
            color = stage_difference(texelFetch(stage_left, at, 0).xyz - texelFetch(stage_right, at, 0).xyz);
        opacity = floor_seen ? 0.0 : opacity;
    } else {
        vec4 side = left ? texelFetch(stage_left, at, 0) : texelFetch(stage_right, at, 0);
        // At the rim, some of a pixel's paths hit nothing.
        if (stage_traced) {
            color = side.xyz / max(side.w, 1.0e-6);
            opacity = surface.w > 0.0 ? opacity * side.w : side.w;
        } else if (surface.w == 1.0)
            color = side.xyz;
        else if (floor_seen)
            color = stage_floor(surface.xyz, texelFetch(stage_place, at, 0).w, texelFetch(stage_lit, at, 0).x);
        color = clamp(stage_gain * color, 0.0, 1.0);
        if (stage_backdrop) {
            vec3 ray = stage_camera * normalize(vec3((stage_from_center() + vec2(2.0 * shift, 0.0)) / min(stage_frame.x, stage_frame.y), -1.6));
            vec3 behind = stage_gain * textureLod(stage_environment, stage_latlong(ray), 1.0).xyz;
            color = mix(clamp(behind, 0.0, 1.0), color, opacity);
            opacity = 1.0;
        }
    }
    vec4 now = vec4(opacity * color, opacity);
    stage_picture = stage_share < 1.0 ? mix(texelFetch(stage_before, ivec2(gl_FragCoord.xy), 0), now, stage_share) : now;
}
